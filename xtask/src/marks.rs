//! What the dense estimator has to reach.

use crate::estimator::Preset;
use crate::markdown_table::MarkdownTable;
use crate::score::Score;

/// The most that a scene's errors may be, the best guess everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mark {
    scene: &'static str,
    /// Per cent of the visible pixels that err by more than 1 px, and their mean error in px.
    best: (f64, f64),
    /// Per cent of all pixels that err by more than 1 px.
    best_all: Option<f64>,
    fast: Option<f64>,
    fast_all: Option<f64>,
}

const MARKS: [Mark; 10] = [
    mark("tsukuba", (3.2, 0.26), 4.2, 3.7, 4.8),
    mark("venus", (1.6, 0.15), 2.2, 1.2, 2.1),
    mark("sawtooth", (1.0, 0.20), 2.2, 1.4, 2.4),
    mark("barn1", (0.7, 0.12), 1.7, 1.0, 1.9),
    mark("bull", (0.7, 0.15), 0.9, 0.8, 1.1),
    mark("teddy", (6.7, 0.41), 12.9, 7.3, 13.4),
    mark("cloth3", (1.3, 0.26), 5.6, 1.5, 5.7),
    visible_alone("motorcycle", (4.4, 0.53)),
    visible_alone("map", (0.45, 0.27)),
    visible_alone("eth3d-terrace", (4.2, 0.30)),
];

const fn mark(
    scene: &'static str,
    best: (f64, f64),
    best_all: f64,
    fast: f64,
    fast_all: f64,
) -> Mark {
    Mark {
        scene,
        best,
        best_all: Some(best_all),
        fast: Some(fast),
        fast_all: Some(fast_all),
    }
}

const fn visible_alone(scene: &'static str, best: (f64, f64)) -> Mark {
    Mark {
        scene,
        best,
        best_all: None,
        fast: None,
        fast_all: None,
    }
}

/// The marks beside what was found, for the scenes that have one; `None` if none was evaluated.
pub(crate) fn table(scores: &[Score], preset: Preset) -> Option<MarkdownTable> {
    let mut table = MarkdownTable::new([
        "scene",
        "visible bad-1 %",
        "mark",
        "mean, px",
        "mark",
        "all bad-1 %",
        "mark",
        "",
    ]);
    let mut rows = 0;
    for mark in MARKS {
        let Some(score) = scores.iter().find(|score| score.scene == mark.scene) else {
            continue;
        };
        let (Some(visible), Some(all)) = (score.dense.visible, score.dense.all) else {
            continue;
        };
        let limits = match preset {
            Preset::Best => [Some(mark.best.0), Some(mark.best.1), mark.best_all],
            Preset::Fast => [mark.fast, None, mark.fast_all],
        };
        let found = [visible.bad.one, visible.mean_absolute, all.bad.one];
        let mut holds = "reached";
        let mut cells = vec![mark.scene.to_owned()];
        for ((found, limit), digits) in found.into_iter().zip(limits).zip([2, 3, 2]) {
            if limit.is_some_and(|limit| found > limit) {
                holds = "missed";
            }
            cells.push(format!("{found:.digits$}"));
            cells.push(limit.map_or_else(|| "-".to_owned(), |limit| format!("{limit:.2}")));
        }
        if limits.iter().all(Option::is_none) {
            holds = "";
        }
        cells.push(holds.to_owned());
        table.push(cells);
        rows += 1;
    }
    (rows > 0).then_some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::tests::made_up;

    #[test]
    fn a_mark_is_reached_or_missed() {
        let mut score = made_up("venus");
        assert!(table(&[made_up("nowhere")], Preset::Best).is_none());
        let missed = table(std::slice::from_ref(&score), Preset::Best).unwrap();
        assert!(missed.to_string().contains("missed"));
        for metrics in [&mut score.dense.visible, &mut score.dense.all] {
            let metrics = metrics.as_mut().unwrap();
            (metrics.bad.one, metrics.mean_absolute) = (1.0, 0.1);
        }
        for preset in [Preset::Best, Preset::Fast] {
            let reached = table(std::slice::from_ref(&score), preset).unwrap();
            assert!(reached.to_string().contains("reached"), "{reached}");
        }
    }
}
