use std::collections::BTreeMap;

use dorsal::v1_gabor::Size;
use ndarray::Array3;
use numpy::{IntoPyArray as _, PyArray2, PyArray3};
use pyo3::prelude::*;
use stereo_scenes::{Exposure, Room as Scene, render};

use crate::refusal::value_error;
use crate::rig::Rig;
use crate::threads::without_the_lock;

/// A room to be rendered, with the head in it.
#[pyclass(frozen, module = "dorsal._native")]
#[derive(Debug)]
pub(crate) struct Room {
    scene: Scene,
}

/// Both pictures, the rig, and the label of every pixel of the left one.
type Rendered<'py> = (
    Bound<'py, PyArray3<u8>>,
    Bound<'py, PyArray3<u8>>,
    Rig,
    Bound<'py, PyArray2<u16>>,
);

#[pymethods]
impl Room {
    /// A room by its name, or of the text of a TOML.
    #[new]
    fn new(room: &str) -> PyResult<Self> {
        let scene = match room {
            "table" => Scene::demo(),
            "shelf" => Scene::shelf(),
            "scan" => Scene::scan(),
            text if text.contains('=') => Scene::from_toml(text).map_err(value_error)?,
            other => {
                return Err(value_error(format!(
                    "'{other}' is no room; it is 'table', 'shelf', 'scan' or the text of a TOML"
                )));
            }
        };
        Ok(Self { scene })
    }

    #[getter]
    fn names(&self) -> BTreeMap<u16, String> {
        let names = self.scene.names();
        names
            .map(|(label, name)| (label.0.get(), name.to_owned()))
            .collect()
    }

    #[getter]
    fn fixation_m(&self) -> [f64; 3] {
        self.scene.fixation_m()
    }

    /// What the head sees that fixates a point, with this many pixels if they are said.
    fn render<'py>(
        &self,
        py: Python<'py>,
        fixation_m: [f64; 3],
        size: Option<(usize, usize)>,
        noise_sigma: f32,
        noise_seed: u32,
    ) -> PyResult<Rendered<'py>> {
        let mut head = self.scene.head();
        if let Some((width, height)) = size {
            head = head.resized(Size { width, height });
        }
        let gaze = head.fixate(fixation_m).map_err(value_error)?;
        let exposure = Exposure {
            noise_sigma,
            noise_seed,
            ..Exposure::default()
        };
        let view = without_the_lock(py, || render(&self.scene, &gaze, exposure))?;
        let view = view.map_err(value_error)?;
        let codes = |colour: &Array3<f32>| colour.mapv(|sample| (sample * 255.0).round() as u8);
        Ok((
            codes(&view.colour.left).into_pyarray(py),
            codes(&view.colour.right).into_pyarray(py),
            Rig::unsized_(gaze.rig()),
            view.truth.labels.plane().to_owned().into_pyarray(py),
        ))
    }
}
