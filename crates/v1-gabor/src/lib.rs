//! Complex Gabor responses of an image over scales and orientations.
mod binocular;
mod luma_image;
mod size;

pub use binocular::Binocular;
pub use luma_image::{LumaImage, NotAnImage};
pub use size::Size;
