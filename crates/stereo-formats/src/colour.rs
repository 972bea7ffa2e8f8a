//! Numbers as colours that read in order: dark blue is low, light yellow is high, grey is unknown.

use ndarray::{Array2, ArrayView2};

/// The grey of what is unknown: the table has no grey in it.
pub const UNKNOWN: [u8; 3] = [128; 3];

/// Which numbers get the first and the last colour.
///
/// Both ends are finite, and the lower one is below the higher one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourRange {
    lowest: f32,
    highest: f32,
}

/// Two numbers between which there is no range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("from {0} to {1} is no range of colours; the ends must be finite and in ascending order")]
pub struct NoRange(pub f32, pub f32);

impl ColourRange {
    /// A range from one number to a higher one.
    ///
    /// # Errors
    /// [`NoRange`] if an end is not finite or they do not ascend.
    pub fn new(lowest: f32, highest: f32) -> Result<Self, NoRange> {
        if lowest < highest && (highest - lowest).is_finite() {
            Ok(Self { lowest, highest })
        } else {
            Err(NoRange(lowest, highest))
        }
    }

    /// The range of a plane's known (finite) numbers without the outermost hundredth on either
    /// side, which a few wild ones would stretch; half a unit about the number if all are equal,
    /// from 0 to 1 if none is known.
    #[must_use]
    pub fn covering(plane: ArrayView2<'_, f32>) -> Self {
        let mut known: Vec<f32> = plane.iter().copied().filter(|n| n.is_finite()).collect();
        known.sort_unstable_by(f32::total_cmp);
        let outermost = known.len() / 100;
        let (Some(&lowest), Some(&highest)) =
            (known.get(outermost), known.iter().rev().nth(outermost))
        else {
            return Self {
                lowest: 0.0,
                highest: 1.0,
            };
        };
        Self::new(lowest, highest)
            .or_else(|_| Self::new(lowest - 0.5, lowest + 0.5))
            .unwrap_or(Self {
                lowest: 0.0,
                highest: 1.0,
            })
    }

    /// The number with the first colour.
    #[must_use]
    pub const fn lowest(self) -> f32 {
        self.lowest
    }

    /// The number with the last colour.
    #[must_use]
    pub const fn highest(self) -> f32 {
        self.highest
    }

    /// How far along the range a number lies, from 0 to 1; what lies outside is drawn in.
    pub(crate) fn along(self, number: f32) -> f32 {
        ((number - self.lowest) / (self.highest - self.lowest)).clamp(0.0, 1.0)
    }
}

/// A plane `[[y, x]]` in colours; whatever is not finite is [`UNKNOWN`].
///
/// For a picture to look at, put [`crate::scale_bar::beneath`] under it.
#[must_use]
pub fn paint(plane: ArrayView2<'_, f32>, range: ColourRange) -> Array2<[u8; 3]> {
    let table = table();
    plane.mapv(|number| {
        if number.is_finite() {
            table[(range.along(number) * 255.0).round() as usize]
        } else {
            UNKNOWN
        }
    })
}

/// The 256 colours, from the lowest to the highest.
///
/// Lightness rises evenly in Oklab (B. Ottosson, 2020), so equal steps of the number look equal
/// and survive a grey printer and colour-blind eyes; the hue turns the long way from blue over
/// red to yellow; the chroma is the largest below a smooth arch that a screen can show.
#[must_use]
pub fn table() -> [[u8; 3]; 256] {
    std::array::from_fn(|index| {
        let along = index as f64 / 255.0;
        let lightness = 0.26 + 0.68 * along;
        let hue = (280.0 + 190.0 * along).to_radians();
        let arch = 0.12 + 0.07 * (std::f64::consts::PI * along).sin();
        // Half a per cent of the arch is less than one step of 8 bits.
        let chroma = (0..=200)
            .rev()
            .map(|part| arch * f64::from(part) / 200.0)
            .find(|&chroma| shows(linear_rgb(lightness, chroma, hue)))
            .unwrap_or(0.0);
        linear_rgb(lightness, chroma, hue).map(|light| (gamma(light) * 255.0).round() as u8)
    })
}

fn shows(rgb: [f64; 3]) -> bool {
    rgb.iter().all(|light| (0.0..=1.0).contains(light))
}

/// Oklab in polar coordinates to linear light of the sRGB primaries.
pub(crate) fn linear_rgb(lightness: f64, chroma: f64, hue: f64) -> [f64; 3] {
    let (a, b) = (chroma * hue.cos(), chroma * hue.sin());
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

/// The transfer curve of sRGB.
pub(crate) fn gamma(light: f64) -> f64 {
    if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of a stored colour.
    fn luminance(rgb: [u8; 3]) -> f64 {
        let [red, green, blue] = rgb.map(|sample| {
            let sample = f64::from(sample) / 255.0;
            if sample <= 0.04045 {
                sample / 12.92
            } else {
                ((sample + 0.055) / 1.055).powf(2.4)
            }
        });
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    #[test]
    fn higher_is_lighter_and_never_grey() {
        let table = table();
        // Eight steps apart the rise is beyond what rounding to 8 bits and the turn of the hue
        // take away.
        for (lower, higher) in table.iter().zip(&table[8..]) {
            assert!(
                luminance(*lower) < luminance(*higher),
                "{lower:?} {higher:?}"
            );
        }
        for colour in table {
            let span = colour.iter().max().unwrap() - colour.iter().min().unwrap();
            assert!(span > 40, "{colour:?} looks grey");
        }
        for pair in table.windows(2) {
            for channel in 0..3 {
                // No step shows as a band.
                assert!(pair[0][channel].abs_diff(pair[1][channel]) < 10, "{pair:?}");
            }
        }
    }

    #[test]
    fn unknown_is_grey_and_what_lies_outside_is_drawn_in() {
        let range = ColourRange::new(0.0, 10.0).unwrap();
        let plane = ndarray::array![[-5.0, 0.0, 10.0, 99.0, f32::NAN, f32::INFINITY]];
        let painted = paint(plane.view(), range);
        let (first, last) = (table()[0], table()[255]);
        let want = ndarray::array![[first, first, last, last, UNKNOWN, UNKNOWN]];
        assert_eq!(painted, want);
    }

    #[test]
    fn a_range_always_exists() {
        for (plane, want) in [
            (ndarray::array![[f32::NAN]], (0.0, 1.0)),
            (ndarray::array![[7.0]], (6.5, 7.5)),
            (ndarray::array![[2.0, f32::NAN, 4.0]], (2.0, 4.0)),
            (ndarray::array![[f32::MAX]], (0.0, 1.0)),
        ] {
            let range = ColourRange::covering(plane.view());
            assert_eq!((range.lowest(), range.highest()), want);
        }
        assert!(ColourRange::new(f32::MIN, f32::MAX).is_err());
        assert!(ColourRange::new(1.0, 1.0).is_err());
    }
}
