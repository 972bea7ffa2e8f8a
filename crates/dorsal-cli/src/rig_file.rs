use std::path::Path;

use dorsal::egocentric_depth::StereoRig;
use stereo_formats::{middlebury_calib, rig_toml};

/// Reads a rig of our own, or a `calib.txt` of Middlebury.
pub(crate) fn read_rig(path: &Path) -> anyhow::Result<StereoRig> {
    let calib = path.extension().is_some_and(|extension| extension == "txt");
    Ok(if calib {
        middlebury_calib::read(path)?.rig
    } else {
        rig_toml::read(path)?
    })
}
