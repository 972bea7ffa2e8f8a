use disparity_pyramid::{
    Acuity, DenseParams, DisparityField, EyeView, MatchParams, RowAlignment, SearchRange,
};
use egocentric_depth::{DisparitySigma, StereoRig};
use v1_gabor::{Binocular, FilterBank};

use crate::{Error, EstimatorWorkspace, Range};

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
        let mut field = DisparityField::default();
        let mut workspace = EstimatorWorkspace::default();
        self.disparity_into(eyes, rig, (bank, matching), (&mut workspace, &mut field))?;
        Ok(field)
    }

    /// The same, written over an earlier field, with what is planned once and kept.
    ///
    /// # Errors
    /// [`Error`] as [`disparity`](Self::disparity).
    pub fn disparity_into(
        &self,
        eyes: &Binocular<EyeView<'_>>,
        rig: &StereoRig,
        (bank, matching): (&FilterBank, MatchParams),
        (workspace, field): (&mut EstimatorWorkspace, &mut DisparityField),
    ) -> Result<(), Error> {
        if self.rows != Rows::Rectified {
            let preparation = self.prepare_in(eyes, (bank, matching), workspace)?;
            return self.look_into(eyes, &preparation, (workspace, field));
        }
        let rectified = workspace.rectify(eyes, rig)?;
        let preparation = self.prepare_in(&rectified.views(), (bank, matching), workspace)?;
        let mut found = std::mem::take(&mut workspace.rectified_field);
        self.look_into(
            &rectified.views(),
            &preparation,
            (&mut *workspace, &mut found),
        )?;
        rectified.as_taken_into(&found, field)?;
        workspace.rectified_field = found;
        workspace.rectified = Some(rectified);
        Ok(())
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
        self.prepare_in(eyes, (bank, matching), &mut EstimatorWorkspace::default())
    }

    /// The same, with what is planned once and kept.
    ///
    /// # Errors
    /// [`Error`] as [`prepare`](Self::prepare).
    pub fn prepare_in(
        &self,
        eyes: &Binocular<EyeView<'_>>,
        (bank, matching): (&FilterBank, MatchParams),
        workspace: &mut EstimatorWorkspace,
    ) -> Result<Preparation, Error> {
        let most_dx = match self.search {
            Search::Given(search) if self.rows != Rows::Aligned => {
                return Ok(Preparation { search, rows: None });
            }
            Search::Given(_) => None,
            Search::Found { most_dx } => most_dx,
        };
        workspace.see_vectors(&eyes.map(|eye| eye.luma), (bank, matching))?;
        let aligned = |workspace: &EstimatorWorkspace| {
            RowAlignment::fit(&workspace.vectors.field).ok_or(Error::NoAlignment)
        };
        if let Search::Given(search) = self.search {
            let rows = Some(aligned(workspace)?);
            return Ok(Preparation { search, rows });
        }
        let seen = SearchRange::covering_in(&workspace.vectors.field, &mut workspace.valid);
        let found = match self.rows {
            // Eyes that were turned parallel converged before, on things that may slant.
            Rows::Rectified => joined(seen, workspace.coarse_range(eyes)?),
            Rows::AsTaken | Rows::Aligned => seen,
        };
        let found = found.ok_or(Error::NoSearch)?;
        let most_dx = most_dx.unwrap_or(found.most_dx());
        let rows = match self.rows {
            Rows::Aligned => Some(aligned(workspace)?),
            Rows::AsTaken | Rows::Rectified => None,
        };
        Ok(Preparation {
            search: SearchRange::new(found.least_dx().min(most_dx), most_dx)?,
            rows,
        })
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
        let mut field = DisparityField::default();
        let mut workspace = EstimatorWorkspace::default();
        self.look_into(eyes, preparation, (&mut workspace, &mut field))?;
        Ok(field)
    }

    /// The same, written over an earlier field, with what is planned once and kept.
    ///
    /// # Errors
    /// [`Error`] as [`look`](Self::look).
    pub fn look_into(
        &self,
        eyes: &Binocular<EyeView<'_>>,
        preparation: &Preparation,
        (workspace, field): (&mut EstimatorWorkspace, &mut DisparityField),
    ) -> Result<(), Error> {
        let search = preparation.search;
        let Some(rows) = &preparation.rows else {
            return workspace.see_densely(self.params, eyes, search, field);
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
        workspace.see_densely(self.params, &aligned, search, field)
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
