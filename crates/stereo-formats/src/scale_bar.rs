//! The bar under a coloured picture that says which colour is which number.

use ndarray::{Array2, ArrayView2, concatenate, s};

use crate::colour::{self, ColourRange};

/// Rows added under the picture.
pub const HEIGHT: usize = MARGIN + BAR + TICK + GAP + NUMBER_HEIGHT + MARGIN;

const MARGIN: usize = 4;
const BAR: usize = 10;
const TICK: usize = 3;
const GAP: usize = 2;
/// Screen pixels to one pixel of a digit.
const ZOOM: usize = 2;
/// From the left edge of one digit to that of the next.
const ADVANCE: usize = ZOOM * (Digit::WIDTH + 1);
/// Height of a number that [`write_number`] writes.
pub(crate) const NUMBER_HEIGHT: usize = ZOOM * Digit::HEIGHT;

const PAPER: [u8; 3] = [255; 3];
const INK: [u8; 3] = [0; 3];

/// The picture with a bar of the range's colours under it, and round numbers at its ticks as far
/// as the width has room for them.
#[must_use]
pub fn beneath(picture: ArrayView2<'_, [u8; 3]>, range: ColourRange) -> Array2<[u8; 3]> {
    let bar = draw(picture.ncols(), range);
    // Both have one width, so this cannot fail; a picture without its bar is still the picture.
    concatenate(ndarray::Axis(0), &[picture, bar.view()]).unwrap_or_else(|_| picture.to_owned())
}

fn draw(width: usize, range: ColourRange) -> Array2<[u8; 3]> {
    let mut strip = Array2::from_elem((HEIGHT, width), PAPER);
    let Some(length) = width.checked_sub(2 * MARGIN).filter(|&length| length > 1) else {
        return strip;
    };
    let step = (range.highest() - range.lowest()) / (length - 1) as f32;
    let numbers = Array2::from_shape_fn((BAR, length), |(_, x)| range.lowest() + step * x as f32);
    strip
        .slice_mut(s![MARGIN..MARGIN + BAR, MARGIN..MARGIN + length])
        .assign(&colour::paint(numbers.view(), range));

    for tick in ticks(length, range) {
        let x = MARGIN + (tick.along * (length - 1) as f64).round() as usize;
        strip
            .slice_mut(s![MARGIN + BAR..MARGIN + BAR + TICK, x])
            .fill(INK);
        // Centred under its tick, as far as the edges allow.
        let left = (x as f64 - tick.label_width() as f64 / 2.0).max(0.0) as usize;
        let left = left.min(width.saturating_sub(tick.label_width()));
        write_number(&mut strip, &tick.label, (left, MARGIN + BAR + TICK + GAP));
    }
    strip
}

/// Writes a number with the upper left corner of its first digit at `(left, top)`, cut off at the
/// edges.
pub(crate) fn write_number(
    picture: &mut Array2<[u8; 3]>,
    number: &str,
    (left, top): (usize, usize),
) {
    for (place, sign) in number.chars().enumerate() {
        Digit::of(sign).draw(picture, (left + place * ADVANCE, top));
    }
}

struct Tick {
    /// Where on the bar, from 0 to 1.
    along: f64,
    label: String,
}

impl Tick {
    fn label_width(&self) -> usize {
        ADVANCE * self.label.chars().count()
    }
}

/// Multiples of the smallest round step (1, 2 or 5 times a power of ten) whose labels do not
/// touch on a bar of this length.
fn ticks(length: usize, range: ColourRange) -> Vec<Tick> {
    let (lowest, highest) = (f64::from(range.lowest()), f64::from(range.highest()));
    let span = highest - lowest;
    let power = span.log10().floor() as i32;
    (power - 2..=power + 1)
        .flat_map(|power| [1.0, 2.0, 5.0].map(|factor| (factor, power)))
        .map(|(factor, power)| {
            let step = factor * 10f64.powi(power);
            let decimals = (-power).max(0) as usize;
            let first = (lowest / step).ceil();
            let count = ((highest / step).floor() - first + 1.0).max(0.0) as usize;
            let ticks = (0..count).map(|index| {
                let number = (first + index as f64) * step;
                Tick {
                    along: (number - lowest) / span,
                    // Added to zero, so that no label reads -0.
                    label: format!("{:.decimals$}", number + 0.0),
                }
            });
            let ticks: Vec<Tick> = ticks.collect();
            (step, ticks)
        })
        .find(|(step, ticks)| {
            let widest = ticks.iter().map(Tick::label_width).max().unwrap_or(0);
            (step / span) * length as f64 >= (widest + ADVANCE) as f64
        })
        .map_or_else(Vec::new, |(_, ticks)| ticks)
}

