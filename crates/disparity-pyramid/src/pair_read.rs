use pulp::Simd;
use pulp::x86::V4;

use crate::slopes::TileSlopes;
use crate::tile::{Along, Products, Reader, TILE, Tile, TileShifts};
use crate::vector::{store, vector};
use crate::warp::Warp;

/// Reads two pixels at a time, the eight orientations of each side by side in a vector of sixteen
/// lanes. The twin of [`ByPixel`](crate::tile::ByPixel) for eight orientations, where a pixel's
/// parts fill one vector.
#[derive(Clone, Copy)]
pub(crate) struct ByPair(pub(crate) V4);

/// Orientations of the bank.
const ORIENTATIONS: usize = 8;

/// Even and odd parts of a pixel.
const PARTS: usize = 2 * ORIENTATIONS;

/// Pixels whose parts are turned together from one beside the other to the other way round.
const GROUP: usize = 16;

/// Pixels that go together: `i` and `i + HALF`, so that what is turned in the end are two squares side
/// by side.
const HALF: usize = GROUP / 2;

type Vector = <V4 as Simd>::f32s;

/// Where the pixels of a tile fall in the right image.
#[repr(align(64))]
struct Places {
    /// The pixel above and left, counted row by row; the first one if there is none.
    corner: [u32; TILE],
    /// From there to the pixel to the right and to that below: nothing at the border.
    right: [u32; TILE],
    below: [u32; TILE],
    /// From there, in `[0, 1]`.
    beyond_x: [f32; TILE],
    beyond_y: [f32; TILE],
    /// How much of the corner is in the place, and of the pixels to the right, below, and both.
    shares: [[f32; TILE]; 4],
    in_view: [bool; TILE],
}

impl Places {
    /// The same as [`Warp::place`] for each pixel, without a branch.
    #[inline(always)]
    fn new(warp: &Warp<'_>, at: Along, (dx, dy): (&[f32; TILE], &[f32; TILE])) -> Self {
        // Adding 1.5 * 2^23 rounds to the nearest integer, which then stands in the lowest bits.
        const ROUNDER: f32 = 12_582_912.0;
        let (most_x, most_y) = (warp.size.width as u32 - 1, warp.size.height as u32 - 1);
        let width = warp.size.width as u32;
        let mut places = Self {
            corner: [0; TILE],
            right: [0; TILE],
            below: [0; TILE],
            beyond_x: [0.0; TILE],
            beyond_y: [0.0; TILE],
            shares: [[0.0; TILE]; 4],
            in_view: [false; TILE],
        };
        let floor = |at: f32| {
            let nearest = (at + ROUNDER) - ROUNDER;
            let floor = if nearest > at { nearest - 1.0 } else { nearest };
            (floor, (floor + ROUNDER).to_bits() - ROUNDER.to_bits())
        };
        for i in 0..TILE {
            let (u, v) = (at.column(i) + dx[i], at.y as f32 + dy[i]);
            // Written so that NaN is outside, and without a branch.
            let inside = (u >= 0.0) & (u <= most_x as f32) & (v >= 0.0) & (v <= most_y as f32);
            let (u, v) = if inside { (u, v) } else { (0.0, 0.0) };
            let ((left, column), (above, row)) = (floor(u), floor(v));
            let held = (row & warp.row_mask) * width;
            let next = (row.wrapping_add(1) & warp.row_mask) * width;
            places.corner[i] = held + column;
            places.right[i] = u32::from(column < most_x);
            // Back to the first place, where the rows that are held go round.
            places.below[i] = if row < most_y {
                next.wrapping_sub(held)
            } else {
                0
            };
            let (fx, fy) = (u - left, v - above);
            places.beyond_x[i] = fx;
            places.beyond_y[i] = fy;
            places.shares[0][i] = (1.0 - fx) * (1.0 - fy);
            places.shares[1][i] = fx * (1.0 - fy);
            places.shares[2][i] = (1.0 - fx) * fy;
            places.shares[3][i] = fx * fy;
            places.in_view[i] = inside;
        }
        places
    }
}

/// Begins at a cache line.
#[repr(align(64))]
struct Aligned<T>(T);

/// What is the same for all pixels.
struct Carrier {
    cos: [Vector; 3],
    /// The sines, and after them their negatives.
    sin: [Vector; 3],
    wave_x: Vector,
    wave_y: Vector,
    /// The wave vectors times the square of the envelope, and after them their negatives.
    grow_x: Vector,
    grow_y: Vector,
}

