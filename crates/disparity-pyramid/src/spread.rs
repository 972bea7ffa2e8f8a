use ndarray::Array2;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use v1_gabor::Size;

use crate::shifts::Shifts;
use crate::slopes::STEEPEST;
use crate::{DisparityField, ShiftCovariance, Validity};

/// Shifts of neighbours no further apart than this, in pixels, are one surface's: a little more than
/// the steepest one grows by between them, as they are two pixels from each other.
const ONE_SURFACE_PX: f32 = 2.0 * STEEPEST + 0.1;

const CONTIGUOUS: &str = "planes are made in row-major order";

/// Writes the field of an image from the shifts of every second pixel of every second row.
///
/// A pixel between two takes their mean where they are one surface's and equally known, and otherwise
/// those of the surer one: a step between surfaces stays a step. It is as valid as the surer one. What
/// lies between rows is found first, then what lies between columns.
pub(crate) fn spread(
    found: &Shifts,
    confidence: &Array2<f32>,
    size: Size,
    field: &mut DisparityField,
) {
    let fit = |plane: &mut Array2<f32>| {
        if plane.dim() != size.dim() {
            *plane = Array2::zeros(size.dim());
        }
    };
    fit(&mut field.dx);
    fit(&mut field.dy);
    fit(&mut field.confidence);
    if field.validity.dim() != size.dim() {
        field.validity = Array2::from_elem(size.dim(), Validity::NoEnergy);
    }
    let width = size.width;
    let samples = Samples {
        dx: found.dx.as_slice().expect(CONTIGUOUS),
        dy: found.dy.as_slice().expect(CONTIGUOUS),
        confidence: confidence.as_slice().expect(CONTIGUOUS),
        validity: found.validity.as_slice().expect(CONTIGUOUS),
    };
    let (rows, columns) = found.dx.dim();
    let row = |y: usize| samples.part(y.min(rows - 1) * columns..(y.min(rows - 1) + 1) * columns);
    let rows = |plane| {
        <Array2<f32>>::as_slice_mut(plane)
            .expect(CONTIGUOUS)
            .par_chunks_mut(width)
    };
    let planes = (
        rows(&mut field.dx),
        rows(&mut field.dy),
        rows(&mut field.confidence),
    );
    let validity = field.validity.as_slice_mut().expect(CONTIGUOUS);
    planes
        .into_par_iter()
        .zip(validity.par_chunks_mut(width))
        .enumerate()
        .for_each(|(y, ((dx, dy, confidence), validity))| {
            Arch::new().dispatch(Row {
                above: row(y / 2),
                below: row(y.div_ceil(2)),
                dx,
                dy,
                confidence,
                validity,
            });
        });
}

/// The covariances of a field from those of every second pixel of every second row: each pixel's are
/// those of the surest one beside it.
pub(crate) fn spread_covariance(
    found: &Array2<ShiftCovariance>,
    confidence: &Array2<f32>,
    size: Size,
) -> Array2<ShiftCovariance> {
    let (height, width) = found.dim();
    Array2::from_shape_fn(size.dim(), |(y, x)| {
        let (below, right) = (y.div_ceil(2).min(height - 1), x.div_ceil(2).min(width - 1));
        let mut surest = [y / 2, x / 2];
        for beside in [[y / 2, right], [below, x / 2], [below, right]] {
            if confidence[beside] > confidence[surest] {
                surest = beside;
            }
        }
        found[surest]
    })
}

/// Samples one after the other.
#[derive(Clone, Copy)]
struct Samples<'a> {
    dx: &'a [f32],
    dy: &'a [f32],
    confidence: &'a [f32],
    validity: &'a [Validity],
}

/// One row of the field, and the samples above and below it: twice the same where it goes through them.
struct Row<'a> {
    above: Samples<'a>,
    below: Samples<'a>,
    dx: &'a mut [f32],
    dy: &'a mut [f32],
    confidence: &'a mut [f32],
    validity: &'a mut [Validity],
}

/// Samples that are treated together.
const STRIP: usize = 128;

/// Some samples of a row and the next one after them.
struct Strip {
    dx: [f32; STRIP + 1],
    dy: [f32; STRIP + 1],
    confidence: [f32; STRIP + 1],
    validity: [Validity; STRIP + 1],
}

