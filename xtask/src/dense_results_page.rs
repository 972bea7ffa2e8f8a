use std::fmt::Write;

use crate::comparison::{
    Comparison, Contestant, Measure, all_bad_1, seconds, visible_bad_1, visible_mean,
};
use crate::estimator::Preset;
use crate::markdown_table::MarkdownTable;
use crate::marks;
use crate::metrics::Metrics;
use crate::score_tables;

const READING: &str = "\
Every matcher gives a value at every pixel and searches the same disparities, from 0 to the first \
multiple of 16 above the largest true one, less one. OpenCV's left border is continued by that \
range, so that it covers the whole picture; its holes take the lower of the nearest valid values on \
the row. Of each of its modes the setting of a small grid stands here that has the least mean of \
visible bad-1 over all scenes; ours has one parameter set for all. Masks and measures are those of \
the [results of the vector pyramid](results.md).
";

/// The page `docs/dense-results.md`.
pub(crate) fn dense_results_page(comparison: &Comparison) -> String {
    let machine = &comparison.machine;
    let versions = comparison.versions.iter();
    let versions: Vec<String> = versions
        .map(|(name, version)| format!("{name} {version}"))
        .collect();
    let mut page = format!(
        "# Dense disparity beside OpenCV\n\n\
         Written by `cargo xtask compare-opencv`; edits by hand are lost.\n\n\
         - date: {}\n- machine: {}, one thread of {} core{}\n- compiler: {}, {} build\n\
         - command: `{}`\n- {}\n\n## How to read this\n\n{READING}",
        comparison.date,
        machine.cpu,
        machine.cores,
        if machine.cores == 1 { "" } else { "s" },
        machine.rustc,
        machine.build,
        comparison.command,
        versions.join(", "),
    );
    // Writing to a string does not fail.
    let _ = writeln!(page, "\nThe settings of OpenCV's modes:\n");
    for chosen in comparison.chosen() {
        let _ = writeln!(page, "- {}: {}", chosen.name, chosen.setting);
    }
    let tables: [(&str, Measure, usize); 4] = [
        ("Visible pixels: bad-1, %", visible_bad_1, 2),
        ("Visible pixels: mean absolute error, px", visible_mean, 3),
        ("All pixels: bad-1, %", all_bad_1, 2),
        ("CPU time, s", seconds, 3),
    ];
    for (title, measure, digits) in tables {
        let _ = write!(
            page,
            "\n## {title}\n\n{}",
            side_by_side(comparison, measure, digits)
        );
    }
    let _ = write!(
        page,
        "\n## At the density of OpenCV's own valid pixels\n\nbad-1 % / mean px over the visible pixels \
         that SGBM calls valid, and over as many of our most confident ones.\n\n{}",
        at_density(comparison)
    );
    for (preset, scores) in [
        (Preset::Best, &comparison.best_scores),
        (Preset::Fast, &comparison.fast_scores),
    ] {
        if let Some(table) = marks::table(scores, preset) {
            let _ = write!(page, "\n## The marks of `{}`\n\n{table}", preset.name());
        }
        let _ = write!(
            page,
            "\n## The order of the confidence of `{}`\n\nArea under the sparsification curve: bad-1 % \
             among the most confident visible pixels, averaged over all numbers of them.\n\n{}",
            preset.name(),
            score_tables::of_sparsification(scores)
        );
        let _ = write!(
            page,
            "\n## Summary of `{}`, visible pixels\n\n{}",
            preset.name(),
            score_tables::of_all(scores)
        );
    }
    page
}

/// One measure of every scene, ours first.
fn side_by_side(comparison: &Comparison, measure: Measure, digits: usize) -> MarkdownTable {
    let chosen = comparison.chosen();
    let contestants = || {
        [&comparison.best, &comparison.fast]
            .into_iter()
            .chain(chosen.iter().copied())
    };
    let mut table = MarkdownTable::with_head(
        std::iter::once("scene".to_owned()).chain(contestants().map(|one| one.name.clone())),
    );
    for (place, scene) in comparison.best.scenes.iter().enumerate() {
        let cells = contestants().map(|one: &Contestant| {
            let on = one.scenes.get(place);
            on.map_or_else(String::new, |on| format!("{:.digits$}", measure(on)))
        });
        table.push(std::iter::once(scene.scene.clone()).chain(cells));
    }
    let means = contestants().map(|one| format!("{:.digits$}", one.mean(measure)));
    table.push(std::iter::once("mean".to_owned()).chain(means));
    table
}

/// SGBM over its own valid pixels and ours over as many.
fn at_density(comparison: &Comparison) -> MarkdownTable {
    let mut table = MarkdownTable::new(["scene", "density %", "SGBM", "best", "fast"]);
    let chosen = comparison.chosen();
    let sgbm = chosen.iter().find(|chosen| chosen.name == "SGBM");
    for on in sgbm.into_iter().flat_map(|sgbm| &sgbm.scenes) {
        let cell = |metrics: Option<Metrics>| {
            metrics.map_or_else(
                || "-".to_owned(),
                |m| format!("{:.2} / {:.3}", m.bad.one, m.mean_absolute),
            )
        };
        let density = on.estimated.map_or(0.0, |estimated| {
            100.0 * estimated.answered as f64 / on.visible.answered as f64
        });
        let ours = on.ours_at_its_density.iter().map(|metrics| cell(*metrics));
        let cells = [
            on.scene.clone(),
            format!("{density:.1}"),
            cell(on.estimated),
        ];
        table.push(cells.into_iter().chain(ours));
    }
    table
}
