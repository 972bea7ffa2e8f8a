use std::{collections::BTreeSet, num::NonZeroU16};

use egocentric_depth::Label;
use serde::Deserialize;
use v1_gabor::Size;

use crate::{
    gaze::{Gaze, NoGaze},
    head::Head,
    random_room::random_room,
    solid::Solid,
    texture::Texture,
    thing::Thing,
    walls::Walls,
};

/// A box-shaped room with things in it, and a head that looks at them.
///
/// The room frame has its origin in a corner of the floor: x to the right, y away, z up, metres.
/// Everything stands inside, every length is positive and every name stands for one thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Room {
    size_m: [f64; 3],
    lamp_m: [f64; 3],
    walls: Walls,
    scenery: Vec<Thing>,
    objects: Vec<Thing>,
    head: Head,
    fixation_m: [f64; 3],
}

/// Why a text is not a room.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BadRoom {
    /// The text is not TOML, or a key is missing, unknown or of the wrong kind.
    #[error("the room cannot be read: {0}")]
    Text(#[from] toml::de::Error),
    /// A thing without a name.
    #[error("thing number {0} of the room has an empty name")]
    NoName(usize),
    /// Two things with one name.
    #[error("two things of the room are called `{0}`; names tell things apart")]
    SameName(String),
    /// A length that is not positive.
    #[error("`{name}` has a length of {length_m} m; lengths must be positive and finite")]
    Length {
        /// Which thing, or `room` for the room itself.
        name: String,
        /// The length.
        length_m: f64,
    },
    /// A coordinate or an angle that is not a number.
    #[error("`{0}` stands nowhere: a coordinate or an angle is not a finite number")]
    Nowhere(String),
    /// A thing, the lamp or the head that is not inside the walls.
    #[error(
        "`{name}` reaches from {from_m:?} to {to_m:?} m, beyond the walls at 0 and {size_m:?} m"
    )]
    Outside {
        /// Which thing.
        name: String,
        /// Its smallest coordinates.
        from_m: [f64; 3],
        /// Its largest coordinates.
        to_m: [f64; 3],
        /// The room's largest coordinates.
        size_m: [f64; 3],
    },
    /// A paint that is not one.
    #[error(
        "the texture of `{0}` is wrong: colours and contrast must be between 0 and 1, and \
         `patch_m` at least 0.001"
    )]
    Texture(String),
    /// More objects than labels.
    #[error("{0} objects are more than the 65535 that labels can tell apart")]
    TooMany(usize),
    /// The head's image has no pixel, or the head cannot look at its fixation point.
    #[error("the head cannot look where the room says: {0}")]
    Gaze(#[from] NoGaze),
}

/// A room as its file says it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RoomFile {
    size_m: [f64; 3],
    lamp_m: [f64; 3],
    head: HeadEntry,
    #[serde(default)]
    walls: Walls,
    #[serde(default)]
    scenery: Vec<Thing>,
    #[serde(default, rename = "object")]
    objects: Vec<Thing>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HeadEntry {
    position_m: [f64; 3],
    #[serde(default)]
    heading_deg: f64,
    fixation_m: [f64; 3],
    baseline_m: Option<f64>,
    size_px: Option<[usize; 2]>,
    focal_px: Option<f64>,
}

impl HeadEntry {
    fn head(&self) -> Head {
        let mut head = Head {
            position_m: self.position_m,
            heading_rad: self.heading_deg.to_radians(),
            ..Head::default()
        };
        if let Some([width, height]) = self.size_px {
            head = head.resized(Size { width, height });
        }
        head.focal_px = self.focal_px.unwrap_or(head.focal_px);
        head.baseline_m = self.baseline_m.unwrap_or(head.baseline_m);
        head
    }
}

impl Room {
    /// Reads a room from TOML text.
    ///
    /// # Errors
    /// [`BadRoom`] names the thing and says what is wrong with it.
    pub fn from_toml(text: &str) -> Result<Self, BadRoom> {
        let file: RoomFile = toml::from_str(text)?;
        let room = Self {
            size_m: file.size_m,
            lamp_m: file.lamp_m,
            walls: file.walls,
            scenery: file.scenery,
            objects: file.objects,
            head: file.head.head(),
            fixation_m: file.head.fixation_m,
        };
        room.check()?;
        Ok(room)
    }

    /// The demonstration: a table top in front of the head, with objects of the paper's Figures 5
    /// to 9 on it, textured walls, and one bare wall on the left.
    #[expect(clippy::missing_panics_doc, reason = "the text is part of this crate")]
    #[must_use]
    pub fn demo() -> Self {
        Self::from_toml(include_str!("../rooms/table.toml"))
            .expect("a test reads the embedded room")
    }

    /// Panels that face the head or slant, between bodies of every shape: a room for tests.
    #[expect(clippy::missing_panics_doc, reason = "the text is part of this crate")]
    #[must_use]
    pub fn shelf() -> Self {
        Self::from_toml(include_str!("../rooms/shelf.toml"))
            .expect("a test reads the embedded room")
    }

    /// A table with four to eight objects on it, drawn anew for every seed: forms, sizes, places, paints,
    /// the table, the walls and the head's place. Objects stand at least 3 cm apart; one may hide a part
    /// of another from the head. The same seed gives the same room on every machine.
    #[must_use]
    pub fn random(seed: u32) -> Self {
        random_room(seed)
    }

    /// A room of these parts, which are known to fit.
    pub(crate) const fn assembled(
        size_m: [f64; 3],
        lamp_m: [f64; 3],
        walls: Walls,
        scenery: Vec<Thing>,
        objects: Vec<Thing>,
        head: Head,
        fixation_m: [f64; 3],
    ) -> Self {
        Self {
            size_m,
            lamp_m,
            walls,
            scenery,
            objects,
            head,
            fixation_m,
        }
    }

