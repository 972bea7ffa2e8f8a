use std::fmt;

use egocentric_depth::DisparitySigma;
use serde::Serialize;

use crate::curve_svg::{self, Diagram, Sheet};
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

/// What finds disparities.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) enum Source {
    Vector,
    DenseBest,
    DenseFast,
}

impl Source {
    pub(crate) const ALL: [Self; 3] = [Self::Vector, Self::DenseBest, Self::DenseFast];

    const fn name(self) -> &'static str {
        match self {
            Self::Vector => "vector pyramid",
            Self::DenseBest => "dense estimator, best",
            Self::DenseFast => "dense estimator, fast",
        }
    }

    /// The file of its reliability diagrams.
    const fn picture(self) -> &'static str {
        match self {
            Self::Vector => "confidence.svg",
            Self::DenseBest => "confidence-dense-best.svg",
            Self::DenseFast => "confidence-dense-fast.svg",
        }
    }

    /// The sigma that the library holds.
    pub(crate) const fn library(self) -> DisparitySigma {
        match self {
            Self::Vector => DisparitySigma::VECTOR,
            Self::DenseBest => DisparitySigma::DENSE_BEST,
            Self::DenseFast => DisparitySigma::DENSE_FAST,
        }
    }

    /// A sigma of the same kind.
    const fn sigma(self, curve: [f64; DisparitySigma::KNOTS]) -> DisparitySigma {
        match self {
            Self::Vector => DisparitySigma::of_vectors(curve),
            Self::DenseBest | Self::DenseFast => DisparitySigma::along_rows(curve),
        }
    }

    /// The ways that are compared; the last one is the library's.
    fn ways(self) -> Vec<&'static Way> {
        let wanted = |way: &&Way| self == Self::Vector || !way.fitted;
        let mut ways: Vec<_> = WAYS.iter().filter(wanted).collect();
        // The library's comes last.
        ways.sort_by_key(|way| way.name == self.own());
        ways
    }

    /// The name of the library's way.
    const fn own(self) -> &'static str {
        match self {
            Self::Vector => BY_ROUGHNESS,
            Self::DenseBest | Self::DenseFast => BY_ITS_CUBE_ROOT,
        }
    }
}

/// A valid pixel: its error, and what may foretell it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pixel {
    /// Absolute error of the horizontal disparity.
    pub(crate) error_px: f32,
    pub(crate) confidence: f32,
    /// One standard deviation of `dx` by the covariance of the fit; NaN without one.
    pub(crate) sigma_dx_px: f32,
    /// How far `dx` is from those of its neighbours.
    pub(crate) scatter_px: f32,
}

/// One scene.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    pub(crate) scene: String,
    pub(crate) pixels: Vec<Pixel>,
    pub(crate) roughness_px: f64,
    /// The part of the pixels without an answer.
    pub(crate) unanswered: f64,
}

/// A way to foretell an error: what tells the pixels of a scene apart, and what tells scenes apart.
#[derive(Clone, Copy, Debug)]
struct Way {
    name: &'static str,
    /// One feature, or two of which every pair of values has its own error.
    features: &'static [fn(&Pixel) -> f32],
    scale: fn(&Sample) -> f64,
    /// Whether it asks for the covariance of a fit, which only vectors have.
    fitted: bool,
}

const BY_ROUGHNESS: &str = "confidence, scenes by their roughness";
const BY_ITS_CUBE_ROOT: &str = "confidence, scenes by the cube root of their roughness";

/// The ways that are compared.
const WAYS: [Way; 9] = [
    Way {
        name: "confidence",
        features: &[|pixel| pixel.confidence],
        scale: |_| 1.0,
        fitted: false,
    },
    Way {
        name: "covariance of the fit",
        features: &[|pixel| pixel.sigma_dx_px],
        scale: |_| 1.0,
        fitted: true,
    },
    Way {
        name: "confidence and covariance together",
        features: &[|pixel| pixel.confidence, |pixel| pixel.sigma_dx_px],
        scale: |_| 1.0,
        fitted: true,
    },
    Way {
        name: "scatter among the neighbours",
        features: &[|pixel| pixel.scatter_px],
        scale: |_| 1.0,
        fitted: false,
    },
    Way {
        name: "confidence and scatter together",
        features: &[|pixel| pixel.confidence, |pixel| pixel.scatter_px],
        scale: |_| 1.0,
        fitted: false,
    },
    Way {
        name: "confidence, scenes by their unanswered pixels",
        features: &[|pixel| pixel.confidence],
        scale: |sample| sample.unanswered,
        fitted: false,
    },
    Way {
        name: "confidence, scenes by the square root of their roughness",
        features: &[|pixel| pixel.confidence],
        scale: |sample| sample.roughness_px.sqrt(),
        fitted: false,
    },
    Way {
        name: BY_ITS_CUBE_ROOT,
        features: &[|pixel| pixel.confidence],
        scale: |sample| sample.roughness_px.cbrt(),
        fitted: false,
    },
    Way {
        name: BY_ROUGHNESS,
        features: &[|pixel| pixel.confidence],
        scale: |sample| sample.roughness_px,
        fitted: false,
    },
];

