use crate::{DepthMap, Observer, Position, StereoRig};

/// A pixel of the left image and where in the world it lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudPoint {
    /// Column and row of the pixel.
    pub pixel: (usize, usize),
    /// Its position in the level observer frame.
    pub position: Position<Observer>,
}

/// The position of every pixel whose depth is known, row by row.
///
/// `rig` is the one the map was triangulated with.
pub fn point_cloud<'a>(
    depth: &'a DepthMap,
    rig: &'a StereoRig,
) -> impl Iterator<Item = CloudPoint> + 'a {
    let left = rig.eyes().left;
    let level = rig.head_to_observer();
    let metres = depth.metres();
    metres
        .into_iter()
        .enumerate()
        .filter(|(_, depth_m)| depth_m.is_finite())
        .filter_map(move |(index, &depth_m)| {
            let width = depth.size().width;
            let pixel = (index % width, index / width);
            let [x, y, z] = left.ray((pixel.0 as f64, pixel.1 as f64))?.direction;
            let stretch = f64::from(depth_m) / z;
            let in_head = [
                left.centre.x_m + stretch * x,
                stretch * y,
                f64::from(depth_m),
            ];
            (z > 0.0).then(|| CloudPoint {
                pixel,
                position: Position::from_array(level.apply(in_head)),
            })
        })
}
