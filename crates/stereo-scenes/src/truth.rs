use egocentric_depth::{DepthMap, LabelImage};
use ndarray::Array2;
use rayon::prelude::*;
use v1_gabor::Binocular;

use crate::{
    exposure::{candidates, starts_segment},
    eye::Eye,
    gaze::Gaze,
    room::Room,
    stage::Stage,
    true_object::TrueObject,
    vector::Vector,
};

/// What is exactly so, for every pixel of the left image, on the ray through the pixel's centre.
///
/// At the outline of a body a pixel's colour mixes two surfaces, but its truth is of one.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Horizontal disparity `[[y, x]]` in pixels: left `(x, y)` matches right `(x + dx, y + dy)`.
    /// NaN where the point lies behind the right eye; known where the point is merely outside of
    /// the right image or hidden from the right eye.
    pub dx: Array2<f32>,
    /// Vertical disparity, as `dx`.
    pub dy: Array2<f32>,
    /// Depth along the forward axis of the head (tilted, not panned), in metres.
    pub depth: DepthMap,
    /// The object that each pixel shows; 0 for walls and scenery.
    pub labels: LabelImage,
    /// Whether the right eye sees the point too: between the centres of the outermost pixels of
    /// the right image, and with nothing in between.
    pub visible: Array2<bool>,
    /// Every object of the room, in the order of labels.
    pub objects: Vec<TrueObject>,
}

/// The truth of one pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    pub(crate) point: Vector,
    pub(crate) label: u16,
    pub(crate) visible: bool,
    shift: Option<(f64, f64)>,
}

impl Truth {
    pub(crate) fn of(room: &Room, stage: &Stage<'_>, gaze: &Gaze) -> Self {
        let (eyes, head) = (gaze.eyes(), gaze.head());
        let rows: Vec<Vec<Sight>> = (0..gaze.size().height)
            .into_par_iter()
            .map(|y| sights(stage, &eyes, y))
            .collect();
        let dim = gaze.size().dim();
        let plane = |value: &dyn Fn(&Sight) -> f64| {
            Array2::from_shape_fn(dim, |(y, x)| value(&rows[y][x]) as f32)
        };
        Self {
            dx: plane(&|sight| sight.shift.map_or(f64::NAN, |(dx, _)| dx)),
            dy: plane(&|sight| sight.shift.map_or(f64::NAN, |(_, dy)| dy)),
            depth: DepthMap::new(plane(&|sight| head.coordinates(sight.point).z)),
            labels: LabelImage::new(Array2::from_shape_fn(dim, |(y, x)| rows[y][x].label)),
            visible: Array2::from_shape_fn(dim, |(y, x)| rows[y][x].visible),
            objects: TrueObject::all(room, gaze, &rows),
        }
    }
}

fn sights(stage: &Stage<'_>, eyes: &Binocular<Eye>, y: usize) -> Vec<Sight> {
    let Binocular { left, right } = eyes;
    let everything = stage.everything();
    let mut among = Vec::new();
    (0..left.size.width)
        .map(|x| {
            if starts_segment(x) {
                among = candidates(stage, left, x, y);
            }
            let direction = left.ray(x as f64, y as f64);
            let hit = stage.first_hit(left.origin(), direction, &among);
            let point = left.origin() + direction * hit.t;
            let there = right.project(point);
            Sight {
                point,
                label: stage.label(hit.surface),
                visible: there.is_some_and(|there| right.shows(there))
                    && reaches(stage, right.origin(), point, &everything),
                shift: there.map(|(u, v)| (u - x as f64, v - y as f64)),
            }
        })
        .collect()
}

/// Whether nothing stands between an eye and a point of a surface.
fn reaches(stage: &Stage<'_>, eye: Vector, point: Vector, among: &[usize]) -> bool {
    // The ray meets the point's own surface at t = 1 up to rounding, which grows where the ray
    // grazes the surface: a thousandth of a millimetre at 1 m is above it and below any thing.
    const ARRIVED: f64 = 1.0 - 1e-6;
    stage.first_hit(eye, point - eye, among).t >= ARRIVED
}
