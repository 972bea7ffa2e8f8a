use std::fmt::Write;

use crate::bounds;
use crate::evaluation::Evaluation;
use crate::score_tables;
use crate::table_1;
use crate::textured_marks;

const READING: &str = "\
Errors are `d estimated - d true` in pixels, in the sign of files (a positive error sees too near), \
at the pixels of the left image whose truth is known:

- **all**: every such pixel; **visible**: the right eye sees it too (the published mask, or the \
truth carried to the right image with a z-buffer); **estimated**: visible, and valid by the \
estimator's own word; **textured**: visible, with a mean squared step to the right neighbour of at \
least four grey levels squared in 3 x 3 pixels, and outside the 9 x 9 windows about steps of the \
truth above 2 px.
- **valid** is the output without its unknown pixels, **dense** the best guess everywhere.
- mean and std are those of the absolute error, signed is the mean with its sign, bad-k the part of \
the answered pixels that err by more than k px, density the part of the mask that is answered.
- Over the estimated pixels both outputs are the same, and the same as valid over visible; density \
there is counted in the mask itself.
- What the errors of the metric pair are in metres, by distance, stands in [depth.md](depth.md#a-real-pair).
";

/// The page `docs/results.md`.
pub(crate) fn results_page(evaluation: &Evaluation) -> String {
    let scores = &evaluation.scenes;
    let machine = &evaluation.machine;
    let mut page = format!(
        "# Results on real pairs\n\n\
         Written by `cargo xtask eval-middlebury`; edits by hand are lost.\n\n\
         - date: {}\n- machine: {}, {} core{}\n- compiler: {}, {} build\n- command: `{}`\n\
         - estimator: {}, one parameter set for all scenes\n\n\
         ## How to read this\n\n{READING}\n\
         ## Summary, visible pixels\n\n{}\n\
         Seconds are wall time from two images to the disparity field, once, on this machine.\n",
        evaluation.date,
        machine.cpu,
        machine.cores,
        if machine.cores == 1 { "" } else { "s" },
        machine.rustc,
        machine.build,
        evaluation.command,
        evaluation.estimator.name(),
        score_tables::of_all(scores),
    );
    // Writing to a string does not fail.
    let _ = write!(
        page,
        "\n## Bounds\n\nMean absolute error, dense, visible; `--check` fails above them.\n\n{}",
        bounds::table(scores)
    );
    if let Some(table) = score_tables::beside_table_1(scores) {
        let reading = table_1::READING;
        let _ = write!(page, "\n## The paper's Table 1\n\n{reading}\n\n{table}");
    }
    if let Some(table) = textured_marks::table(&evaluation.textured) {
        let reading = textured_marks::READING;
        let _ = write!(page, "\n## Textured pixels\n\n{reading}\n\n{table}");
    }
    page.push_str("\n## Scenes\n");
    for score in scores {
        let _ = write!(
            page,
            "\n### {}\n\n{}, {} x {} px. {}\n",
            score.scene, score.dataset, score.width, score.height, score.citation
        );
        if score.integer_truth {
            page.push_str(
                "\nThe truth is rounded to whole pixels, which penalises a finer answer.\n",
            );
        }
        let _ = write!(page, "\n{}", score_tables::of_scene(score));
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::Estimator;
    use crate::machine::Machine;
    use crate::score::tests::made_up;

    #[test]
    fn a_page_says_when_where_and_how() {
        let page = results_page(&Evaluation {
            schema: Evaluation::SCHEMA,
            date: "2024-02-29".to_owned(),
            machine: Machine {
                cpu: "A CPU".to_owned(),
                cores: 2,
                rustc: "rustc 1".to_owned(),
                build: "release",
            },
            command: "cargo xtask eval-middlebury".to_owned(),
            estimator: Estimator::Vector,
            scenes: vec![made_up("venus")],
            textured: Vec::new(),
        });
        for part in [
            "2024-02-29",
            "A CPU, 2 cores",
            "rustc 1, release build",
            "### venus",
            "0.04 / 0.74",
        ] {
            assert!(page.contains(part), "{part} is not in\n{page}");
        }
    }
}
