use allocentric_qsr::BadSighting;
use disparity_pyramid::Mismatch;
use egocentric_depth::NotLocatable;
use v1_gabor::WrongSize;

/// Why a look gave nothing: the level that refused, in its own words.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// Level 1: an image has another size than the bank was planned for.
    #[error(transparent)]
    Responses(#[from] WrongSize),
    /// Level 2: the eyes cannot be matched.
    #[error(transparent)]
    Disparity(#[from] Mismatch),
    /// Level 3: the labels do not belong to the depth map.
    #[error(transparent)]
    Depth(#[from] NotLocatable),
    /// Level 4: an object's place cannot be qualified.
    #[error(transparent)]
    Relations(#[from] BadSighting),
}
