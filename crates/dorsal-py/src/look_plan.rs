use dorsal::allocentric_qsr::{DepthReference, QualifyParams, QualitativeScene};
use dorsal::disparity_pyramid::{DenseParams, DisparityField, MatchParams, SearchRange};
use dorsal::egocentric_depth::{DepthMap, StereoRig, triangulate};
use dorsal::v1_gabor::{Binocular, FilterBank, GaborParams, Size};
use dorsal::{DenseLook, Error, Estimator, Range, Rows, Search};
use pyo3::prelude::*;

use crate::eye::{Eye, Wanted};
use crate::qsr::reference_system;
use crate::refusal::{look_error, value_error};

/// How to look, as the keyword arguments of `dorsal.look` say it; the defaults are the command's.
#[derive(Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct LookOptions {
    estimator: String,
    range: String,
    scales: Option<usize>,
    zero_disparity: Option<f32>,
    published: bool,
    rows_only: bool,
    max_disparity: Option<i32>,
    min_disparity: Option<i32>,
    rectify: Option<String>,
    pub(crate) segment: bool,
    system: String,
}

/// The parameters of every level, for pictures of one size.
#[derive(Debug)]
pub(crate) struct LookPlan {
    estimator: Estimator,
    bank: FilterBank,
    matching: MatchParams,
    reference: DepthReference,
    pub(crate) segment: bool,
}

impl LookOptions {
    /// The plan of a look at pictures of this size; `for_objects` if it is to place things. It is the plan of the
    /// command `dorsal look`, and a test holds the two together.
    pub(crate) fn plan(
        &self,
        size: Size,
        rig: Option<&StereoRig>,
        for_objects: bool,
    ) -> PyResult<LookPlan> {
        let range = self.range()?;
        let gabor = GaborParams::default();
        let scales = match (range, self.scales) {
            (Range::Given, Some(scales @ 1..=32)) => scales,
            (Range::Given, None) => gabor.scales,
            (_, Some(scales)) => {
                return Err(value_error(format!(
                    "scales is {scales}; a whole number from 1 to 32 is needed"
                )));
            }
            (Range::Auto | Range::Wide, None) => gabor.most_scales(size),
        };
        let gabor = GaborParams { scales, ..gabor }.fitted_to(size);
        let zero_disparity = self.zero_disparity.unwrap_or(0.0);
        if !zero_disparity.is_finite() {
            return Err(value_error("zero_disparity is not finite"));
        }
        let steps = if self.published {
            MatchParams::as_published()
        } else if for_objects {
            MatchParams::for_objects()
        } else {
            MatchParams::default()
        };
        Ok(LookPlan {
            estimator: self.estimator(range, rig)?,
            bank: FilterBank::plan(gabor, size).map_err(value_error)?,
            matching: MatchParams {
                // Whoever calls speaks the sign of files.
                zero_disparity_px: (0.0 - zero_disparity, 0.0),
                rows_only: self.rows_only,
                covariance: true,
                ..steps
            },
            reference: reference_system(&self.system)?,
            segment: self.segment,
        })
    }

    /// Whether colours are looked at: the dense estimators and segments follow them.
    pub(crate) fn wanted(&self) -> Wanted {
        if self.estimator == "vector" && !self.segment {
            Wanted::Luma
        } else {
            Wanted::Colours
        }
    }

    /// Where the vector pyramid searches. What is said of it holds; the paper's steps begin at zero, and so does
    /// what prepares the dense estimator.
    fn range(&self) -> PyResult<Range> {
        let said = self.scales.is_some() || self.zero_disparity.is_some();
        if said || self.published || self.estimator != "vector" {
            return Ok(Range::Given);
        }
        match self.range.as_str() {
            "near" => Ok(Range::Given),
            "auto" => Ok(Range::Auto),
            "wide" => Ok(Range::Wide),
            other => Err(value_error(format!(
                "range is '{other}'; it is 'near', 'auto' or 'wide'"
            ))),
        }
    }

    fn estimator(&self, range: Range, rig: Option<&StereoRig>) -> PyResult<Estimator> {
        let params = match self.estimator.as_str() {
            "vector" => return Ok(Estimator::Vector(range)),
            "dense" => DenseParams::best(),
            "dense-fast" => DenseParams::fast(),
            other => {
                return Err(value_error(format!(
                    "estimator is '{other}'; it is 'vector', 'dense' or 'dense-fast'"
                )));
            }
        };
        let search = match (self.max_disparity, self.min_disparity) {
            (None, least) => Search::Found {
                most_dx: least.map(i32::saturating_neg),
            },
            (Some(most), least) => {
                let least = least.unwrap_or(most.min(0));
                if least > most {
                    return Err(value_error(format!(
                        "no disparity lies between min_disparity {least} and max_disparity {most}"
                    )));
                }
                let range = SearchRange::new(most.saturating_neg(), least.saturating_neg());
                Search::Given(range.map_err(value_error)?)
            }
        };
        let turned = rig.is_some_and(|rig| !rig.is_rectified());
        let rows = match self.rectify.as_deref() {
            Some("none") => Rows::AsTaken,
            Some("auto") => Rows::Aligned,
            Some("rig") if rig.is_none() => {
                return Err(value_error("rectify='rig' needs a rig"));
            }
            Some("rig") => Rows::Rectified,
            None if turned => Rows::Rectified,
            None => Rows::AsTaken,
            Some(other) => {
                return Err(value_error(format!(
                    "rectify is '{other}'; it is 'none', 'auto' or 'rig'"
                )));
            }
        };
        Ok(Estimator::Dense(DenseLook {
            params,
            search,
            rows,
        }))
    }
}

impl LookPlan {
    /// Level 1 and level 2.
    pub(crate) fn disparity(
        &self,
        eyes: &Binocular<Eye>,
        rig: Option<&StereoRig>,
    ) -> Result<DisparityField, Error> {
        match (self.estimator, rig) {
            (Estimator::Vector(range), _) => {
                let responses = eyes.as_ref().try_map(|eye| self.bank.respond(eye.luma()))?;
                Ok(range.disparity(&responses, self.matching)?.field)
            }
            (Estimator::Dense(dense), Some(rig)) => {
                let views = eyes.as_ref().map(Eye::view);
                dense.disparity(&views, rig, &self.bank, self.matching)
            }
            // Without a rig nothing is rectified by one.
            (Estimator::Dense(dense), None) => {
                let views = eyes.as_ref().map(Eye::view);
                let preparation = dense.prepare(&views, &self.bank, self.matching)?;
                dense.look(&views, &preparation)
            }
        }
    }

    /// Level 3: the depth of every pixel, with the disparity's uncertainty.
    pub(crate) fn depth(
        &self,
        disparity: &DisparityField,
        rig: &StereoRig,
    ) -> Result<DepthMap, Error> {
        let sigma_px = self.estimator.disparity_sigma().of(disparity);
        Ok(triangulate(disparity, rig).with_disparity_sigma(sigma_px)?)
    }

    /// Level 4: what is placed, in symbols.
    pub(crate) fn qualify(
        &self,
        sightings: impl IntoIterator<Item = dorsal::allocentric_qsr::Sighting>,
    ) -> PyResult<QualitativeScene> {
        let scene =
            QualitativeScene::qualify_with(sightings, &self.reference, QualifyParams::default());
        scene.map_err(|why| look_error(why.into()))
    }
}
