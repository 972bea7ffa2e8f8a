use std::path::{Path, PathBuf};

use anyhow::Context;

/// The variable that names the folder of evaluation data.
pub(crate) const VARIABLE: &str = "DORSAL_DATA";

/// The folder that the variable names; `None` if it is not set, or empty.
pub(crate) fn of_environment() -> Option<PathBuf> {
    std::env::var_os(VARIABLE)
        .filter(|folder| !folder.is_empty())
        .map(PathBuf::from)
}

/// The folder that the command line names, or else the variable.
pub(crate) fn required(named: Option<&Path>) -> anyhow::Result<PathBuf> {
    named
        .map(Path::to_owned)
        .or_else(of_environment)
        .with_context(|| {
            format!(
                "no data folder: name it with --data DIR or the variable {VARIABLE}.\n\
                 It holds stereo scenes as stereo/SET/SCENE and flow scenes as flow/SCENE, each \
                 with its scene.toml. Middlebury's can be downloaded from \
                 https://vision.middlebury.edu/"
            )
        })
}

/// The data that tests compare with: the folder that the variable names, or `shared/data` beside
/// the checkout; `None` if there is no such folder.
#[cfg(test)]
pub(crate) fn beside_the_checkout() -> Option<PathBuf> {
    let folder = of_environment()
        .unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"));
    folder.is_dir().then_some(folder)
}