impl WithSimd for Row<'_> {
    type Output = ();

    // The loops are compiled for the machine's vectors.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let samples = self.above.dx.len();
        let mut strip = Strip {
            dx: [0.0; STRIP + 1],
            dy: [0.0; STRIP + 1],
            confidence: [0.0; STRIP + 1],
            validity: [Validity::NoEnergy; STRIP + 1],
        };
        let mut between = Strip {
            dx: [0.0; STRIP + 1],
            dy: [0.0; STRIP + 1],
            confidence: [0.0; STRIP + 1],
            validity: [Validity::NoEnergy; STRIP + 1],
        };
        let planes = self
            .dx
            .chunks_mut(2 * STRIP)
            .zip(self.dy.chunks_mut(2 * STRIP));
        let words = self
            .confidence
            .chunks_mut(2 * STRIP)
            .zip(self.validity.chunks_mut(2 * STRIP));
        for (number, ((dx, dy), (confidence, validity))) in planes.zip(words).enumerate() {
            let start = number * STRIP;
            let count = dx.len().div_ceil(2);
            let here = start..(start + count + 1).min(samples);
            let known = here.len();
            blend(
                &mut strip,
                self.above.part(here.clone()),
                self.below.part(here),
            );
            // Beyond the last column its values hold.
            if known == count {
                strip.repeat(count);
            }
            let (first, next) = strip.neighbours(count);
            blend(&mut between, first, next);
            interleave(dx, &strip.dx, &between.dx);
            interleave(dy, &strip.dy, &between.dy);
            interleave(confidence, &strip.confidence, &between.confidence);
            interleave(validity, &strip.validity, &between.validity);
        }
    }
}

impl<'a> Samples<'a> {
    #[inline(always)]
    fn part(self, here: std::ops::Range<usize>) -> Self {
        Self {
            dx: &self.dx[here.clone()],
            dy: &self.dy[here.clone()],
            confidence: &self.confidence[here.clone()],
            validity: &self.validity[here],
        }
    }
}

impl Strip {
    /// The first samples, and each one's neighbour.
    #[inline(always)]
    fn neighbours(&self, count: usize) -> (Samples<'_>, Samples<'_>) {
        let all = Samples {
            dx: &self.dx,
            dy: &self.dy,
            confidence: &self.confidence,
            validity: &self.validity,
        };
        (all.part(0..count), all.part(1..count + 1))
    }

    /// Repeats the sample before this one.
    #[inline(always)]
    fn repeat(&mut self, at: usize) {
        self.dx[at] = self.dx[at - 1];
        self.dy[at] = self.dy[at - 1];
        self.confidence[at] = self.confidence[at - 1];
        self.validity[at] = self.validity[at - 1];
    }
}

/// What lies between each two samples.
#[inline(always)]
fn blend(out: &mut Strip, one: Samples<'_>, other: Samples<'_>) {
    let count = one.dx.len();
    let (dx, dy) = (&mut out.dx[..count], &mut out.dy[..count]);
    let (confidence, validity) = (&mut out.confidence[..count], &mut out.validity[..count]);
    let (dx_1, dx_2) = (&one.dx[..count], &other.dx[..count]);
    let (dy_1, dy_2) = (&one.dy[..count], &other.dy[..count]);
    let (sure_1, sure_2) = (&one.confidence[..count], &other.confidence[..count]);
    let (valid_1, valid_2) = (&one.validity[..count], &other.validity[..count]);
    for i in 0..count {
        let first = sure_1[i] >= sure_2[i];
        // What is not valid has no confidence.
        let alike = (sure_1[i] > 0.0) == (sure_2[i] > 0.0);
        let near = ((dx_1[i] - dx_2[i]).abs() < ONE_SURFACE_PX)
            & ((dy_1[i] - dy_2[i]).abs() < ONE_SURFACE_PX);
        let mean = alike & near;
        let choose = |one: f32, other: f32| {
            let surer = if first { one } else { other };
            if mean { 0.5 * (one + other) } else { surer }
        };
        dx[i] = choose(dx_1[i], dx_2[i]);
        dy[i] = choose(dy_1[i], dy_2[i]);
        confidence[i] = choose(sure_1[i], sure_2[i]);
    }
    for i in 0..count {
        let first = sure_1[i] >= sure_2[i];
        validity[i] = if first { valid_1[i] } else { valid_2[i] };
    }
}

