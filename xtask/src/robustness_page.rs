use std::fmt::Write;

use crate::curve_svg::{Diagram, Sheet};
use crate::markdown_table::MarkdownTable;
use crate::metrics::Metrics;
use crate::robustness_marks;
use crate::robustness_run::{RobustnessRun, Trial};
use crate::robustness_series::Series;

const READING: &str = "\
The right picture of each pair is altered, the left one is not (noise of both eyes apart); what is \
altered is handed to every matcher as the same eight-bit pictures. Errors are those of the horizontal \
component over visible pixels whose true match lies in the altered right picture, and that the \
matcher itself answers; the density says how many those are.

- **Geometry**: the altered right camera is the true one followed by a projective map (down, turned \
about the middle, grown about the middle, nodding at a focal length of the picture's width). The \
truth is carried through the same map, point by point: left `(x, y)` matches `W(x - d, y)`, so that \
both components of the truth are exact. The picture is resampled once, by Lanczos interpolation with \
four lobes.
- **Photometry**, in the order of a camera: blur, gamma, gain and offset, noise, eight bits, all \
clipped to black and white.
- The vector pyramid gets its default parameters, and nothing of the alteration. OpenCV's matchers get \
the range of the untouched truth and 16 px more on either side; SGBM runs with eight paths, block 5, \
P1 = 200, P2 = 800, uniqueness 10, speckles of 100 px left out; BM with block 15 and the same checks.
";

/// The files of the curves, below docs/.
pub(crate) const ERROR_CURVES: &str = "pictures/robustness-error.svg";
/// The same for densities.
pub(crate) const DENSITY_CURVES: &str = "pictures/robustness-density.svg";

/// The page `docs/robustness.md`.
pub(crate) fn robustness_page(run: &RobustnessRun) -> String {
    let machine = &run.machine;
    let opencv = run.opencv.as_deref().unwrap_or("not run");
    let names: Vec<&str> = run.scenes.iter().map(|scene| &*scene.scene).collect();
    let mut page = format!(
        "# What a bad rig and a bad camera cost\n\n\
         Written by `cargo xtask eval-robustness`; edits by hand are lost.\n\n\
         - date: {}\n- machine: {}, {} core{}\n- compiler: {}, {} build\n- command: `{}`\n\
         - OpenCV: {opencv}\n- scenes: {}\n\n## How to read this\n\n{READING}\n\
         ## Marks\n\nMean absolute error over that of the untouched pair, valid and visible pixels.\n\n{}\n\
         ## Curves, means over the scenes\n\n![errors]({ERROR_CURVES})\n\n\
         ![densities]({DENSITY_CURVES})\n\n\
         ## Means over the scenes\n\nMean absolute error in px (density in per cent); dy is our vertical \
         component's.\n",
        run.date,
        machine.cpu,
        machine.cores,
        if machine.cores == 1 { "" } else { "s" },
        machine.rustc,
        machine.build,
        run.command,
        names.join(", "),
        robustness_marks::table(run),
    );
    // Writing to a string does not fail.
    for series in Series::ALL {
        if let Some(table) = table(run, series) {
            let _ = write!(page, "\n### {}\n\n{table}", series.title());
        }
    }
    page.push_str("\n## Scenes\n\n");
    for scene in &run.scenes {
        let _ = writeln!(page, "- **{}**: {}", scene.scene, scene.citation);
    }
    page
}

/// One row an amount, means over the scenes; `None` if the series was not run.
pub(crate) fn table(run: &RobustnessRun, series: Series) -> Option<MarkdownTable> {
    let mut table = MarkdownTable::new([
        "amount",
        "dorsal",
        "dorsal, dense",
        "dy",
        "SGBM",
        "BM",
        "bad-1 %: dorsal",
        "SGBM",
        "BM",
    ]);
    let mut rows = 0;
    for &amount in series.amounts() {
        let mean = |measure: &dyn Fn(&Trial) -> Option<f64>| run.mean(series, amount, measure);
        let Some(_) = mean(&|trial| Some(trial.ours?.mean_absolute)) else {
            continue;
        };
        let error = |of: fn(&Trial) -> Option<Metrics>| {
            let px = mean(&|trial| Some(of(trial)?.mean_absolute));
            let density = mean(&|trial| Some(of(trial)?.density));
            px.zip(density).map_or_else(
                || "-".to_owned(),
                |(px, density)| format!("{px:.3} ({:.0})", 100.0 * density),
            )
        };
        let plain = |found: Option<f64>| {
            found.map_or_else(|| "-".to_owned(), |number| format!("{number:.3}"))
        };
        let bad = |of: fn(&Trial) -> Option<Metrics>| {
            let bad = mean(&|trial| Some(of(trial)?.bad.one));
            bad.map_or_else(|| "-".to_owned(), |bad| format!("{bad:.1}"))
        };
        let [(_, ours), (_, sgbm), (_, bm)] = Trial::MATCHERS;
        table.push([
            format!("{amount}"),
            error(ours),
            error(|trial| trial.ours_dense),
            plain(mean(&|trial| Some(trial.ours_vertical?.mean_absolute))),
            error(sgbm),
            error(bm),
            bad(ours),
            bad(sgbm),
            bad(bm),
        ]);
        rows += 1;
    }
    (rows > 0).then_some(table)
}

/// The curves of a measure over every series, means over the scenes.
pub(crate) fn curves(run: &RobustnessRun, title: &str, measure: impl Fn(Metrics) -> f64) -> Sheet {
    let diagram = |series: Series| Diagram {
        title: series.title().to_owned(),
        curves: Trial::MATCHERS
            .iter()
            .map(|(_, of)| {
                let point = |&amount: &f64| {
                    let mean = run.mean(series, amount, |trial| of(trial).map(&measure))?;
                    Some((amount, mean))
                };
                series.amounts().iter().filter_map(point).collect()
            })
            .collect(),
    };
    let names = Trial::MATCHERS.iter().map(|(name, _)| (*name).to_owned());
    Sheet {
        title: title.to_owned(),
        names: names.collect(),
        // A curve has more than two points.
        diagrams: Series::ALL
            .into_iter()
            .filter(|series| *series != Series::Everything)
            .map(diagram)
            .collect(),
    }
}
