use ndarray::{Array2, ArrayView2, Axis};
use num_complex::Complex;
use rayon::prelude::*;
use v1_gabor::WaveVector;

use crate::dense::phase_agreement::{AgreementRow, BIAS, COST_ORIENTATIONS, PhaseAgreement};
use crate::dense::pixel_cost::PixelCost;

/// Side of the blocks over which phases are asked together, in pixels: one pixel's gradient is mostly noise.
pub(crate) const BLOCK: usize = 12;

/// How fast the shifts of a block grow downwards, as the phases have it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Slant {
    /// `d dx / dy`, in pixels a row.
    pub(crate) down: f32,
    /// The sum of moduli and squared frequencies that it rests upon; 0 where nothing is heard.
    pub(crate) weight: f32,
}

impl Slant {
    /// The mean by weight of some, and the sum of their weights.
    pub(crate) fn mean(slants: impl IntoIterator<Item = Self>) -> Self {
        let (mut sum, mut weight) = (0.0, 0.0);
        for slant in slants {
            sum += slant.weight * slant.down;
            weight += slant.weight;
        }
        Self::of(sum, weight)
    }

    /// A sum of weighed slants over that of their weights.
    fn of(sum: f32, weight: f32) -> Self {
        let heard = weight > f32::MIN_POSITIVE;
        let down = if heard { sum / weight } else { 0.0 };
        Self { down, weight }
    }
}

/// The slants downwards of blocks of [`BLOCK`] by [`BLOCK`] pixels, `[[row of blocks, column of blocks]]`, from
/// both eyes' codes where `dx`, in pixels, says that they match.
///
/// With `phi_L(x, y) = phi_R(x + dx(x, y), y)`, derived along `y`:
/// `phi_L,y - phi_R,y = phi_R,x d dx / dy`. On the left stands, for each orientation, the angle of
/// `Z = sum (u_L(y + 1) conj u_L(y)) conj (u_R(y + 1) conj u_R(y))` over the block, both rows of the right
/// eye at the same column, so that no phase is unwrapped; `phi_R,x` is the orientation's own frequency `w_x`.
/// Of all orientations by least squares, each weighed with its modulus:
/// `d dx / dy = sum |Z| w_x arg Z / sum |Z| w_x^2`. What is told
/// has the right sign and falls short: in either eye a filter hears what is near its own frequency, which is not the same
/// texture once the one is sheared against the other. As the shear goes, so does what it falls short of.
pub(crate) fn slants(
    agreement: &PhaseAgreement,
    waves: &[WaveVector],
    dx: ArrayView2<'_, f32>,
) -> Array2<Slant> {
    let (height, width) = dx.dim();
    let mut slants = Array2::default((height.div_ceil(BLOCK), width.div_ceil(BLOCK)));
    slants
        .axis_iter_mut(Axis(0))
        .into_par_iter()
        .enumerate()
        .for_each(|(band, mut slants)| {
            let mut turns = vec![Turns::default(); slants.len()];
            // The last row has none below it.
            for y in band * BLOCK..((band + 1) * BLOCK).min(height - 1) {
                let shifts = dx.row(y);
                let rows = [agreement.row(y), agreement.row(y + 1)];
                for (x, dx) in shifts.iter().enumerate() {
                    let seen = (x as f32 + dx).round();
                    // What is out of view tells nothing.
                    if (0.0..width as f32).contains(&seen) {
                        add(&mut turns[x / BLOCK], rows, [x, seen as usize]);
                    }
                }
            }
            for (slant, turns) in slants.iter_mut().zip(&turns) {
                *slant = slant_of(turns, waves);
            }
        });
    slants
}

/// `Z` of each orientation.
type Turns = [Complex<f32>; COST_ORIENTATIONS];

