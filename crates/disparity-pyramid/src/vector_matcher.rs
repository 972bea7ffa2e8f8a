use std::borrow::Borrow;

use ndarray::Array2;
use v1_gabor::{
    BankWorkspace, Binocular, FilterBank, LumaImage, Size, V1Responses, WaveVector, WrongSize,
};

use crate::estimate::{both_ways, estimate_scales_into};
use crate::estimate_from_votes::search_from_votes;
use crate::estimate_near_first::search_near_first;
use crate::grid::Grid;
use crate::pair_search::PairSearch;
use crate::refine::{Eyes, refine};
use crate::refine_rows::{Band, RowEyes, refine_rows};
use crate::shifts::Shifts;
use crate::start::LONGEST_SIDE;
use crate::{CoarseVotes, DisparityField, FromVotes, MatchParams, MatchWorkspace, Mismatch};

/// The vector pyramid from images to field, for pair after pair of one size: level 1 and
/// [`estimate`](crate::estimate) in one visit, with the same bits.
///
/// The finest responses, three quarters of all, are needed once, and by one row after the other. They
/// are computed row by row where the warp reads them and forgotten. Of the left eye one row is there at a
/// time, of the right eye as many as the vertical shifts of a row are apart: a few, or, with stray shifts,
/// some tens (56 of 768 on a real pair), where a frame of both eyes would be 128 bytes a pixel of memory. What a
/// matcher works in is kept from pair to pair, so that none but the first allocates anything large.
///
/// ```
/// # use ndarray::Array2;
/// # use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};
/// use disparity_pyramid::{DisparityField, MatchParams, VectorMatcher};
/// # let size = Size { width: 64, height: 48 };
/// # let frame = || LumaImage::new(Array2::zeros(size.dim()));
/// # let pairs = vec![Binocular { left: frame()?, right: frame()? }; 2];
///
/// let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size)?;
/// let mut matcher = VectorMatcher::plan(bank, MatchParams::default())?;
/// let mut field = DisparityField::default();
/// for eyes in &pairs {
///     matcher.estimate_into(eyes, &mut field)?;
/// }
/// assert_eq!(field.size(), size);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct VectorMatcher {
    bank: FilterBank,
    params: MatchParams,
    /// Whether the finest responses are computed as they are needed.
    by_rows: bool,
    waves: Vec<WaveVector>,
    bank_workspace: BankWorkspace,
    /// All of them, or, by rows, those of the coarser scales.
    responses: Binocular<V1Responses>,
    workspace: MatchWorkspace,
    bands: Vec<Band>,
}

impl VectorMatcher {
    /// Plans a matcher for images of the bank's size.
    ///
    /// Where the finest responses are needed more than once they are held after all: with more than one
    /// warp at the finest scale or a look back there, with [`MatchParams::singularity_tau`], with one scale only, and with filters that have no pass over
    /// single rows.
    ///
    /// # Errors
    /// [`Mismatch::Parameter`] if a parameter cannot be.
    pub fn plan(bank: FilterBank, params: MatchParams) -> Result<Self, Mismatch> {
        params.check()?;
        let looks_back_there = params.left_right_px.is_some() && params.look_back_scale == 0;
        let once = params.finest_warps == 1
            && !looks_back_there
            && params.singularity_tau.is_none()
            && bank.answers_by_rows();
        let coarser = bank.coarser().filter(|_| once);
        let silence = coarser.as_ref().unwrap_or(&bank).silence();
        Ok(Self {
            by_rows: coarser.is_some(),
            waves: bank.params().wave_vectors(),
            bank_workspace: bank.workspace(),
            responses: Binocular {
                left: silence.clone(),
                right: silence,
            },
            workspace: MatchWorkspace::new(),
            bands: Vec::new(),
            bank,
            params,
        })
    }

    /// The size of the images.
    #[must_use]
    pub const fn size(&self) -> Size {
        self.bank.size()
    }

    /// How many scales its bank has.
    #[must_use]
    pub const fn scales(&self) -> usize {
        self.bank.params().scales
    }

    /// The parameters it was planned with.
    #[must_use]
    pub const fn params(&self) -> MatchParams {
        self.params
    }

    /// Whether it was planned for this bank and these parameters, so that planning it anew would change
    /// nothing.
    #[must_use]
    pub fn is_plan_of(&self, bank: &FilterBank, params: MatchParams) -> bool {
        self.params == params && self.bank.is_same_as(bank)
    }

    /// The vector disparity of every pixel of the left image.
    ///
    /// # Errors
    /// [`Mismatch`] if an image has another size.
    pub fn estimate(
        &mut self,
        eyes: &Binocular<impl Borrow<LumaImage>>,
    ) -> Result<DisparityField, Mismatch> {
        let mut field = DisparityField::default();
        self.estimate_into(eyes, &mut field)?;
        Ok(field)
    }

    /// The same, written over the field of an earlier pair.
    ///
    /// # Errors
    /// [`Mismatch`] if an image has another size; the field stays as it is then.
    pub fn estimate_into(
        &mut self,
        eyes: &Binocular<impl Borrow<LumaImage>>,
        field: &mut DisparityField,
    ) -> Result<(), Mismatch> {
        let mut pair = self.see(eyes)?;
        let (params, scales) = (pair.matcher.params, pair.held_scales());
        pair.search(&params, scales, field)
    }

