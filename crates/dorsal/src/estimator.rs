use disparity_pyramid::{
    Acuity, DenseMatcher, DenseParams, DisparityField, EyeView, MatchParams, RowAlignment,
    SearchRange, estimate,
};
use egocentric_depth::{DisparitySigma, StereoRig};
use v1_gabor::{Binocular, FilterBank};

use crate::coarse_range::coarse_range;
use crate::{Error, Range, RectifiedEyes};

/// Which estimator of level 2 looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Estimator {
    /// The paper's vector pyramid: `dx` and `dy`, nothing assumed of the rig; over a range that is
    /// given, or that it finds itself.
    Vector(Range),
    /// The dense epipolar estimator: `dx` at every pixel of a rectified pair.
    Dense(DenseLook),
}

impl Default for Estimator {
    fn default() -> Self {
        Self::Vector(Range::default())
    }
}

impl Estimator {
    /// What the disparities of this estimator are worth in pixels. Ingredients of the dense estimator that
    /// are neither preset's count as those of the preset that has the same [`Acuity`], which decides most
    /// of an error.
    #[must_use]
    pub const fn disparity_sigma(&self) -> DisparitySigma {
        match self {
            Self::Vector(_) => DisparitySigma::VECTOR,
            Self::Dense(look) => match look.params.acuity {
                Acuity::TwoBanks => DisparitySigma::DENSE_BEST,
                Acuity::CostBank | Acuity::Parabola => DisparitySigma::DENSE_FAST,
            },
        }
    }
}

/// How the dense estimator looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DenseLook {
    /// Its ingredients.
    pub params: DenseParams,
    /// Which shifts it tries.
    pub search: Search,
    /// What is done first so that what corresponds lies on one row.
    pub rows: Rows,
}

/// How the rows of a pair come to correspond.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rows {
    /// They do: the pair is rectified.
    #[default]
    AsTaken,
    /// The right image's rows are aligned with the left one's, by what the vector pyramid sees: for a
    /// rig whose calibration is missing or cannot be trusted.
    Aligned,
    /// Both images are turned into those of parallel pinholes ([`RectifiedEyes`](crate::RectifiedEyes)),
    /// by a rig of any attitude and any lenses; what is found is carried back to the images as they
    /// were taken. A range that is given is one of the rectified images.
    Rectified,
}

/// Which shifts the dense estimator tries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Those that the vector pyramid sees in the same pair, up to `most_dx` if the farthest is
    /// known; with [`Rows::Rectified`] also those that a dense look at a quarter of the size sees.
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

/// What the dense estimator has to know of a pair before it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preparation {
    /// The shifts to try.
    pub search: SearchRange,
    /// How the right image's rows lie, if they are to be aligned.
    pub rows: Option<RowAlignment>,
}

impl DenseLook {
    /// The disparity of a pair that this rig took. `bank` and `matching` are those of the vector pyramid,
    /// which finds the search and the alignment if they are asked for. With an alignment `dy` is 0 all
    /// the same: the field belongs to the aligned right image.
    ///
    /// # Errors
    /// [`Error`] carries the refusal of the first step that refused.
    pub fn disparity(
        &self,
        eyes: &Binocular<EyeView<'_>>,
        rig: &StereoRig,
        bank: &FilterBank,
        matching: MatchParams,
    ) -> Result<DisparityField, Error> {
        if self.rows != Rows::Rectified {
            let preparation = self.prepare(eyes, bank, matching)?;
            return self.look(eyes, &preparation);
        }
        let rectified = RectifiedEyes::of(eyes, rig)?;
        let preparation = self.prepare(&rectified.views(), bank, matching)?;
        let field = self.look(&rectified.views(), &preparation)?;
        Ok(rectified.as_taken(&field)?)
    }

    /// What the vector pyramid finds out first, if anything is asked of it. The pair is rectified already
    /// if it is to be.
    ///
    /// # Errors
    /// [`Error`] if the vector pyramid refuses, or sees too little.
    pub fn prepare(
        &self,
        eyes: &Binocular<EyeView<'_>>,
        bank: &FilterBank,
        matching: MatchParams,
    ) -> Result<Preparation, Error> {
        let field = || {
            let responses = eyes.try_map(|eye| bank.respond(eye.luma))?;
            Ok::<_, Error>(estimate(&responses, matching)?)
        };
        match self.search {
            Search::Given(search) if self.rows != Rows::Aligned => {
                Ok(Preparation { search, rows: None })
            }
            Search::Given(search) => Ok(Preparation {
                search,
                rows: Some(RowAlignment::fit(&field()?).ok_or(Error::NoAlignment)?),
            }),
            Search::Found { most_dx } => {
                let field = field()?;
                let seen = SearchRange::covering(&field);
                let found = match self.rows {
                    // Eyes that were turned parallel converged before, on things that may slant.
                    Rows::Rectified => joined(seen, coarse_range(eyes)?),
                    Rows::AsTaken | Rows::Aligned => seen,
                };
                let found = found.ok_or(Error::NoSearch)?;
                let most_dx = most_dx.unwrap_or(found.most_dx());
                let rows = if self.rows == Rows::Aligned {
                    Some(RowAlignment::fit(&field).ok_or(Error::NoAlignment)?)
                } else {
                    None
                };
                Ok(Preparation {
                    search: SearchRange::new(found.least_dx().min(most_dx), most_dx)?,
                    rows,
                })
            }
        }
    }

    /// The disparity of a prepared pair.
    ///
    /// # Errors
    /// [`Error`] if a parameter cannot be, or a picture has another size than the left luma.
    pub fn look(
        &self,
        eyes: &Binocular<EyeView<'_>>,
        preparation: &Preparation,
    ) -> Result<DisparityField, Error> {
        let matcher = DenseMatcher::plan(self.params, eyes.left.luma.size())?;
        let Some(rows) = &preparation.rows else {
            return Ok(matcher.estimate(eyes, preparation.search)?);
        };
        let luma = rows.align_luma(eyes.right.luma);
        let rgb = eyes.right.rgb.map(|rgb| rows.align_rgb(rgb));
        let aligned = Binocular {
            left: EyeView {
                luma: eyes.left.luma,
                rgb: eyes.left.rgb.as_ref().map(|rgb| rgb.view()),
            },
            right: EyeView {
                luma: &luma,
                rgb: rgb.as_ref().map(|rgb| rgb.view()),
            },
        };
        Ok(matcher.estimate(&aligned, preparation.search)?)
    }
}

/// The range that holds both.
fn joined(one: Option<SearchRange>, other: Option<SearchRange>) -> Option<SearchRange> {
    let (Some(a), Some(b)) = (one, other) else {
        return one.or(other);
    };
    let least = a.least_dx().min(b.least_dx());
    SearchRange::new(least, a.most_dx().max(b.most_dx())).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_estimator_knows_its_sigma() {
        let dense = |params| {
            Estimator::Dense(DenseLook {
                params,
                ..DenseLook::default()
            })
        };
        assert_eq!(
            Estimator::default().disparity_sigma(),
            DisparitySigma::VECTOR
        );
        let best = dense(DenseParams::best()).disparity_sigma();
        assert_eq!(best, DisparitySigma::DENSE_BEST);
        let fast = dense(DenseParams::fast()).disparity_sigma();
        assert_eq!(fast, DisparitySigma::DENSE_FAST);
    }
}
