//! The paper's Table 1 beside our own, as tables for people.

use std::fmt::Write;

use crate::markdown_table::MarkdownTable;
use crate::metrics::Metrics;
use crate::table_1::{self, Printed};
use crate::table_1_row::{Filters, Matcher};
use crate::table_1_run::{RowRun, SceneRun, Table1Run};

/// One mask of a row.
type Over = fn(&RowRun) -> Option<Metrics>;

const PROTOCOL: &str = "\
One protocol for all rows. Every family has its default parameters: eight orientations (SQF: one a \
pixel), six scales, peak frequency pi / 2 rad/px, 11 x 11 taps (SQF: the Fourier domain), bandwidth \
1 octave (s4 1.22, s2 1.76, by their order), unit gain at the peak, no DC. The responses go through \
one matcher with the paper's own steps (`MatchParams::as_published`): from the coarsest scale to the \
finest one warp a scale, demodulated interpolation of the right responses, component disparities \
from phase differences over the peak frequency, a plain least-squares fit of both components where \
three orientations or more have an energy above 1e-6, one 3 x 3 median over valid neighbours; no \
look back, no robust weights, no prior.

- **SQF** knows one orientation a pixel, and one orientation tells one component. Its fit takes the \
components along the local orientations of a neighbourhood, a Gaussian of 2 px of each scale, with \
the structure tensor of the Riesz transform as matrix (`disparity_pyramid::estimate_monogenic`); a \
pixel is heard if its own energy is.
- **PBBDE** is the vector pyramid over Gabor responses. The paper does not say what its matcher does \
for the four rows above it, so under one protocol this row is the Gabor row.
- **rows only** is the same with the vertical component held at 0, which these rectified pairs allow.
- **two warps** is the same with a second warp a scale, which reads again what the first fell short of.
- **ours** is PBBDE with the default parameters of this library (`MatchParams::default`): two warps \
a scale and one at the finest, robust weights, 5 x 5 medians, a vertical prior, coherence, look back and filled quiet spots.

Errors are `d estimated - d true` in pixels, over the pixels that the estimator calls valid. \
**textured**: seen by both eyes, with a mean squared step to the right neighbour of at least four \
grey levels squared in 3 x 3 pixels, and outside the 9 x 9 windows about steps of the truth above \
2 px. **visible**: seen by both eyes. **common**: textured, and called valid by all four families under \
the protocol, so that no family gains by answering fewer pixels. mean and std are those of the absolute error, density is the \
part of the mask that is answered. ";

/// The page `docs/table-1.md`.
pub(crate) fn table_1_page(run: &Table1Run) -> String {
    let machine = &run.machine;
    let mut page = format!(
        "# The paper's Table 1, run again\n\n\
         Written by `cargo xtask eval-middlebury --table1`; edits by hand are lost. Why the rows \
         differ from the printed ones stands in [paper.md](paper.md).\n\n\
         - date: {}\n- machine: {}, {} cores\n- compiler: {}, {} build\n\n\
         ## Protocol\n\n{PROTOCOL}{}\n\n\
         ## Side by side\n\nMean / standard deviation of the absolute error, px (density), \
         textured.\n\n{}\nThe same over the common pixels.\n\n{}\n## What each family's phases are like\n\n\
         The finest scale of the left eye, responses of an energy above 1e-6. Ratio and spread: the \
         phase gradient along the wave vector over the peak frequency, its mean and standard \
         deviation without the outermost twentieths; a component is read this many times too \
         large. Unstable: the gradient leaves the wave vector by more than 40 % of the peak \
         frequency. Heard: pixels with three orientations or more.\n\n{}",
        run.date,
        machine.cpu,
        machine.cores,
        machine.rustc,
        machine.build,
        table_1::READING,
        side_by_side(&run.scenes, |row| row.textured),
        side_by_side(&run.scenes, |row| row.common),
        phases(&run.scenes),
    );
    for scene in &run.scenes {
        // Writing to a string does not fail.
        let _ = write!(page, "\n## {}\n\n", scene.scene);
        if scene.integer_truth {
            page.push_str(
                "The truth is rounded to whole pixels, which penalises a finer answer.\n\n",
            );
        }
        let _ = write!(page, "{}", of_scene(scene));
    }
    page
}

