use std::fmt::Write as _;

use stereo_scenes::{BadRoom, Room};

use crate::chance::Chance;

/// A long table under a patterned cloth with seven to ten boxes, balls and cylinders on it, placed by chance, before the head
/// of [`Room::scan`] with pictures of 480 x 360 pixels: a room to count in.
///
/// Things are 5 to 30 cm high and keep 3 cm of ground between them; they hide each other as chance has
/// it. The same seed gives the same room.
///
/// # Errors
/// None that a seed is known for; [`BadRoom`] would say what is wrong with the room.
pub fn random_room(seed: u64) -> Result<Room, BadRoom> {
    let mut chance = Chance::new(seed.wrapping_mul(0x9E37_79B9) ^ 0x5ca7);
    let mut text = String::from(TABLE);
    let wanted = 7 + (4.0 * chance.uniform()) as usize;
    let mut placed: Vec<([f64; 2], f64)> = Vec::new();
    // So many tries fill any table; a room with fewer things is a room too.
    for _ in 0..400 {
        if placed.len() == wanted {
            break;
        }
        let (distance, aside) = (chance.between(0.85, 1.75), chance.between(-0.72, 0.72));
        let at = [2.0 + distance * aside.sin(), 0.35 + distance * aside.cos()];
        let body = Body::by(&mut chance);
        let reach = body.reach_m();
        let apart = |other: &([f64; 2], f64)| {
            (at[0] - other.0[0]).hypot(at[1] - other.0[1]) > reach + other.1 + 0.03
        };
        let on_table = at[1] - reach > 0.76 && at[1] + reach < 2.24;
        if on_table && placed.iter().all(apart) {
            let colour: [f64; 3] = std::array::from_fn(|_| chance.between(0.4, 0.95));
            let patch = chance.between(0.03, 0.08);
            let seed = (1000.0 * chance.uniform()) as u32;
            // Writing to a string does not fail.
            let _ = write!(
                text,
                "[[object]]\nname = \"thing_{}\"\n{}\ntexture = {{ colour = {colour:?}, patch_m = \
                 {patch}, seed = {seed} }}\n",
                placed.len() + 1,
                body.toml(at),
            );
            placed.push((at, reach));
        }
    }
    Room::from_toml(&text)
}

/// The room and its table.
const TABLE: &str = "\
size_m = [4.0, 2.8, 2.4]
lamp_m = [1.2, 0.7, 2.3]
[head]
position_m = [2.0, 0.35, 1.17]
fixation_m = [2.0, 1.45, 0.79]
size_px = [480, 360]
[walls]
left = { pattern = \"plain\", colour = [0.78, 0.76, 0.70] }
right = { colour = [0.55, 0.66, 0.60], patch_m = 0.25 }
far = { colour = [0.82, 0.74, 0.60], patch_m = 0.3 }
near = { colour = [0.7, 0.7, 0.7] }
floor = { pattern = \"wood\", colour = [0.45, 0.36, 0.30] }
ceiling = { pattern = \"plain\", colour = [0.9, 0.9, 0.9] }
[[scenery]]
name = \"table top\"
shape.box = { base_m = [2.0, 1.50, 0.72], size_m = [3.3, 1.50, 0.03] }
texture = { colour = [0.80, 0.70, 0.55], ink = [0.36, 0.23, 0.14], patch_m = 0.12 }
";

/// A body of random kind and size.
enum Body {
    Box { size_m: [f64; 3], turn_deg: f64 },
    Ball { radius_m: f64 },
    Can { radius_m: f64, height_m: f64 },
}

impl Body {
    fn by(chance: &mut Chance) -> Self {
        let kind = chance.uniform();
        if kind < 0.5 {
            Self::Box {
                size_m: [
                    chance.between(0.06, 0.3),
                    chance.between(0.04, 0.15),
                    chance.between(0.05, 0.25),
                ],
                turn_deg: chance.between(-45.0, 45.0),
            }
        } else if kind < 0.7 {
            Self::Ball {
                radius_m: chance.between(0.04, 0.09),
            }
        } else {
            Self::Can {
                radius_m: chance.between(0.03, 0.06),
                height_m: chance.between(0.08, 0.3),
            }
        }
    }

    /// How far it reaches from its middle over the ground, in metres.
    fn reach_m(&self) -> f64 {
        match self {
            Self::Box { size_m, .. } => size_m[0].hypot(size_m[1]) / 2.0,
            Self::Ball { radius_m } | Self::Can { radius_m, .. } => *radius_m,
        }
    }

    /// Its shape on the table at a place of the room, as a room's file says it.
    fn toml(&self, [x, y]: [f64; 2]) -> String {
        match self {
            Self::Box { size_m, turn_deg } => format!(
                "shape.box = {{ base_m = [{x}, {y}, 0.75], size_m = {size_m:?}, turn_deg = {turn_deg} }}"
            ),
            Self::Ball { radius_m } => format!(
                "shape.sphere = {{ centre_m = [{x}, {y}, {}], radius_m = {radius_m} }}",
                0.75 + radius_m
            ),
            Self::Can { radius_m, height_m } => format!(
                "shape.cylinder = {{ base_m = [{x}, {y}, 0.75], radius_m = {radius_m}, height_m = \
                 {height_m} }}"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_seed_gives_a_room_of_its_own() {
        let rooms: Vec<Room> = (0..20)
            .map(|seed| random_room(seed).expect("a room"))
            .collect();
        for (at, room) in rooms.iter().enumerate() {
            assert!(room.objects().len() >= 5);
            assert_eq!(*room, random_room(at as u64).expect("a room"));
            assert!(rooms[..at].iter().all(|other| other != room));
        }
    }
}