impl Carrier {
    #[inline(always)]
    fn new(v4: V4, warp: &Warp<'_>) -> Self {
        let twice = |numbers: &[f32], factor: f32| {
            let mut both = [0.0; PARTS];
            for q in 0..ORIENTATIONS {
                both[q] = numbers[q];
                both[ORIENTATIONS + q] = factor * numbers[q];
            }
            vector(v4, &both, 0)
        };
        let turns = &warp.carriers.turns;
        let sigma_squared = v4.splat_f32s(warp.carriers.sigma_squared);
        Self {
            cos: [
                twice(&turns[0].cos, 1.0),
                twice(&turns[1].cos, 1.0),
                twice(&turns[2].cos, 1.0),
            ],
            sin: [
                twice(&turns[0].sin, -1.0),
                twice(&turns[1].sin, -1.0),
                twice(&turns[2].sin, -1.0),
            ],
            wave_x: twice(&warp.carriers.wave_x, 1.0),
            wave_y: twice(&warp.carriers.wave_y, 1.0),
            grow_x: v4.mul_f32s(sigma_squared, twice(&warp.carriers.wave_x, -1.0)),
            grow_y: v4.mul_f32s(sigma_squared, twice(&warp.carriers.wave_y, -1.0)),
        }
    }

    /// The right eye's parts at a place, as [`Warp::read`] gives them: even ones, then odd ones.
    #[inline(always)]
    fn read(&self, v4: V4, right: &[[f32; PARTS]], places: &Places, i: usize) -> Vector {
        let corner = places.corner[i];
        let below = corner.wrapping_add(places.below[i]);
        let to_right = places.right[i];
        let neighbours = [
            &right[(corner + to_right) as usize],
            &right[below as usize],
            &right[(below + to_right) as usize],
        ];
        let share = |n: usize| v4.splat_f32s(places.shares[n][i]);
        let mut sum = v4.mul_f32s(share(0), vector(v4, &right[corner as usize], 0));
        // What the turns bring from the even parts to the odd ones and back, still at its old place.
        let mut crossing = v4.splat_f32s(0.0);
        for n in 0..3 {
            let part = v4.mul_f32s(share(n + 1), vector(v4, neighbours[n], 0));
            sum = v4.mul_add_e_f32s(part, self.cos[n], sum);
            crossing = v4.mul_add_e_f32s(part, self.sin[n], crossing);
        }
        let avx512 = v4.avx512f;
        let crossing = pulp::cast(crossing);
        let crossed = avx512._mm512_shuffle_f32x4::<0b01_00_11_10>(crossing, crossing);
        v4.add_f32s(sum, pulp::cast(crossed))
    }

    /// The same, of filters that are stretched by the slope there, as [`Warp::read_stretched`] gives
    /// them.
    #[inline(always)]
    fn read_stretched(
        &self,
        v4: V4,
        right: &[[f32; PARTS]],
        (places, slopes): (&Places, &TileSlopes),
        i: usize,
    ) -> Vector {
        let corner = places.corner[i];
        let below = corner.wrapping_add(places.below[i]);
        let to_right = places.right[i];
        let neighbours = [
            &right[corner as usize],
            &right[(corner + to_right) as usize],
            &right[below as usize],
            &right[(below + to_right) as usize],
        ];
        let grow = |along_x: f32, along_y: f32| {
            let along_y = v4.mul_f32s(self.grow_y, v4.splat_f32s(along_y));
            v4.mul_add_e_f32s(self.grow_x, v4.splat_f32s(along_x), along_y)
        };
        let [xx, xy, yx, yy] = slopes.0;
        let (grow_x, grow_y) = (grow(xx[i], yx[i]), grow(xy[i], yy[i]));
        let (fx, fy) = (places.beyond_x[i], places.beyond_y[i]);
        let weights = [
            (fy - 1.0, fx - 1.0),
            (1.0 - fy, -fx),
            (-fy, 1.0 - fx),
            (fy, fx),
        ];
        let mut sum = v4.splat_f32s(0.0);
        let mut crossing = v4.splat_f32s(0.0);
        for n in 0..4 {
            let part = vector(v4, neighbours[n], 0);
            let share = v4.splat_f32s(places.shares[n][i]);
            let (along_x, along_y) = weights[n];
            let along_x = v4.mul_f32s(grow_x, v4.splat_f32s(along_x));
            // A quarter turn on, so that what is even here counts for the odd parts.
            let rise = v4.mul_add_e_f32s(grow_y, v4.splat_f32s(along_y), along_x);
            if n == 0 {
                sum = v4.mul_f32s(share, part);
                crossing = v4.mul_f32s(rise, part);
                continue;
            }
            let (cos, sin) = (self.cos[n - 1], self.sin[n - 1]);
            // `(share + j rise) (cos + j sin)`, the rise and the sine with their signs.
            let straight = v4.negate_mul_add_e_f32s(rise, sin, v4.mul_f32s(share, cos));
            let across = v4.mul_add_e_f32s(rise, cos, v4.mul_f32s(share, sin));
            sum = v4.mul_add_e_f32s(part, straight, sum);
            crossing = v4.mul_add_e_f32s(part, across, crossing);
        }
        let avx512 = v4.avx512f;
        let crossing = pulp::cast(crossing);
        let crossed = avx512._mm512_shuffle_f32x4::<0b01_00_11_10>(crossing, crossing);
        v4.add_f32s(sum, pulp::cast(crossed))
    }
}

