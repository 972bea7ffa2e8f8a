//! Phase-based vector disparity between the responses of two eyes, coarse to fine.
mod disparity_field;
mod validity;

pub use disparity_field::{Disparity, DisparityField, NotAField};
pub use validity::Validity;
