use ndarray::Array2;
use v1_gabor::{Binocular, LumaImage};

use crate::Validity;
use crate::dense::aggregate::PathRoom;
use crate::dense::bank_rows::BankRows;
use crate::dense::cross_arms::CrossArms;
use crate::dense::fill::FillRoom;
use crate::dense::guide::Guide;
use crate::dense::heard_responses::AcuityRoom;
use crate::dense::local_range::LocalRange;
use crate::dense::look_back::RowRoom;
use crate::dense::neighbour_planes::NeighbourPlanes;
use crate::dense::phase_agreement::{PhaseAgreement, PictureRows};
use crate::dense::phase_quadrants::PhaseQuadrants;
use crate::dense::search_windows::SearchWindows;
use crate::dense::voting::VoteRoom;
use crate::median::KnownMedian;
use crate::speckles::Patches;

/// Buffers that [`DenseMatcher::estimate_into`](crate::DenseMatcher::estimate_into) works in, kept from
/// one pair to the next: once they have grown, [`DenseParams::fast`](crate::DenseParams::fast) allocates
/// nothing large for the next pair of that size and range. (Where a coarse look narrows the search, a
/// pair that needs a wider one somewhere makes them grow once more, and so do more holes.)
///
/// What they hold between two pairs means nothing; a workspace may go from one matcher to another.
#[derive(Clone, Debug, Default)]
pub struct DenseWorkspace {
    /// The look at a quarter of the size, if it narrows the search.
    pub(crate) coarse: Option<Box<CoarseLook>>,
    pub(crate) guides: Binocular<Guide>,
    pub(crate) windows: SearchWindows,
    /// One of the two costs is asked.
    pub(crate) agreement: PhaseAgreement,
    pub(crate) quadrants: PhaseQuadrants,
    pub(crate) bank_rows: Vec<BankRows>,
    pub(crate) picture_rows: Vec<PictureRows>,
    pub(crate) paths: PathRoom,
    pub(crate) margin: Array2<u8>,
    pub(crate) other_dx: Array2<f32>,
    pub(crate) look_back: Vec<RowRoom>,
    pub(crate) patches: Patches,
    pub(crate) known: Array2<bool>,
    pub(crate) arms: CrossArms,
    pub(crate) votes: VoteRoom,
    pub(crate) fill: FillRoom,
    pub(crate) median: KnownMedian,
    pub(crate) ranges: LocalRange,
    pub(crate) acuity: Vec<AcuityRoom>,
    pub(crate) coherence: Array2<f32>,
    pub(crate) planes: NeighbourPlanes,
    pub(crate) moved: Array2<f32>,
}

/// A look at a quarter of the size: what it works in and what it finds.
#[derive(Clone, Debug, Default)]
pub(crate) struct CoarseLook {
    /// Both eyes at half the size, and at a quarter.
    pub(crate) images: Option<[Binocular<LumaImage>; 2]>,
    pub(crate) workspace: DenseWorkspace,
    pub(crate) dx: Array2<f32>,
    pub(crate) validity: Array2<Validity>,
}

impl DenseWorkspace {
    /// Buffers that have not grown yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }
}