impl Reader for ByPair {
    type Simd = V4;

    #[inline(always)]
    fn simd(self) -> V4 {
        self.0
    }

    #[inline(always)]
    fn read(
        self,
        tile: &mut Tile,
        (left, warp): (&[f32], &Warp<'_>),
        at: Along,
        (shifts, slopes): (TileShifts<'_>, Option<&TileSlopes>),
        threshold: f32,
    ) {
        let Self(v4) = self;
        let (left, _) = left.as_chunks::<PARTS>();
        let (right, _) = warp.samples.as_chunks::<PARTS>();
        let last = left.len() - 1;
        let places = Places::new(warp, at, shifts);
        let carrier = Carrier::new(v4, warp);
        let threshold = v4.splat_f32s(threshold);
        let second = pulp::b16(0xff00);
        let both = |numbers: &[f32; TILE], i: usize| {
            let (one, other) = (numbers[i], numbers[i + HALF]);
            v4.select_f32s(second, v4.splat_f32s(other), v4.splat_f32s(one))
        };
        for first in (0..TILE).step_by(GROUP) {
            let silence = (threshold, threshold);
            let mut products = Aligned([Products::new(v4, silence, silence); HALF]);
            for (i, products) in (first..).zip(&mut products.0) {
                let left = (
                    vector(v4, &left[(i * at.step).min(last)], 0),
                    vector(v4, &left[((i + HALF) * at.step).min(last)], 0),
                );
                let right = match slopes {
                    None => (
                        carrier.read(v4, right, &places, i),
                        carrier.read(v4, right, &places, i + HALF),
                    ),
                    Some(slopes) => (
                        carrier.read_stretched(v4, right, (&places, slopes), i),
                        carrier.read_stretched(v4, right, (&places, slopes), i + HALF),
                    ),
                };
                let (left, right) = (by_part(v4, left), by_part(v4, right));
                *products = Products::new(v4, left, right);
            }
            // A loop of its own: its steps are long chains, of which the processor sees several at a
            // time only if nothing else is among them.
            let mut phases = [threshold; HALF];
            let mut weights = [threshold; HALF];
            for i in 0..HALF {
                let along_y = v4.mul_f32s(carrier.wave_y, both(&places.beyond_y, first + i));
                let beyond_x = both(&places.beyond_x, first + i);
                let turn = v4.mul_add_e_f32s(carrier.wave_x, beyond_x, along_y);
                (phases[i], weights[i]) = products.0[i].phase_and_weight(v4, turn, threshold);
            }
            let (phases, weights) = (turned(v4, phases), turned(v4, weights));
            for q in 0..ORIENTATIONS {
                store(v4, &mut tile.phase[q], first, phases[q]);
                store(v4, &mut tile.weight[q], first, weights[q]);
            }
        }
        tile.in_view = places.in_view;
    }
}

/// The even parts of two pixels, and their odd parts.
#[inline(always)]
fn by_part(v4: V4, (one, other): (Vector, Vector)) -> (Vector, Vector) {
    let (one, other) = (pulp::cast(one), pulp::cast(other));
    let avx512 = v4.avx512f;
    (
        pulp::cast(avx512._mm512_shuffle_f32x4::<0b01_00_01_00>(one, other)),
        pulp::cast(avx512._mm512_shuffle_f32x4::<0b11_10_11_10>(one, other)),
    )
}

/// From the orientations of two pixels in each vector to the pixels of a tile for each orientation:
/// the squares of the first and of the second pixels, each turned by itself.
#[inline(always)]
fn turned(v4: V4, pairs: [Vector; HALF]) -> [Vector; ORIENTATIONS] {
    let avx512 = v4.avx512f;
    let mut rows = [pulp::cast(pairs[0]); HALF];
    for i in 1..HALF {
        rows[i] = pulp::cast(pairs[i]);
    }
    let before = rows;
    for i in 0..4 {
        let (a, b) = (before[2 * i], before[2 * i + 1]);
        rows[2 * i] = avx512._mm512_unpacklo_ps(a, b);
        rows[2 * i + 1] = avx512._mm512_unpackhi_ps(a, b);
    }
    // In quarter `c` of vector `4 group + i`: column `4 c + i` of four rows, quarters 2 and 3 being
    // the second square's.
    let before = rows;
    for group in 0..2 {
        for i in 0..2 {
            let (a, b) = (before[4 * group + i], before[4 * group + 2 + i]);
            rows[4 * group + 2 * i] = avx512._mm512_shuffle_ps::<0b01_00_01_00>(a, b);
            rows[4 * group + 2 * i + 1] = avx512._mm512_shuffle_ps::<0b11_10_11_10>(a, b);
        }
    }
    let even_quarters = pulp::cast([0u64, 1, 8, 9, 4, 5, 12, 13]);
    let odd_quarters = pulp::cast([2u64, 3, 10, 11, 6, 7, 14, 15]);
    let mut columns = pairs;
    for i in 0..4 {
        let (a, b) = (
            avx512._mm512_castps_pd(rows[i]),
            avx512._mm512_castps_pd(rows[4 + i]),
        );
        columns[i] = pulp::cast(avx512._mm512_permutex2var_pd(a, even_quarters, b));
        columns[4 + i] = pulp::cast(avx512._mm512_permutex2var_pd(a, odd_quarters, b));
    }
    columns
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;
    use proptest::prelude::*;
    use pulp::{NullaryFnOnce, Scalar};
    use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};

    use super::*;
    use crate::tile::ByPixel;
    use crate::warp::Carriers;

    struct Read<'a, R> {
        reader: R,
        left: &'a [f32],
        warp: &'a Warp<'a>,
        at: Along,
        shifts: (TileShifts<'a>, Option<&'a TileSlopes>),
    }

