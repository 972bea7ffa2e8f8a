use allocentric_qsr::BadSighting;
use disparity_pyramid::{BadDense, BadRange, Mismatch, WrongView};
use egocentric_depth::{BadRig, NotLocatable, WrongFieldSize, WrongPlane};
use v1_gabor::{NotAnImage, WrongSize};

/// Why a look gave nothing: the level that refused, in its own words.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// Level 1: an image has another size than the bank was planned for.
    #[error(transparent)]
    Responses(#[from] WrongSize),
    /// Level 2: the eyes cannot be matched.
    #[error(transparent)]
    Disparity(#[from] Mismatch),
    /// Level 2: the dense estimator cannot be planned.
    #[error(transparent)]
    Dense(#[from] BadDense),
    /// Level 2: a picture does not fit the dense estimator.
    #[error(transparent)]
    View(#[from] WrongView),
    /// Level 2: the shifts to try are no range.
    #[error(transparent)]
    Range(#[from] BadRange),
    /// Level 2: the vector pyramid sees nothing from which a search could be taken.
    #[error(
        "no disparity is valid, so no search can be found; give one, or more scales and a start \
         nearer to what is seen"
    )]
    NoSearch,
    /// Level 2: the vector pyramid sees too little for the rows to be aligned.
    #[error(
        "too few disparities are valid for the rows to be aligned; more scales or a start nearer to \
         what is seen may help"
    )]
    NoAlignment,
    /// Level 3: the rig's eyes cannot be made parallel.
    #[error(transparent)]
    Rig(#[from] BadRig),
    /// Level 3: an eye's picture cannot be rectified.
    #[error(transparent)]
    Rectified(#[from] NotAnImage),
    /// Level 3: a field is not one of the rectified pair.
    #[error(transparent)]
    FieldSize(#[from] WrongFieldSize),
    /// Level 3: a plane of uncertainties is not one of the depth map.
    #[error(transparent)]
    Sigma(#[from] WrongPlane),
    /// Level 3: the labels do not belong to the depth map.
    #[error(transparent)]
    Depth(#[from] NotLocatable),
    /// Level 4: an object's place cannot be qualified.
    #[error(transparent)]
    Relations(#[from] BadSighting),
}
