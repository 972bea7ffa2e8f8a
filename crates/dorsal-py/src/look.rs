use std::collections::BTreeMap;
use std::num::NonZeroU16;
use std::time::Instant;

use dorsal::allocentric_qsr::QualitativeScene;
use dorsal::egocentric_depth::{
    DepthMap, EgocentricScene, Label, LabelImage, LocateParams, SegmentParams, StereoRig, locate,
    segment,
};
use dorsal::v1_gabor::Binocular;
use dorsal::{Names, sightings};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::depth::Depth;
use crate::eye::both_eyes;
use crate::field::Field;
use crate::look_plan::LookOptions;
use crate::plane_view::plane_view;
use crate::refusal::{look_error, value_error};
use crate::rig::Rig;
use crate::scene_record::{ObjectRecord, QualitativeRecord, json, objects, unlocated};
use crate::threads::without_the_lock;

/// What one look gave, as far as it went.
#[pyclass(frozen, module = "dorsal._native")]
#[derive(Debug)]
pub(crate) struct Look {
    #[pyo3(get)]
    field: Py<Field>,
    #[pyo3(get)]
    depth: Option<Py<Depth>>,
    /// Seconds of the levels' work, from the planes of both eyes to the relations.
    #[pyo3(get)]
    seconds: f64,
    pub(crate) scene: Option<Scene>,
}

/// The objects of a look, with what a memory must know beside them.
#[derive(Debug)]
pub(crate) struct Scene {
    pub(crate) rig: StereoRig,
    pub(crate) labels: LabelImage,
    pub(crate) names: Names,
    pub(crate) egocentric: EgocentricScene,
    qualitative: QualitativeScene,
}

/// Looks once. The Python half says what the arguments mean; `labels` are `uint16`.
#[pyfunction]
pub(crate) fn look(
    py: Python<'_>,
    left: &Bound<'_, PyAny>,
    right: &Bound<'_, PyAny>,
    rig: Option<&Bound<'_, Rig>>,
    labels: Option<PyReadonlyArray2<'_, u16>>,
    names: BTreeMap<u16, String>,
    options: LookOptions,
) -> PyResult<Look> {
    let eyes = both_eyes(left, right, options.wanted())?;
    let size = eyes.left.size();
    let rig = rig.map(|rig| rig.get().of_pictures(size)).transpose()?;
    let labels = labels.map(|labels| LabelImage::new(labels.as_array().to_owned()));
    if let Some(labels) = &labels
        && labels.size() != size
    {
        return Err(value_error(format!(
            "labels has {} pixels and left has {size}; labels belong to the left picture, pixel by pixel",
            labels.size()
        )));
    }
    let names = named(names)?;
    let for_objects = labels.is_some() || options.segment;
    if rig.is_none() && for_objects {
        return Err(value_error(
            "labels and segment need a rig: objects have places in metres",
        ));
    }
    let plan = options.plan(size, rig.as_ref(), for_objects)?;
    let began = Instant::now();
    let (field, depth, scene) = without_the_lock(py, || {
        let field = plan.disparity(&eyes, rig.as_ref()).map_err(look_error)?;
        let Some(rig) = rig else {
            return PyResult::Ok((field, None, None));
        };
        let depth = plan.depth(&field, &rig).map_err(look_error)?;
        let labels = if plan.segment {
            let rgb = eyes.left.rgb();
            let found = segment(&depth, rgb.view(), &rig, &SegmentParams::default());
            Some(found.map_err(value_error)?.labels)
        } else {
            labels
        };
        let Some(labels) = labels else {
            return Ok((field, Some(depth), None));
        };
        let egocentric = locate(&depth, &labels, &rig, &LocateParams::default());
        let egocentric = egocentric.map_err(value_error)?;
        let qualitative = plan.qualify(sightings(&egocentric, &names))?;
        let scene = Scene {
            rig,
            labels,
            names,
            egocentric,
            qualitative,
        };
        Ok((field, Some(depth), Some(scene)))
    })??;
    let seconds = began.elapsed().as_secs_f64();
    let Binocular { left, right } = eyes;
    left.keep();
    right.keep();
    Ok(Look {
        field: Py::new(py, Field { field })?,
        depth: depth
            .map(|depth| Py::new(py, Depth { depth }))
            .transpose()?,
        seconds,
        scene,
    })
}

#[pymethods]
impl Look {
    /// The labels that objects were placed by, `uint16`, 0 where there is none.
    #[getter]
    fn labels<'py>(this: &Bound<'py, Self>) -> Option<Bound<'py, PyArray2<u16>>> {
        plane_view(this, |look| Some(look.scene.as_ref()?.labels.plane()))
    }

    /// Objects, places and relations, as JSON; `None` if no objects were asked for.
    fn scene_json(&self) -> PyResult<Option<String>> {
        let record = |scene: &Scene| {
            json(&SceneRecord {
                objects: objects(&scene.egocentric, &scene.rig, &scene.names),
                unlocated: unlocated(&scene.egocentric, &scene.names),
                qualitative: QualitativeRecord::of(&scene.qualitative),
            })
        };
        self.scene.as_ref().map(record).transpose()
    }
}

#[derive(serde::Serialize)]
struct SceneRecord {
    objects: Vec<ObjectRecord>,
    unlocated: Vec<crate::scene_record::UnlocatedRecord>,
    #[serde(flatten)]
    qualitative: QualitativeRecord,
}

impl Look {
    /// The depth map, if a rig gave one.
    pub(crate) fn depth_map(&self) -> Option<&DepthMap> {
        Some(&self.depth.as_ref()?.get().depth)
    }
}

/// The names of labels, each of one object.
pub(crate) fn named(names: BTreeMap<u16, String>) -> PyResult<Names> {
    let named = names.into_iter().map(|(label, name)| {
        let label = NonZeroU16::new(label);
        let label = label.ok_or_else(|| value_error("label 0 is no object and has no name"))?;
        Ok((Label(label), name))
    });
    named.collect()
}
