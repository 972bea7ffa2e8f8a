//! OpenCV's matchers on the same pairs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, ensure};
use ndarray::Array2;
use serde::{Deserialize, Serialize};
use v1_gabor::Size;

use crate::python_environment::run;

/// A pair as the script is told of it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Pair {
    pub(crate) name: String,
    pub(crate) left: PathBuf,
    pub(crate) right: PathBuf,
    /// The least disparity that is searched.
    pub(crate) least: i32,
    /// How many from there on, a multiple of 16.
    pub(crate) shifts: usize,
}

/// What the script says of its runs.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Runs {
    pub(crate) versions: BTreeMap<String, String>,
    pub(crate) runs: Vec<Run>,
}

/// One matcher with one setting on every pair.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Run {
    index: usize,
    /// `SGBM`, `HH`, `3WAY` or `BM`.
    pub(crate) matcher: String,
    pub(crate) setting: String,
    /// CPU seconds of the matcher alone, by pair.
    pub(crate) seconds: BTreeMap<String, f64>,
}

/// The setting of SGBM that `compare-opencv` finds best over all scenes, as the script names it.
pub(crate) const TUNED_SGBM: (&str, &str) = ("SGBM", "block 3, P x 1, cap 63");

/// Runs every matcher with every setting, or `only` this matcher with this setting, on every pair;
/// the results stay in `folder`.
pub(crate) fn match_pairs(
    python: &Path,
    folder: &Path,
    pairs: &[Pair],
    only: Option<(&str, &str)>,
) -> anyhow::Result<Runs> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("python/opencv_matchers.py");
    let listed = folder.join("pairs.json");
    std::fs::write(&listed, serde_json::to_vec(pairs)?)
        .with_context(|| format!("{} cannot be written", listed.display()))?;
    let mut command = Command::new(python);
    command.arg(&script).arg(folder);
    if let Some((matcher, setting)) = only {
        command.args([matcher, setting]);
    }
    run(&mut command)?;
    let told = folder.join("matchers.json");
    let told = std::fs::read(&told).with_context(|| format!("{}", told.display()))?;
    Ok(serde_json::from_slice(&told)?)
}

/// One run's disparity `d` of a pair, holes filled, and where the matcher itself gave a value.
pub(crate) fn read(
    folder: &Path,
    run: &Run,
    pair: &str,
    size: Size,
) -> anyhow::Result<(Array2<f32>, Array2<bool>)> {
    let stem = folder.join(format!("{}-{pair}", run.index));
    let bytes = |extension| {
        let path = stem.with_extension(extension);
        std::fs::read(&path).with_context(|| format!("{}", path.display()))
    };
    let (d, valid) = (bytes("f32")?, bytes("u8")?);
    let (numbers, rest) = d.as_chunks::<4>();
    ensure!(rest.is_empty(), "{} is cut off", stem.display());
    let d = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes));
    let d = Array2::from_shape_vec(size.dim(), d.collect())?;
    let valid = valid.into_iter().map(|valid| valid != 0);
    Ok((d, Array2::from_shape_vec(size.dim(), valid.collect())?))
}
