use stereo_scenes::{Head, NoView, Room};

use crate::field::Field;
use crate::footprint::Footprint;
use crate::true_places::TruePlace;

/// One object that somebody moves between two looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Relocation {
    /// Its name.
    pub object: String,
    /// How far it goes, in the room's x and y, in metres.
    pub step_m: [f64; 2],
}

/// How far an object is moved, in metres.
const STRIDE_M: f64 = 0.3;

/// How much ground it keeps to its neighbours, in metres.
const CLEARANCE_M: f64 = 0.1;

/// An object that covers fewer pixels of the truth's picture than this is hidden.
const LEAST_PIXELS: usize = 60;

impl Relocation {
    /// Finds an object and a step such that it stands free and in sight of the head afterwards, within
    /// the field of the scan; `seed` chooses among them. A scan does not hide things on purpose: where
    /// nobody can look, nobody can know.
    pub(crate) fn find(
        room: &Room,
        head: &Head,
        field: &Field,
        seed: u64,
    ) -> Result<Option<Self>, NoView> {
        let objects: Vec<_> = room.names().zip(room.objects()).collect();
        let count = objects.len();
        for at in 0..count {
            let ((label, name), thing) = objects[(at + seed as usize) % count];
            let feet = room.objects().iter().filter(|other| other.name != name);
            let feet: Vec<Footprint> = feet.map(|other| Footprint::of(&other.shape)).collect();
            let own = Footprint::of(&thing.shape);
            let [x, y, z] = thing.shape.centre_m();
            let reach_m = own.reach_m() + CLEARANCE_M;
            for turn in 0..8u64 {
                let way = (turn + seed) as f64 * std::f64::consts::FRAC_PI_4;
                let step_m = [STRIDE_M * way.cos(), STRIDE_M * way.sin()];
                let to = [x + step_m[0], y + step_m[1]];
                let free = feet.iter().all(|foot| foot.distance_m(to) > reach_m);
                if !(free && is_within(head, field, to) && stands(room, to, z)) {
                    continue;
                }
                let moved = room.with_moved(name, [step_m[0], step_m[1], 0.0]);
                let Ok(moved) = moved else { continue };
                let there = TruePlace::of(&moved, head, label)?;
                if there.is_some_and(|place| place.pixels >= LEAST_PIXELS) {
                    return Ok(Some(Self {
                        object: name.to_owned(),
                        step_m,
                    }));
                }
            }
        }
        Ok(None)
    }

    /// The room afterwards; the same one if that cannot be.
    pub(crate) fn done(&self, room: &Room) -> Option<Room> {
        let [x, y] = self.step_m;
        room.with_moved(&self.object, [x, y, 0.0]).ok()
    }
}

/// Whether a place of the room lies well within the field.
fn is_within(head: &Head, field: &Field, [x, y]: [f64; 2]) -> bool {
    let (dx, dy) = (x - head.position_m[0], y - head.position_m[1]);
    let distance_m = dx.hypot(dy);
    let aside = (dx.atan2(dy) - head.heading_rad).abs();
    let edge_m = 0.1;
    (field.nearest_m + edge_m..field.farthest_m - edge_m).contains(&distance_m)
        && aside < field.aside_rad - 0.1
}

/// Whether a piece of scenery carries a thing at this place; in a room without furniture the floor
/// does.
fn stands(room: &Room, to: [f64; 2], height_m: f64) -> bool {
    let mut carriers = room
        .scenery()
        .iter()
        .filter(|thing| thing.shape.centre_m()[2] < height_m && thing.shape.foot_m() > 0.0)
        .peekable();
    carriers.peek().is_none()
        || carriers.any(|thing| Footprint::of(&thing.shape).distance_m(to) == 0.0)
}
