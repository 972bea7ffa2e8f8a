use std::fmt;

use egocentric_depth::DisparitySigma;
use serde::Serialize;

use crate::machine::Machine;
use crate::markdown_table::MarkdownTable;

/// The command that gives a page again.
const COMMAND: &str = "cargo xtask calibrate-confidence";

/// What a 95 % interval may hold of the truth, per cent, on average over scenes not fitted on.
const MARK: (f64, f64) = (93.0, 97.0);

/// Half the width of a normal distribution's central 95 %, in standard deviations.
const HALF_95: f64 = 1.96;

/// Shares of a normal distribution and half their width in standard deviations.
const LEVELS: [(f64, f64); 6] = [
    (50.0, 0.6745),
    (68.27, 1.0),
    (80.0, 1.2816),
    (90.0, 1.6449),
    (95.0, HALF_95),
    (99.0, 2.5758),
];

/// One scene: confidence and absolute error of its valid pixels, px.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    pub(crate) scene: String,
    pub(crate) pairs: Vec<(f32, f32)>,
}

/// One scene as the fit to all others sees it.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct LeftOut {
    scene: String,
    pixels: usize,
    /// Part of the pixels within each of [`LEVELS`], per cent.
    held: [f64; LEVELS.len()],
    /// The same within 1.96 of the sigma that the library holds, per cent: it was fitted on this scene
    /// too.
    held_by_library: f64,
}

/// One fit, and how it does on scenes that it has not seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ConfidenceRun {
    schema: &'static str,
    date: String,
    machine: Machine,
    command: &'static str,
    /// The fit to all scenes: sigma at [`DisparitySigma::CONFIDENCES`], px.
    sigma_px: [f64; DisparitySigma::KNOTS],
    left_out: Vec<LeftOut>,
}

impl ConfidenceRun {
    pub(crate) fn fit(date: String, machine: Machine, samples: &[Sample]) -> Self {
        let left_out = samples
            .iter()
            .map(|sample| {
                let others = samples.iter().filter(|other| other.scene != sample.scene);
                let model = fit(others);
                let count = sample.pairs.len();
                let within = |model: &DisparitySigma, half: f64| {
                    let held = sample.pairs.iter().filter(|(confidence, error)| {
                        f64::from(*error) <= half * model.px(*confidence)
                    });
                    100.0 * held.count() as f64 / count as f64
                };
                LeftOut {
                    scene: sample.scene.clone(),
                    pixels: count,
                    held: LEVELS.map(|(_, half)| within(&model, half)),
                    held_by_library: within(&DisparitySigma::default(), HALF_95),
                }
            })
            .collect();
        Self {
            schema: "dorsal-confidence/1",
            date,
            machine,
            command: COMMAND,
            sigma_px: fit(samples.iter()).sigma_px(),
            left_out,
        }
    }

    fn mean(&self, level: usize) -> f64 {
        let sum: f64 = self.left_out.iter().map(|row| row.held[level]).sum();
        sum / self.left_out.len() as f64
    }

    /// The place of the 95 % in [`LEVELS`].
    const NINETY_FIVE: usize = 4;