    /// A long table before a head whose view takes in a part of it only: things of the paper's
    /// Figure 12 and others, for a head that looks about.
    #[expect(clippy::missing_panics_doc, reason = "the text is part of this crate")]
    #[must_use]
    pub fn scan() -> Self {
        Self::from_toml(include_str!("../rooms/scan.toml")).expect("a test reads the embedded room")
    }

    /// The same room with one object elsewhere, `step_m` away; the room itself if it has none of
    /// that name.
    ///
    /// # Errors
    /// [`BadRoom`] if the object would not stand inside.
    pub fn with_moved(&self, object: &str, step_m: [f64; 3]) -> Result<Self, BadRoom> {
        let mut room = self.clone();
        for thing in &mut room.objects {
            if thing.name == object {
                thing.shape = thing.shape.moved(step_m);
            }
        }
        room.check()?;
        Ok(room)
    }

    pub(crate) fn check(&self) -> Result<(), BadRoom> {
        positive("room", &self.size_m)?;
        for (name, point) in [
            ("lamp", self.lamp_m),
            ("head", self.head.position_m),
            ("fixation point", self.fixation_m),
        ] {
            finite(name, &point)?;
            self.inside(name, point, [0.0; 3])?;
        }
        for (name, texture) in self.walls.named() {
            painted(name, texture)?;
        }
        let mut names = BTreeSet::new();
        for (number, thing) in self.objects.iter().chain(&self.scenery).enumerate() {
            if thing.name.trim().is_empty() {
                return Err(BadRoom::NoName(number + 1));
            }
            if !names.insert(thing.name.as_str()) {
                return Err(BadRoom::SameName(thing.name.clone()));
            }
            positive(&thing.name, &thing.shape.lengths_m())?;
            finite(&thing.name, &thing.shape.placing())?;
            painted(&thing.name, &thing.texture)?;
            let solid = Solid::new(&thing.shape);
            self.inside(
                &thing.name,
                solid.centre.to_array(),
                solid.half_extent().to_array(),
            )?;
        }
        if self.objects.len() > usize::from(u16::MAX) {
            return Err(BadRoom::TooMany(self.objects.len()));
        }
        self.gaze()?;
        Ok(())
    }

    fn inside(&self, name: &str, centre: [f64; 3], half: [f64; 3]) -> Result<(), BadRoom> {
        // What stands on the floor or hangs on a wall touches it up to rounding.
        const TOUCH_M: f64 = 1e-9;
        let mut from_m = centre;
        let mut to_m = centre;
        let mut fits = true;
        for k in 0..3 {
            from_m[k] -= half[k];
            to_m[k] += half[k];
            fits &= from_m[k] >= -TOUCH_M && to_m[k] <= self.size_m[k] + TOUCH_M;
        }
        if fits {
            Ok(())
        } else {
            Err(BadRoom::Outside {
                name: name.to_owned(),
                from_m,
                to_m,
                size_m: self.size_m,
            })
        }
    }

    /// Where the walls at the far ends of x, y and z are, in metres.
    #[must_use]
    pub const fn size_m(&self) -> [f64; 3] {
        self.size_m
    }

    /// Where the lamp hangs, in the room frame, in metres.
    #[must_use]
    pub const fn lamp_m(&self) -> [f64; 3] {
        self.lamp_m
    }

    /// The paint of the walls.
    #[must_use]
    pub const fn walls(&self) -> &Walls {
        &self.walls
    }

    /// Things without a label: furniture.
    #[must_use]
    pub fn scenery(&self) -> &[Thing] {
        &self.scenery
    }

    /// The labelled things: the first has label 1.
    #[must_use]
    pub fn objects(&self) -> &[Thing] {
        &self.objects
    }

    /// The label and the name of every object.
    pub fn names(&self) -> impl Iterator<Item = (Label, &str)> {
        (1..=u16::MAX)
            .filter_map(NonZeroU16::new)
            .map(Label)
            .zip(self.objects.iter().map(|thing| thing.name.as_str()))
    }

    /// The head that the room's file places in it.
    #[must_use]
    pub const fn head(&self) -> Head {
        self.head
    }

    /// The point that the head looks at, in the room frame, in metres.
    #[must_use]
    pub const fn fixation_m(&self) -> [f64; 3] {
        self.fixation_m
    }

    /// The room's head looking at the room's fixation point.
    ///
    /// # Errors
    /// None for a room that was read: the point was checked to lie in front of the head.
    pub fn gaze(&self) -> Result<Gaze, NoGaze> {
        self.head.fixate(self.fixation_m)
    }
}

fn positive(name: &str, lengths_m: &[f64]) -> Result<(), BadRoom> {
    match lengths_m.iter().find(|l| !(l.is_finite() && **l > 0.0)) {
        Some(&length_m) => Err(BadRoom::Length {
            name: name.to_owned(),
            length_m,
        }),
        None => Ok(()),
    }
}

fn finite(name: &str, numbers: &[f64]) -> Result<(), BadRoom> {
    if numbers.iter().all(|n| n.is_finite()) {
        Ok(())
    } else {
        Err(BadRoom::Nowhere(name.to_owned()))
    }
}

fn painted(name: &str, texture: &Texture) -> Result<(), BadRoom> {
    let unit = 0.0..=1.0;
    let shares = texture.colour.iter().chain(texture.ink.iter().flatten());
    let patch_fits = texture.patch_m.is_finite() && texture.patch_m >= 0.001;
    if shares.chain([&texture.contrast]).all(|s| unit.contains(s)) && patch_fits {
        Ok(())
    } else {
        Err(BadRoom::Texture(name.to_owned()))
    }
}
