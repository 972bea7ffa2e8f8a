use dorsal::v1_gabor::{FilterBank, GaborParams, Responses};
use ndarray::Array3;
use numpy::{Complex32, IntoPyArray as _, PyArray3};
use pyo3::prelude::*;

use crate::eye::{Eye, Wanted};
use crate::refusal::value_error;
use crate::threads::without_the_lock;

/// The complex responses `[orientation, y, x]` of each scale, finest first.
#[pyfunction]
pub(crate) fn respond<'py>(
    py: Python<'py>,
    image: &Bound<'py, PyAny>,
    scales: usize,
    orientations: usize,
    peak_frequency: f32,
    bandwidth: f32,
) -> PyResult<Vec<Bound<'py, PyArray3<Complex32>>>> {
    let eye = Eye::of("image", image, Wanted::Luma)?;
    let params = GaborParams {
        orientations,
        scales,
        peak_frequency,
        bandwidth,
        ..GaborParams::default()
    };
    let size = eye.size();
    let bank = FilterBank::plan(params.fitted_to(size), size).map_err(value_error)?;
    let responses = without_the_lock(py, || {
        let responses = bank.respond(eye.luma()).map_err(value_error)?;
        PyResult::Ok(responses.scales().iter().map(planes).collect::<Vec<_>>())
    })??;
    Ok(responses
        .into_iter()
        .map(|planes| planes.into_pyarray(py))
        .collect())
}

/// All orientations of a scale as planes; the level keeps the orientations of a pixel side by side.
fn planes(responses: &Responses) -> Array3<Complex32> {
    let size = responses.size();
    let shape = (responses.orientations(), size.height, size.width);
    Array3::from_shape_fn(shape, |(orientation, y, x)| responses.at(orientation, x, y))
}
