use v1_gabor::{Binocular, V1Responses};

use crate::{Disparity, DisparityField, Validity};

/// Least orientations that tell a shift and whether they agree on it.
const LEAST_HEARD: usize = 3;

/// Tells apart why too few orientations were heard at a pixel: [`Validity::Singular`] where enough
/// of them have the energy in both eyes, so that only the test for singularities took them away.
/// `eyes` are the responses before that test.
pub(crate) fn mark_singular(
    field: &mut DisparityField,
    eyes: &Binocular<V1Responses>,
    threshold: f32,
) {
    let finest = eyes.as_ref().map(|eye| &eye.scales()[0]);
    let size = field.size();
    field.give_reasons(|x, y, Disparity { dx, dy, .. }| {
        // The nearest pixel of the other eye; the casts saturate, so the border stands for what
        // lies beyond it.
        let nearest = |at: f32, length: usize| (at.round() as usize).min(length - 1);
        let match_x = nearest(x as f32 + dx, size.width);
        let match_y = nearest(y as f32 + dy, size.height);
        let energetic = |q: &usize| {
            let left = finest.left.at(*q, x, y).norm_sqr();
            let right = finest.right.at(*q, match_x, match_y).norm_sqr();
            left.min(right) > threshold
        };
        let energetic = (0..finest.left.orientations()).filter(energetic).count();
        if energetic < LEAST_HEARD {
            Validity::NoEnergy
        } else {
            Validity::Singular
        }
    });
}
