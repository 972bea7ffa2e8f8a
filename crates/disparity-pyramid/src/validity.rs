/// Whether the disparity of a pixel is an answer, and if not, why not.
///
/// A field holds a best guess at every pixel; this says how far the estimator stands behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Validity {
    /// The estimator stands behind the value.
    Valid,
    /// Too little contrast in too few orientations: a textureless place.
    #[default]
    NoEnergy,
    /// Contrast enough, but too near to phase singularities in all but two orientations or fewer;
    /// only an estimator that tests for them
    /// ([`MatchParams::singularity_tau`](crate::MatchParams::singularity_tau)) says so.
    Singular,
    /// The orientations contradict one another: a depth edge, a reflection, a singularity not tested
    /// for.
    Incoherent,
    /// The match lies outside the other eye's image.
    OutOfView,
    /// The other eye, looking back, sees something nearer there: a place only this eye sees.
    Occluded,
    /// The other eye, looking back, points somewhere else.
    Inconsistent,
}

impl Validity {
    /// Every value, in the order of declaration.
    pub const ALL: [Self; 7] = [
        Self::Valid,
        Self::NoEnergy,
        Self::Singular,
        Self::Incoherent,
        Self::OutOfView,
        Self::Occluded,
        Self::Inconsistent,
    ];

    /// Whether the value is an answer.
    #[must_use]
    pub const fn is_valid(self) -> bool {
        matches!(self, Self::Valid)
    }
}
