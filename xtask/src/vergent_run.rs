use std::fmt::Write;

use serde::Serialize;

use crate::machine::Machine;
use crate::markdown_table::MarkdownTable;
use crate::metrics::Metrics;
use crate::point_errors::PointErrors;

/// The most median endpoint error on the verged pairs, px: valid points.
const TEMPLE: (&str, f64) = ("temple", 0.6);
/// The least part of the corners of the unaligned pairs within 2 px, per cent: the best guess.
const CHESSBOARD: (&str, f64) = ("chess", 90.0);

/// One run over pairs that nobody rectified, and over rectified ones that reach far.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct VergentRun {
    /// Version of this form.
    pub(crate) schema: &'static str,
    /// Date of the run, UTC.
    pub(crate) date: String,
    /// The machine.
    pub(crate) machine: Machine,
    /// The command that gives these numbers again; folders are left out.
    pub(crate) command: String,
    /// Pairs with sparse truth.
    pub(crate) points: Vec<PointScore>,
    /// Rectified pairs with dense truth.
    pub(crate) starts: Vec<StartScore>,
}

/// One pair with sparse truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct PointScore {
    /// Name of the scene.
    pub(crate) scene: String,
    /// The set it comes from.
    pub(crate) dataset: String,
    /// The starts that were found, `(dx, dy)` in px; none if the search started at zero.
    pub(crate) starts_px: Vec<(f32, f32)>,
    /// Scales of the pyramid.
    pub(crate) scales: usize,
    /// Points of known truth.
    pub(crate) points: usize,
    /// Errors where the estimator stands behind its answer.
    pub(crate) valid: Option<PointErrors>,
    /// Errors of the best guess.
    pub(crate) dense: Option<PointErrors>,
}

/// What a found start is worth on one rectified pair, visible pixels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct StartScore {
    /// Name of the scene.
    pub(crate) scene: String,
    /// The 5th and the 95th percentile of the true disparity `d`, px.
    pub(crate) truth_px: Option<(f32, f32)>,
    /// The starts that were found, `(dx, dy)` in px.
    pub(crate) starts_px: Vec<(f32, f32)>,
    /// Scales of the pyramid from there.
    pub(crate) scales: usize,
    /// Errors from zero with six scales, valid pixels.
    pub(crate) zero_valid: Option<Metrics>,
    /// The same, the best guess everywhere.
    pub(crate) zero_dense: Option<Metrics>,
    /// Errors from the start, valid pixels.
    pub(crate) start_valid: Option<Metrics>,
    /// The same, the best guess everywhere.
    pub(crate) start_dense: Option<Metrics>,
}

impl VergentRun {
    /// The form that this version writes.
    pub(crate) const SCHEMA: &'static str = "dorsal-vergent/1";

