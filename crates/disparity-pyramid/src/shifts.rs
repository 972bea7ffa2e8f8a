use ndarray::Array2;
use v1_gabor::Size;

use crate::Validity;
use crate::shift_covariance::FitCovariance;
use crate::slopes::Slopes;

/// Shifts of one scale, and what the last warp thought of each.
#[derive(Clone, Debug)]
pub(crate) struct Shifts {
    pub(crate) dx: Array2<f32>,
    pub(crate) dy: Array2<f32>,
    pub(crate) validity: Array2<Validity>,
    /// Root mean square of what the orientations leave unexplained, in pixels of this scale.
    pub(crate) residual: Array2<f32>,
    /// How fast the coarser scale's shifts grow.
    pub(crate) slopes: Slopes,
    /// The covariance of each fit, unknown where there is no answer; a plane that is there is
    /// written by the warp, and it is there at the last one alone.
    pub(crate) covariance: Option<Array2<FitCovariance>>,
}

impl Shifts {
    /// Planes of a size, of which nothing is known yet.
    pub(crate) fn silent(size: Size) -> Self {
        Self {
            dx: Array2::zeros(size.dim()),
            dy: Array2::zeros(size.dim()),
            validity: Array2::from_elem(size.dim(), Validity::NoEnergy),
            residual: Array2::zeros(size.dim()),
            slopes: Slopes::default(),
            covariance: None,
        }
    }
}
