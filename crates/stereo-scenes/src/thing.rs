use serde::Deserialize;

use crate::{shape::Shape, texture::Texture};

/// One body of a room: its name, its shape and place, and its paint.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thing {
    /// What people call it; no two things of a room share a name.
    pub name: String,
    /// Form, extent and place.
    pub shape: Shape,
    /// Paint.
    #[serde(default)]
    pub texture: Texture,
}
