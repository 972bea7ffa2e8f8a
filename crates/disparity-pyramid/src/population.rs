use std::f32::consts::PI;

use ndarray::{Array2, ArrayView2};
use num_complex::Complex32;
use v1_gabor::WaveVector;

/// The response of a binocular energy cell: `|L + R exp(j shift)|^2`.
///
/// `left` and `right` are what quadrature pairs of one orientation say at one place of each eye, and
/// `shift` the phase by which the cell's right receptive field is shifted against its left one. Over
/// all shifts the response is `|L|^2 + |R|^2 + 2 |L R| cos(phase - shift)` with
/// `phase = arg(L conj R)`: a cell answers most where its own shift is the eyes' phase difference,
/// the numerator of equation 2, although no cell computes an angle.
#[must_use]
pub fn binocular_energy(left: Complex32, right: Complex32, shift: f32) -> f32 {
    (left + right * Complex32::cis(shift)).norm_sqr()
}

/// A population of binocular energy cells at one place, pooled over orientations.
///
/// Each cell prefers one shift `u = (dx, dy)` of a square grid about zero. For orientation `q` its
/// phase shift is `k_q.u`; the cell's response is that of its orientations, each divided by the
/// monocular energies `|L|^2 + |R|^2` (a contrast gain control), less the mean of the population:
/// `sum_q b_q cos(phase_q - k_q.u) / sum_q b_q`, `b_q` being the balance of the eyes' amplitudes.
/// It is 1 where every orientation's phase difference is that of the shift, and falls off as a
/// Bessel function of the distance from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Population {
    /// Cells along each axis; odd, so that one of them prefers no shift.
    side: usize,
    /// From one preferred shift to the next, px.
    step_px: f32,
    /// `exp(-j k_q.u)` of each cell and orientation, `[[cell, q]]`, cells row by row.
    tuning: Array2<Complex32>,
}

/// How far from zero preferred shifts lie, in periods of the filters: half a period either way is all
/// that a phase can tell.
const REACH_PERIODS: f32 = 0.5;

/// Cells in half a period: one every eighth of it puts the centre of mass within 0.005 px of the
/// peak of what it samples.
const CELLS: usize = 8;

/// Part of the strongest response below which a cell has no say in the centre of mass.
const SILENT: f32 = 0.5;

impl Population {
    /// The population whose orientations have these wave vectors, all of one length.
    ///
    /// # Panics
    /// If there is no wave vector.
    #[must_use]
    pub fn tuned_to(waves: &[WaveVector]) -> Self {
        let first = waves.first().expect("a population has orientations");
        let period_px = 2.0 * PI / first.x.hypot(first.y);
        let step_px = REACH_PERIODS * period_px / CELLS as f32;
        let side = 2 * CELLS + 1;
        let shift = |place: usize| (place as f32 - CELLS as f32) * step_px;
        let tuning = Array2::from_shape_fn((side * side, waves.len()), |(cell, q)| {
            let (dx, dy) = (shift(cell % side), shift(cell / side));
            Complex32::cis(-(waves[q].x * dx + waves[q].y * dy))
        });
        Self {
            side,
            step_px,
            tuning,
        }
    }