/// What a way came to: the part of the pixels within its 95 % of each scene that was left out, per cent.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Tried {
    way: &'static str,
    held: Vec<f64>,
}

/// One scene as the fit to all others sees it.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct LeftOut {
    scene: String,
    pixels: usize,
    roughness_px: f64,
    /// Part of the pixels within each of [`LEVELS`], per cent.
    held: [f64; LEVELS.len()],
    /// The same by the confidence alone.
    held_by_confidence: [f64; LEVELS.len()],
    /// The same within 1.96 of the sigma that the library holds, per cent: it was fitted on this scene
    /// too.
    held_by_library: f64,
}

/// Fits, and how they do on scenes that they have not seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ConfidenceRun {
    schema: &'static str,
    date: String,
    machine: Machine,
    command: &'static str,
    sources: Vec<Fitted>,
}

/// The fit of one source.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Fitted {
    source: Source,
    /// The fit to all scenes at [`DisparitySigma::CONFIDENCES`].
    curve: [f64; DisparitySigma::KNOTS],
    tried: Vec<Tried>,
    left_out: Vec<LeftOut>,
}

impl ConfidenceRun {
    /// `samples` are those of each source, in the order of [`Source::ALL`].
    pub(crate) fn fit(
        date: String,
        machine: Machine,
        samples: &[Vec<Sample>; Source::ALL.len()],
    ) -> Self {
        let sources = Source::ALL.into_iter().zip(samples);
        Self {
            schema: "dorsal-confidence/3",
            date,
            machine,
            command: COMMAND,
            sources: sources
                .map(|(source, samples)| Fitted::of(source, samples))
                .collect(),
        }
    }

