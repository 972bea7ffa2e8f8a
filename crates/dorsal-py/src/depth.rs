use std::collections::BTreeMap;

use dorsal::Estimator;
use dorsal::egocentric_depth::{
    DepthMap, DisparitySigma, LabelImage, LocateParams, SegmentParams, normals, point_cloud,
};
use ndarray::{Array2, Array3};
use numpy::{IntoPyArray as _, PyArray2, PyArray3, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::eye::{Eye, Wanted};
use crate::field::Field;
use crate::look::named;
use crate::plane_view::plane_view;
use crate::refusal::value_error;
use crate::rig::Rig;
use crate::scene_record::{ObjectRecord, UnlocatedRecord, json, objects, unlocated};
use crate::threads::without_the_lock;

/// A depth map, as level 3 made it.
#[pyclass(frozen, module = "dorsal._native")]
#[derive(Debug)]
pub(crate) struct Depth {
    pub(crate) depth: DepthMap,
}

#[pymethods]
impl Depth {
    /// A map of metres that came from elsewhere; NaN, infinite and what is not positive is unknown.
    #[staticmethod]
    fn of_metres(metres: PyReadonlyArray2<'_, f32>) -> Self {
        Self {
            depth: DepthMap::new(metres.as_array().to_owned()),
        }
    }

    #[getter]
    fn shape(&self) -> (usize, usize) {
        self.depth.size().dim()
    }

    #[getter]
    fn density(&self) -> f64 {
        self.depth.density()
    }

    #[getter]
    fn metres<'py>(this: &Bound<'py, Self>) -> Option<Bound<'py, PyArray2<f32>>> {
        plane_view(this, |depth| Some(depth.depth.metres()))
    }

    #[getter]
    fn sigma_px<'py>(this: &Bound<'py, Self>) -> Option<Bound<'py, PyArray2<f32>>> {
        plane_view(this, |depth| depth.depth.disparity_sigma_px())
    }

    fn points<'py>(
        &self,
        py: Python<'py>,
        rig: &Bound<'py, Rig>,
    ) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let rig = rig.get().of_pictures(self.depth.size())?;
        let points = without_the_lock(py, || {
            let (height, width) = self.depth.size().dim();
            let mut points = Array3::from_elem((height, width, 3), f32::NAN);
            for point in point_cloud(&self.depth, &rig) {
                let (x, y) = point.pixel;
                for (axis, metres) in point.position.to_array().into_iter().enumerate() {
                    points[[y, x, axis]] = metres as f32;
                }
            }
            points
        })?;
        Ok(points.into_pyarray(py))
    }

    fn normals<'py>(
        &self,
        py: Python<'py>,
        rig: &Bound<'py, Rig>,
    ) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let rig = rig.get().of_pictures(self.depth.size())?;
        let facing = without_the_lock(py, || {
            let facing = normals(&self.depth, &rig);
            let (height, width) = facing.dim();
            Array3::from_shape_fn((height, width, 3), |(y, x, axis)| facing[[y, x]][axis])
        })?;
        Ok(facing.into_pyarray(py))
    }
}

/// Level 3 alone: the depth of every pixel of a field.
#[pyfunction]
pub(crate) fn triangulate(
    py: Python<'_>,
    field: &Bound<'_, Field>,
    rig: &Bound<'_, Rig>,
) -> PyResult<Depth> {
    let field = &field.get().field;
    let rig = rig.get().of_pictures(field.size())?;
    let depth = without_the_lock(py, || {
        let depth = dorsal::egocentric_depth::triangulate(field, &rig);
        // A field that says how sure it fits is the vector pyramid's, whose errors are measured.
        match field.covariance() {
            Some(_) => depth.with_disparity_sigma(sigma().of(field)),
            None => Ok(depth),
        }
    })?;
    Ok(Depth {
        depth: depth.map_err(value_error)?,
    })
}

/// What the vector pyramid's disparities are worth.
fn sigma() -> DisparitySigma {
    Estimator::default().disparity_sigma()
}

/// Where labelled objects are, as JSON.
#[pyfunction]
pub(crate) fn locate(
    py: Python<'_>,
    depth: &Bound<'_, Depth>,
    labels: PyReadonlyArray2<'_, u16>,
    rig: &Bound<'_, Rig>,
    names: BTreeMap<u16, String>,
) -> PyResult<String> {
    let depth = &depth.get().depth;
    let labels = LabelImage::new(labels.as_array().to_owned());
    let rig = rig.get().of_pictures(depth.size())?;
    let names = named(names)?;
    let scene = without_the_lock(py, || {
        dorsal::egocentric_depth::locate(depth, &labels, &rig, &LocateParams::default())
    })?;
    let scene = scene.map_err(value_error)?;
    json(&Located {
        objects: objects(&scene, &rig, &names),
        unlocated: unlocated(&scene, &names),
    })
}

#[derive(serde::Serialize)]
struct Located {
    objects: Vec<ObjectRecord>,
    unlocated: Vec<UnlocatedRecord>,
}

/// The objects that stand on a plane: labels `uint16`, 1, 2, ... from left to right.
#[pyfunction]
pub(crate) fn segment<'py>(
    py: Python<'py>,
    depth: &Bound<'py, Depth>,
    image: &Bound<'py, PyAny>,
    rig: &Bound<'py, Rig>,
) -> PyResult<Bound<'py, PyArray2<u16>>> {
    let depth = &depth.get().depth;
    let eye = Eye::of("image", image, Wanted::Colours)?;
    let rig = rig.get().of_pictures(depth.size())?;
    let found = without_the_lock(py, || {
        let rgb = eye.rgb();
        dorsal::egocentric_depth::segment(depth, rgb.view(), &rig, &SegmentParams::default())
    })?;
    let labels: Array2<u16> = found.map_err(value_error)?.labels.plane().to_owned();
    Ok(labels.into_pyarray(py))
}
