use std::path::{Path, PathBuf};

/// The folder of the documents; `None` if this program was built outside the repository.
pub(crate) fn docs_folder() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?;
    Some(root.join("docs"))
}
