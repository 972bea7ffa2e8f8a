use clap::ValueEnum;
use serde::Serialize;

use crate::alteration::Alteration;

/// One thing that befalls the right camera, more and more of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Series {
    /// The picture lies lower, px.
    VerticalShift,
    /// It is turned about its middle, degrees.
    Roll,
    /// The camera nods, degrees.
    Pitch,
    /// It is larger, per cent.
    Scale,
    /// Shift, roll and scale together, in parts of 3 px, 1 degree and 2 %.
    Rig,
    /// Another exposure: a factor on luma.
    Gain,
    /// Another transfer curve: an exponent of luma.
    Gamma,
    /// Noise of the right camera, sigma in grey levels.
    Noise,
    /// Noise of both cameras, sigma in grey levels.
    NoiseOfBoth,
    /// The right camera out of focus, sigma in px.
    Blur,
    /// The rig's parts with a gain of 0.6, an offset of 20 and noise of sigma 2 and 5.
    Everything,
}

impl Series {
    /// Every series, in the order of the tables.
    pub(crate) const ALL: [Self; 11] = [
        Self::VerticalShift,
        Self::Roll,
        Self::Pitch,
        Self::Scale,
        Self::Rig,
        Self::Gain,
        Self::Gamma,
        Self::Noise,
        Self::NoiseOfBoth,
        Self::Blur,
        Self::Everything,
    ];

    /// Its name with its unit, as titles have it.
    pub(crate) const fn title(self) -> &'static str {
        match self {
            Self::VerticalShift => "vertical shift, px",
            Self::Roll => "roll, degrees",
            Self::Pitch => "pitch, degrees",
            Self::Scale => "scale, %",
            Self::Rig => "3 px, 1 degree and 2 %, times",
            Self::Gain => "gain (0.6 with 20 grey levels added)",
            Self::Gamma => "gamma",
            Self::Noise => "noise, right eye, grey levels",
            Self::NoiseOfBoth => "noise, both eyes, grey levels",
            Self::Blur => "blur, px",
            Self::Everything => "the rig, gain 0.6 + 20, noise, grey levels",
        }
    }

    /// The amounts, ascending.
    pub(crate) const fn amounts(self) -> &'static [f64] {
        match self {
            Self::VerticalShift => &[0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0],
            Self::Roll => &[0.0, 0.5, 1.0, 1.5, 2.0, 3.0],
            Self::Pitch => &[0.0, 0.25, 0.5, 1.0, 1.5],
            Self::Scale => &[0.0, 1.0, 2.0, 3.0, 4.0],
            Self::Rig => &[0.0, 0.5, 1.0, 1.5],
            Self::Gain => &[0.5, 0.6, 0.75, 1.0, 1.25, 1.5],
            Self::Gamma => &[0.7, 0.85, 1.0, 1.2, 1.4],
            Self::Noise | Self::NoiseOfBoth => &[0.0, 2.0, 5.0, 8.0, 12.0],
            Self::Blur => &[0.0, 0.5, 1.0, 1.5],
            Self::Everything => &[2.0, 5.0],
        }
    }

    /// What an amount of it does.
    pub(crate) const fn alteration(self, amount: f64) -> Alteration {
        let none = Alteration::NONE;
        match self {
            Self::VerticalShift => Alteration {
                down_px: amount,
                ..none
            },
            Self::Roll => Alteration {
                roll_deg: amount,
                ..none
            },
            Self::Pitch => Alteration {
                pitch_deg: amount,
                ..none
            },
            Self::Scale => Alteration {
                scale_percent: amount,
                ..none
            },
            Self::Rig => Alteration {
                down_px: 3.0 * amount,
                roll_deg: amount,
                scale_percent: 2.0 * amount,
                ..none
            },
            Self::Gain => Alteration {
                gain: amount,
                offset_grey: if amount == 0.6 { 20.0 } else { 0.0 },
                ..none
            },
            Self::Gamma => Alteration {
                gamma: amount,
                ..none
            },
            Self::Noise => Alteration {
                noise_grey: amount,
                ..none
            },
            Self::NoiseOfBoth => Alteration {
                noise_grey: amount,
                both_noisy: true,
                ..none
            },
            Self::Blur => Alteration {
                blur_px: amount,
                ..none
            },
            Self::Everything => Alteration {
                gain: 0.6,
                offset_grey: 20.0,
                noise_grey: amount,
                ..Self::Rig.alteration(1.0)
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_ascend_and_series_differ() {
        for series in Series::ALL {
            let amounts = series.amounts();
            assert!(amounts.is_sorted_by(|a, b| a < b));
            for &amount in amounts {
                let untouched = series.alteration(amount) == Alteration::NONE;
                let nothing = match series {
                    Series::Gain | Series::Gamma => amount == 1.0,
                    _ => amount == 0.0,
                };
                // Noise of strength 0 in both eyes is none, and still says so.
                assert!(untouched == nothing || series == Series::NoiseOfBoth);
            }
        }
    }
}
