use disparity_pyramid::{
    DenseMatcher, DenseParams, DisparityField, EyeView, MatchParams, SearchRange, estimate,
};
use v1_gabor::{Binocular, FilterBank};

use crate::Error;

/// Which estimator of level 2 looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Estimator {
    /// The paper's vector pyramid: `dx` and `dy`, nothing assumed of the rig.
    #[default]
    Vector,
    /// The dense epipolar estimator: `dx` at every pixel of a rectified pair.
    Dense(DenseLook),
}

/// How the dense estimator looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DenseLook {
    /// Its ingredients.
    pub params: DenseParams,
    /// Which shifts it tries.
    pub search: Search,
}

/// Which shifts the dense estimator tries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Those that the vector pyramid sees in the same pair, up to `most_dx` if the farthest is
    /// known.
    Found {
        /// The largest shift to try, in pixels.
        most_dx: Option<i32>,
    },
    /// These.
    Given(SearchRange),
}

impl Default for Search {
    fn default() -> Self {
        Self::Found { most_dx: None }
    }
}

impl Search {
    /// The shifts to try in this pair.
    ///
    /// # Errors
    /// [`Error`] if they are to be found and the vector pyramid refuses, or sees nothing.
    pub fn range(
        self,
        eyes: &Binocular<EyeView<'_>>,
        bank: &FilterBank,
        matching: MatchParams,
    ) -> Result<SearchRange, Error> {
        match self {
            Self::Given(range) => Ok(range),
            Self::Found { most_dx } => {
                let responses = eyes.try_map(|eye| bank.respond(eye.luma))?;
                let field = estimate(&responses, matching)?;
                let found = SearchRange::covering(&field).ok_or(Error::NoSearch)?;
                let most_dx = most_dx.unwrap_or(found.most_dx());
                Ok(SearchRange::new(found.least_dx().min(most_dx), most_dx)?)
            }
        }
    }
}

impl DenseLook {
    /// The disparity of a rectified pair. `bank` and `matching` are those of the vector pyramid,
    /// which finds the search if none is given.
    ///
    /// # Errors
    /// [`Error`] carries the refusal of the first step that refused.
    pub fn disparity(
        &self,
        eyes: &Binocular<EyeView<'_>>,
        bank: &FilterBank,
        matching: MatchParams,
    ) -> Result<DisparityField, Error> {
        let search = self.search.range(eyes, bank, matching)?;
        let matcher = DenseMatcher::plan(self.params, eyes.left.luma.size())?;
        Ok(matcher.estimate(eyes, search)?)
    }
}