/// A digit of seven segments, three pixels wide and five high.
struct Digit {
    /// Segments a to g as bits from the lowest: top, upper right, lower right, bottom, lower
    /// left, upper left, middle; the eighth is the point.
    segments: u8,
}

impl Digit {
    const WIDTH: usize = 3;
    const HEIGHT: usize = 5;

    const fn of(sign: char) -> Self {
        let segments = match sign {
            '0' => 0b011_1111,
            '1' => 0b000_0110,
            '2' => 0b101_1011,
            '3' => 0b100_1111,
            '4' => 0b110_0110,
            '5' => 0b110_1101,
            '6' => 0b111_1101,
            '7' => 0b000_0111,
            '8' => 0b111_1111,
            '9' => 0b110_1111,
            '-' => 0b100_0000,
            '.' => 0b1000_0000,
            _ => 0,
        };
        Self { segments }
    }

    /// Whether a pixel of the digit is ink: one of the segments that touch it is lit.
    const fn inks(&self, x: usize, y: usize) -> bool {
        let touching = match (x, y) {
            (0, 0) => 0b010_0001,
            (1, 0) => 0b000_0001,
            (2, 0) => 0b000_0011,
            (0, 1) => 0b010_0000,
            (2, 1) => 0b000_0010,
            (0, 2) => 0b111_0000,
            (1, 2) => 0b100_0000,
            (2, 2) => 0b100_0110,
            (0, 3) => 0b001_0000,
            (2, 3) => 0b000_0100,
            (0, 4) => 0b001_1000,
            (1, 4) => 0b1000_1000,
            (2, 4) => 0b000_1100,
            _ => 0,
        };
        self.segments & touching != 0
    }

    /// Draws the digit with its upper left corner at `(left, top)`, cut off at the edges.
    fn draw(&self, strip: &mut Array2<[u8; 3]>, (left, top): (usize, usize)) {
        for y in 0..ZOOM * Self::HEIGHT {
            for x in 0..ZOOM * Self::WIDTH {
                if self.inks(x / ZOOM, y / ZOOM)
                    && let Some(pixel) = strip.get_mut((top + y, left + x))
                {
                    *pixel = INK;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn labels_are_round_and_apart() {
        let labels = |length, lowest, highest| {
            let range = ColourRange::new(lowest, highest).unwrap();
            let ticks = ticks(length, range).into_iter();
            ticks.map(|tick| tick.label).collect::<Vec<_>>()
        };
        assert_eq!(
            labels(300, 3.0, 19.75),
            ["4", "6", "8", "10", "12", "14", "16", "18"]
        );
        assert_eq!(labels(100, 0.0, 1.0), ["0.0", "0.5", "1.0"]);
        assert_eq!(
            labels(200, -3.2, 3.2),
            ["-3", "-2", "-1", "0", "1", "2", "3"]
        );
        assert_eq!(labels(10, 0.0, 1.0), ["0"]);
    }

    #[test]
    fn digits_differ() {
        let drawn: std::collections::BTreeSet<Vec<bool>> = "0123456789-. "
            .chars()
            .map(|sign| {
                let digit = Digit::of(sign);
                (0..15).map(|i| digit.inks(i % 3, i / 3)).collect()
            })
            .collect();
        assert_eq!(drawn.len(), 13);
    }

    proptest! {
        /// A bar is as wide as its picture, of one height, and leaves the picture as it is.
        #[test]
        fn the_picture_stays(
            width in 1usize..300,
            lowest in -1e6f32..1e6,
            span in 1e-3f32..1e6,
        ) {
            prop_assume!(lowest + span > lowest);
            let range = ColourRange::new(lowest, lowest + span).unwrap();
            let picture = Array2::from_elem((3, width), [1, 2, 3]);
            let whole = beneath(picture.view(), range);
            prop_assert_eq!(whole.dim(), (3 + HEIGHT, width));
            prop_assert_eq!(whole.slice(s![..3, ..]), picture);
        }
    }
}
