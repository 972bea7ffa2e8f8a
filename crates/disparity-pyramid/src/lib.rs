//! Phase-based vector disparity between the responses of two eyes, coarse to fine. The second level
//! of *dorsal*.
//!
//! [`estimate`] takes what two eyes say ([`v1_gabor::V1Responses`]) and gives a [`DisparityField`]:
//! at every pixel of the left image a shift `(dx, dy)`, a confidence, and a [`Validity`] that says
//! whether the shift is an answer and, if not, why not. The search is two-dimensional, so the eyes
//! need no rectification.
//!
//! ```
//! use disparity_pyramid::{MatchParams, estimate};
//! use ndarray::Array2;
//! use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};
//!
//! let size = Size { width: 128, height: 96 };
//! // Waves of many directions and lengths, as natural images have.
//! let texture = |x: f32, y: f32| -> f32 {
//!     let wave = |i: f32| (0.15 + 0.12 * i) * (x * (2.4 * i).cos() + y * (2.4 * i).sin());
//!     (0..16u8).map(|i| wave(f32::from(i)).sin()).sum()
//! };
//! let image = |dx: f32, dy: f32| {
//!     LumaImage::new(Array2::from_shape_fn(size.dim(), |(y, x)| {
//!         0.5 + 0.05 * texture(x as f32 - dx, y as f32 - dy)
//!     }))
//! };
//! // The right eye sees everything 5.3 px further left and 1.2 px further down.
//! let eyes = Binocular { left: image(0.0, 0.0)?, right: image(-5.3, 1.2)? };
//!
//! let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size)?;
//! let responses = eyes.as_ref().try_map(|eye| bank.respond(eye))?;
//! let field = estimate(&responses, MatchParams::default())?;
//!
//! let found = field.at(64, 48).expect("a textured place that both eyes see");
//! assert!((found.dx + 5.3).abs() < 0.05 && (found.dy - 1.2).abs() < 0.05);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The steps
//! From the coarsest scale to the finest, starting at [`MatchParams::zero_disparity_px`]:
//! 1. the coarser shifts are expanded: the grid doubled, the values too;
//! 2. the right responses (not the image) are read at the shifted places, demodulated;
//! 3. each orientation's phase difference is a component disparity (equation 2);
//! 4. a robust fit over the orientations gives the shift that remains (equation 3) and it is added
//!    (equation 4); where fewer than three orientations are heard, or they contradict one another,
//!    the coarser shift stays and the pixel is marked;
//! 5. medians over valid neighbours smooth and fill.
//!
//! Then the same is done from the right eye to the left, and what does not come back to where it
//! started is occluded or inconsistent. [`MatchParams::as_published`] takes the paper's steps alone.
//!
//! Where nothing is known of the range, [`estimate_from_votes`] finds where to start, and how many
//! scales it takes; [`estimate_near_first`] asks it only if a search from zero misses the scene.
//!
//! [`estimate_monogenic`] takes the same steps over responses that know one orientation a pixel
//! ([`v1_gabor::MonogenicResponses`]), with fits over neighbourhoods in place of orientations.
mod between;
mod coarse_to_fine;
mod contradicted;
mod dense;
mod disparity_field;
mod doubled;
mod estimate;
mod estimate_from_votes;
mod estimate_monogenic;
mod estimate_near_first;
mod estimate_population;
mod expand;
mod fill;
mod first_false;
mod flow_params;
mod grid;
mod left_right;
mod match_params;
mod match_workspace;
mod median;
mod median_network;
mod most_consistent;
mod object_params;
mod one_warp_params;
#[cfg(target_arch = "x86_64")]
mod pair_read;
mod pair_search;
mod phase;
mod pooled_fit;
mod population;
mod refine;
mod refine_rows;
mod robust_fit;
mod rough;
mod shift_covariance;
mod shifts;
mod singular;
mod slopes;
mod speckles;
mod spread;
mod start;
mod tile;
mod track;
mod validity;
mod vector;
mod vector_matcher;
mod warp;

pub use dense::{
    Acuity, BadDense, BadDenseParam, BadRange, Cost, DenseMatcher, DenseParams, DenseWorkspace,
    EyeView, LookBack, RowAlignment, SearchRange, WrongView,
};
pub use disparity_field::{Disparity, DisparityField, NotAField};
pub use estimate::{Mismatch, estimate, estimate_into};
pub use estimate_from_votes::{FromVotes, estimate_from_votes};
pub use estimate_monogenic::estimate_monogenic;
pub use estimate_near_first::estimate_near_first;
pub use estimate_population::estimate_population;
pub use match_params::{MatchParams, MedianRadius};
pub use match_workspace::MatchWorkspace;
pub use most_consistent::most_consistent;
pub use population::{Population, binocular_energy};
pub use shift_covariance::ShiftCovariance;
pub use start::{CoarseVotes, Start};
pub use validity::Validity;
pub use vector_matcher::VectorMatcher;
