use serde::Deserialize;

use crate::texture::Texture;

/// The paint of the six walls, each seen from inside the room.
///
/// A wall that a room file leaves out is grey noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Walls {
    /// The wall at x = 0.
    pub left: Texture,
    /// The wall at the largest x.
    pub right: Texture,
    /// The wall at y = 0, behind a head of heading 0.
    pub near: Texture,
    /// The wall at the largest y.
    pub far: Texture,
    /// The ground, z = 0.
    pub floor: Texture,
    /// The wall overhead.
    pub ceiling: Texture,
}

impl Walls {
    /// The six walls with their names, in the order in which they are numbered.
    pub(crate) const fn named(&self) -> [(&'static str, &Texture); 6] {
        [
            ("left", &self.left),
            ("right", &self.right),
            ("near", &self.near),
            ("far", &self.far),
            ("floor", &self.floor),
            ("ceiling", &self.ceiling),
        ]
    }
}
