use std::path::{Path, PathBuf};

use egocentric_depth::StereoRig;
use stereo_formats::picture;
use stereo_scenes::{Gaze, Room};
use v1_gabor::{Binocular, LumaImage, Size};

use crate::eval_middlebury::write_file;

/// Distance of the parallel eyes at a width of 1024 pixels, in metres: the room's things then lie
/// within the shifts that are searched. At other widths the eyes move, and the shifts stay.
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

/// Both pictures as files that OpenCV reads, named after the pair.
pub(super) fn write_pair(
    images: &Binocular<LumaImage>,
    folder: &Path,
    pair: &str,
) -> anyhow::Result<Binocular<PathBuf>> {
    let paths = paths(folder, pair);
    let write = |image: &LumaImage, path: &Path| {
        let Size { width, height } = image.size();
        let grey = image.plane().mapv(|luma| (255.0 * luma).round() as u8);
        let mut bytes = format!("P5\n{width} {height}\n255\n").into_bytes();
        bytes.extend(grey.iter());
        write_file(path, &bytes)
    };
    write(&images.left, &paths.left)?;
    write(&images.right, &paths.right)?;
    Ok(paths)
}

/// The pair that was written under this name.
pub(super) fn read_pair(folder: &Path, pair: &str) -> anyhow::Result<Binocular<LumaImage>> {
    let paths = paths(folder, pair);
    Ok(picture::read_luma_pair(
        paths.as_ref().map(PathBuf::as_path),
    )?)
}

fn paths(folder: &Path, pair: &str) -> Binocular<PathBuf> {
    Binocular {
        left: folder.join(format!("{pair}-left.pgm")),
        right: folder.join(format!("{pair}-right.pgm")),
    }
}
