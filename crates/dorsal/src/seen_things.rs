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
    /// The median pixel of every thing.
    middles: BTreeMap<ObjectId, (usize, usize)>,
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
    /// What these labels mark; `placed` are those of the things whose places are believed.
    pub fn new<'b>(
        labels: &'a LabelImage,
        names: &Names,
        rig: &StereoRig,
        placed: impl IntoIterator<Item = &'b LocatedObject>,
    ) -> Self {
        let placed = placed.into_iter().map(|object| {
            // What is seen lies on either side of the middle, a body's front before its flanks.
            let half_m = 2.0 * radius_m(object, rig) + 3.0 * object.covariance_m2[2][2].sqrt();
            let range = (object.depth_m - half_m, object.depth_m + half_m);
            (object.label, range)
        });
        let mut pixels: BTreeMap<Label, (Vec<usize>, Vec<usize>)> = BTreeMap::new();
        let size = labels.size();
        for (y, x) in (0..size.height).flat_map(|y| (0..size.width).map(move |x| (y, x))) {
            if let Some(label) = labels.at(x, y) {
                let (columns, rows) = pixels.entry(label).or_default();
                columns.push(x);
                rows.push(y);
            }
        }
        let middle = |mut along: Vec<usize>| {
            along.sort_unstable();
            along[along.len() / 2]
        };
        let middles = pixels.into_iter().map(|(label, (columns, rows))| {
            (object_id(label, names), (middle(columns), middle(rows)))
        });
        Self {
            labels,
            placed: placed.collect(),
            middles: middles.collect(),
        }
    }

    /// The median pixel `(x, y)` of a thing; nothing if the picture does not show it.
    #[must_use]
    pub fn middle(&self, object: &ObjectId) -> Option<(usize, usize)> {
        self.middles.get(object).copied()
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
