use ndarray::{Array2, Zip};
use v1_gabor::{BadParams, Binocular, FilterBank, GaborParams, LumaImage, Size, WrongSize};

use crate::dense::aggregate::{Ground, Winners, aggregate};
use crate::dense::confidence::{Evidence, confidence};
use crate::dense::cross_arms::CrossArms;
use crate::dense::dense_params::{Acuity, BadDenseParam, Cost, DenseParams, LookBack};
use crate::dense::eye_view::EyeView;
use crate::dense::fill::fill;
use crate::dense::guide::Guide;
use crate::dense::hyperacuity::sharpen;
use crate::dense::local_range::local_range;
use crate::dense::look_back::look_back;
use crate::dense::partial_field::PartialField;
use crate::dense::phase_agreement::{COST_ORIENTATIONS, PhaseAgreement};
use crate::dense::phase_quadrants::PhaseQuadrants;
use crate::dense::pixel_cost::PixelCost;
use crate::dense::search_range::SearchRange;
use crate::dense::search_windows::SearchWindows;
use crate::dense::slanted_cells::fit_surfaces;
use crate::dense::step_penalty::StepPenalty;
use crate::dense::voting::vote;
use crate::median::median_of_known;
use crate::speckles::{Patches, reject_speckles};
use crate::{DisparityField, MedianRadius, Validity};

/// The dense epipolar estimator, planned for images of one size: a disparity at every pixel of a
/// rectified pair.
///
/// ```
/// use disparity_pyramid::{DenseMatcher, DenseParams, EyeView, SearchRange};
/// use ndarray::Array2;
/// use v1_gabor::{Binocular, LumaImage, Size};
///
/// let size = Size { width: 96, height: 64 };
/// let texture = |x: f32, y: f32| -> f32 {
///     let wave = |i: f32| (0.15 + 0.12 * i) * (x * (2.4 * i).cos() + y * (2.4 * i).sin());
///     (0..16u8).map(|i| wave(f32::from(i)).sin()).sum()
/// };
/// let image = |dx: f32| {
///     LumaImage::new(Array2::from_shape_fn(size.dim(), |(y, x)| {
///         0.5 + 0.05 * texture(x as f32 - dx, y as f32)
///     }))
/// };
/// // The right eye sees everything 7.25 px further left.
/// let (left, right) = (image(0.0)?, image(-7.25)?);
///
/// let matcher = DenseMatcher::plan(DenseParams::best(), size)?;
/// let eyes = Binocular { left: EyeView::grey(&left), right: EyeView::grey(&right) };
/// let field = matcher.estimate(&eyes, SearchRange::new(-15, 0)?)?;
///
/// let found = field.at(48, 32).expect("a textured place that both eyes see");
/// assert!((found.dx + 7.25).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct DenseMatcher {
    params: DenseParams,
    size: Size,
    /// What the cost is taken from.
    cost_bank: FilterBank,
    /// The banks of hyperacuity that are not the cost's own.
    acuity_banks: Vec<FilterBank>,
    /// The estimator at half the size that narrows the search.
    coarse: Option<Box<Self>>,
}

