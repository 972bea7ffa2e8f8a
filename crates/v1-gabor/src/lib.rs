//! Complex Gabor responses of an image over scales and orientations.
mod binocular;
mod filter_bank;
mod fourier;
mod gabor_params;
mod luma_image;
mod pyramid;
mod responses;
mod separable;
mod separable_pass;
mod size;
mod wave_vector;

pub use binocular::Binocular;
pub use filter_bank::{FilterBank, WrongSize};
pub use gabor_params::{BadParams, GaborParams};
pub use luma_image::{LumaImage, NotAnImage};
pub use responses::{PixelResponses, Responses, V1Responses};
pub use size::Size;
pub use wave_vector::WaveVector;
