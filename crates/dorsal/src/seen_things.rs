use std::collections::BTreeMap;

use allocentric_qsr::ObjectId;
use egocentric_depth::{Label, LabelImage, LocatedObject, StereoRig};

use crate::{Names, object_id, radius_m};

/// The things that labels mark in the left picture of a look, and which of them have a place.
///
/// A thing whose depths do not agree, or that the edge of the picture cuts, has none. Its pixels are
/// evidence all the same: it is not where no pixel shows it, and it may stand anywhere along the lines
/// of sight that do.
#[derive(Clone, Debug)]
pub struct SeenThings<'a> {
    labels: &'a LabelImage,
    /// Between which depths a placed thing's surface lies, in metres.
    placed: BTreeMap<Label, (f64, f64)>,
    seen: BTreeMap<ObjectId, Outline>,
}

/// What the picture of a thing tells without its depth.
#[derive(Clone, Copy, Debug)]
struct Outline {
    /// The median pixel.
    middle: (usize, usize),
    /// The middle pixel of the lowest row.
    foot: (usize, usize),
    /// Whether what is seen below that row is no thing, which may hide more of this one.
    is_open: bool,
}

/// Where a thing's picture meets the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// To the right of the robot, in metres.
    pub right_m: f64,
    /// Ahead of the robot, in metres.
    pub forward_m: f64,
    /// How far a pixel reaches over the ground there, in metres.
    pub pixel_m: f64,
    /// Whether the whole foot is seen. Else another thing or the edge of the picture hides some of it, and
    /// the thing stands nearer.
    pub is_whole: bool,
}

/// What a line of sight meets, as far as labels tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Meets {
    /// No thing.
    Ground,
    /// A thing that has a place: its surface lies between these depths, in metres.
    Placed(f64, f64),
    /// A thing that has none.
    Unplaced,
}

impl<'a> SeenThings<'a> {
    /// What these labels mark, none of it with a place yet.
    #[must_use]
    pub fn new(labels: &'a LabelImage, names: &Names) -> Self {
        let mut pixels: BTreeMap<Label, (Vec<usize>, Vec<usize>)> = BTreeMap::new();
        let size = labels.size();
        for (y, x) in (0..size.height).flat_map(|y| (0..size.width).map(move |x| (y, x))) {
            if let Some(label) = labels.at(x, y) {
                let (columns, rows) = pixels.entry(label).or_default();
                columns.push(x);
                rows.push(y);
            }
        }
        let median = |along: &[usize]| {
            let mut along = along.to_vec();
            along.sort_unstable();
            along[along.len() / 2]
        };
        let seen = pixels.into_iter().map(|(label, (columns, rows))| {
            let lowest = rows.iter().copied().max().unwrap_or_default();
            let pairs = columns.iter().zip(&rows);
            let low: Vec<usize> = pairs
                .filter(|(_, row)| **row == lowest)
                .map(|(&x, _)| x)
                .collect();
            let below = lowest + 1;
            let outline = Outline {
                middle: (median(&columns), median(&rows)),
                foot: (median(&low), lowest),
                is_open: below < size.height && low.iter().all(|&x| labels.at(x, below).is_none()),
            };
            (object_id(label, names), outline)
        });
        Self {
            labels,
            placed: BTreeMap::new(),
            seen: seen.collect(),
        }
    }

    /// The same things, these of them with the places that are believed.
    #[must_use]
    pub fn placed<'b>(
        self,
        rig: &StereoRig,
        objects: impl IntoIterator<Item = &'b LocatedObject>,
    ) -> Self {
        let placed = objects.into_iter().map(|object| {
            // What is seen lies on either side of the middle, a body's front before its flanks.
            let half_m = 2.0 * radius_m(object, rig) + 3.0 * object.covariance_m2[2][2].sqrt();
            let range = (object.depth_m - half_m, object.depth_m + half_m);
            (object.label, range)
        });
        Self {
            placed: placed.collect(),
            ..self
        }
    }

    /// The median pixel `(x, y)` of a thing; nothing if the picture does not show it.
    #[must_use]
    pub fn middle(&self, object: &ObjectId) -> Option<(usize, usize)> {
        self.seen.get(object).map(|outline| outline.middle)
    }

    /// Every thing that the picture shows, by name.
    pub fn objects(&self) -> impl Iterator<Item = &ObjectId> {
        self.seen.keys()
    }

    /// Where the lowest row of a thing's picture meets the ground, which lies `eyes_above_ground_m` below the
    /// eyes: what one eye knows of the distance of what stands on the ground. Nothing if the thing is
    /// not seen, or its foot is above the horizon.
    #[must_use]
    pub fn foot(
        &self,
        object: &ObjectId,
        rig: &StereoRig,
        eyes_above_ground_m: f64,
    ) -> Option<Foot> {
        let outline = self.seen.get(object)?;
        let (x, y) = outline.foot;
        let at = |depth_m| {
            let point = rig.back_project((x as f64, y as f64), depth_m)?;
            Some(rig.to_observer(point))
        };
        let (near, far) = (at(1.0)?, at(2.0)?);
        let part = (eyes_above_ground_m - near.y_m) / (far.y_m - near.y_m);
        // Where a line of sight rises, or meets the ground ten metres away, a row is worth no distance.
        if !(-1.0..9.0).contains(&part) {
            return None;
        }
        let along = |near: f64, far: f64| near + part * (far - near);
        let (right_m, forward_m) = (along(near.x_m, far.x_m), along(near.z_m, far.z_m));
        let range_m2 = right_m * right_m + forward_m * forward_m + eyes_above_ground_m.powi(2);
        let (fx, fy) = rig.intrinsics().left.focal_px;
        Some(Foot {
            right_m,
            forward_m,
            pixel_m: range_m2 / (eyes_above_ground_m * fx.min(fy)),
            is_whole: outline.is_open,
        })
    }

    pub(crate) fn at(&self, x: usize, y: usize) -> Meets {
        let Some(label) = self.labels.at(x, y) else {
            return Meets::Ground;
        };
        self.placed
            .get(&label)
            .map_or(Meets::Unplaced, |&(near, far)| Meets::Placed(near, far))
    }
}
