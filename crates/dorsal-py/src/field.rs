use dorsal::disparity_pyramid::{DisparityField, ShiftCovariance, Validity};
use ndarray::{Array2, Zip};
use numpy::{IntoPyArray as _, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use stereo_formats::{file_sign, validity_png};

use crate::plane_view::plane_view;
use crate::refusal::value_error;

/// A disparity field, as level 2 made it.
#[pyclass(frozen, module = "dorsal._native")]
#[derive(Debug)]
pub(crate) struct Field {
    pub(crate) field: DisparityField,
}

#[pymethods]
impl Field {
    /// A field of planes that came from elsewhere, with `dx` right minus left; NaN is unknown.
    #[staticmethod]
    fn of_planes(
        dx: PyReadonlyArray2<'_, f32>,
        dy: PyReadonlyArray2<'_, f32>,
        confidence: PyReadonlyArray2<'_, f32>,
    ) -> PyResult<Self> {
        let (dx, dy) = (dx.as_array(), dy.as_array());
        if dx.dim() != dy.dim() {
            return Err(value_error("dx and dy differ in shape"));
        }
        let validity = Zip::from(dx).and(dy).map_collect(|dx, dy| {
            if dx.is_nan() || dy.is_nan() {
                Validity::NoEnergy
            } else {
                Validity::Valid
            }
        });
        let known = |shift: f32| if shift.is_nan() { 0.0 } else { shift };
        let field = DisparityField::new(
            dx.mapv(known),
            dy.mapv(known),
            confidence.as_array().to_owned(),
            validity,
        );
        let field = field.map_err(value_error)?;
        Ok(Self { field })
    }

    #[getter]
    fn shape(&self) -> (usize, usize) {
        self.field.size().dim()
    }

    #[getter]
    fn density(&self) -> f64 {
        self.field.density()
    }

    #[getter]
    fn d<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f32>> {
        let (dx, validity) = (self.field.dx(), self.field.validity());
        let d = Zip::from(dx).and(validity).map_collect(|&dx, validity| {
            if validity.is_valid() {
                file_sign::d_of_shift(dx)
            } else {
                f32::NAN
            }
        });
        d.into_pyarray(py)
    }

    #[getter]
    fn dx<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f32>> {
        self.field.only_valid(self.field.dx()).into_pyarray(py)
    }

    #[getter]
    fn dy<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f32>> {
        self.field.only_valid(self.field.dy()).into_pyarray(py)
    }

    #[getter]
    fn guess_dx<'py>(this: &Bound<'py, Self>) -> Option<Bound<'py, PyArray2<f32>>> {
        plane_view(this, |field| Some(field.field.dx()))
    }

    #[getter]
    fn guess_dy<'py>(this: &Bound<'py, Self>) -> Option<Bound<'py, PyArray2<f32>>> {
        plane_view(this, |field| Some(field.field.dy()))
    }

    #[getter]
    fn confidence<'py>(this: &Bound<'py, Self>) -> Option<Bound<'py, PyArray2<f32>>> {
        plane_view(this, |field| Some(field.field.confidence()))
    }

    #[getter]
    fn validity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<u8>> {
        let grey: Array2<u8> = self.field.validity().mapv(validity_png::grey);
        grey.into_pyarray(py)
    }

    #[getter]
    fn sigma_dx<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f32>>> {
        self.sigma(py, ShiftCovariance::sigma_dx)
    }

    #[getter]
    fn sigma_dy<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f32>>> {
        self.sigma(py, ShiftCovariance::sigma_dy)
    }
}

impl Field {
    /// A standard deviation of every answer, if the estimator fits.
    fn sigma<'py>(
        &self,
        py: Python<'py>,
        of: fn(ShiftCovariance) -> f32,
    ) -> Option<Bound<'py, PyArray2<f32>>> {
        Some(self.field.covariance()?.mapv(of).into_pyarray(py))
    }
}
