use std::fmt;

use egocentric_depth::{RelativeOrientation, RigDrift};
use serde::Serialize;

use crate::machine::Machine;
use crate::markdown_table::MarkdownTable;

/// The command that gives a page again.
const COMMAND: &str = "cargo xtask eval-calibration";

/// How far pitch and roll may be off on Venus, degrees.
const VENUS_DEG: f64 = 0.05;
/// The vertical disparity that may be left there, px.
const VENUS_PX: f64 = 0.2;
/// Depth errors on the verged pairs with the published cameras: median and 90th percentile, m.
const PUBLISHED_M: (f64, f64) = (0.002, 0.006);
/// The median after recalibration, m.
const RECALIBRATED_M: f64 = 0.004;
/// The median vertical residual at the corners of the chessboards, px.
const CHESSBOARD_PX: f64 = 0.5;

/// One run of calibrations from images.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct CalibrationRun {
    schema: &'static str,
    date: String,
    machine: Machine,
    command: &'static str,
    /// Turns put into rectified pairs.
    pub(crate) injected: Vec<Injected>,
    /// Pairs with a published pose and sparse truth.
    pub(crate) points: Vec<PointRig>,
}

/// What the images said of a rig.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Found {
    /// Pitch, yaw and roll, deg; down and forward, baselines.
    drift: [f64; 5],
    standard_error: [f64; 5],
    /// Which of them the images told.
    told: [bool; 5],
    /// Part of the matches off one plane.
    relief: f64,
    one_plane: bool,
    matches: usize,
    noise_px: f64,
    vertical_rms_before_px: f64,
    vertical_rms_after_px: f64,
}

impl From<RelativeOrientation> for Found {
    fn from(found: RelativeOrientation) -> Self {
        let degrees = |numbers: RigDrift| {
            let [pitch, yaw, roll, down, forward] = numbers.to_array();
            let [pitch, yaw, roll] = [pitch, yaw, roll].map(f64::to_degrees);
            [pitch, yaw, roll, down, forward]
        };
        Self {
            drift: degrees(found.drift),
            standard_error: degrees(found.standard_error),
            told: found.told,
            relief: found.relief,
            one_plane: found.is_one_plane(),
            matches: found.matches,
            noise_px: found.noise_px,
            vertical_rms_before_px: found.vertical_rms_before_px,
            vertical_rms_after_px: found.vertical_rms_after_px,
        }
    }
}

/// A rectified pair whose right picture was turned.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Injected {
    pub(crate) scene: String,
    pub(crate) pitch_deg: f64,
    pub(crate) roll_deg: f64,
    pub(crate) found: Found,
}

/// A pair with a published pose.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct PointRig {
    pub(crate) scene: String,
    /// The rig that calibration starts from.
    pub(crate) start: String,
    /// How far the calibrated turn is from the published one: pitch, yaw, roll, deg.
    pub(crate) apart: [f64; 3],
    /// Median distance of the points from their epipolar lines, px.
    pub(crate) misaligned_published_px: Option<f64>,
    pub(crate) misaligned_before_px: Option<f64>,
    pub(crate) misaligned_after_px: Option<f64>,
    /// Depth errors, where the pair is metric.
    pub(crate) published: Option<Depths>,
    pub(crate) before: Option<Depths>,
    pub(crate) after: Option<Depths>,
    /// The same if the right centre is not held, and yaw expected as usual.
    pub(crate) after_turned: Option<Depths>,
    pub(crate) found: Found,
}

/// Absolute errors of depth at points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Depths {
    points: usize,
    median_m: f64,
    ninetieth_m: f64,
}

impl Depths {
    pub(crate) fn of(mut errors_m: Vec<f64>) -> Option<Self> {
        errors_m.sort_unstable_by(f64::total_cmp);
        let last = errors_m.len().checked_sub(1)?;
        Some(Self {
            points: errors_m.len(),
            median_m: errors_m[last / 2],
            ninetieth_m: errors_m[last * 9 / 10],
        })
    }

