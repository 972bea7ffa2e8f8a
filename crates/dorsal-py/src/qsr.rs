use dorsal::allocentric_qsr::{
    Case, CompositionTable, DepthReference, DepthSet, Mode, QualifyParams, QualitativeScene,
    SeenLine, Sighting,
};
use pyo3::prelude::*;

use crate::refusal::value_error;
use crate::scene_record::{QualitativeRecord, json};

/// The reference system of this name, or of this TOML.
pub(crate) fn reference_system(name: &str) -> PyResult<DepthReference> {
    if name.contains('\n') {
        return DepthReference::from_toml(name).map_err(value_error);
    }
    DepthReference::preset(name).ok_or_else(|| {
        value_error(format!(
            "no reference system is called '{name}'; there are drs1, drs2, robot-150 and robot-120, or the text of \
             a TOML of your own"
        ))
    })
}

/// The classes of a reference system, as JSON.
#[pyfunction]
pub(crate) fn system(name: &str) -> PyResult<String> {
    json(&reference_system(name)?)
}

/// Sightings (JSON lines of a look's `seen`) in symbols, as JSON.
#[pyfunction]
pub(crate) fn qualify(sightings: &str, system: &str) -> PyResult<String> {
    let seen: Vec<SeenLine> = serde_json::from_str(sightings).map_err(value_error)?;
    let sightings = seen.into_iter().map(|seen| Sighting {
        object: seen.object,
        distance_m: seen.distance_m,
        bearing_rad: seen.bearing_rad,
        sigma_distance_m: seen.sigma_distance_m,
        sigma_bearing_rad: seen.sigma_bearing_rad,
    });
    let reference = reference_system(system)?;
    let scene = QualitativeScene::qualify_with(sightings, &reference, QualifyParams::default());
    json(&QualitativeRecord::of(&scene.map_err(value_error)?))
}

/// What two distances say about a third: labels, nearest first.
#[pyfunction]
pub(crate) fn compose(
    first: Vec<String>,
    second: Vec<String>,
    case: u8,
    system: &str,
    mode: &str,
) -> PyResult<Vec<String>> {
    let reference = reference_system(system)?;
    let set = |labels: Vec<String>| -> PyResult<DepthSet> {
        let classes = labels.iter().map(|label| {
            reference.class_named(label).ok_or_else(|| {
                let name = reference.name();
                value_error(format!("`{label}` is no distance class of `{name}`"))
            })
        });
        classes.collect()
    };
    let (first, second) = (set(first)?, set(second)?);
    let (case, mode) = (case_numbered(case)?, mode_named(mode)?);
    let composed = dorsal::allocentric_qsr::compose(&reference, case, mode, first, second);
    let labels = reference.labels(composed.depth).into_iter();
    Ok(labels.map(str::to_owned).collect())
}

/// A composition table, as JSON.
#[pyfunction]
pub(crate) fn composition_table(case: u8, system: &str, mode: &str) -> PyResult<String> {
    let reference = reference_system(system)?;
    json(&CompositionTable::new(
        &reference,
        case_numbered(case)?,
        mode_named(mode)?,
    ))
}

fn case_numbered(case: u8) -> PyResult<Case> {
    Case::numbered(case)
        .ok_or_else(|| value_error(format!("there is no CASE {case}; there are 1 to 4")))
}

fn mode_named(mode: &str) -> PyResult<Mode> {
    match mode {
        "sound" => Ok(Mode::Sound),
        "published" => Ok(Mode::Published),
        other => Err(value_error(format!(
            "mode is '{other}'; it is 'sound' or 'published'"
        ))),
    }
}