/// Adds a pixel's part of `Z`: what two rows of the left eye say at one column, those of the right eye at another.
fn add(turns: &mut Turns, [here, below]: [AgreementRow<'_>; 2], [x, seen]: [usize; 2]) {
    let (own, other) = (here.padding.place(x), here.padding.place(seen));
    for q in 0..COST_ORIENTATIONS {
        let left = part(below.left[q][own]) * part(here.left[q][own]).conj();
        let right = part(below.right[q][other]) * part(here.right[q][other]).conj();
        turns[q] += left * right.conj();
    }
}

fn slant_of(turns: &Turns, waves: &[WaveVector]) -> Slant {
    let (mut sum, mut weight) = (0.0, 0.0);
    for (turn, wave) in turns.iter().zip(waves) {
        let modulus = turn.norm();
        sum += modulus * wave.x * turn.arg();
        weight += modulus * wave.x * wave.x;
    }
    Slant::of(sum, weight)
}

/// A code without its bias.
fn part([even, odd]: [u8; 2]) -> Complex<f32> {
    let bias = f32::from(BIAS);
    Complex::new(f32::from(even) - bias, f32::from(odd) - bias)
}

#[cfg(test)]
mod tests {
    use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};

    use super::*;
    use crate::SearchRange;
    use crate::dense::phase_agreement::{Loudness, Seen};

    /// What is told has the sign of the slant and is no more than it, be the match right or wrong by some pixels, and
    /// of no slant none is told: all that is needed to come to the slant by shears.
    #[test]
    fn slanted_planes_are_told() {
        let size = Size {
            width: 120,
            height: 61,
        };
        let texture = |x: f32, y: f32| -> f32 {
            let wave =
                |i: f32| (0.3 + 0.055 * i) * (x * (2.4 * i).cos() + y * (2.4 * i).sin()) + i * i;
            (0..24u8).map(|i| 0.03 * wave(f32::from(i)).sin()).sum()
        };
        let params = GaborParams {
            orientations: COST_ORIENTATIONS,
            scales: 1,
            ..GaborParams::default()
        };
        let bank = FilterBank::plan(params, size).unwrap();
        let search = SearchRange::new(-30, 30).unwrap();
        let loudness = Loudness {
            silent_energy: 1e-9,
            opponent: 0.0,
            opponent_silent_energy: 0.0,
        };
        for down in [-0.6, -0.25, 0.0, 0.1, 0.5] {
            let shift = |y: usize| down * (y as f32 - 30.0);
            let see = |moved: f32| {
                let luma =
                    |(y, x): (usize, usize)| 0.5 + texture(x as f32 - moved * shift(y), y as f32);
                LumaImage::new(Array2::from_shape_fn(size.dim(), luma)).unwrap()
            };
            let (left, right) = (see(0.0), see(1.0));
            let eyes = Binocular {
                left: &left,
                right: &right,
            };
            let mut agreement = PhaseAgreement::default();
            agreement
                .take_in(
                    &bank,
                    eyes.map(Seen::luma),
                    loudness,
                    (search, 30),
                    &mut Vec::new(),
                )
                .unwrap();
            let told = |wrong_px: f32| {
                let dx = Array2::from_shape_fn(size.dim(), |(y, _)| shift(y) + wrong_px);
                let slants = slants(&agreement, &params.wave_vectors(), dx.view());
                // Away from the border, which a filter sees repeated; the last row of blocks has one row.
                let inside = slants.slice(ndarray::s![1..4, 3..7]).to_owned();
                Slant::mean(inside).down
            };
            for wrong_px in [0.0, 3.0, -5.0] {
                let told = told(wrong_px);
                let tells = down == 0.0 || told * down > 0.0;
                assert!(
                    tells && told.abs() <= down.abs() + 0.02,
                    "{told} for {down}"
                );
                assert!(down == 0.0 || told.abs() > 0.03, "{told} for {down}");
            }
        }
    }

    /// Silence tells of no slant.
    #[test]
    fn silence_says_nothing() {
        assert_eq!(Slant::mean([Slant::default(); 3]), Slant::default());
    }
}
