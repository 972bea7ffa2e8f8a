use disparity_pyramid::{
    DenseMatcher, DenseParams, DenseWorkspace, DisparityField, EyeView, FromVotes, MatchParams,
    Mismatch, SearchRange, VectorMatcher,
};
use egocentric_depth::StereoRig;
use v1_gabor::{Binocular, FilterBank, LumaImage, Size};

use crate::coarse_range::CoarseLook;
use crate::{Error, RectifiedEyes};

/// What the estimators of level 2 plan and work in, kept from look to look: from the second look with the
/// same parameters on nothing is planned again, and the vector pyramid and the dense estimator for robots
/// allocate nothing large. A look with other parameters, or of another size, plans what they change.
///
/// What a look gave is not in it: two looks of the same pair give the same bits, whatever came between.
/// The default has planned nothing yet.
#[derive(Clone, Debug, Default)]
pub struct EstimatorWorkspace {
    vector: Option<VectorMatcher>,
    /// What the vector pyramid sees before a dense look.
    pub(crate) vectors: FromVotes,
    pub(crate) valid: Vec<f32>,
    coarse: Option<CoarseLook>,
    dense: Option<DenseMatcher>,
    dense_room: DenseWorkspace,
    pub(crate) rectified: Option<RectifiedEyes>,
    pub(crate) rectified_field: DisparityField,
}

impl EstimatorWorkspace {
    /// Nothing planned yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The vector pyramid over this bank, planned for these parameters: for who looks with it, step by
    /// step ([`Range::disparity_into`](crate::Range::disparity_into)).
    ///
    /// # Errors
    /// [`Mismatch::Parameter`] if a parameter cannot be.
    pub fn vector(
        &mut self,
        bank: &FilterBank,
        matching: MatchParams,
    ) -> Result<&mut VectorMatcher, Mismatch> {
        let kept = self.vector.take();
        let matcher = match kept.filter(|kept| kept.is_plan_of(bank, matching)) {
            Some(kept) => kept,
            None => VectorMatcher::plan(bank.clone(), matching)?,
        };
        Ok(self.vector.insert(matcher))
    }

    /// The pair as parallel pinholes would see it, in the maps and the room of the last pair if this rig took
    /// that too. It is given away; [`give_back`](Self::give_back) keeps it for the next pair.
    ///
    /// # Errors
    /// [`Error::Rig`] if the eyes are no rig along their own baseline.
    pub fn rectify(
        &mut self,
        eyes: &Binocular<EyeView<'_>>,
        rig: &StereoRig,
    ) -> Result<RectifiedEyes, Error> {
        match self.rectified.take().filter(|kept| kept.rig() == rig) {
            Some(mut kept) => {
                kept.retake(eyes)?;
                Ok(kept)
            }
            None => RectifiedEyes::of(eyes, rig),
        }
    }

    /// Keeps what was rectified, for its room.
    pub fn give_back(&mut self, rectified: RectifiedEyes) {
        self.rectified = Some(rectified);
    }

    /// What the vector pyramid sees from where its parameters say.
    pub(crate) fn see_vectors(
        &mut self,
        eyes: &Binocular<&LumaImage>,
        (bank, matching): (&FilterBank, MatchParams),
    ) -> Result<(), Error> {
        let mut found = std::mem::take(&mut self.vectors);
        let seen = self
            .vector(bank, matching)?
            .estimate_into(eyes, &mut found.field);
        self.vectors = found;
        Ok(seen?)
    }

    /// The shifts that a coarse dense look finds; `None` if the images are too small to tell.
    pub(crate) fn coarse_range(
        &mut self,
        eyes: &Binocular<EyeView<'_>>,
    ) -> Result<Option<SearchRange>, Error> {
        let size = eyes.left.luma.size();
        if self.coarse.as_ref().is_none_or(|look| look.size() != size) {
            self.coarse = CoarseLook::plan(size)?;
        }
        self.coarse
            .as_mut()
            .map_or(Ok(None), |look| look.range(eyes))
    }

    /// The dense estimator's field of a pair whose rows correspond.
    pub(crate) fn see_densely(
        &mut self,
        params: DenseParams,
        eyes: &Binocular<EyeView<'_>>,
        search: SearchRange,
        field: &mut DisparityField,
    ) -> Result<(), Error> {
        let size: Size = eyes.left.luma.size();
        let is_plan = |matcher: &DenseMatcher| matcher.params() == params && matcher.size() == size;
        let matcher = match self.dense.take().filter(is_plan) {
            Some(kept) => kept,
            None => DenseMatcher::plan(params, size)?,
        };
        let matcher = self.dense.insert(matcher);
        matcher.estimate_into(eyes, search, &mut self.dense_room, field)?;
        Ok(())
    }
}
