use dorsal::Error;
use dorsal::disparity_pyramid::{MatchParams, estimate};
use dorsal::v1_gabor::{FilterBank, GaborParams};
use pyo3::prelude::*;

use crate::eye::{Wanted, both_eyes};
use crate::field::Field;
use crate::refusal::{look_error, value_error};
use crate::threads::without_the_lock;

/// How every point moves between two moments of one eye.
#[pyfunction]
pub(crate) fn flow(
    py: Python<'_>,
    before: &Bound<'_, PyAny>,
    after: &Bound<'_, PyAny>,
    scales: usize,
) -> PyResult<Field> {
    // The earlier moment takes the left eye's place.
    let moments = both_eyes(before, after, Wanted::Luma)?;
    let size = moments.left.size();
    if !(1..=32).contains(&scales) {
        return Err(value_error(format!(
            "scales is {scales}; a whole number from 1 to 32 is needed"
        )));
    }
    let gabor = GaborParams {
        scales,
        ..GaborParams::default()
    };
    let bank = FilterBank::plan(gabor.fitted_to(size), size).map_err(value_error)?;
    let field = without_the_lock(py, || {
        let responses = moments.as_ref().try_map(|eye| bank.respond(eye.luma()))?;
        Ok::<_, Error>(estimate(&responses, MatchParams::for_flow())?)
    })?;
    Ok(Field {
        field: field.map_err(look_error)?,
    })
}