/// Why no dense estimator can be planned.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BadDense {
    /// A parameter cannot be.
    #[error(transparent)]
    Param(#[from] BadDenseParam),
    /// Level 1 has no bank for images of this size.
    #[error(transparent)]
    Bank(#[from] BadParams),
}

/// A picture of another size than the estimator was planned for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("this estimator was planned for pictures of {planned}, and {which} has {given}")]
pub struct WrongView {
    /// Size the estimator was planned for.
    pub planned: Size,
    /// Which picture differs.
    pub which: &'static str,
    /// Its size.
    pub given: Size,
}

impl DenseMatcher {
    /// Plans the estimator for images of one size.
    ///
    /// # Errors
    /// [`BadDense`] if a parameter cannot be, or the image has no pixel.
    pub fn plan(params: DenseParams, size: Size) -> Result<Self, BadDense> {
        params.check()?;
        let acuity = match params.acuity {
            Acuity::Parabola | Acuity::CostBank => Vec::new(),
            Acuity::TwoBanks => vec![bank(8, 1.5, 3), bank(8, 2.27, 5)],
        };
        let plan = |params| FilterBank::plan(params, size);
        let coarse = match params.narrow_px {
            Some(_) => Some(Box::new(Self::plan(params.coarse(), size.halved())?)),
            None => None,
        };
        Ok(Self {
            coarse,
            params,
            size,
            cost_bank: plan(bank(COST_ORIENTATIONS, 1.5, 3))?,
            acuity_banks: acuity.into_iter().map(plan).collect::<Result<_, _>>()?,
        })
    }

    /// The parameters it was planned with.
    #[must_use]
    pub const fn params(&self) -> DenseParams {
        self.params
    }

    /// The disparity of every pixel of the left image.
    ///
    /// Rows must correspond (a rectified pair); `dy` is 0 everywhere. Shifts that would leave the
    /// image from every pixel are not tried. A pixel that is not valid carries what surrounds it,
    /// or what lies behind it where only the left eye sees it.
    ///
    /// # Errors
    /// [`WrongView`] if a picture has another size than planned.
    pub fn estimate(
        &self,
        eyes: &Binocular<EyeView<'_>>,
        search: SearchRange,
    ) -> Result<DisparityField, WrongView> {
        self.check(eyes)?;
        let search = search.within(self.size.width);
        let lumas = eyes.map(|eye| eye.luma);
        let coarse = self.look_coarsely(&lumas, search)?;
        let windows = self.windows(coarse.as_ref(), search);
        let guides = eyes.map(|eye| Guide::of(&eye, self.params.colour));
        let penalty = StepPenalty::new(&self.params);
        let bank = &self.cost_bank;
        let (winners, other_dx) = match self.params.cost {
            Cost::PhaseAgreement => {
                let silent = self.params.silent_energy;
                let cost = PhaseAgreement::new(bank, lumas, silent, search, penalty.unit)?;
                self.compete(&cost, &guides, &penalty, search, &windows)
            }
            Cost::PhaseQuadrants => {
                let cost = PhaseQuadrants::new(bank, lumas, search, penalty.unit)?;
                self.compete(&cost, &guides, &penalty, search, &windows)
            }
        };
        let Winners { dx, margin, .. } = winners;
        let validity = self.judge(&dx, &margin, &other_dx, search);
        drop(other_dx);
        let PartialField {
            mut dx, validity, ..
        } = self.complete(dx, validity, &guides.left, search);

        let ranges = local_range(dx.view());
        let steady = validity.mapv(Validity::is_valid);
        let banks: Vec<&FilterBank> = match self.params.acuity {
            Acuity::Parabola => Vec::new(),
            Acuity::CostBank => vec![&self.cost_bank],
            Acuity::TwoBanks => self.acuity_banks.iter().collect(),
        };
        let coherence = if banks.is_empty() {
            Array2::zeros(dx.dim())
        } else {
            sharpen(&mut dx, &banks, lumas, ranges.view(), steady.view())?
        };
        let moved = self.smooth_surfaces(&mut dx, &steady, &coherence, &guides.left);
        let confidence = confidence(Evidence {
            validity: validity.view(),
            coherence: coherence.view(),
            margin: margin.view(),
            range: ranges.view(),
            moved: moved.view(),
        });
        let dy = Array2::zeros(dx.dim());
        Ok(DisparityField::trusted(dx, dy, confidence, validity))
    }

    fn check(&self, eyes: &Binocular<EyeView<'_>>) -> Result<(), WrongView> {
        let colours = |eye: &EyeView<'_>| eye.rgb.map_or(self.size, |rgb| Size::of_dim(rgb.dim()));
        let sizes = [
            ("the left luma", eyes.left.luma.size()),
            ("the right luma", eyes.right.luma.size()),
            ("the left colour", colours(&eyes.left)),
            ("the right colour", colours(&eyes.right)),
        ];
        match sizes.into_iter().find(|(_, size)| *size != self.size) {
            Some((which, given)) => Err(WrongView {
                planned: self.size,
                which,
                given,
            }),
            None => Ok(()),
        }
    }

    /// What a look at half the size finds, if it is to narrow the search.
    fn look_coarsely(
        &self,
        lumas: &Binocular<&LumaImage>,
        search: SearchRange,
    ) -> Result<Option<DisparityField>, WrongView> {
        let Some(coarse) = &self.coarse else {
            return Ok(None);
        };
        let halves = lumas.map(LumaImage::halved);
        let views = halves.as_ref().map(EyeView::grey);
        Ok(Some(coarse.estimate(&views, search.halved())?))
    }

    /// Which shifts are searched where: all, or what lies near those that the coarse look found.
    fn windows(&self, coarse: Option<&DisparityField>, search: SearchRange) -> SearchWindows {
        match (coarse, self.params.narrow_px) {
            (Some(coarse), Some(margin_px)) => {
                SearchWindows::around(coarse.dx(), self.size, search, margin_px)
            }
            _ => SearchWindows::all(self.size, search),
        }
    }

    /// The winning shifts of the left eye, and the right eye's own for the look back.
    fn compete<C: PixelCost>(
        &self,
        cost: &C,
        guides: &Binocular<Guide>,
        penalty: &StepPenalty,
        search: SearchRange,
        windows: &SearchWindows,
    ) -> (Winners, Array2<f32>) {
        let ground = Ground {
            cost,
            guide: &guides.left,
            penalty,
            shifts: search.shifts(),
            windows,
        };
        let own_paths = self.params.look_back == LookBack::OwnPaths;
        let mut winners = aggregate(ground, search, !own_paths);
        let other_dx = match winners.other_dx.take() {
            Some(told) => told,
            None => {
                // What the coarse look says is said of the left eye's pixels.
                let ground = Ground {
                    cost: &cost.seen_by_the_other_eye(),
                    guide: &guides.right.mirrored(),
                    windows: &SearchWindows::all(self.size, search),
                    ..ground
                };
                let mut mirrored = aggregate(ground, search, false).dx;
                for mut row in mirrored.rows_mut() {
                    row.as_slice_mut().unwrap_or_default().reverse();
                }
                mirrored
            }
        };
        (winners, other_dx)
    }

    /// Which winners are answers: those that the other eye confirms, in patches of some size. Where
    /// no shift is better than another there is nothing to see.
    fn judge(
        &self,
        dx: &Array2<f32>,
        margin: &Array2<u8>,
        other_dx: &Array2<f32>,
        search: SearchRange,
    ) -> Array2<Validity> {
        let tolerance_px = self.params.left_right_px;
        let mut validity = look_back(dx.view(), other_dx.view(), tolerance_px, search);
        Zip::from(&mut validity)
            .and(margin)
            .for_each(|validity, margin| {
                if *margin == 0 {
                    *validity = Validity::NoEnergy;
                }
            });
        let least = self.params.least_patch;
        reject_speckles(dx.view(), &mut validity, least, &mut Patches::default());
        validity
    }

    /// A shift for every pixel, from those that are answers.
    fn complete(
        &self,
        dx: Array2<f32>,
        validity: Array2<Validity>,
        guide: &Guide,
        search: SearchRange,
    ) -> PartialField {
        let mut field = PartialField::new(dx, validity);
        if self.params.votes > 0 {
            let arms = CrossArms::of(guide);
            for _ in 0..self.params.votes {
                vote(&mut field, &arms, search);
            }
        }
        // Where nothing at all is known, the shift that says least.
        let otherwise = 0.clamp(search.least_dx(), search.most_dx()) as f32;
        field.dx = fill(&field, otherwise);
        if self.params.median {
            field.dx = median_of_known(field.dx.view(), MedianRadius::Two);
        }
        field
    }

    /// Fits surface cells; returns how far each shift moved.
    fn smooth_surfaces(
        &self,
        dx: &mut Array2<f32>,
        steady: &Array2<bool>,
        coherence: &Array2<f32>,
        guide: &Guide,
    ) -> Array2<f32> {
        /// How much a filled shift counts, against one that is an answer without any coherence.
        const FILLED: f32 = 0.2;
        if self.params.surface_radius == 0 {
            return Array2::zeros(dx.dim());
        }
        let trust = Zip::from(steady)
            .and(coherence)
            .map_collect(|steady, coherence| {
                let found = if *steady { 1.0 } else { FILLED };
                found * (0.5 + 0.5 * coherence.clamp(0.0, 1.0))
            });
        fit_surfaces(dx, trust.view(), guide, self.params.surface_radius)
    }
}

impl From<WrongSize> for WrongView {
    fn from(wrong: WrongSize) -> Self {
        Self {
            planned: wrong.planned,
            which: "a luma",
            given: wrong.given,
        }
    }
}

/// One scale of Gabor filters at `pi / 2` rad/px with an envelope of this width.
fn bank(orientations: usize, sigma_px: f32, radius: usize) -> GaborParams {
    let params = GaborParams {
        orientations,
        scales: 1,
        radius,
        ..GaborParams::default()
    };
    // GaborParams::sigma_px solved for the bandwidth.
    let ratio = sigma_px * params.peak_frequency / (2.0 * 2.0f32.ln()).sqrt();
    GaborParams {
        bandwidth: ((ratio + 1.0) / (ratio - 1.0)).log2(),
        ..params
    }
}
