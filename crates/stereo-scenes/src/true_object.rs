use egocentric_depth::Label;

use crate::{gaze::Gaze, room::Room, solid::Solid, truth::Sight};

/// Where an object really is, and what the left eye sees of it.
///
/// Positions are in the observer frame: origin midway between the eyes, x right, y down, z forward
/// over the ground, whatever the tilt of the head; metres.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueObject {
    /// Its number in the label image.
    pub label: Label,
    /// Its name in the room's file.
    pub name: String,
    /// The centre of the body, which no eye sees.
    pub centre_m: [f64; 3],
    /// How many pixels of the left image show it.
    pub pixels: usize,
    /// How many of these the right eye sees too.
    pub binocular_pixels: usize,
    /// The part of its surface that both eyes see, if there is any.
    pub surface: Option<TrueSurface>,
}

/// What a perfect observer reports of an object: medians over the pixels of the left image that
/// show it and whose point the right eye sees too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrueSurface {
    /// Median depth along the forward axis of the head, in metres.
    pub depth_m: f64,
    /// Median of each coordinate of the surface's points, in the observer frame, in metres.
    pub point_m: [f64; 3],
}

impl TrueObject {
    /// Every object of a room, in the order of labels.
    pub(crate) fn all(room: &Room, gaze: &Gaze, rows: &[Vec<Sight>]) -> Vec<Self> {
        let mut seen = vec![(0, Vec::new()); room.objects().len() + 1];
        for sight in rows.iter().flatten() {
            let (pixels, points) = &mut seen[usize::from(sight.label)];
            *pixels += 1;
            if sight.visible && sight.label != 0 {
                points.push(sight.point);
            }
        }
        let head = gaze.head();
        let described = room
            .names()
            .zip(room.objects())
            .zip(seen.into_iter().skip(1));
        described
            .map(|(((label, name), thing), (pixels, points))| {
                let depths = points.iter().map(|&point| head.coordinates(point).z);
                let observed: Vec<[f64; 3]> = points
                    .iter()
                    .map(|point| gaze.observe(point.to_array()))
                    .collect();
                let coordinate = |k: usize| median(observed.iter().map(|point| point[k]).collect());
                let surface = (!points.is_empty()).then(|| TrueSurface {
                    depth_m: median(depths.collect()),
                    point_m: [coordinate(0), coordinate(1), coordinate(2)],
                });
                Self {
                    label,
                    name: name.to_owned(),
                    centre_m: gaze.observe(Solid::new(&thing.shape).centre.to_array()),
                    pixels,
                    binocular_pixels: points.len(),
                    surface,
                }
            })
            .collect()
    }
}

/// The middle value of a non-empty list; of an even number the upper of the two.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
