//! What a bad rig and a bad camera may cost.

use crate::markdown_table::MarkdownTable;
use crate::robustness_run::{RobustnessRun, SceneTrials};
use crate::robustness_series::Series;

/// One limit: on our mean absolute error (visible, valid) as a multiple of the untouched figure.
struct Mark {
    name: &'static str,
    series: Series,
    amount: f64,
    most_ratio: f64,
}

const MARKS: [Mark; 8] = [
    mark("3 px lower", Series::VerticalShift, 3.0, 1.12),
    mark("5 px lower", Series::VerticalShift, 5.0, 1.12),
    mark("1 degree of roll", Series::Roll, 1.0, 1.12),
    mark("2 % larger", Series::Scale, 2.0, 1.12),
    mark("3 px, 1 degree, 2 %", Series::Rig, 1.0, 1.25),
    mark("gain 0.6 + 20 grey levels", Series::Gain, 0.6, 1.10),
    mark("noise sigma 5, right eye", Series::Noise, 5.0, 2.0),
    mark("noise sigma 5, both eyes", Series::NoiseOfBoth, 5.0, 2.0),
];

/// The most that our vertical component may err on a rig that is out of place, px.
const MOST_VERTICAL_PX: f64 = 0.30;

const fn mark(name: &'static str, series: Series, amount: f64, most_ratio: f64) -> Mark {
    Mark {
        name,
        series,
        amount,
        most_ratio,
    }
}

/// The ratio of our error to the untouched one.
fn ratio(scene: &SceneTrials, mark: &Mark) -> Option<f64> {
    let untouched = scene.untouched.ours?.mean_absolute;
    let altered = scene.trial(mark.series, mark.amount)?.ours?.mean_absolute;
    Some(altered / untouched)
}

/// The largest vertical error over the rigs of the marks, px.
fn vertical_px(scene: &SceneTrials) -> Option<f64> {
    MARKS
        .iter()
        .take(5)
        .map(|mark| {
            let trial = scene.trial(mark.series, mark.amount)?;
            Some(trial.ours_vertical?.mean_absolute)
        })
        .try_fold(0.0f64, |most, found| Some(most.max(found?)))
}

/// Every mark that was measured, a row each: what it allows, and what each scene has.
pub(crate) fn table(run: &RobustnessRun) -> MarkdownTable {
    let head = ["mark".to_owned(), "at most".to_owned()];
    let scenes = run.scenes.iter().map(|scene| scene.scene.clone());
    let mut table = MarkdownTable::with_head(head.into_iter().chain(scenes).chain([String::new()]));
    let mut push = |name: &str, most: f64, found: Vec<Option<f64>>| {
        if found.iter().all(Option::is_none) {
            return;
        }
        let cells = found
            .iter()
            .map(|found| found.map_or_else(|| "-".to_owned(), |found| format!("{found:.3}")));
        let missed = found
            .iter()
            .flatten()
            .filter(|found| **found > most)
            .count();
        let verdict = match missed {
            0 => "holds".to_owned(),
            missed => format!("missed on {missed}"),
        };
        table.push(
            [name.to_owned(), format!("{most:.2}")]
                .into_iter()
                .chain(cells)
                .chain([verdict]),
        );
    };
    for mark in &MARKS {
        let found = run.scenes.iter().map(|scene| ratio(scene, mark)).collect();
        push(
            &format!("{}, error / untouched", mark.name),
            mark.most_ratio,
            found,
        );
    }
    push(
        "dy on any of the five rigs, px",
        MOST_VERTICAL_PX,
        run.scenes.iter().map(vertical_px).collect(),
    );
    table
}

/// The first mark that a scene misses or lacks, in a sentence.
pub(crate) fn missed(run: &RobustnessRun) -> Option<String> {
    for scene in &run.scenes {
        for mark in &MARKS {
            match ratio(scene, mark) {
                None => return Some(format!("{}, {} was not tried", scene.scene, mark.name)),
                Some(found) if found > mark.most_ratio => {
                    return Some(format!(
                        "{}, {}: the error is {found:.3} of the untouched one, and the mark is {:.2}",
                        scene.scene, mark.name, mark.most_ratio
                    ));
                }
                Some(_) => {}
            }
        }
        if let Some(found) = vertical_px(scene)
            && found > MOST_VERTICAL_PX
        {
            return Some(format!(
                "{}: dy errs by {found:.3} px, and the mark is {MOST_VERTICAL_PX:.2} px",
                scene.scene
            ));
        }
    }
    None
}
