use std::fmt;

use egocentric_depth::DepthMap;
use serde::Serialize;
use stereo_scenes::Truth;

use crate::machine::Machine;
use crate::markdown_table::MarkdownTable;

/// The command that gives a page again.
const COMMAND: &str = "cargo xtask eval-depth";

/// The most depth error up to [`NEAR_M`] with the true rig, m: median and 90th percentile.
const TRUE_RIG_M: f64 = 0.010;
/// The most median after recalibration, m.
const RECALIBRATED_M: f64 = 0.015;
/// How far the marks reach, m.
const NEAR_M: f64 = 1.2;

/// Which components of disparity there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) enum Condition {
    /// Along the rows only: parallel eyes.
    Horizontal,
    /// Along the columns only: parallel eyes on their sides.
    Vertical,
    /// Both: verging eyes.
    Both,
}

impl Condition {
    pub(crate) const ALL: [Self; 3] = [Self::Horizontal, Self::Vertical, Self::Both];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Horizontal => "horizontal only",
            Self::Vertical => "vertical only",
            Self::Both => "both",
        }
    }
}

/// Absolute errors of depth over the objects' pixels whose disparity is valid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct DepthErrors {
    /// Part of the objects' pixels that have a depth.
    density: f64,
    median_m: f64,
    ninetieth_m: f64,
}

impl DepthErrors {
    /// The errors where an object is; `None` if no pixel has a depth.
    pub(crate) fn of(depth: &DepthMap, truth: &Truth) -> Option<Self> {
        let mut errors = Vec::new();
        let mut pixels = 0usize;
        for ((y, x), &label) in truth.labels.plane().indexed_iter() {
            if label == 0 || !truth.visible[[y, x]] {
                continue;
            }
            pixels += 1;
            if let (Some(found), Some(want)) = (depth.at(x, y), truth.depth.at(x, y)) {
                errors.push(f64::from((found - want).abs()));
            }
        }
        Self::sorted(errors, pixels)
    }

    fn sorted(mut errors: Vec<f64>, pixels: usize) -> Option<Self> {
        errors.sort_unstable_by(f64::total_cmp);
        let last = errors.len().checked_sub(1)?;
        Some(Self {
            density: errors.len() as f64 / pixels as f64,
            median_m: errors[last / 2],
            ninetieth_m: errors[last * 9 / 10],
        })
    }

    fn words(this: Option<Self>) -> String {
        this.map_or_else(
            || "-".to_owned(),
            |errors| {
                format!(
                    "{:.1} / {:.1}",
                    1000.0 * errors.median_m,
                    1000.0 * errors.ninetieth_m
                )
            },
        )
    }
}

/// What recalibration came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) enum Recalibrated {
    Found {
        /// How far pitch, yaw and roll are from the truth, deg.
        off_deg: [f64; 3],
        errors: Option<DepthErrors>,
    },
    Refused(String),
}

/// One distance in one condition.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Viewed {
    pub(crate) condition: Condition,
    pub(crate) distance_m: f64,
    /// How far depth moves with one pixel.
    pub(crate) mm_per_px: f64,
    pub(crate) exact: Option<DepthErrors>,
    pub(crate) uncorrected: Option<DepthErrors>,
    pub(crate) recalibrated: Recalibrated,
}

impl Viewed {
    const fn after(&self) -> Option<DepthErrors> {
        match &self.recalibrated {
            Recalibrated::Found { errors, .. } => *errors,
            Recalibrated::Refused(_) => None,
        }
    }
}

/// Depth errors of a real pair over a span of distances.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct RealDepth {
    scene: String,
    /// By which estimator, over which of its pixels.
    by: &'static str,
    nearest_m: f64,
    farthest_m: f64,
    errors: Option<DepthErrors>,
    /// Median of the error over the depth, per cent.
    relative_percent: f64,
}

impl RealDepth {
    /// Half-metre spans, where the truth has at least a thousand pixels.
    pub(crate) fn by_distance(
        scene: &str,
        by: &'static str,
        depth: &DepthMap,
        truth: &DepthMap,
    ) -> Vec<Self> {
        const SPAN_M: f64 = 0.5;
        const LEAST_PIXELS: usize = 1000;
        let size = truth.size();
        let mut spans: Vec<(usize, Vec<f64>)> = Vec::new();
        for y in 0..size.height {
            for x in 0..size.width {
                let Some(want) = truth.at(x, y).map(f64::from) else {
                    continue;
                };
                let span = (want / SPAN_M) as usize;
                if spans.len() <= span {
                    spans.resize(span + 1, (0, Vec::new()));
                }
                spans[span].0 += 1;
                if let Some(found) = depth.at(x, y) {
                    spans[span].1.push((f64::from(found) - want).abs());
                }
            }
        }
        spans
            .into_iter()
            .enumerate()
            .filter(|(_, (pixels, _))| *pixels >= LEAST_PIXELS)
            .map(|(span, (pixels, errors))| {
                let nearest_m = span as f64 * SPAN_M;
                let errors = DepthErrors::sorted(errors, pixels);
                let middle_m = nearest_m + SPAN_M / 2.0;
                Self {
                    scene: scene.to_owned(),
                    by,
                    nearest_m,
                    farthest_m: nearest_m + SPAN_M,
                    errors,
                    relative_percent: errors
                        .map_or(f64::NAN, |errors| 100.0 * errors.median_m / middle_m),
                }
            })
            .collect()
    }
}

/// One run of the depth experiment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct DepthRun {
    schema: &'static str,
    date: String,
    machine: Machine,
    command: &'static str,
    pub(crate) viewed: Vec<Viewed>,
    pub(crate) real: Vec<RealDepth>,
}

