//! Phase-based vector disparity between the responses of two eyes, coarse to fine.
mod coarse_to_fine;
mod disparity_field;
mod estimate;
mod expand;
mod left_right;
mod match_params;
mod median;
mod median_network;
mod phase;
mod refine;
mod robust_fit;
mod validity;
mod warp;

pub use disparity_field::{Disparity, DisparityField, NotAField};
pub use estimate::{Mismatch, estimate};
pub use match_params::{MatchParams, MedianRadius};
pub use validity::Validity;
