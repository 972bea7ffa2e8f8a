use std::fmt::Write;

use crate::dense_robustness_marks;
use crate::dense_robustness_run::DenseRobustnessRun;
use crate::markdown_table::MarkdownTable;
use crate::metrics::Metrics;
use crate::opencv::TUNED_SGBM;

const READING: &str = "\
Every matcher gives a value at every pixel (density 100 %) and gets the same eight-bit pictures; errors \
are those over visible pixels whose true match lies in the right picture. Pictures are grey but for \
those as taken, which are in colour for ours, so that the clean figures are not those of \
[dense-results.md](dense-results.md). Noise has one seed. What the alterations are and how the truth is \
carried through them says [robustness.md](robustness.md). Ours aligns the rows of the rig by itself and \
finds its range, as `dorsal look --rectify auto` does; the vertical residual is the true one, over the \
visible pixels. A bad rig has the right picture 3 px lower (+) or higher, turned by a degree clockwise (+) or \
the other way, and 2 % larger (+) or smaller: parts that add up are worse than parts that cancel, so all eight \
are there. Ours and SGBM have their marks on each of them. SGBM has the setting that `compare-opencv` finds best over all scenes, borders continued and \
holes filled as there, and on the rig the true range with 16 px more on either side.
";

/// The page `docs/dense-robustness.md`.
pub(crate) fn page(run: &DenseRobustnessRun) -> String {
    let machine = &run.machine;
    let versions = run.versions.iter();
    let versions: Vec<String> = versions
        .map(|(name, version)| format!("{name} {version}"))
        .collect();
    let mut page = format!(
        "# What a bad rig and a bad camera cost the dense estimator\n\n\
         Written by `cargo xtask eval-dense-robustness`; edits by hand are lost.\n\n\
         - date: {}\n- machine: {}, {} cores\n- compiler: {}, {} build\n- command: `{}`\n\
         - {}; SGBM with {}\n\n## How to read this\n\n{READING}\n\
         ## Visible pixels: bad-1 % / mean absolute error, px\n\n{}\n{}## Marks\n\n",
        run.date,
        machine.cpu,
        machine.cores,
        machine.rustc,
        machine.build,
        run.command,
        versions.join(", "),
        TUNED_SGBM.1,
        table(run),
        on_rigs(run),
    );
    let missed = dense_robustness_marks::missed(run);
    if missed.is_empty() {
        page.push_str("Every mark holds.\n");
    } else {
        page.push_str("Missed:\n\n");
    }
    for missed in missed {
        // Writing to a string does not fail.
        let _ = writeln!(page, "- {missed}");
    }
    page
}

/// The peer's word on the bad rigs, if it saw them.
fn on_rigs(run: &DenseRobustnessRun) -> String {
    dense_robustness_marks::sgbm_on_rigs(run).map_or_else(String::new, |bad| {
        format!("SGBM's bad-1 on the mean of the bad rigs is {bad:.2} %.\n\n")
    })
}

/// A row a trial.
pub(crate) fn table(run: &DenseRobustnessRun) -> MarkdownTable {
    let head = [
        "scene",
        "condition",
        "best",
        "fast",
        "SGBM",
        "dy left, px",
        "told, px",
    ];
    let mut table = MarkdownTable::new(head);
    let cell = |metrics: Option<Metrics>| {
        metrics.map_or_else(
            || "-".to_owned(),
            |m| format!("{:.2} / {:.3}", m.bad.one, m.mean_absolute),
        )
    };
    let px = |px: Option<f64>| px.map_or_else(String::new, |px| format!("{px:.3}"));
    for trial in &run.trials {
        table.push([
            trial.scene.clone(),
            trial.condition.title().to_owned(),
            cell(trial.best),
            cell(trial.fast),
            cell(trial.sgbm),
            px(trial.residual_px),
            px(trial.told_residual_px),
        ]);
    }
    table
}
