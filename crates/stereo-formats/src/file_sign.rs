//! Where the sign of disparity turns: `dx` inside, `d = -dx` in files.

use disparity_pyramid::DisparityField;
use ndarray::{Array2, ArrayView2};

/// The file's disparity `d = x_left - x_right`, which is `-dx`: positive and larger when nearer on
/// a parallel rig. NaN, which is unknown, stays.
#[must_use]
pub fn d_of_dx(dx: ArrayView2<'_, f32>) -> Array2<f32> {
    dx.mapv(d_of_shift)
}

/// The same of one pixel.
#[must_use]
pub const fn d_of_shift(dx: f32) -> f32 {
    // Subtracted from zero, so that no shift is 0 and not -0.
    0.0 - dx
}

/// The library's `dx` of a file's disparity `d`. NaN, which is unknown, stays.
#[must_use]
pub fn dx_of_d(d: ArrayView2<'_, f32>) -> Array2<f32> {
    d_of_dx(d)
}

/// The file's disparity of a field: NaN where the field is not valid, or, if `dense`, the best
/// guess everywhere.
#[must_use]
pub fn d_of_field(field: &DisparityField, dense: bool) -> Array2<f32> {
    said(field, d_of_dx(field.dx()).view(), dense)
}

/// What a file says of one plane of a field: NaN where the field is not valid, or, if `dense`, the
/// best guess everywhere.
pub(crate) fn said(field: &DisparityField, plane: ArrayView2<'_, f32>, dense: bool) -> Array2<f32> {
    if dense {
        plane.to_owned()
    } else {
        field.only_valid(plane)
    }
}