    /// The errors at the points, two rows a pair.
    pub(crate) fn point_table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new([
            "pair, output",
            "starts, px",
            "scales",
            "points",
            "median, px",
            "mean",
            "dx",
            "dy",
            "within 2 px, %",
        ]);
        for score in &self.points {
            for (output, errors) in [("valid", score.valid), ("dense", score.dense)] {
                let about = [
                    format!("{}, {output}", score.scene),
                    starts(&score.starts_px),
                    score.scales.to_string(),
                ];
                let cells = errors.map_or_else(
                    || vec![format!("0 of {}", score.points)],
                    |errors| {
                        vec![
                            format!("{} of {}", errors.answered, score.points),
                            format!("{:.3}", errors.endpoint_median),
                            format!("{:.3}", errors.endpoint_mean),
                            format!("{:.3}", errors.along_x),
                            format!("{:.3}", errors.along_y),
                            format!("{:.1}", errors.within_2),
                        ]
                    },
                );
                table.push(about.into_iter().chain(cells));
            }
        }
        table
    }

    /// The marks beside what was found.
    pub(crate) fn marks(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new(["pair", "measure", "found", "mark", ""]);
        for score in &self.points {
            if let Some((measure, found, mark, holds)) = score.mark() {
                let verdict = if holds { "holds" } else { "missed" };
                table.push([
                    score.scene.clone(),
                    measure.to_owned(),
                    found.map_or_else(dash, |found| format!("{found:.3}")),
                    mark.to_string(),
                    verdict.to_owned(),
                ]);
            }
        }
        table
    }

    /// The first pair that misses its mark, in a sentence.
    pub(crate) fn missed(&self) -> Option<String> {
        self.points.iter().find_map(|score| {
            let (measure, found, mark, holds) = score.mark()?;
            (!holds).then(|| {
                format!(
                    "{}: {measure} is {found:?}, and the mark is {mark}",
                    score.scene
                )
            })
        })
    }

    /// What the start is worth on rectified pairs.
    pub(crate) fn start_table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new([
            "pair",
            "true d, 5 to 95 %",
            "starts (dx, dy), px",
            "scales",
            "from 0: valid",
            "dense",
            "from the start: valid",
            "dense",
        ]);
        for score in &self.starts {
            let error = |metrics: Option<Metrics>| {
                metrics.map_or_else(dash, |metrics| {
                    format!(
                        "{:.3} ({:.0} %)",
                        metrics.mean_absolute,
                        100.0 * metrics.density
                    )
                })
            };
            table.push([
                score.scene.clone(),
                score
                    .truth_px
                    .map_or_else(dash, |(least, most)| format!("{least:.0} to {most:.0}")),
                starts(&score.starts_px),
                score.scales.to_string(),
                error(score.zero_valid),
                error(score.zero_dense),
                error(score.start_valid),
                error(score.start_dense),
            ]);
        }
        table
    }

    /// The page `docs/vergent.md`.
    pub(crate) fn page(&self) -> String {
        let machine = &self.machine;
        let mut page = format!(
            "# Eyes that nobody lined up\n\n\
             Written by `cargo xtask eval-vergent`; edits by hand are lost.\n\n\
             - date: {}\n- machine: {}, {} core{}\n- compiler: {}, {} build\n- command: `{}`\n\n\
             Verged cameras and a rig out of line, unrectified, matched in both components; the truth \
             is sparse. The start of the search is found by a coarse look (`disparity_pyramid::Start`): \
             every shift of a coarse scale is tried, and windows that choose each other from both eyes \
             vote. The middle of the votes is the start if five scales reach them all; else up to six starts \
             share them, and of their fields each place gets the one that both eyes can agree upon \
             (`disparity_pyramid::most_consistent`).\n\n\
             ## Errors at the points\n\nEndpoint errors in px; **valid** where the estimator stands \
             behind its answer, **dense** the best guess.\n\n{}\n## Marks\n\n{}\n",
            self.date,
            machine.cpu,
            machine.cores,
            if machine.cores == 1 { "" } else { "s" },
            machine.rustc,
            machine.build,
            self.command,
            self.point_table(),
            self.marks(),
        );
        // Writing to a string does not fail.
        let _ = write!(
            page,
            "## The same start on rectified pairs that reach far\n\nMean absolute error in px over \
             visible pixels (density); from zero with six scales, and from the start with those that it \
             asks for.\n\n{}",
            self.start_table()
        );
        page
    }
}

impl PointScore {
    /// What is measured, what was found, the mark, whether it holds; `None` for a pair without mark.
    fn mark(&self) -> Option<(&'static str, Option<f64>, f64, bool)> {
        let (name, mark) = TEMPLE;
        if self.scene.contains(name) {
            let found = self.valid.map(|errors| errors.endpoint_median);
            let holds = found.is_some_and(|found| found <= mark);
            return Some(("median endpoint error, valid, px", found, mark, holds));
        }
        let (name, mark) = CHESSBOARD;
        if self.scene.contains(name) {
            // The best guess answers at every corner that lies in the picture.
            let found = self
                .dense
                .map(|errors| errors.within_2 * errors.answered as f64 / self.points as f64);
            let holds = found.is_some_and(|found| found >= mark);
            return Some(("corners within 2 px, dense, %", found, mark, holds));
        }
        None
    }
}

fn starts(starts_px: &[(f32, f32)]) -> String {
    if starts_px.is_empty() {
        return "(0, 0)".to_owned();
    }
    let written = starts_px
        .iter()
        .map(|(dx, dy)| format!("({dx:.0}, {dy:.0})"));
    written.collect::<Vec<_>>().join(" ")
}

fn dash() -> String {
    "-".to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_is_held_or_missed() {
        let errors = PointErrors {
            answered: 10,
            endpoint_median: 0.5,
            endpoint_mean: 0.7,
            along_x: 0.4,
            along_y: 0.2,
            within_2: 95.0,
        };
        let score = |scene: &str, points| PointScore {
            scene: scene.to_owned(),
            dataset: "a set".to_owned(),
            starts_px: Vec::new(),
            scales: 6,
            points,
            valid: Some(errors),
            dense: Some(errors),
        };
        let holds = |scene, points| score(scene, points).mark().map(|(_, _, _, holds)| holds);
        assert_eq!(holds("temple20", 10), Some(true));
        assert_eq!(holds("chess01", 10), Some(true));
        // A corner outside the picture is a corner missed.
        assert_eq!(holds("chess01", 11), Some(false));
        assert_eq!(holds("venus", 10), None);
    }
}
