use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use dorsal::egocentric_depth::StereoRig;
use dorsal::v1_gabor::{Binocular, Size};
use stereo_formats::rig_toml::{self, SizedRig};
use stereo_formats::{kalibr, middlebury_calib, opencv_storage, ros_camera_info};

/// Reads a rig of any format that stands in one file or in a folder of ROS, lengths in metres.
pub(crate) fn read_rig(path: &Path) -> anyhow::Result<SizedRig> {
    read_rigs(&[path.to_owned()], 1.0)
}

/// The rig, if it is one of pictures of this size: its focal lengths and principal points count their pixels.
pub(crate) fn rig_of_pictures(sized: &SizedRig, size: Size) -> anyhow::Result<StereoRig> {
    match sized.size {
        Some(said) if said != size => bail!(
            "the rig is one of pictures of {said} pixels, and these have {size}: give pictures of its size, or \
             a rig whose focal lengths, principal points and size_px are scaled like them"
        ),
        _ => Ok(sized.rig),
    }
}

/// Reads a rig of any format, from one file or from the two that ROS and OpenCV's sample write, which for
/// ROS may be named by their folder. A unit of OpenCV's translation is `unit_m` long.
///
/// TOML is ours and TXT Middlebury's; YAML tells by its keys whose it is.
pub(crate) fn read_rigs(paths: &[PathBuf], unit_m: f64) -> anyhow::Result<SizedRig> {
    let [first, rest @ ..] = paths else {
        bail!("no file holds the rig");
    };
    if first.is_dir() {
        let [] = rest else {
            bail!(
                "{} is a folder, and no other file is read beside it",
                first.display()
            );
        };
        return ros_pair(&first.join("left.yaml"), &first.join("right.yaml"));
    }
    let extension = first.extension().and_then(|extension| extension.to_str());
    let extension = extension.unwrap_or_default().to_ascii_lowercase();
    let alone = |format: &str| match rest {
        [] => Ok(()),
        [other, ..] => Err(anyhow::anyhow!(
            "{} is a whole rig ({format}), and {} is one too many",
            first.display(),
            other.display()
        )),
    };
    match extension.as_str() {
        "txt" => {
            alone("Middlebury's calib.txt")?;
            let calib = middlebury_calib::read(first)?;
            Ok(SizedRig {
                rig: calib.rig,
                size: Some(calib.size),
            })
        }
        "xml" => Ok(opencv_storage::read(paths, unit_m)?),
        "yaml" | "yml" => match Kind::of(first) {
            Kind::Ros => {
                let [right] = rest else {
                    bail!(
                        "{} is one eye's camera_info; a rig needs both: dorsal rig convert LEFT.yaml \
                         RIGHT.yaml --out rig.toml, or a folder that holds left.yaml and right.yaml",
                        first.display()
                    );
                };
                ros_pair(first, right)
            }
            Kind::Kalibr => {
                alone("Kalibr's camchain")?;
                Ok(kalibr::read(first)?)
            }
            Kind::OpenCv => Ok(opencv_storage::read(paths, unit_m)?),
        },
        _ => {
            alone("rig.toml")?;
            Ok(rig_toml::read_sized(first)?)
        }
    }
}

/// The rig of the two files of a calibration in ROS.
fn ros_pair(left: &Path, right: &Path) -> anyhow::Result<SizedRig> {
    let pair = Binocular {
        left: ros_camera_info::read(left)?,
        right: ros_camera_info::read(right)?,
    };
    let rig = ros_camera_info::rig(&pair);
    rig.with_context(|| format!("{} and {}", left.display(), right.display()))
}

/// Whose YAML a file is.
enum Kind {
    Ros,
    Kalibr,
    OpenCv,
}

impl Kind {
    /// By the keys that stand at the beginning of a line; what is none of them OpenCV's reader refuses
    /// in its own words.
    fn of(path: &Path) -> Self {
        // A file that cannot be read is refused by its reader.
        let bytes = fs::read(path).unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes);
        let has = |key: &str| text.lines().any(|line| line.starts_with(key));
        if has("cam0:") {
            Self::Kalibr
        } else if has("camera_matrix:") && has("projection_matrix:") {
            Self::Ros
        } else {
            Self::OpenCv
        }
    }
}