/// Writes samples and what lies behind each in turn.
#[inline(always)]
fn interleave<T: Copy>(out: &mut [T], samples: &[T], between: &[T]) {
    let (pairs, single) = out.as_chunks_mut::<2>();
    let count = pairs.len();
    let (first, second) = (&samples[..count], &between[..count]);
    for i in 0..count {
        pairs[i] = [first[i], second[i]];
    }
    if let [single] = single {
        *single = samples[count];
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// What one pixel knows.
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Word {
        dx: f32,
        dy: f32,
        confidence: f32,
        validity: Validity,
    }

    /// The twin: what lies between two, one pixel at a time.
    fn between(one: Word, other: Word) -> Word {
        let surer = if one.confidence >= other.confidence {
            one
        } else {
            other
        };
        let same = |one: f32, other: f32| (one - other).abs() < ONE_SURFACE_PX;
        let near = same(one.dx, other.dx) && same(one.dy, other.dy);
        if !near || one.validity.is_valid() != other.validity.is_valid() {
            return surer;
        }
        Word {
            dx: 0.5 * (one.dx + other.dx),
            dy: 0.5 * (one.dy + other.dy),
            confidence: 0.5 * (one.confidence + other.confidence),
            validity: surer.validity,
        }
    }

    fn shifts(samples: &Array2<Word>) -> (Shifts, Array2<f32>) {
        let mut shifts = Shifts::silent(Size::of_dim(samples.dim()));
        shifts.dx = samples.mapv(|word| word.dx);
        shifts.dy = samples.mapv(|word| word.dy);
        shifts.validity = samples.mapv(|word| word.validity);
        (shifts, samples.mapv(|word| word.confidence))
    }

    proptest! {
        #[test]
        fn rows_of_vectors_say_what_single_pixels_do(
            width in prop_oneof![1usize..30, 250usize..270], height in 1usize..7, seed: u64,
        ) {
            let size = Size { width, height };
            let mut state = seed | 1;
            let mut random = move || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 40) as f32 / (1u64 << 24) as f32
            };
            let samples = Array2::from_shape_simple_fn(size.halved().dim(), || {
                let valid = random() < 0.7;
                Word {
                    dx: 2.0 * random(),
                    dy: random(),
                    confidence: if valid { 0.1 + 0.9 * random() } else { 0.0 },
                    validity: if valid { Validity::Valid } else { Validity::Incoherent },
                }
            });
            let (found, confidence) = shifts(&samples);
            let mut field = DisparityField::default();
            spread(&found, &confidence, size, &mut field);
            let (rows, columns) = samples.dim();
            for y in 0..height {
                for x in 0..width {
                    let down = |x: usize| {
                        let x = x.min(columns - 1);
                        let (above, below) = (samples[[y / 2, x]], samples[[y.div_ceil(2).min(rows - 1), x]]);
                        if y % 2 == 0 { above } else { between(above, below) }
                    };
                    let twin = if x % 2 == 0 { down(x / 2) } else { between(down(x / 2), down(x / 2 + 1)) };
                    let at = [y, x];
                    let word = Word {
                        dx: field.dx[at],
                        dy: field.dy[at],
                        confidence: field.confidence[at],
                        validity: field.validity[at],
                    };
                    prop_assert_eq!(word, twin, "x = {}, y = {}", x, y);
                }
            }
        }

        /// A covariance is there exactly where a shift is valid.
        #[test]
        fn what_is_valid_has_a_covariance(valid in prop::collection::vec(any::<bool>(), 12)) {
            let size = Size { width: 7, height: 6 };
            let mut places = valid.iter();
            let samples = Array2::from_shape_simple_fn(size.halved().dim(), || {
                let valid = *places.next().expect("there are twelve");
                Word {
                    dx: 0.0,
                    dy: 0.0,
                    confidence: f32::from(u8::from(valid)),
                    validity: if valid { Validity::Valid } else { Validity::NoEnergy },
                }
            });
            let (found, confidence) = shifts(&samples);
            let mut field = DisparityField::default();
            spread(&found, &confidence, size, &mut field);
            let certain = ShiftCovariance { xx: 1.0, xy: 0.0, yy: 1.0 };
            let known = samples.mapv(|word| if word.validity.is_valid() { certain } else { ShiftCovariance::UNKNOWN });
            let covariance = spread_covariance(&known, &confidence, size);
            for (at, validity) in field.validity.indexed_iter() {
                prop_assert_eq!(covariance[at] == certain, validity.is_valid());
            }
        }
    }

    #[test]
    fn the_steepest_slope_stays_a_slope_and_a_step_a_step() {
        let size = Size {
            width: 21,
            height: 15,
        };
        let at = |x: usize, y: usize| Word {
            dx: 0.69 * x as f32 - 0.6 * y as f32 - if x > 10 { 9.0 } else { 0.0 },
            dy: 0.02 * y as f32,
            confidence: 0.9,
            validity: Validity::Valid,
        };
        let samples = Array2::from_shape_fn(size.halved().dim(), |(y, x)| at(2 * x, 2 * y));
        let (found, confidence) = shifts(&samples);
        let mut field = DisparityField::default();
        spread(&found, &confidence, size, &mut field);
        for ((y, x), &dx) in field.dx.indexed_iter() {
            // Between the surfaces stands one of both.
            let expected = if x == 11 { at(10, y) } else { at(x, y) };
            assert!((dx - expected.dx).abs() < 1e-5, "{dx} at {x}, {y}");
            assert!((field.dy[[y, x]] - expected.dy).abs() < 1e-5);
        }
    }
}