    /// The reliability diagrams and the names of their files.
    pub(crate) fn pictures(&self) -> impl Iterator<Item = (&'static str, String)> + '_ {
        let sources = self.sources.iter();
        sources.map(|fitted| (fitted.source.picture(), fitted.picture()))
    }

    /// The marks that are missed, in a sentence; `None` if all hold.
    pub(crate) fn missed(&self) -> Option<String> {
        let missed: Vec<String> = self.sources.iter().filter_map(Fitted::missed).collect();
        (!missed.is_empty()).then(|| missed.join("; "))
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

impl Fitted {
    fn of(source: Source, samples: &[Sample]) -> Self {
        let library = source.library();
        let scale = |sample: &Sample| library.scale(sample.roughness_px);
        let fit_to =
            |samples: &mut dyn Iterator<Item = &Sample>| source.sigma(fit(samples, &scale));
        let left_out = samples
            .iter()
            .map(|sample| {
                let others = || samples.iter().filter(|other| other.scene != sample.scene);
                let model = fit_to(&mut others());
                let by_confidence = DisparitySigma::of_vectors(fit(&mut others(), &|_| 1.0));
                let within = |model: &DisparitySigma, roughness_px, half| {
                    within(sample, model, roughness_px, half)
                };
                let own = sample.roughness_px;
                LeftOut {
                    scene: sample.scene.clone(),
                    pixels: sample.pixels.len(),
                    roughness_px: own,
                    held: LEVELS.map(|(_, half)| within(&model, own, half)),
                    held_by_confidence: LEVELS.map(|(_, half)| within(&by_confidence, 1.0, half)),
                    held_by_library: within(&library, own, HALF_95),
                }
            })
            .collect();
        let tried = source.ways().into_iter().map(|way| Tried {
            way: way.name,
            held: samples
                .iter()
                .map(|left| way.holds(samples, left))
                .collect(),
        });
        Self {
            source,
            curve: fit(&mut samples.iter(), &scale),
            left_out,
            tried: tried.collect(),
        }
    }

    fn mean(&self, level: usize) -> f64 {
        let sum: f64 = self.left_out.iter().map(|row| row.held[level]).sum();
        sum / self.left_out.len() as f64
    }

    /// The place of the 95 % in [`LEVELS`].
    const NINETY_FIVE: usize = 4;

    fn fit_table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new([
            "confidence",
            "sigma at a roughness of 1 px",
            "in the library",
        ]);
        let library = self.source.library().curve();
        let knots = DisparitySigma::CONFIDENCES.iter().zip(self.curve);
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
            .chain(["roughness, px", "pixels", "library, 95 %"].map(str::to_owned));
        let mut table = MarkdownTable::with_head(head);
        for row in &self.left_out {
            let held = row.held.map(|held| format!("{held:.1}"));
            table.push(std::iter::once(row.scene.clone()).chain(held).chain([
                format!("{:.2}", row.roughness_px),
                row.pixels.to_string(),
                format!("{:.1}", row.held_by_library),
            ]));
        }
        let means = (0..LEVELS.len()).map(|level| format!("{:.1}", self.mean(level)));
        table.push(std::iter::once("mean".to_owned()).chain(means));
        table
    }

    fn way_table(&self) -> MarkdownTable {
        let head = [
            "sigma by",
            "mean",
            "worst",
            "best",
            "mean distance from 95",
            "scenes in 93 to 97",
        ];
        let mut table = MarkdownTable::new(head);
        for Tried { way, held } in &self.tried {
            let mean = |value: &dyn Fn(f64) -> f64| {
                held.iter().map(|&held| value(held)).sum::<f64>() / held.len() as f64
            };
            let inside = held.iter().filter(|held| is_inside(**held)).count();
            table.push([
                if *way == self.source.own() {
                    format!("{way} (the library's)")
                } else {
                    (*way).to_owned()
                },
                format!("{:.1}", mean(&|held| held)),
                format!("{:.1}", held.iter().copied().fold(f64::INFINITY, f64::min)),
                format!("{:.1}", held.iter().copied().fold(0.0, f64::max)),
                format!("{:.2}", mean(&|held| (held - 95.0).abs())),
                format!("{inside} of {}", held.len()),
            ]);
        }
        table
    }

    /// The reliability diagrams, one a scene: claimed against held.
    fn picture(&self) -> String {
        let claimed = LEVELS.map(|(share, _)| share);
        let line = |held: [f64; LEVELS.len()]| claimed.into_iter().zip(held).collect();
        let diagrams = self.left_out.iter().map(|row| Diagram {
            title: row.scene.clone(),
            curves: vec![line(row.held), line(row.held_by_confidence), line(claimed)],
        });
        curve_svg::encode(&Sheet {
            title: format!(
                "{}: held against claimed, per cent, on scenes that were left out",
                self.source.name()
            ),
            names: ["with roughness", "without", "as claimed"]
                .map(str::to_owned)
                .to_vec(),
            diagrams: diagrams.collect(),
        })
    }

    fn verdict(&self) -> String {
        let mean = self.mean(Self::NINETY_FIVE);
        let held = |row: &LeftOut| row.held[Self::NINETY_FIVE];
        let scenes = self
            .left_out
            .iter()
            .filter(|row| is_inside(held(row)))
            .count();
        let beyond: Vec<String> = self
            .left_out
            .iter()
            .filter(|row| !is_inside(held(row)))
            .map(|row| format!("{} ({:.1})", row.scene, held(row)))
            .collect();
        format!(
            "On average a claimed 95 % interval holds the truth in {mean:.1} % of the pixels of a scene that \
             was not fitted on ({} to {} % are asked: {}); {scenes} of {} scenes lie within that span by \
             themselves{}{}.",
            MARK.0,
            MARK.1,
            if is_inside(mean) { "holds" } else { "missed" },
            self.left_out.len(),
            if beyond.is_empty() {
                ""
            } else {
                ", the others are "
            },
            beyond.join(", ")
        )
    }

    /// The mark in a sentence if it is missed.
    fn missed(&self) -> Option<String> {
        let mean = self.mean(Self::NINETY_FIVE);
        (!is_inside(mean)).then(|| {
            let name = self.source.name();
            format!("{name}: a 95 % interval holds the truth in {mean:.1} %")
        })
    }
}

const fn is_inside(held: f64) -> bool {
    MARK.0 <= held && held <= MARK.1
}

impl Way {
    /// The part of the pixels of a scene within the error that 95 % of the pixels of all others keep
    /// within, in the same bin of the features and in units of the scenes' scales; per cent.
    fn holds(&self, samples: &[Sample], left: &Sample) -> f64 {
        // Twelve bins of one feature, or eight by eight, each of as many pixels as the next.
        let bins = if self.features.len() == 1 { 12 } else { 8 };
        let others = || samples.iter().filter(|other| other.scene != left.scene);
        let edges: Vec<Vec<f32>> = self
            .features
            .iter()
            .map(|feature| {
                let mut all: Vec<f32> = others()
                    .flat_map(|sample| sample.pixels.iter().map(feature))
                    .collect();
                all.sort_unstable_by(f32::total_cmp);
                (1..bins).map(|edge| all[all.len() * edge / bins]).collect()
            })
            .collect();
        let bin = |pixel: &Pixel| {
            let features = self.features.iter().zip(&edges);
            features.fold(0, |bin, (feature, edges)| {
                bin * bins + edges.partition_point(|edge| *edge <= feature(pixel))
            })
        };
        let mut errors = vec![Vec::new(); bins.pow(self.features.len() as u32)];
        for sample in others() {
            let scale = (self.scale)(sample);
            for pixel in &sample.pixels {
                errors[bin(pixel)].push((f64::from(pixel.error_px) / scale) as f32);
            }
        }
        let most: Vec<f32> = errors
            .into_iter()
            .map(|mut errors| {
                let place = errors.len() * 95 / 100;
                if errors.is_empty() {
                    return 0.0;
                }
                *errors.select_nth_unstable_by(place, f32::total_cmp).1
            })
            .collect();
        let scale = (self.scale)(left);
        let held = left
            .pixels
            .iter()
            .filter(|pixel| f64::from(pixel.error_px) <= scale * f64::from(most[bin(pixel)]));
        100.0 * held.count() as f64 / left.pixels.len() as f64
    }
}

/// The part of the pixels of a scene within a number of sigmas, per cent.
fn within(sample: &Sample, model: &DisparitySigma, roughness_px: f64, half: f64) -> f64 {
    let held = sample.pixels.iter().filter(|pixel| {
        f64::from(pixel.error_px) <= half * model.px(pixel.confidence, roughness_px)
    });
    100.0 * held.count() as f64 / sample.pixels.len() as f64
}

/// The fit to some scenes, each counted alike: at every confidence the error that 95 % of the pixels
/// keep within, in units of their scene's scale, as the standard deviation of a normal distribution
/// that has it; never growing with confidence.
fn fit<'a>(
    samples: &mut dyn Iterator<Item = &'a Sample>,
    scale: &dyn Fn(&Sample) -> f64,
) -> [f64; DisparitySigma::KNOTS] {
    let knots = DisparitySigma::CONFIDENCES;
    let mut bins: Vec<Vec<(f32, f64)>> = vec![Vec::new(); knots.len()];
    for sample in samples {
        let weight = 1.0 / sample.pixels.len().max(1) as f64;
        let scale = scale(sample) as f32;
        for pixel in &sample.pixels {
            let nearest = (0..knots.len()).min_by(|&a, &b| {
                let apart = |knot: usize| (knots[knot] - pixel.confidence).abs();
                apart(a).total_cmp(&apart(b))
            });
            if let Some(bin) = nearest.and_then(|nearest| bins.get_mut(nearest)) {
                bin.push((pixel.error_px / scale, weight));
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
    sigma
}

impl fmt::Display for ConfidenceRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Each estimator with its defaults on every rectified pair whose truth is finer than a pixel, \
             over its valid pixels of known truth, hidden ones among them (some 60,000 a pair, evenly). \
             `DisparitySigma` is a curve over the confidence, times the roughness of the field \
             (`roughness_px`): how far nine in ten of its shifts are from their neighbours, at most. The dense \
             estimator follows edges, which make a field rough and little worse: there the cube root of the \
             roughness of `dx` counts. Sigma is the error that 95 % of the pixels keep within, over 1.96; every \
             scene counts alike. Between the knots it is read linearly.\n\n\
             Reliability: each scene as the fit to all others sees it, how many per cent of its pixels lie within \
             the interval that a normal distribution of that sigma claims. Errors have heavier tails than a \
             normal distribution, so a fit that is right at 95 % claims too much width below.\n\n\
             What was tried: per cent of the pixels within 95 % of scenes that were left out. Every way has its \
             own table of errors over bins of as many pixels each, twelve of one feature or eight by eight of two; \
             some scale a scene's errors by a number that the scene tells of itself. No feature of single pixels \
             makes scenes alike: what parts them is how hard a scene is as a whole. The curve is fitted without \
             the scene it is tried on, but the kind of number was chosen among many by these scenes, so the last \
             row of each table may be a little too good.\n"
        )?;
        for fitted in &self.sources {
            let mut name = fitted.source.name().to_owned();
            name[..1].make_ascii_uppercase();
            write!(
                f,
                "\n## {name}\n\n{}\n\
                 ### Reliability\n\n{}\n{}\n\n\
                 ![claimed against held, scene by scene, with and without the roughness](pictures/{})\n\n\
                 ### What was tried\n\n{}",
                fitted.fit_table(),
                fitted.reliability_table(),
                fitted.verdict(),
                fitted.source.picture(),
                fitted.way_table()
            )?;
        }
        Ok(())
    }
}
