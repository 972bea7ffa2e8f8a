use dorsal::egocentric_depth::{NoOrientation, RelativeOrientation, RigDrift};
use serde::Serialize;

use crate::text_table::TextTable;

/// What a look says of how the right eye has slipped from where the rig has it.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub(crate) enum DriftRecord {
    /// It was found.
    Found(Box<FoundDrift>),
    /// It was not, for this reason.
    Unknown {
        /// The reason.
        reason: String,
    },
}

/// A drift and how well it is known, for JSON.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct FoundDrift {
    #[serde(skip)]
    found: RelativeOrientation,
    /// Up, in degrees.
    pitch: Number,
    /// To the right, in degrees.
    yaw: Number,
    /// Clockwise, in degrees.
    roll: Number,
    /// In baselines.
    down: Number,
    /// In baselines.
    forward: Number,
    /// Root mean square over the matches as the fit weighs them.
    vertical_before_px: f64,
    vertical_after_px: f64,
    matches: usize,
    /// The part of the matches off the one plane that most lie on.
    relief: f64,
    /// What keeps the scene from telling all of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    degenerate: Option<&'static str>,
}

/// One number of a drift.
#[derive(Clone, Copy, Debug, Serialize)]
struct Number {
    value: f64,
    sigma: f64,
    /// Whether the images tell it; if not, it is what was expected.
    told: bool,
}

impl DriftRecord {
    pub(crate) fn of(found: &Result<RelativeOrientation, NoOrientation>) -> Self {
        match found {
            Ok(found) => Self::Found(Box::new(FoundDrift::of(found))),
            Err(reason) => Self::Unknown {
                reason: reason.to_string(),
            },
        }
    }

    /// The drift in a line, for a person.
    pub(crate) fn sentence(&self) -> String {
        match self {
            Self::Found(drift) => drift.sentence(),
            Self::Unknown { reason } => format!("unknown: {reason}"),
        }
    }
}

impl FoundDrift {
    pub(crate) fn of(found: &RelativeOrientation) -> Self {
        let (values, sigmas) = (degrees(&found.drift), degrees(&found.standard_error));
        let number = |i: usize| Number {
            value: values[i],
            sigma: sigmas[i],
            told: found.told[i],
        };
        Self {
            found: *found,
            pitch: number(0),
            yaw: number(1),
            roll: number(2),
            down: number(3),
            forward: number(4),
            vertical_before_px: found.vertical_rms_before_px,
            vertical_after_px: found.vertical_rms_after_px,
            matches: found.matches,
            relief: found.relief,
            degenerate: found.is_one_plane().then_some(ONE_PLANE),
        }
    }

    fn sentence(&self) -> String {
        let angle = |name: &str, number: Number| {
            format!("{name} {:+.3} ± {:.3}", number.value, number.sigma)
        };
        format!(
            "{}, {}, {} deg; {:.2} px of vertical disparity, {:.2} without it{}",
            angle("pitch", self.pitch),
            angle("yaw", self.yaw),
            angle("roll", self.roll),
            self.vertical_before_px,
            self.vertical_after_px,
            if self.degenerate.is_some() {
                "; one plane"
            } else {
                ""
            }
        )
    }

    /// Every number in a line of its own, and where it comes from.
    pub(crate) fn table(&self) -> String {
        let mut table = TextTable::new(["right eye", ">correction", "", "", "told by"]);
        let numbers = [self.pitch, self.yaw, self.roll, self.down, self.forward];
        let ways = ["up", "to the right", "clockwise", "", ""];
        for ((name, number), way) in RigDrift::NAMES.into_iter().zip(numbers).zip(ways) {
            let angle = !way.is_empty();
            let (value, sigma, unit) = if angle {
                (
                    format!("{:+.4}", number.value),
                    format!("± {:.4}", number.sigma),
                    format!("deg {way}"),
                )
            } else {
                (
                    format!("{:+.5}", number.value),
                    format!("± {:.5}", number.sigma),
                    "baselines".to_owned(),
                )
            };
            let by = if number.told {
                "the images"
            } else {
                "what was expected"
            };
            table.line([name.to_owned(), value, sigma, unit, by.to_owned()]);
        }
        table.to_string()
    }

    /// What should be known before the correction is trusted.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(degenerate) = self.degenerate {
            warnings.push(format!(
                "the scene is degenerate: {degenerate} ({:.1} % of the matches lie off it)",
                100.0 * self.relief
            ));
        }
        if self.vertical_after_px > MOST_LEFT_PX {
            warnings.push(format!(
                "{:.1} px of vertical disparity stay: many matches are false, or the cameras are not those of \
                 the rig; look at validity.png of dorsal look, and at the lenses of the rig",
                self.vertical_after_px
            ));
        }
        if !self.yaw.told {
            warnings.push(
                "the images do not tell yaw, which depth hangs on: give the vergence that encoders \
                 read, with its error as yaw_deg in [sigma] of the rig"
                    .to_owned(),
            );
        }
        if !self.found.settled {
            warnings.push("the fit did not come to rest".to_owned());
        }
        warnings
    }
}

/// What true matches through known lenses leave stays below this, in pixels of vertical disparity.
const MOST_LEFT_PX: f64 = 2.0;

/// Why a single plane does not tell all.
const ONE_PLANE: &str = "it is a single plane, which tells a turn of the eye from a step of it only \
                         by what was expected of the step";

/// Angles in degrees, shares of the baseline as they are.
fn degrees(numbers: &RigDrift) -> [f64; 5] {
    let [pitch, yaw, roll, down, forward] = numbers.to_array();
    [
        pitch.to_degrees(),
        yaw.to_degrees(),
        roll.to_degrees(),
        down,
        forward,
    ]
}
