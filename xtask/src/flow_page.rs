use std::fmt::Write;

use crate::flow_run::FlowRun;

const READING: &str = "\
Over every pixel of the first frame whose true motion is published: the **endpoint** error is the \
length of the difference between the estimated and the true vector, the **angular** error the angle \
between `(u, v, 1)` of both. **dense** is the best guess everywhere, **valid** the pixels that the \
estimator stands behind, with their part of the known pixels as density.
";

/// The page `docs/flow.md`.
pub(crate) fn flow_page(run: &FlowRun) -> String {
    let machine = &run.machine;
    let opencv = run.opencv.as_deref().map_or_else(
        || "not run".to_owned(),
        |version| {
            format!(
                "{version}, one thread; Farneback with 5 levels, window 15, 3 iterations, \
                 neighbourhood 5; DIS with its medium preset"
            )
        },
    );
    let mut page = format!(
        "# Optic flow: results on real and rendered frames\n\n\
         Written by `cargo xtask eval-flow`; edits by hand are lost.\n\n\
         Flow is the vector pyramid between two moments of one eye (`dorsal flow PREV NEXT --out \
         DIR`): no other code, no training, one parameter set for all scenes \
         (`MatchParams::for_flow`).\n\n\
         - date: {}\n- machine: {}, {} core{}\n- compiler: {}, {} build\n- command: `{}`\n\
         - OpenCV: {opencv}\n\n## How to read this\n\n{READING}\n## Errors\n\n{}\n\
         Seconds are wall time from two frames to the flow, once; ours with every core.\n",
        run.date,
        machine.cpu,
        machine.cores,
        if machine.cores == 1 { "" } else { "s" },
        machine.rustc,
        machine.build,
        run.command,
        run.table(),
    );
    // Writing to a string does not fail.
    let _ = write!(
        page,
        "\n## Marks\n\nMean endpoint error, dense, all known pixels.\n\n{}\n## Scenes\n\n",
        run.marks()
    );
    for score in &run.scenes {
        let _ = writeln!(
            page,
            "- **{}**: {}, {} x {} px. {}",
            score.scene, score.dataset, score.width, score.height, score.citation
        );
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow_run::tests::made_up;

    #[test]
    fn the_page_holds_errors_and_marks() {
        let page = flow_page(&made_up("grove2", 0.25));
        for part in ["2024-02-29", "| grove2, dorsal, dense", "holds", "not run"] {
            assert!(page.contains(part), "{part} is not in\n{page}");
        }
    }
}