/// Paper and ours in one table: a row of the paper above each of ours.
pub(crate) fn side_by_side(scenes: &[SceneRun], over: Over) -> MarkdownTable {
    let [venus, sawtooth, tsukuba] = table_1::SCENES;
    let mut table = MarkdownTable::new(["mean / std, px", venus, sawtooth, tsukuba]);
    let ours = |filters, matcher| {
        table_1::SCENES.map(|name| {
            let scene = scenes.iter().find(|scene| scene.scene == name);
            let metrics = scene.and_then(|scene| over(scene.row(filters, matcher)?));
            metrics.map_or_else(
                || "-".to_owned(),
                |m| {
                    let (mean, std) = (m.mean_absolute, m.std_absolute);
                    format!("{mean:.3} / {std:.3} ({:.0} %)", 100.0 * m.density)
                },
            )
        })
    };
    let named = |name: String, cells: [String; 3]| std::iter::once(name).chain(cells);
    let families = Filters::ALL.into_iter().chain([Filters::Gabor]);
    for ((name, printed), filters) in table_1::ROWS.into_iter().zip(families) {
        let paper = printed.map(|Printed { mean, std }| format!("{mean:.2} / {std:.2}"));
        table.push(named(format!("{name}, paper"), paper));
        table.push(named(
            format!("{name}, here"),
            ours(filters, Matcher::Published),
        ));
    }
    for (matcher, what) in [
        (Matcher::PublishedRowsOnly, "rows only"),
        (Matcher::PublishedTwoWarps, "two warps"),
    ] {
        for filters in Filters::ALL {
            let name = format!("{}, here, {what}", filters.name());
            table.push(named(name, ours(filters, matcher)));
        }
    }
    table.push(named(
        "ours".to_owned(),
        ours(Filters::Gabor, Matcher::Default),
    ));
    table
}

/// Every measure of one scene, over every mask.
fn of_scene(scene: &SceneRun) -> MarkdownTable {
    let mut table = MarkdownTable::new([
        "row, mask",
        "mean",
        "std",
        "signed",
        "RMS",
        "bad-0.5 %",
        "bad-1 %",
        "bad-2 %",
        "bad-4 %",
        "density %",
        "pixels",
    ]);
    let masks: [(&str, Over); 3] = [
        ("textured", |row| row.textured),
        ("visible", |row| row.visible),
        ("common", |row| row.common),
    ];
    for run in &scene.rows {
        let name = match (run.row.filters, run.row.matcher) {
            (Filters::Gabor, Matcher::Published) => "Gabor, PBBDE".to_owned(),
            (filters, Matcher::Published) => filters.name().to_owned(),
            (filters, Matcher::PublishedRowsOnly) => format!("{}, rows only", filters.name()),
            (filters, Matcher::PublishedTwoWarps) => format!("{}, two warps", filters.name()),
            (_, Matcher::Default) => "ours".to_owned(),
        };
        for (mask, over) in masks {
            let metrics = over(run);
            let name = std::iter::once(format!("{name}; {mask}"));
            table.push(name.chain(metrics.iter().flat_map(Metrics::cells)));
        }
    }
    table
}

fn phases(scenes: &[SceneRun]) -> MarkdownTable {
    let mut table =
        MarkdownTable::new(["scene, family", "ratio", "spread", "unstable %", "heard %"]);
    for scene in scenes {
        for (filters, phases) in &scene.phases {
            let name = format!("{}, {}", scene.scene, filters.name());
            let cells = phases.map(|phases| {
                [
                    format!("{:.3}", phases.frequency_ratio),
                    format!("{:.3}", phases.frequency_spread),
                    format!("{:.1}", 100.0 * phases.unstable),
                    format!("{:.1}", 100.0 * phases.heard),
                ]
            });
            table.push(std::iter::once(name).chain(cells.into_iter().flatten()));
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Machine;
    use crate::score::tests::made_up;

    #[test]
    fn paper_and_ours_stand_together() {
        let metrics = made_up("venus").valid.all;
        let rows = Table1Run::rows().into_iter().map(|row| RowRun {
            row,
            textured: metrics,
            visible: metrics,
            common: metrics,
        });
        let page = table_1_page(&Table1Run {
            schema: Table1Run::SCHEMA,
            date: "2024-02-29".to_owned(),
            machine: Machine {
                cpu: "A CPU".to_owned(),
                cores: 2,
                rustc: "rustc 1".to_owned(),
                build: "release",
            },
            scenes: vec![SceneRun {
                scene: "venus".to_owned(),
                integer_truth: false,
                rows: rows.collect(),
                phases: vec![(Filters::Gabor, None)],
            }],
        });
        for (paper, ours) in [("Gabor, paper", "Gabor, here"), ("SQF, paper", "SQF, here")] {
            let (paper, ours) = (page.find(paper).unwrap(), page.find(ours).unwrap());
            assert!(paper < ours, "{page}");
        }
        for part in [
            "2024-02-29",
            "0.04 / 0.74",
            "0.500 / 0.000 (68 %)",
            "## venus",
        ] {
            assert!(page.contains(part), "{part} is not in\n{page}");
        }
    }
}
