use std::path::{Path, PathBuf};

use egocentric_depth::StereoRig;
use stereo_scenes::{Gaze, Room};
use v1_gabor::{Binocular, LumaImage, Size};

use crate::eval_middlebury::write_file;

/// Distance of the parallel eyes at a width of 1024 pixels, in metres: the room's things then lie
/// within the [`SHIFTS`] that are searched. At other widths the eyes move, and the shifts stay.
const PARALLEL_BASELINE_M: f64 = 0.065;

/// Parallel eyes at the head's place, tilted toward what it fixates.
pub(super) fn parallel_gaze(room: &Room, size: Size) -> anyhow::Result<Gaze> {
    let head = room.head().resized(size);
    let ([_, y, z], [_, to_y, to_z]) = (head.position_m, room.fixation_m());
    let eyes = Binocular {
        left: head.intrinsics(),
        right: head.intrinsics(),
    };
    let baseline_m = PARALLEL_BASELINE_M * 1024.0 / size.width as f64;
    let rig = StereoRig::parallel(eyes, baseline_m)?.tilted((to_z - z).atan2(to_y - y))?;
    Ok(Gaze::new(head.position_m, head.heading_rad, size, rig)?)
}

/// Both pictures as files that OpenCV reads.
pub(super) fn write_pair(
    images: &Binocular<LumaImage>,
    folder: &Path,
) -> anyhow::Result<Binocular<PathBuf>> {
    let write = |image: &LumaImage, name: &str| -> anyhow::Result<PathBuf> {
        let Size { width, height } = image.size();
        let grey = image.plane().mapv(|luma| (255.0 * luma).round() as u8);
        let path = folder.join(name);
        let mut bytes = format!("P5\n{width} {height}\n255\n").into_bytes();
        bytes.extend(grey.iter());
        write_file(&path, &bytes)?;
        Ok(path)
    };
    Ok(Binocular {
        left: write(&images.left, "left.pgm")?,
        right: write(&images.right, "right.pgm")?,
    })
}
