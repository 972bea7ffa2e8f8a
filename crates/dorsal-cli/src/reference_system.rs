use std::path::Path;

use anyhow::{Context as _, bail};
use dorsal::allocentric_qsr::DepthReference;

/// The reference system of `--system`: a preset by its name, or a TOML file.
pub(crate) fn reference_system(system: &str) -> anyhow::Result<DepthReference> {
    if let Some(preset) = DepthReference::preset(system) {
        return Ok(preset);
    }
    let path = Path::new(system);
    let presets = DepthReference::PRESETS.join(", ");
    if !path.exists() {
        bail!(
            "--system {system} is neither a preset ({presets}) nor a file; \
             check the spelling or the path"
        );
    }
    let text = std::fs::read_to_string(path)
        .with_context(|| format!("{system} cannot be read as a reference system"))?;
    DepthReference::from_toml(&text).with_context(|| {
        format!("{system} is no reference system; it needs a name and an array of classes")
    })
}