    /// The preferred shifts along either axis, ascending, px.
    pub fn preferred_px(&self) -> impl Iterator<Item = f32> + '_ {
        (0..self.side).map(|place| self.preferred(place))
    }

    /// What the cells say, `[[dy, dx]]` by preferred shift, from -1 to 1: 1 is full agreement.
    /// `products` are `b_q exp(j phase_q)` by orientation, zero for those that are not heard. All
    /// zero if none is.
    ///
    /// # Panics
    /// If there are not as many products as orientations.
    #[must_use]
    pub fn respond(&self, products: &[Complex32]) -> Array2<f32> {
        assert_eq!(
            products.len(),
            self.tuning.ncols(),
            "one product for each orientation"
        );
        let balance: f32 = products.iter().map(|product| product.norm()).sum();
        let balance = balance.max(f32::MIN_POSITIVE);
        let cell = |place: usize| {
            let tuning = self.tuning.row(place);
            let agreement = products.iter().zip(&tuning);
            let sum: f32 = agreement
                .map(|(product, tuning)| product.re * tuning.re - product.im * tuning.im)
                .sum();
            sum / balance
        };
        Array2::from_shape_fn((self.side, self.side), |(y, x)| cell(y * self.side + x))
    }

    /// The shift `(dx, dy)` that a population's responses stand for, px: their centre of mass, each
    /// weighted by the square of what it has above half the strongest. With the strongest response
    /// itself, the agreement of the orientations. `None` if no cell responds.
    ///
    /// The cells above half form a disc about the peak, so its middle is the peak, finer than the
    /// grid; the square leaves no edge to step over. Where one orientation alone is heard, the disc is
    /// a ridge, and its middle says that nothing moves along it.
    #[must_use]
    pub fn centre_of_mass(&self, responses: ArrayView2<'_, f32>) -> Option<((f32, f32), f32)> {
        let strongest = responses.iter().copied().fold(0.0, f32::max);
        if strongest <= 0.0 {
            return None;
        }
        let (mut mass, mut along_x, mut along_y) = (0.0, 0.0, 0.0);
        for ((y, x), response) in responses.indexed_iter() {
            let weight = (response - SILENT * strongest).max(0.0).powi(2);
            mass += weight;
            along_x += weight * self.preferred(x);
            along_y += weight * self.preferred(y);
        }
        Some(((along_x / mass, along_y / mass), strongest))
    }

    fn preferred(&self, place: usize) -> f32 {
        (place as f32 - (self.side / 2) as f32) * self.step_px
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use v1_gabor::GaborParams;

    use super::*;

    proptest! {
        /// The strongest cell is the one whose shift is the phase difference, and the population
        /// vector of evenly spread shifts has exactly its angle.
        #[test]
        fn cells_agree_with_the_phase(left in -3.0f32..3.0, right in -3.0f32..3.0, gain in 0.2f32..5.0) {
            let (left, right) = (Complex32::cis(left), gain * Complex32::cis(right));
            let cells = (0..12u8).map(|n| f32::from(n) * PI / 6.0);
            let vector: Complex32 = cells
                .map(|shift| binocular_energy(left, right, shift) * Complex32::cis(shift))
                .sum();
            let phase = left * right.conj();
            // Twelve sums of f32 of size up to 36.
            prop_assert!((vector / vector.norm() - phase / phase.norm()).norm() < 1e-4);
        }

        /// The centre of mass of phases that come from one shift is that shift, between the cells.
        #[test]
        fn a_shift_is_the_centre_of_mass(dx in -0.8f32..0.8, dy in -0.8f32..0.8) {
            let waves = GaborParams::default().wave_vectors();
            let population = Population::tuned_to(&waves);
            let products: Vec<Complex32> = waves
                .iter()
                .map(|k| Complex32::cis(k.x * dx + k.y * dy))
                .collect();
            let responses = population.respond(&products);
            let ((x, y), strongest) = population.centre_of_mass(responses.view()).unwrap();
            // A grid of a quarter of a pixel samples a disc of radius one pixel.
            prop_assert!((x - dx).abs() < 0.005 && (y - dy).abs() < 0.005, "({x}, {y})");
            prop_assert!(strongest > 0.9 && strongest <= 1.0 + 1e-5);
        }
    }

    #[test]
    fn silence_has_no_shift() {
        let waves = GaborParams::default().wave_vectors();
        let population = Population::tuned_to(&waves);
        let silence = population.respond(&[Complex32::ZERO; 8]);
        assert_eq!(population.centre_of_mass(silence.view()), None);
        let preferred: Vec<f32> = population.preferred_px().collect();
        assert_eq!(
            (preferred[0], preferred[8], preferred[16]),
            (-2.0, 0.0, 2.0)
        );
    }
}
