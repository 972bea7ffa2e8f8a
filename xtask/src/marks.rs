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
    /// Root of the mean squared error of the visible pixels, px: the paper's, for `best`.
    best_rms: Option<f64>,
    /// Mean error of the valid pixels in texture, px, and how many per cent of those must be valid, for
    /// `best`.
    best_textured: Option<(f64, f64)>,
}

const MARKS: [Mark; 10] = [
    mark("tsukuba", (3.2, 0.26), 4.2, 3.7, 4.8).rms(0.74),
    mark("venus", (1.6, 0.15), 2.2, 1.2, 2.1)
        .rms(0.741)
        .textured(0.125, 99.0),
    mark("sawtooth", (1.0, 0.20), 2.2, 1.4, 2.4)
        .rms(1.221)
        .textured(0.14, 99.0),
    mark("barn1", (0.7, 0.12), 1.7, 1.0, 1.9).textured(0.09, 99.0),
    mark("bull", (0.7, 0.15), 0.9, 0.8, 1.1).textured(0.14, 99.0),
    mark("teddy", (6.7, 0.41), 12.9, 7.3, 13.4).textured(0.18, 97.0),
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
        best_rms: None,
        best_textured: None,
    }
}

impl Mark {
    const fn rms(self, most_px: f64) -> Self {
        Self {
            best_rms: Some(most_px),
            ..self
        }
    }

    const fn textured(self, most_px: f64, least_density: f64) -> Self {
        Self {
            best_textured: Some((most_px, least_density)),
            ..self
        }
    }
}

const fn visible_alone(scene: &'static str, best: (f64, f64)) -> Mark {
    Mark {
        scene,
        best,
        best_all: None,
        fast: None,
        fast_all: None,
        best_rms: None,
        best_textured: None,
    }
}

/// A figure beside the most that it may be.
#[derive(Clone, Copy, Debug)]
struct Found {
    what: &'static str,
    figure: f64,
    digits: usize,
    most: Option<f64>,
    /// Per cent of the pixels that the figure is of, and the least that there may be.
    density: Option<(f64, f64)>,
}

impl Found {
    fn holds(&self) -> bool {
        self.most.is_none_or(|most| self.figure <= most)
            && self.density.is_none_or(|(found, least)| found >= least)
    }

    /// The figure, and its mark.
    fn cells(&self) -> [String; 2] {
        let Self { figure, digits, .. } = self;
        let mark = self
            .most
            .map_or_else(|| "-".to_owned(), |most| most.to_string());
        match self.density {
            None => [format!("{figure:.digits$}"), mark],
            Some((density, least)) => [
                format!("{figure:.digits$} ({density:.1} %)"),
                format!("{mark} ({least} %)"),
            ],
        }
    }
}

/// What a scene's marks speak of.
fn found(mark: &Mark, score: &Score, preset: Preset) -> Option<[Found; 5]> {
    let (visible, all) = (score.dense.visible?, score.dense.all?);
    let textured = score.valid.textured?;
    let best = preset == Preset::Best;
    let limits = match preset {
        Preset::Best => [Some(mark.best.0), Some(mark.best.1), mark.best_all],
        Preset::Fast => [mark.fast, None, mark.fast_all],
    };
    let plain = |what, figure, digits, most| Found {
        what,
        figure,
        digits,
        most,
        density: None,
    };
    let in_texture = mark.best_textured.filter(|_| best);
    Some([
        plain("visible bad-1, %", visible.bad.one, 2, limits[0]),
        plain("mean, px", visible.mean_absolute, 3, limits[1]),
        plain("all bad-1, %", all.bad.one, 2, limits[2]),
        plain("RMS, px", visible.rms, 3, mark.best_rms.filter(|_| best)),
        Found {
            density: in_texture.map(|(_, least)| (100.0 * textured.density, least)),
            ..plain(
                "textured, valid mean, px",
                textured.mean_absolute,
                3,
                in_texture.map(|(most, _)| most),
            )
        },
    ])
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
        "RMS, px",
        "mark",
        "textured, px",
        "mark",
        "",
    ]);
    let mut rows = 0;
    for mark in MARKS {
        let score = scores.iter().find(|score| score.scene == mark.scene);
        let Some(found) = score.and_then(|score| found(&mark, score, preset)) else {
            continue;
        };
        let verdict = if found.iter().all(|found| found.most.is_none()) {
            ""
        } else if found.iter().all(Found::holds) {
            "reached"
        } else {
            "missed"
        };
        let cells = found.iter().flat_map(Found::cells);
        let scene = std::iter::once(mark.scene.to_owned());
        table.push(scene.chain(cells).chain([verdict.to_owned()]));
        rows += 1;
    }
    (rows > 0).then_some(table)
}

/// Every mark that is missed, a sentence each with the scene and the figure.
pub(crate) fn missed(scores: &[Score], preset: Preset) -> Vec<String> {
    let mut missed = Vec::new();
    for mark in MARKS {
        let score = scores.iter().find(|score| score.scene == mark.scene);
        let found = score.and_then(|score| found(&mark, score, preset));
        for found in found.iter().flatten().filter(|found| !found.holds()) {
            let [figure, most] = found.cells();
            let (scene, what) = (mark.scene, found.what);
            missed.push(format!("{scene}, {what}: {figure}, and the mark is {most}"));
        }
    }
    missed
}

#[cfg(test)]
mod tests {
    use super::missed as missed_marks;
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
            metrics.rms = 0.3;
        }
        let textured = score.valid.textured.as_mut().unwrap();
        (textured.mean_absolute, textured.density) = (0.1, 0.98);
        let scores = std::slice::from_ref(&score);
        let too_few = missed_marks(scores, Preset::Best);
        assert!(too_few[0].contains("98.0 %"), "{too_few:?}");
        assert!(missed_marks(scores, Preset::Fast).is_empty());
        score.valid.textured.as_mut().unwrap().density = 0.995;
        assert!(missed_marks(std::slice::from_ref(&score), Preset::Best).is_empty());
        for preset in [Preset::Best, Preset::Fast] {
            let reached = table(std::slice::from_ref(&score), preset).unwrap();
            assert!(reached.to_string().contains("reached"), "{reached}");
        }
    }
}
