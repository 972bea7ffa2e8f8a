use std::path::PathBuf;

/// The variable that names the folder of evaluation data.
pub(crate) const VARIABLE: &str = "DORSAL_DATA";

/// The folder that the variable names; `None` if it is not set, or empty.
pub(crate) fn of_environment() -> Option<PathBuf> {
    std::env::var_os(VARIABLE)
        .filter(|folder| !folder.is_empty())
        .map(PathBuf::from)
}

/// The data that tests compare with: the folder that the variable names, or `shared/data` beside
/// the checkout; `None` if there is no such folder.
#[cfg(test)]
pub(crate) fn beside_the_checkout() -> Option<PathBuf> {
    let folder = of_environment()
        .unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"));
    folder.is_dir().then_some(folder)
}
