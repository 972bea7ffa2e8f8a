use dorsal::egocentric_depth::LabelImage;
use ndarray::{Array2, ArrayView2};
use serde::Serialize;

use crate::base64::base64;

/// A plane of numbers that the page paints and reads out: sixteen bits a pixel, 0 unknown.
#[derive(Debug, Serialize)]
pub(crate) struct Plane {
    width: usize,
    height: usize,
    unit: &'static str,
    alt: String,
    /// The value of code 1.
    offset: f64,
    /// From one code to the next.
    step: f64,
    data: String,
}

/// Label numbers, eight bits a pixel; higher ones than 255 are left out.
#[derive(Debug, Serialize)]
pub(crate) struct LabelPlane {
    width: usize,
    height: usize,
    data: String,
}

impl Plane {
    /// Every so many-th pixel of a plane, at most `most_width` of them in a row; NaN is unknown.
    pub(crate) fn of(
        plane: ArrayView2<'_, f32>,
        most_width: usize,
        unit: &'static str,
        alt: impl Into<String>,
    ) -> Self {
        let small = thinned(plane, most_width);
        let known = || small.iter().copied().filter(|value| value.is_finite());
        let least = known().fold(f32::INFINITY, f32::min);
        let most = known().fold(f32::NEG_INFINITY, f32::max);
        // A plane of one value, or of none, still has a step.
        let step = (f64::from(most - least) / 65_000.0).max(1e-6);
        let offset = if least.is_finite() {
            f64::from(least)
        } else {
            0.0
        };
        let code = |value: f32| {
            if value.is_finite() {
                ((f64::from(value) - offset) / step).round() as u16 + 1
            } else {
                0
            }
        };
        let bytes: Vec<u8> = small
            .iter()
            .flat_map(|&value| code(value).to_le_bytes())
            .collect();
        let (height, width) = small.dim();
        Self {
            width,
            height,
            unit,
            alt: alt.into(),
            offset,
            step: if step.is_finite() { step } else { 1e-6 },
            data: base64(&bytes),
        }
    }
}

impl LabelPlane {
    /// The labels of every so many-th pixel, as [`Plane::of`].
    pub(crate) fn of(labels: &LabelImage, most_width: usize) -> Self {
        let small = thinned(labels.plane(), most_width);
        let bytes: Vec<u8> = small
            .iter()
            .map(|&label| u8::try_from(label).unwrap_or(0))
            .collect();
        let (height, width) = small.dim();
        Self {
            width,
            height,
            data: base64(&bytes),
        }
    }
}

/// The pixel in the middle of each square of so many.
fn thinned<T: Copy>(plane: ArrayView2<'_, T>, most_width: usize) -> Array2<T> {
    let (height, width) = plane.dim();
    let step = width.div_ceil(most_width.max(1)).max(1);
    let middle = |at: usize, length: usize| (at * step + step / 2).min(length - 1);
    Array2::from_shape_fn((height.div_ceil(step), width.div_ceil(step)), |(y, x)| {
        plane[[middle(y, height), middle(x, width)]]
    })
}