    fn words(this: Option<Self>) -> String {
        this.map_or_else(String::new, |depths| {
            format!(
                "{:.2} / {:.2}",
                1000.0 * depths.median_m,
                1000.0 * depths.ninetieth_m
            )
        })
    }
}

struct Mark {
    what: String,
    found: f64,
    most: f64,
    unit: &'static str,
}

impl CalibrationRun {
    pub(crate) const fn new(date: String, machine: Machine) -> Self {
        Self {
            schema: "dorsal-calibration/1",
            date,
            machine,
            command: COMMAND,
            injected: Vec::new(),
            points: Vec::new(),
        }
    }

    fn injected_table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new([
            "pair",
            "put in: pitch, roll",
            "pitch found",
            "±",
            "roll found",
            "±",
            "yaw found",
            "±",
            "vertical RMS before, px",
            "after",
            "off one plane, %",
        ]);
        for row in &self.injected {
            let [pitch, yaw, roll, ..] = row.found.drift;
            let [pitch_sigma, yaw_sigma, roll_sigma, ..] = row.found.standard_error;
            table.push([
                row.scene.clone(),
                format!("{}, {}", row.pitch_deg, row.roll_deg),
                format!("{pitch:.3}"),
                format!("{pitch_sigma:.3}"),
                format!("{roll:.3}"),
                format!("{roll_sigma:.3}"),
                format!("{yaw:.3}"),
                format!("{yaw_sigma:.3}"),
                format!("{:.2}", row.found.vertical_rms_before_px),
                format!("{:.2}", row.found.vertical_rms_after_px),
                format!("{:.0}", 100.0 * row.found.relief),
            ]);
        }
        table
    }

    fn turn_table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new([
            "pair",
            "from",
            "pitch off",
            "±",
            "yaw off",
            "±",
            "roll off",
            "±",
            "off one plane, %",
            "points: residual published, px",
            "before",
            "after",
        ]);
        for row in &self.points {
            let mut cells = vec![row.scene.clone(), row.start.clone()];
            for (off, sigma) in row.apart.iter().zip(row.found.standard_error) {
                cells.push(format!("{off:.3}"));
                cells.push(format!("{sigma:.3}"));
            }
            cells.push(format!("{:.0}", 100.0 * row.found.relief));
            for residual in [
                row.misaligned_published_px,
                row.misaligned_before_px,
                row.misaligned_after_px,
            ] {
                cells.push(residual.map_or_else(String::new, |px| format!("{px:.3}")));
            }
            table.push(cells);
        }
        table
    }

    fn depth_table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new([
            "pair",
            "points",
            "published",
            "put out",
            "recalibrated",
            "recalibrated, centre on a bar",
        ]);
        for row in self.points.iter().filter(|row| row.published.is_some()) {
            let points = row.published.map_or(0, |depths| depths.points);
            table.push([
                row.scene.clone(),
                points.to_string(),
                Depths::words(row.published),
                Depths::words(row.before),
                Depths::words(row.after),
                Depths::words(row.after_turned),
            ]);
        }
        table
    }

    fn marks(&self) -> Vec<Mark> {
        let mut marks = Vec::new();
        let mut mark = |what: String, found: f64, most: f64, unit| {
            marks.push(Mark {
                what,
                found,
                most,
                unit,
            });
        };
        for row in &self.injected {
            if row.scene == "venus" && row.pitch_deg != 0.0 {
                let [pitch, _, roll, ..] = row.found.drift;
                // A picture turns against its camera: a camera that leans clockwise sees the world lean
                // the other way. So pitch is compared as it is and roll with the other sign.
                let off = |found: f64, put_in: f64| (found.abs() - put_in.abs()).abs();
                mark(
                    "venus, pitch off".into(),
                    off(pitch, row.pitch_deg),
                    VENUS_DEG,
                    "deg",
                );
                mark(
                    "venus, roll off".into(),
                    off(roll, row.roll_deg),
                    VENUS_DEG,
                    "deg",
                );
                let left = row.found.vertical_rms_after_px;
                mark(
                    "venus, vertical disparity left".into(),
                    left,
                    VENUS_PX,
                    "px",
                );
            }
        }
        for row in &self.points {
            if let Some(depths) = row.published {
                let name = &row.scene;
                let (median_m, ninetieth_m) = PUBLISHED_M;
                let what = |what: &str| format!("{name}, {what}");
                mark(
                    what("published, median"),
                    1e3 * depths.median_m,
                    1e3 * median_m,
                    "mm",
                );
                mark(
                    what("published, P90"),
                    1e3 * depths.ninetieth_m,
                    1e3 * ninetieth_m,
                    "mm",
                );
                let recalibrated = [
                    ("recalibrated, median", row.after),
                    ("recalibrated on a bar, median", row.after_turned),
                ];
                for (way, after) in recalibrated {
                    let median_m = after.map_or(f64::INFINITY, |after| after.median_m);
                    mark(what(way), 1e3 * median_m, 1e3 * RECALIBRATED_M, "mm");
                }
            } else if let Some(px) = row.misaligned_after_px {
                let what = format!("{}, residual at the corners", row.scene);
                mark(what, px, CHESSBOARD_PX, "px");
            }
        }
        marks
    }

    fn mark_table(&self) -> MarkdownTable {
        let mut table = MarkdownTable::new(["what", "found", "at most", ""]);
        for mark in self.marks() {
            let holds = if mark.found <= mark.most {
                "holds"
            } else {
                "missed"
            };
            table.push([
                mark.what,
                format!("{:.3} {}", mark.found, mark.unit),
                format!("{} {}", mark.most, mark.unit),
                holds.to_owned(),
            ]);
        }
        table
    }

    /// The marks that are missed, in a sentence; `None` if all hold.
    pub(crate) fn missed(&self) -> Option<String> {
        let missed: Vec<String> = self
            .marks()
            .into_iter()
            .filter(|mark| mark.found.is_nan() || mark.found > mark.most)
            .map(|mark| format!("{} is {:.3} {}", mark.what, mark.found, mark.unit))
            .collect();
        (!missed.is_empty()).then(|| format!("missed: {}", missed.join("; ")))
    }

    /// The page for the documentation.
    pub(crate) fn page(&self) -> String {
        format!(
            "# Rigs calibrated from their own images\n\n\
             Written by `{COMMAND}`; edits by hand are lost.\n\n\
             - date: {}\n- machine: {}, {} cores\n- compiler: {}, {} build\n\n\
             The vector disparity of a pair, matched for it (`OrientationParams::matching`), its start found by a \
             coarse look, goes into `egocentric_depth::relative_orientation`; nothing else is known but the rig that is written \
             in the second column. Angles in degrees.\n\n{self}",
            self.date, self.machine.cpu, self.machine.cores, self.machine.rustc, self.machine.build
        )
    }
}

impl fmt::Display for CalibrationRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "## Turns put into rectified pairs\n\n\
             The right picture is turned as a camera with a focal length of the picture's width would turn \
             it; that is the camera the rig is told to have. A picture turns against its camera. Yaw is \
             not put in, and what is found of it is error.\n\n{}\n\
             ## Poses that were published\n\n\
             How far the calibrated turn of the right camera is from the published one, with one standard \
             error, and the median distance of the reference points from their epipolar lines.\n\n{}\n\
             ## Depth at the reference points\n\n\
             Median and 90th percentile of the absolute error along the left optical axis, mm, from the \
             vector disparity at the pixel nearest to each point, where it is valid. **Recalibrated** expects what \
             `dorsal calibrate` does (`OrientationParams::SIGMA`): nothing of pitch and roll, yaw to a degree, \
             the centre to a hundredth of the baseline. **With the centre on a bar** the eye has turned by anything \
             and moved by a thousandth of the baseline at most (`OrientationParams::TURNED`, `--turned`).\n\n{}\n\
             ## Marks\n\n{}",
            self.injected_table(),
            self.turn_table(),
            self.depth_table(),
            self.mark_table()
        )
    }
}