    impl<R: Reader> NullaryFnOnce for Read<'_, R> {
        type Output = Tile;

        #[inline(always)]
        fn call(self) -> Tile {
            let mut tile = Tile::new();
            let eyes = (self.left, self.warp);
            self.reader
                .read(&mut tile, eyes, self.at, self.shifts, 1e-9);
            tile
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Both ways to read see the same phases and weights, at the image's border, outside it, and
        /// at the end of a row too. On a machine without AVX-512 there is but one.
        #[test]
        fn pairs_read_what_single_pixels_do(
            start in 0usize..3, step in 1usize..3, y in 0usize..20, seed: u64,
            dx in prop::array::uniform32(-30.0f32..30.0), dy in prop::array::uniform32(-5.0f32..5.0),
            slopes in prop::array::uniform4(prop::array::uniform32(-0.3f32..0.3)), slants: bool,
        ) {
            let Some(v4) = V4::try_new() else {
                return Ok(());
            };
            let size = Size { width: 70, height: 20 };
            let params = GaborParams { scales: 1, ..GaborParams::default() };
            let bank = FilterBank::plan(params, size).unwrap();
            let mut state = seed | 1;
            let mut see = || {
                let plane = Array2::from_shape_simple_fn(size.dim(), || {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    (state >> 40) as f32 / (1u64 << 24) as f32
                });
                bank.respond(&LumaImage::new(plane).unwrap()).unwrap()
            };
            let (left, right) = (see(), see());
            let carriers = Carriers::new(&params.wave_vectors(), params.sigma_px());
            let warp = Warp::new(&right.scales()[0], &carriers);
            let start = start * TILE;
            let mut dx = dx;
            // The last tile of a row has fewer pixels, and whole numbers are places too.
            for i in 0..TILE {
                if start + i * step >= size.width {
                    dx[i] = f32::NAN;
                } else if i % 5 == 0 {
                    dx[i] = dx[i].round();
                }
            }
            let left = &left.scales()[0].samples()[(y * size.width + start) * PARTS..];
            let slopes = TileSlopes(slopes);
            let shifts = ((&dx, &dy), slants.then_some(&slopes));
            let (warp, at) = (&warp, Along { x: start, y, step });
            let pairs = v4.vectorize(Read { reader: ByPair(v4), left, warp, at, shifts });
            let reader = ByPixel::<8, _>(Scalar, 8);
            let singles = Read { reader, left, warp, at, shifts }.call();
            prop_assert_eq!(pairs.in_view, singles.in_view);
            for i in (0..TILE).filter(|&i| singles.in_view[i]) {
                for q in 0..ORIENTATIONS {
                    // Responses near 0.1 differ in their last bits, weak ones by more of themselves.
                    let weight = singles.weight[q][i];
                    prop_assert!((pairs.weight[q][i] - weight).abs() < 1e-3);
                    let turns = (pairs.phase[q][i] - singles.phase[q][i]) / std::f32::consts::TAU;
                    let apart = (turns - turns.round()).abs() * std::f32::consts::TAU;
                    prop_assert!(apart * weight < 1e-3, "{apart} rad, weight {weight}");
                }
            }
        }
    }
}
