use ndarray::Array2;
use rayon::prelude::*;
use v1_gabor::{
    BadParams, Binocular, FilterBank, GaborParams, LumaImage, Size, WaveVector, WrongSize,
};

use crate::dense::aggregate::{Ground, Winners, aggregate};
use crate::dense::confidence::{Evidence, confidence};
use crate::dense::dense_params::{Acuity, BadDenseParam, Cost, DenseParams, LookBack};
use crate::dense::dense_workspace::{CoarseLook, DenseWorkspace};
use crate::dense::eye_view::EyeView;
use crate::dense::fill::fill;
use crate::dense::fitted::{fit, numbers};
use crate::dense::heard_codes::sharpen_by_codes;
use crate::dense::heard_responses::sharpen;
use crate::dense::hyperacuity::Gates;
use crate::dense::look_back::look_back;
use crate::dense::neighbour_planes::{Neighbour, neighbours};
use crate::dense::opponent::opponent;
use crate::dense::partial_field::PartialField;
use crate::dense::phase_agreement::{COST_ORIENTATIONS, Loudness, Seen};
use crate::dense::pixel_cost::PixelCost;
use crate::dense::search_range::SearchRange;
use crate::dense::sheared_look::look_along_slants;
use crate::dense::slanted_cells::{Cell, fit_surfaces};
use crate::dense::step_penalty::StepPenalty;
use crate::dense::surface_choice::{self, MEETING_REACH, choose_surfaces};
use crate::dense::voting::vote;
use crate::speckles::reject_speckles;
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
    /// The neighbours that surface cells and the choice of surfaces ask.
    cell: Cell,
    choice: Vec<Neighbour>,
    /// The estimator at a quarter of the size that narrows the search.
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
            Some(_) => Some(Box::new(Self::plan(
                params.coarse(),
                size.halved().halved(),
            )?)),
            None => None,
        };
        let grid = (params.surface_stride, params.surface_stride > 2);
        let cell = Cell::new(params.surface_radius, grid);
        let grid = (params.choice_stride, false);
        let choice = neighbours(params.choice_radius, grid, surface_choice::DISTANCE_PX);
        Ok(Self {
            coarse,
            cell,
            choice,
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

    /// The size of the pictures.
    #[must_use]
    pub const fn size(&self) -> Size {
        self.size
    }

    /// The wave vectors of the bank that the cost is taken from, by orientation.
    pub(crate) fn waves(&self) -> Vec<WaveVector> {
        self.cost_bank.params().wave_vectors()
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
        let mut field = DisparityField::default();
        self.estimate_into(eyes, search, &mut DenseWorkspace::new(), &mut field)?;
        Ok(field)
    }

    /// The same for pair after pair, in buffers that the caller keeps and written over the field of an
    /// earlier pair: the bits are those of [`estimate`](Self::estimate), a fifth of the time is saved.
    ///
    /// # Errors
    /// [`WrongView`] if a picture has another size than planned; the field stays as it is then.
    pub fn estimate_into(
        &self,
        eyes: &Binocular<EyeView<'_>>,
        search: SearchRange,
        workspace: &mut DenseWorkspace,
        field: &mut DisparityField,
    ) -> Result<(), WrongView> {
        self.check(eyes)?;
        let search = search.within(self.size.width);
        let lumas = eyes.map(|eye| eye.luma);
        self.find(
            eyes,
            search,
            workspace,
            (&mut field.dx, &mut field.validity),
        )?;

        let DenseWorkspace {
            guides,
            margin,
            ranges,
            agreement,
            acuity,
            coherence,
            planes,
            moved,
            ..
        } = workspace;
        let ranges = ranges.of(field.dx.view());
        fit(coherence, self.size, 0.0);
        let gates = Gates {
            ranges,
            validity: &field.validity,
        };
        let dx = &mut field.dx;
        match (self.params.acuity, self.params.cost) {
            (Acuity::Parabola, _) => coherence.fill(0.0),
            (Acuity::CostBank, Cost::PhaseAgreement) => {
                sharpen_by_codes(dx, agreement, &self.waves(), gates, coherence);
            }
            (Acuity::CostBank, Cost::PhaseQuadrants) => {
                let bank = std::slice::from_ref(&self.cost_bank);
                sharpen(dx, bank, lumas, gates, (coherence, acuity))?;
            }
            (Acuity::TwoBanks, _) => {
                sharpen(dx, &self.acuity_banks, lumas, gates, (coherence, acuity))?;
            }
        }
        let choice = self.params.choice_radius > 0;
        let surfaces = self.params.surface_radius > 0;
        if surfaces || choice {
            planes.take_in(&guides.left, &field.validity, coherence, self.border());
            fit(moved, self.size, 0.0);
            moved.fill(0.0);
        }
        if surfaces {
            planes.take_shifts(field.dx.view());
            fit_surfaces(&mut field.dx, planes, &self.cell, moved);
        }
        if choice {
            planes.take_shifts(field.dx.view());
            choose_surfaces(&mut field.dx, planes, &self.choice, ranges.view(), moved);
        }
        fit(&mut field.confidence, self.size, 0.0);
        let evidence = Evidence {
            validity: field.validity.view(),
            coherence: coherence.view(),
            margin: margin.view(),
            range: ranges.view(),
            moved: (surfaces || choice).then(|| moved.view()),
        };
        confidence(evidence, &mut field.confidence);
        fit(&mut field.dy, self.size, 0.0);
        field.dy.fill(0.0);
        field.covariance = None;
        if self.params.slants > 0 && self.params.cost == Cost::PhaseAgreement {
            look_along_slants(self, eyes, search, workspace, field)?;
        }
        Ok(())
    }

    /// A shift for every pixel, before hyperacuity, and which of them are answers.
    fn find(
        &self,
        eyes: &Binocular<EyeView<'_>>,
        search: SearchRange,
        workspace: &mut DenseWorkspace,
        (dx, validity): (&mut Array2<f32>, &mut Array2<Validity>),
    ) -> Result<(), WrongView> {
        let lumas = eyes.map(|eye| eye.luma);
        self.choose_windows(&lumas, search, workspace)?;
        let DenseParams { colour, noisy, .. } = self.params;
        let noise = workspace.guides.left.take_in(&eyes.left, colour, noisy);
        let params = noise.map_or(self.params, |noise| self.params.in_noise(noise));
        if self.params.look_back == LookBack::OwnPaths {
            workspace.guides.right.take_in(&eyes.right, colour, noisy);
            workspace.guides.right.mirror();
        }
        fit(dx, self.size, 0.0);
        fit(validity, self.size, Validity::NoEnergy);
        fit(&mut workspace.margin, self.size, 0);
        fit(&mut workspace.other_dx, self.size, 0.0);
        let penalty = StepPenalty::new(&params);
        let (bank, unit) = (&self.cost_bank, penalty.unit);
        match self.params.cost {
            Cost::PhaseAgreement => {
                let loudness = Loudness {
                    silent_energy: params.silent_energy,
                    opponent: params.opponent,
                    opponent_silent_energy: params.opponent_silent_energy,
                };
                let mut cost = std::mem::take(&mut workspace.agreement);
                {
                    // Not kept: once they are in codes nobody asks for them, and what comes next needs room.
                    let opponents =
                        eyes.map(|eye| eye.rgb.filter(|_| loudness.opponent > 0.0).map(opponent));
                    let eyes = Binocular {
                        left: Seen {
                            luma: lumas.left,
                            opponent: opponents.left.as_ref(),
                        },
                        right: Seen {
                            luma: lumas.right,
                            opponent: opponents.right.as_ref(),
                        },
                    };
                    let rows = &mut workspace.picture_rows;
                    cost.take_in(bank, eyes, loudness, (search, unit), rows)?;
                }
                self.compete(&mut cost, &penalty, search, workspace, dx);
                workspace.agreement = cost;
            }
            Cost::PhaseQuadrants => {
                let mut cost = std::mem::take(&mut workspace.quadrants);
                cost.take_in(bank, lumas, search, unit, &mut workspace.bank_rows)?;
                self.compete(&mut cost, &penalty, search, workspace, dx);
                workspace.quadrants = cost;
            }
        }
        self.judge(dx, workspace, search, validity);
        self.complete((dx, validity), workspace, search);
        Ok(())
    }

    /// How far from a pixel its neighbours lie at most, in pixels.
    fn border(&self) -> usize {
        let asked = self.params.surface_radius.max(self.params.choice_radius);
        asked.max(MEETING_REACH)
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

    /// Chooses which shifts are searched where: all, or what lies near those that a look at a quarter
    /// of the size finds.
    fn choose_windows(
        &self,
        lumas: &Binocular<&LumaImage>,
        search: SearchRange,
        workspace: &mut DenseWorkspace,
    ) -> Result<(), WrongView> {
        let (Some(matcher), Some(margin_px)) = (&self.coarse, self.params.narrow_px) else {
            workspace.windows.take_all(self.size, search);
            return Ok(());
        };
        let CoarseLook {
            images,
            workspace: room,
            dx,
            validity,
        } = &mut **workspace.coarse.get_or_insert_default();
        let [halves, quarters] = images.get_or_insert_with(|| {
            let halves = lumas.map(LumaImage::halved);
            let quarters = halves.as_ref().map(LumaImage::halved);
            [halves, quarters]
        });
        lumas.left.halve_into(&mut halves.left);
        lumas.right.halve_into(&mut halves.right);
        halves.left.halve_into(&mut quarters.left);
        halves.right.halve_into(&mut quarters.right);
        let views = quarters.as_ref().map(EyeView::grey);
        matcher.find(&views, search.halved().halved(), room, (dx, validity))?;
        workspace
            .windows
            .take_around(dx.view(), self.size, search, margin_px);
        Ok(())
    }

    /// The winning shifts of the left eye, and the right eye's own for the look back.
    fn compete<C: PixelCost>(
        &self,
        cost: &mut C,
        penalty: &StepPenalty,
        search: SearchRange,
        workspace: &mut DenseWorkspace,
        dx: &mut Array2<f32>,
    ) {
        let DenseWorkspace {
            guides,
            windows,
            paths,
            margin,
            other_dx,
            ..
        } = workspace;
        let ground = Ground {
            cost: &*cost,
            guide: &guides.left,
            penalty,
            shifts: search.shifts(),
            windows,
        };
        let own_paths = self.params.look_back == LookBack::OwnPaths;
        let winners = Winners {
            dx,
            margin,
            other_dx: (!own_paths).then_some(&mut *other_dx),
        };
        aggregate(ground, search, paths, winners);
        if !own_paths {
            return;
        }
        // What the coarse look says is said of the left eye's pixels.
        windows.take_all(self.size, search);
        cost.change_eyes();
        let ground = Ground {
            cost: &*cost,
            guide: &guides.right,
            penalty,
            shifts: search.shifts(),
            windows,
        };
        let winners = Winners {
            dx: &mut *other_dx,
            // Nobody asks how sure the other eye is.
            margin: &mut Array2::zeros(self.size.dim()),
            other_dx: None,
        };
        aggregate(ground, search, paths, winners);
        // Phases are asked from the left eye's pixels.
        cost.change_eyes();
        for mut row in other_dx.rows_mut() {
            row.as_slice_mut().unwrap_or_default().reverse();
        }
    }

    /// Which winners are answers: those that the other eye confirms, in patches of some size. Where
    /// no shift is better than another there is nothing to see.
    fn judge(
        &self,
        dx: &Array2<f32>,
        workspace: &mut DenseWorkspace,
        search: SearchRange,
        validity: &mut Array2<Validity>,
    ) {
        let tolerance_px = self.params.left_right_px;
        let other_dx = workspace.other_dx.view();
        let verdicts = (&mut *validity, &mut workspace.look_back);
        look_back(dx.view(), other_dx, tolerance_px, search, verdicts);
        let width = self.size.width;
        numbers(validity)
            .par_chunks_exact_mut(width)
            .zip(numbers(&mut workspace.margin).par_chunks_exact(width))
            .for_each(|(validity, margins)| {
                for (validity, margin) in validity.iter_mut().zip(margins) {
                    let tells = *margin > 0;
                    *validity = if tells { *validity } else { Validity::NoEnergy };
                }
            });
        let least = self.params.least_patch;
        reject_speckles(dx.view(), validity, least, &mut workspace.patches);
    }

    /// A shift for every pixel, from those that are answers.
    fn complete(
        &self,
        (dx, validity): (&mut Array2<f32>, &mut Array2<Validity>),
        workspace: &mut DenseWorkspace,
        search: SearchRange,
    ) {
        use std::mem::take;
        let mut field = PartialField::new(take(dx), take(validity), take(&mut workspace.known));
        if self.params.votes > 0 {
            let DenseWorkspace { arms, votes, .. } = workspace;
            arms.take_in(&workspace.guides.left, &field.known);
            for _ in 0..self.params.votes {
                vote(&mut field, arms, search, votes);
            }
        }
        fill(&mut field, search, &mut workspace.fill);
        if self.params.median {
            workspace.median.smooth(&mut field.dx, MedianRadius::Two);
        }
        (*dx, *validity, workspace.known) = (field.dx, field.validity, field.known);
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