    /// The vector disparity of a pair of whose range little is known, as
    /// [`estimate_near_first`](crate::estimate_near_first) finds it in the responses of this bank, bit for
    /// bit; written over what an earlier pair gave. Where six scales from
    /// [`MatchParams::zero_disparity_px`] are enough, nothing large is allocated.
    ///
    /// # Errors
    /// [`Mismatch`] if an image has another size; what was found stays as it is then.
    pub fn estimate_near_first_into(
        &mut self,
        eyes: &Binocular<impl Borrow<LumaImage>>,
        found: &mut FromVotes,
    ) -> Result<(), Mismatch> {
        let params = self.params;
        search_near_first(&mut self.see(eyes)?, params, found)
    }

    /// The vector disparity of a pair of which nothing is known, as
    /// [`estimate_from_votes`](crate::estimate_from_votes) finds it in the responses of this bank, bit
    /// for bit; written over what an earlier pair gave. The coarse look allocates what it works in.
    ///
    /// # Errors
    /// [`Mismatch`] if an image has another size; what was found stays as it is then.
    pub fn estimate_from_votes_into(
        &mut self,
        eyes: &Binocular<impl Borrow<LumaImage>>,
        found: &mut FromVotes,
    ) -> Result<(), Mismatch> {
        let params = self.params;
        search_from_votes(&mut self.see(eyes)?, params, found)
    }

    /// Takes in what both eyes say, by rows that of the coarser scales only.
    fn see<'a>(
        &'a mut self,
        eyes: &'a Binocular<impl Borrow<LumaImage>>,
    ) -> Result<SeenPair<'a>, Mismatch> {
        let images = eyes.as_ref().map(Borrow::borrow);
        for eye in [images.left, images.right] {
            if eye.size() != self.size() {
                let (planned, given) = (self.size(), eye.size());
                return Err(WrongSize { planned, given }.into());
            }
        }
        let Self {
            bank,
            bank_workspace,
            responses,
            ..
        } = self;
        let Binocular { left, right } = responses;
        for (eye, responses) in [(images.left, left), (images.right, right)] {
            if self.by_rows {
                bank.respond_coarser_into(eye, bank_workspace, responses)?;
            } else {
                bank.respond_into(eye, bank_workspace, responses)?;
            }
        }
        Ok(SeenPair {
            matcher: self,
            images,
        })
    }
}

/// A pair that a matcher has taken in.
struct SeenPair<'a> {
    matcher: &'a mut VectorMatcher,
    images: Binocular<&'a LumaImage>,
}

impl PairSearch for SeenPair<'_> {
    fn held_scales(&self) -> usize {
        self.matcher.scales()
    }

    fn votes(&mut self) -> Option<CoarseVotes> {
        let VectorMatcher {
            bank,
            by_rows,
            responses,
            ..
        } = &*self.matcher;
        let Size { width, height } = bank.size();
        if !by_rows {
            return CoarseVotes::count(responses);
        }
        if width.max(height) > LONGEST_SIDE {
            return CoarseVotes::count_coarser(responses, 1);
        }
        // The finest scale of so small an image is the one that is searched.
        let held = self.images.try_map(|eye| bank.respond(eye)).ok()?;
        CoarseVotes::count(&held)
    }

    fn search(
        &mut self,
        params: &MatchParams,
        scales: usize,
        field: &mut DisparityField,
    ) -> Result<(), Mismatch> {
        if self.matcher.by_rows && scales > 1 {
            self.walk(params, scales, field);
            return Ok(());
        }
        if self.matcher.by_rows {
            // The way back begins at the finest scale then, whose responses are needed twice.
            let bank = &self.matcher.bank;
            let held = self.images.try_map(|eye| bank.respond(eye))?;
            let room = (&mut self.matcher.workspace, field);
            return estimate_scales_into(&held, *params, scales, room);
        }
        let VectorMatcher {
            responses,
            workspace,
            ..
        } = &mut *self.matcher;
        estimate_scales_into(responses, *params, scales, (workspace, field))
    }
}

impl SeenPair<'_> {
    /// From the coarser responses to the field, the finest ones as they are needed.
    fn walk(&mut self, params: &MatchParams, scales: usize, field: &mut DisparityField) {
        let images = self.images;
        let VectorMatcher {
            bank,
            waves,
            responses,
            workspace,
            bands,
            ..
        } = &mut *self.matcher;
        let finer = |size: &Size| Some(size.halved());
        let sizes = std::iter::successors(Some(bank.size()), finer).take(scales);
        let grids = Grid::of_scales(sizes, params);
        let warp = |from: &V1Responses,
                    to: &V1Responses,
                    scale: usize,
                    shifts: &mut Shifts,
                    dy: Option<&Array2<f32>>| {
            let eyes = Eyes {
                left: &from.scales()[scale - 1],
                right: &to.scales()[scale - 1],
                waves,
                step: grids[scale].step,
            };
            refine(&eyes, shifts, dy, params);
        };
        let (left, right) = (&responses.left, &responses.right);
        let there = |scale: usize, shifts: &mut Shifts, dy: Option<&Array2<f32>>| {
            if scale > 0 {
                return warp(left, right, scale, shifts, dy);
            }
            let eyes = RowEyes {
                bank,
                images,
                waves,
                step: grids[0].step,
            };
            refine_rows(&eyes, shifts, params, bands);
        };
        both_ways(
            (workspace, field),
            params,
            (bank.size(), &grids),
            Some(bank.params()),
            there,
            |scale, shifts, dy| warp(right, left, scale, shifts, dy),
        );
    }
}
