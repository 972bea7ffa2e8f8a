//! The bar under a coloured picture that says which colour is which number.

use ndarray::{Array2, ArrayView2, concatenate, s};

use crate::colour::{self, ColourRange};

/// Rows added under the picture.
pub const HEIGHT: usize = MARGIN + BAR + TICK + GAP + NUMBER_HEIGHT + MARGIN;

const MARGIN: usize = 4;
const BAR: usize = 10;
const TICK: usize = 3;
const GAP: usize = 2;
/// Screen pixels to one pixel of a glyph.
const ZOOM: usize = 2;
/// From the left edge of one glyph to that of the next.
const ADVANCE: usize = ZOOM * (Glyph::WIDTH + 1);
/// Height of a number that [`write_number`] writes.
pub(crate) const NUMBER_HEIGHT: usize = ZOOM * Glyph::HEIGHT;

const PAPER: [u8; 3] = [255; 3];
const INK: [u8; 3] = [0; 3];

/// The picture with a bar of the range's colours under it, and round numbers at its ticks as far
/// as the width has room for them, the last of them with its unit.
///
/// A unit is spelt with `m`, `p` and `x`, or empty where the numbers have none.
#[must_use]
pub fn beneath(
    picture: ArrayView2<'_, [u8; 3]>,
    range: ColourRange,
    unit: &str,
) -> Array2<[u8; 3]> {
    let bar = draw(picture.ncols(), range, unit);
    // Both have one width, so this cannot fail; a picture without its bar is still the picture.
    concatenate(ndarray::Axis(0), &[picture, bar.view()]).unwrap_or_else(|_| picture.to_owned())
}

fn draw(width: usize, range: ColourRange, unit: &str) -> Array2<[u8; 3]> {
    let mut strip = Array2::from_elem((HEIGHT, width), PAPER);
    let Some(length) = width.checked_sub(2 * MARGIN).filter(|&length| length > 1) else {
        return strip;
    };
    let step = (range.highest() - range.lowest()) / (length - 1) as f32;
    let numbers = Array2::from_shape_fn((BAR, length), |(_, x)| range.lowest() + step * x as f32);
    strip
        .slice_mut(s![MARGIN..MARGIN + BAR, MARGIN..MARGIN + length])
        .assign(&colour::paint(numbers.view(), range));

    for tick in ticks(length, range, unit) {
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
        Glyph::of(sign).draw(picture, (left + place * ADVANCE, top));
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
fn ticks(length: usize, range: ColourRange, unit: &str) -> Vec<Tick> {
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
            let mut ticks: Vec<Tick> = ticks.collect();
            if let (Some(last), false) = (ticks.last_mut(), unit.is_empty()) {
                last.label = format!("{} {unit}", last.label);
            }
            (step, ticks)
        })
        .find(|(step, ticks)| {
            let widest = ticks.iter().map(Tick::label_width).max().unwrap_or(0);
            (step / span) * length as f64 >= (widest + ADVANCE) as f64
        })
        .map_or_else(Vec::new, |(_, ticks)| ticks)
}

/// A digit or a letter of a unit, three pixels wide and five high.
struct Glyph {
    /// Its rows from the top; the lowest bit is the pixel on the right.
    rows: [u8; Self::HEIGHT],
}

impl Glyph {
    const WIDTH: usize = 3;
    const HEIGHT: usize = 5;

    const fn of(sign: char) -> Self {
        let rows = match sign {
            '0' => [0b111, 0b101, 0b101, 0b101, 0b111],
            '1' => [0b001, 0b001, 0b001, 0b001, 0b001],
            '2' => [0b111, 0b001, 0b111, 0b100, 0b111],
            '3' => [0b111, 0b001, 0b111, 0b001, 0b111],
            '4' => [0b101, 0b101, 0b111, 0b001, 0b001],
            '5' => [0b111, 0b100, 0b111, 0b001, 0b111],
            '6' => [0b111, 0b100, 0b111, 0b101, 0b111],
            '7' => [0b111, 0b001, 0b001, 0b001, 0b001],
            '8' => [0b111, 0b101, 0b111, 0b101, 0b111],
            '9' => [0b111, 0b101, 0b111, 0b001, 0b111],
            '-' => [0b000, 0b000, 0b111, 0b000, 0b000],
            '.' => [0b000, 0b000, 0b000, 0b000, 0b010],
            'm' => [0b101, 0b111, 0b111, 0b101, 0b101],
            'p' => [0b111, 0b101, 0b111, 0b100, 0b100],
            'x' => [0b101, 0b101, 0b010, 0b101, 0b101],
            _ => [0; Self::HEIGHT],
        };
        Self { rows }
    }

    const fn inks(&self, x: usize, y: usize) -> bool {
        self.rows[y] >> (Self::WIDTH - 1 - x) & 1 == 1
    }

    /// Draws the glyph with its upper left corner at `(left, top)`, cut off at the edges.
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
        let labels = |length, lowest, highest, unit| {
            let range = ColourRange::new(lowest, highest).unwrap();
            let ticks = ticks(length, range, unit).into_iter();
            ticks.map(|tick| tick.label).collect::<Vec<_>>()
        };
        assert_eq!(
            labels(300, 3.0, 19.75, ""),
            ["4", "6", "8", "10", "12", "14", "16", "18"]
        );
        assert_eq!(labels(100, 0.0, 1.0, ""), ["0.0", "0.5", "1.0"]);
        assert_eq!(
            labels(200, -3.2, 3.2, ""),
            ["-3", "-2", "-1", "0", "1", "2", "3"]
        );
        assert_eq!(labels(10, 0.0, 1.0, ""), ["0"]);
        // A unit stands once, and takes its room.
        assert_eq!(labels(120, 0.0, 1.0, "m"), ["0.0", "0.5", "1.0 m"]);
        assert_eq!(labels(60, 0.0, 1.0, "px"), ["0", "1 px"]);
    }

    #[test]
    fn glyphs_differ() {
        let drawn: std::collections::BTreeSet<Vec<bool>> = "0123456789-.mpx "
            .chars()
            .map(|sign| {
                let glyph = Glyph::of(sign);
                (0..15).map(|i| glyph.inks(i % 3, i / 3)).collect()
            })
            .collect();
        assert_eq!(drawn.len(), 16);
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
            let whole = beneath(picture.view(), range, "px");
            prop_assert_eq!(whole.dim(), (3 + HEIGHT, width));
            prop_assert_eq!(whole.slice(s![..3, ..]), picture);
        }
    }
}
