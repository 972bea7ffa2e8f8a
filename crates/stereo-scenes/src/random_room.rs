use crate::noise::mix;
use crate::{Head, Pattern, Room, Shape, Texture, Thing, Walls};

/// A room of its own kind for every seed: a table with some objects on it, and a head that looks down
/// at them from an arm's length.
///
/// The room, the table, the head, and the objects' number, forms, sizes, places and paints are drawn
/// anew for every seed. Objects stand on the table, some centimetres apart over the ground, so that
/// one may hide a part of another but none touches another.
pub(crate) fn random_room(seed: u32) -> Room {
    let mut draw = Draw(mix(seed ^ 0x00DD_BA11));
    let size_m = [draw.from(2.6, 3.4), draw.from(2.6, 3.2), 2.4];
    let middle = size_m[0] / 2.0;
    let table_m = [draw.from(1.0, 1.4), draw.from(0.7, 1.0)];
    let top_m = draw.from(0.65, 0.8);
    let position_m = [middle, 0.4, top_m + draw.from(0.45, 0.60)];
    // Its near edge is an arm's length away.
    let table_y = position_m[1] + draw.from(0.60, 0.70) + table_m[1] / 2.0;
    const THICK_M: f64 = 0.03;
    let table = Thing {
        name: "table top".to_owned(),
        shape: Shape::Box {
            base_m: [middle, table_y, top_m - THICK_M],
            size_m: [table_m[0], table_m[1], THICK_M],
            turn_deg: draw.from(-5.0, 5.0),
        },
        texture: Texture {
            pattern: Pattern::Wood,
            patch_m: 0.12,
            ..draw.paint()
        },
    };
    let mut stands: Vec<([f64; 2], f64)> = Vec::new();
    let mut objects = Vec::new();
    let wanted = 4 + draw.below(5);
    // Most places are free at first; a table that is full keeps what it has.
    for _ in 0..40 {
        if objects.len() == wanted {
            break;
        }
        let form = draw.form();
        let radius_m = form.radius_m();
        let reach = [
            table_m[0] / 2.0 - radius_m - 0.06,
            table_m[1] / 2.0 - radius_m - 0.06,
        ];
        let foot = [
            middle + draw.from(-reach[0], reach[0]),
            table_y + draw.from(-reach[1], reach[1]),
        ];
        let free = stands.iter().all(|(other, other_radius_m)| {
            (foot[0] - other[0]).hypot(foot[1] - other[1]) > radius_m + other_radius_m + APART_M
        });
        let texture = draw.paint();
        if free {
            stands.push((foot, radius_m));
            objects.push(Thing {
                name: format!("{}-{}", form.name(), objects.len() + 1),
                shape: form.standing([foot[0], foot[1], top_m]),
                texture,
            });
        }
    }
    Room::assembled(
        size_m,
        [0.6, 0.6, 2.3],
        Walls {
            left: draw.paint(),
            right: draw.paint(),
            far: Texture {
                patch_m: 0.3,
                ..draw.paint()
            },
            ..Walls::default()
        },
        vec![table],
        objects,
        Head {
            position_m,
            ..Head::default()
        },
        [middle, table_y, top_m + 0.05],
    )
}

/// How far apart objects stand at least, metres.
const APART_M: f64 = 0.03;

/// An object without a place.
#[derive(Clone, Copy, Debug)]
enum Form {
    Box { size_m: [f64; 3], turn_deg: f64 },
    Ball { radius_m: f64 },
    Can { radius_m: f64, height_m: f64 },
}

impl Form {
    const fn name(self) -> &'static str {
        match self {
            Self::Box { .. } => "box",
            Self::Ball { .. } => "ball",
            Self::Can { .. } => "can",
        }
    }

    /// Of the circle on the table that holds it.
    fn radius_m(self) -> f64 {
        match self {
            Self::Box { size_m, .. } => size_m[0].hypot(size_m[1]) / 2.0,
            Self::Ball { radius_m } | Self::Can { radius_m, .. } => radius_m,
        }
    }

    const fn standing(self, base_m: [f64; 3]) -> Shape {
        match self {
            Self::Box { size_m, turn_deg } => Shape::Box {
                base_m,
                size_m,
                turn_deg,
            },
            Self::Ball { radius_m } => Shape::Sphere {
                centre_m: [base_m[0], base_m[1], base_m[2] + radius_m],
                radius_m,
            },
            Self::Can { radius_m, height_m } => Shape::Cylinder {
                base_m,
                radius_m,
                height_m,
            },
        }
    }
}

/// Numbers drawn one after another.
struct Draw(u32);

impl Draw {
    fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9);
        mix(self.0)
    }

    /// A number between two others.
    fn from(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * f64::from(self.bits()) / f64::from(u32::MAX)
    }

    fn below(&mut self, limit: usize) -> usize {
        self.bits() as usize % limit
    }

    fn form(&mut self) -> Form {
        match self.below(4) {
            0 | 1 => Form::Box {
                size_m: [
                    self.from(0.05, 0.18),
                    self.from(0.05, 0.15),
                    self.from(0.03, 0.20),
                ],
                turn_deg: self.from(-90.0, 90.0),
            },
            2 => Form::Ball {
                radius_m: self.from(0.03, 0.07),
            },
            _ => Form::Can {
                radius_m: self.from(0.025, 0.05),
                height_m: self.from(0.06, 0.22),
            },
        }
    }

    /// A paint of any hue, dark on light.
    fn paint(&mut self) -> Texture {
        let mut channel = |least, most| self.from(least, most) as f32;
        let colour = [(); 3].map(|()| channel(0.4, 0.95));
        let ink = [(); 3].map(|()| channel(0.05, 0.4));
        Texture {
            colour,
            ink: Some(ink),
            patch_m: channel(0.04, 0.10),
            seed: self.bits(),
            ..Texture::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Whatever the seed, the room is one that a file could hold, with objects in it.
        #[test]
        fn every_seed_makes_a_room(seed: u32) {
            let room = random_room(seed);
            prop_assert_eq!(room.check(), Ok(()));
            prop_assert!((3..=8).contains(&room.objects().len()));
            prop_assert_eq!(&random_room(seed), &room);
        }
    }
}
