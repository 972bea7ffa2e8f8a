use anyhow::Context;
use serde::Serialize;
use v1_gabor::Size;

use super::callgrind::{self, Instructions};
use super::contestants::{DENSE_FAST, LOOK, NO_LOOK_BACK, ONE_WARP, RESPONSES, UNFUSED, VECTOR};
use super::scene::Scene;

/// Instructions of one frame, as callgrind counts them: the same number again and again, whatever else
/// the machine does.
#[derive(Debug, Serialize)]
pub(crate) struct Count {
    pub(crate) name: &'static str,
    pub(crate) instructions_a_pixel: f64,
    /// What it may be at the most.
    pub(crate) mark: Option<f64>,
    /// By function, of all pixels.
    #[serde(skip)]
    pub(super) instructions: Instructions,
}

/// Whose are counted.
pub(super) const COUNTED: [&str; 7] = [
    RESPONSES,
    NO_LOOK_BACK,
    VECTOR,
    ONE_WARP,
    UNFUSED,
    DENSE_FAST,
    LOOK,
];

/// The most for the vector pyramid, as its CPU time is compared: without the look back.
const MARK: (&str, f64) = (NO_LOOK_BACK, 450.0);

/// At which size: instructions a pixel hardly depend on it, and counting takes fifty times as long as
/// running.
pub(crate) const SIZE: Size = Size {
    width: 384,
    height: 288,
};

/// The counts of these; in their place the reason where there is no valgrind.
pub(super) fn counts(names: &[&'static str]) -> anyhow::Result<Result<Vec<Count>, String>> {
    if !callgrind::is_there() {
        return Ok(Err("valgrind is not there".to_owned()));
    }
    let folder = tempfile::tempdir().context("there is no room for the scene")?;
    Scene::render(SIZE)?.write(folder.path())?;
    let count = |name: &'static str| {
        let instructions = callgrind::of_a_frame(name, folder.path())?;
        let total: u64 = instructions.own.values().sum();
        Ok(Count {
            name,
            instructions_a_pixel: total as f64 / SIZE.area() as f64,
            mark: (MARK.0 == name).then_some(MARK.1),
            instructions,
        })
    };
    let counts: anyhow::Result<Vec<Count>> = names.iter().copied().map(count).collect();
    Ok(Ok(counts?))
}
