//! The dense epipolar estimator: a disparity at every pixel of a rectified pair, from the same
//! responses.
//!
//! Each file is one ingredient; [`DenseMatcher::estimate`](crate::DenseMatcher::estimate) puts them
//! together, in this order:
//! 0. if asked for, the same at a quarter of the size, which says where which shifts are worth a search;
//! 1. the cost of every shift at every pixel: phase agreement, or the phases' quadrants;
//! 2. three paths a pixel gather costs along rows and down columns, and the least sum wins;
//! 3. the other eye looks back; small patches are dropped;
//! 4. what has no answer is filled: by vote on its surface, from what lies behind, from around;
//! 5. a median;
//! 6. hyperacuity: the phases that remain move the shift by less than a pixel;
//! 7. surface cells: a slanted plane about each pixel;
//! 8. where surfaces meet, colours say which of them a pixel is on;
//! 9. confidence;
//! 10. what phases tell to be steep is looked at again, sheared, and what is surer is taken.
mod aggregate;
mod bands;
mod bank_rows;
mod confidence;
mod cross_arms;
mod dense_matcher;
mod dense_params;
mod dense_workspace;
mod eye_view;
mod fill;
mod fitted;
mod guide;
mod heard_codes;
mod heard_responses;
mod hyperacuity;
mod in_noise;
mod lesser;
mod local_range;
mod look_back;
mod nearest;
mod neighbour_planes;
mod noise_level;
mod opponent;
mod other_eye;
mod padding;
mod partial_field;
mod path_step;
mod paths_along;
mod paths_down;
mod phase_agreement;
mod phase_quadrants;
mod phase_slants;
mod pixel_cost;
mod row_alignment;
mod search_range;
mod search_windows;
mod sheared_look;
mod slanted_cells;
mod steep_patches;
mod step_penalty;
mod surface_choice;
mod voting;
mod wide;
mod winner;

pub use dense_matcher::{BadDense, DenseMatcher, WrongView};
pub use dense_params::{Acuity, BadDenseParam, Cost, DenseParams, LookBack};
pub use dense_workspace::DenseWorkspace;
pub use eye_view::EyeView;
pub use row_alignment::RowAlignment;
pub use search_range::{BadRange, SearchRange};
