use std::collections::BTreeMap;
use std::path::PathBuf;

use ndarray::Array3;
use numpy::{IntoPyArray as _, PyArray2, PyArray3};
use pyo3::prelude::*;
use stereo_formats::picture::{self, Picture};
use stereo_formats::{label_png, label_polygons};

use crate::refusal::{file_error, value_error};

/// A picture file as `uint8` `(height, width, 3)`: PNG, PNM, JPEG or TIFF.
#[pyfunction]
pub(crate) fn read_picture(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyArray3<u8>>> {
    let picture = py.detach(|| picture::read(path)).map_err(file_error)?;
    rgb_array(py, &picture)
}

/// The colours of a picture as `(height, width, 3)`.
pub(crate) fn rgb_array<'py>(
    py: Python<'py>,
    picture: &Picture,
) -> PyResult<Bound<'py, PyArray3<u8>>> {
    let rgb = picture.rgb();
    let (height, width) = rgb.dim();
    let codes: Vec<u8> = rgb.iter().flatten().copied().collect();
    let rgb = Array3::from_shape_vec((height, width, 3), codes).map_err(value_error)?;
    Ok(rgb.into_pyarray(py))
}

/// A label image and what its labels are called.
type NamedLabels<'py> = (Bound<'py, PyArray2<u16>>, BTreeMap<u16, String>);

/// Labels `uint16` and their names, of a TOML of outlines or a PNG whose samples are labels.
#[pyfunction]
pub(crate) fn read_labels(py: Python<'_>, path: PathBuf) -> PyResult<NamedLabels<'_>> {
    let outlines = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    let (labels, names) = if outlines {
        let polygons = label_polygons::read(&path).map_err(file_error)?;
        (polygons.fill().map_err(value_error)?, polygons.names())
    } else {
        (label_png::read(&path).map_err(file_error)?, BTreeMap::new())
    };
    let names = names.into_iter().map(|(label, name)| (label.0.get(), name));
    Ok((labels.plane().to_owned().into_pyarray(py), names.collect()))
}