impl DepthRun {
    pub(crate) const fn new(date: String, machine: Machine) -> Self {
        Self {
            schema: "dorsal-depth/1",
            date,
            machine,
            command: COMMAND,
            viewed: Vec::new(),
            real: Vec::new(),
        }
    }

    fn table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new([
            "condition",
            "distance, m",
            "mm a pixel",
            "density, %",
            "true rig, mm",
            "out by a degree, mm",
            "recalibrated, mm",
            "pitch, yaw, roll left, deg",
        ]);
        for viewed in &self.viewed {
            let density = viewed.exact.map_or(0.0, |errors| errors.density);
            let left = match &viewed.recalibrated {
                Recalibrated::Found { off_deg, .. } => {
                    let [pitch, yaw, roll] = off_deg;
                    format!("{pitch:+.3}, {yaw:+.3}, {roll:+.3}")
                }
                Recalibrated::Refused(reason) => reason.clone(),
            };
            table.push([
                viewed.condition.name().to_owned(),
                format!("{:.1}", viewed.distance_m),
                format!("{:.2}", viewed.mm_per_px),
                format!("{:.0}", 100.0 * density),
                DepthErrors::words(viewed.exact),
                DepthErrors::words(viewed.uncorrected),
                DepthErrors::words(viewed.after()),
                left,
            ]);
        }
        table
    }

    /// What is marked, what was found and what is asked, in metres.
    fn marks(&self) -> Vec<(String, f64, f64)> {
        let mut marks = Vec::new();
        for condition in Condition::ALL {
            let near = || {
                self.viewed
                    .iter()
                    .filter(move |row| row.condition == condition && row.distance_m <= NEAR_M)
            };
            // No answer is worse than any.
            let worst = |found: &dyn Fn(&Viewed) -> Option<f64>| {
                near()
                    .map(|row| found(row).unwrap_or(f64::INFINITY))
                    .fold(0.0, f64::max)
            };
            let name = condition.name();
            let median = worst(&|row| row.exact.map(|errors| errors.median_m));
            marks.push((format!("{name}, true rig, median"), median, TRUE_RIG_M));
            let ninetieth = worst(&|row| row.exact.map(|errors| errors.ninetieth_m));
            marks.push((format!("{name}, true rig, P90"), ninetieth, TRUE_RIG_M));
            let after = worst(&|row| row.after().map(|errors| errors.median_m));
            marks.push((
                format!("{name}, recalibrated, median"),
                after,
                RECALIBRATED_M,
            ));
        }
        marks
    }

    fn mark_table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new(["worst up to 1.2 m", "found, mm", "at most, mm", ""]);
        for (what, found, most) in self.marks() {
            table.push([
                what,
                format!("{:.1}", 1000.0 * found),
                format!("{:.0}", 1000.0 * most),
                if found <= most { "holds" } else { "missed" }.to_owned(),
            ]);
        }
        table
    }

    fn real_table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new([
            "pair",
            "depth by",
            "distance, m",
            "density, %",
            "error, mm",
            "median, % of depth",
        ]);
        for row in &self.real {
            let density = row.errors.map_or(0.0, |errors| errors.density);
            table.push([
                row.scene.clone(),
                row.by.to_owned(),
                format!("{:.1} to {:.1}", row.nearest_m, row.farthest_m),
                format!("{:.0}", 100.0 * density),
                DepthErrors::words(row.errors),
                format!("{:.2}", row.relative_percent),
            ]);
        }
        table
    }

    /// The marks that are missed, in a sentence; `None` if all hold.
    pub(crate) fn missed(&self) -> Option<String> {
        let missed: Vec<String> = self
            .marks()
            .into_iter()
            .filter(|(_, found, most)| found.is_nan() || found > most)
            .map(|(what, found, _)| format!("{what} is {:.1} mm", 1000.0 * found))
            .collect();
        (!missed.is_empty()).then(|| format!("missed: {}", missed.join("; ")))
    }

    /// The page for the documentation.
    pub(crate) fn page(&self) -> String {
        let machine = &self.machine;
        format!(
            "# The depth experiment\n\nWritten by `{COMMAND}`; edits by hand are lost.\n\n\
             - date: {}\n- machine: {}, {} cores\n- compiler: {}, {} build\n\n{self}",
            self.date, machine.cpu, machine.cores, machine.rustc, machine.build
        )
    }
}

impl fmt::Display for DepthRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "A panel, a ball and a can before the paper's head (270 mm, 1024 x 768, 887 px), which fixates \
             them, behind a lens of some 15 px of barrel in the corners; shot noise of 10,000 electrons, \
             reading noise of 10, eight bits. **Horizontal only**: parallel eyes with shifted sensors; \
             **vertical only**: the same on their sides; **both**: verging eyes.\n\n\
             Errors are the median and the 90th percentile of the absolute error of depth over the objects' \
             pixels that both eyes see and whose disparity is valid; density is the part of them. **Out by a \
             degree**: the right eye is turned by one degree about each axis and the rig does not know. \
             **Recalibrated**: it is found from the images, matched for it (`OrientationParams::matching`), with an \
             encoder of the vergence good to 0.2 degrees whose reading is off by as much, and centres held to a \
             thousandth of the baseline.\n\n{}\n\
             ## Marks\n\n{}\n\
             One pixel is 26 mm at 2.5 m: the paper's centimetre is there a budget of 0.38 px for matching, \
             and of 0.02 degrees for the vergence. The rows at 1.6 m and beyond say what is reached.\n\n\
             ## A real pair\n\n\
             Both estimators on a metric pair, over all pixels of known truth, those that one eye alone sees \
             among them: over the pixels that the estimator calls valid, and of the dense one also over all.\n\n{}",
            self.table(),
            self.mark_table(),
            self.real_table()
        )
    }
}