    fn fit_table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new(["confidence", "sigma, px", "in the library, px"]);
        let library = DisparitySigma::default().sigma_px();
        let knots = DisparitySigma::CONFIDENCES.iter().zip(self.sigma_px);
        for ((confidence, sigma), library) in knots.zip(library) {
            table.push([
                format!("{confidence:.2}"),
                format!("{sigma:.3}"),
                format!("{library:.3}"),
            ]);
        }
        table
    }

    fn reliability_table(&self) -> MarkdownTable {
        let head = std::iter::once("scene left out".to_owned())
            .chain(LEVELS.map(|(share, _)| format!("claimed {share} %")))
            .chain(["pixels".to_owned(), "library, 95 %".to_owned()]);
        let mut table = MarkdownTable::with_head(head);
        for row in &self.left_out {
            let held = row.held.map(|held| format!("{held:.1}"));
            table.push(std::iter::once(row.scene.clone()).chain(held).chain([
                row.pixels.to_string(),
                format!("{:.1}", row.held_by_library),
            ]));
        }
        let means = (0..LEVELS.len()).map(|level| format!("{:.1}", self.mean(level)));
        table.push(std::iter::once("mean".to_owned()).chain(means));
        table
    }

    fn verdict(&self) -> String {
        let mean = self.mean(Self::NINETY_FIVE);
        let inside = |held: f64| (MARK.0..=MARK.1).contains(&held);
        let scenes = self
            .left_out
            .iter()
            .filter(|row| inside(row.held[Self::NINETY_FIVE]))
            .count();
        format!(
            "On average a claimed 95 % interval holds the truth in {mean:.1} % of the pixels of a scene that \
             was not fitted on ({} to {} % are asked: {}); {scenes} of {} scenes lie within that span by \
             themselves.",
            MARK.0,
            MARK.1,
            if inside(mean) { "holds" } else { "missed" },
            self.left_out.len()
        )
    }

    /// The mark in a sentence if it is missed.
    pub(crate) fn missed(&self) -> Option<String> {
        let mean = self.mean(Self::NINETY_FIVE);
        let holds = (MARK.0..=MARK.1).contains(&mean);
        (!holds).then(|| format!("a 95 % interval holds the truth in {mean:.1} %"))
    }

    /// The page for the documentation.
    pub(crate) fn page(&self) -> String {
        let machine = &self.machine;
        format!(
            "# What a confidence is worth in pixels\n\nWritten by `{COMMAND}`; edits by hand are lost.\n\n\
             - date: {}\n- machine: {}, {} cores\n- compiler: {}, {} build\n\n{self}",
            self.date, machine.cpu, machine.cores, machine.rustc, machine.build
        )
    }
}

/// The fit to some scenes, each counted alike: at every confidence the error that 95 % of the pixels
/// keep within, as the standard deviation of a normal distribution that has it; never growing with
/// confidence.
fn fit<'a>(samples: impl Iterator<Item = &'a Sample>) -> DisparitySigma {
    let knots = DisparitySigma::CONFIDENCES;
    let mut bins: Vec<Vec<(f32, f64)>> = vec![Vec::new(); knots.len()];
    for sample in samples {
        let weight = 1.0 / sample.pairs.len().max(1) as f64;
        for &(confidence, error) in &sample.pairs {
            let nearest = (0..knots.len()).min_by(|&a, &b| {
                let apart = |knot: usize| (knots[knot] - confidence).abs();
                apart(a).total_cmp(&apart(b))
            });
            if let Some(bin) = nearest.and_then(|nearest| bins.get_mut(nearest)) {
                bin.push((error, weight));
            }
        }
    }
    let mut sigma = [f64::NAN; DisparitySigma::KNOTS];
    for (sigma, mut bin) in sigma.iter_mut().zip(bins) {
        bin.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = bin.iter().map(|(_, weight)| weight).sum();
        let mut sum = 0.0;
        for (error, weight) in bin {
            sum += weight;
            if sum >= 0.95 * total {
                *sigma = f64::from(error) / HALF_95;
                break;
            }
        }
    }
    // From the surest down, no less sure is better; an empty bin is as its surer neighbour.
    let mut least = 0.0f64;
    for sigma in sigma.iter_mut().rev() {
        least = least.max(*sigma);
        *sigma = least;
    }
    DisparitySigma::new(sigma)
}

impl fmt::Display for ConfidenceRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "The vector pyramid with its defaults on every rectified pair whose truth is finer than a pixel, \
             over its valid pixels of known truth, hidden ones among them. Sigma is the error that 95 % of \
             the pixels of a confidence keep within, over 1.96; every scene counts alike. Between the knots \
             it is read linearly.\n\n{}\n\
             ## Reliability\n\n\
             Each scene as the fit to all others sees it: how many per cent of its pixels lie within the \
             interval that a normal distribution of that sigma claims. Errors have heavier tails than a \
             normal distribution, so a fit that is right at 95 % claims too much width below.\n\n{}\n{}\n",
            self.fit_table(),
            self.reliability_table(),
            self.verdict()
        )
    }
}
