use ndarray::Array2;

use crate::Size;
use crate::samples::Samples;
use crate::strip_kernel::{StripKernel, StripWorkspace};

/// The buffers that a [`FilterBank`](crate::FilterBank) works in, planned once and used for any
/// number of images: the coarser images of the pyramid, and for each band of rows that a thread
/// takes the few rows it keeps in its cache.
///
/// It holds nothing that matters from one image to the next.
#[derive(Clone, Debug)]
pub struct BankWorkspace {
    /// The pyramid without the image itself, finer ones first.
    pub(crate) coarser: Vec<Array2<f32>>,
    pub(crate) bands: Vec<BandWorkspace>,
    /// One row of responses, for those who want them row by row; empty until then.
    pub(crate) responses: Samples,
    /// [`StripKernel::shape`] of the kernel that the bands were planned for.
    kernel: (usize, usize, usize),
    /// Size of the image.
    finest: Size,
}

/// What one band of rows needs.
#[derive(Clone, Debug)]
pub(crate) struct BandWorkspace {
    pub(crate) strips: StripWorkspace,
}

/// Bands for each thread, so that a thread that is held up leaves work to the others.
const BANDS_A_THREAD: usize = 4;

impl BankWorkspace {
    /// Buffers for images of these sizes, finest first, and for the threads of the current pool.
    pub(crate) fn new(mut sizes: impl Iterator<Item = Size>, kernel: &StripKernel) -> Self {
        let finest = sizes.next().unwrap_or(Size {
            width: 0,
            height: 0,
        });
        let bands = match rayon::current_num_threads() {
            1 => 1,
            threads => BANDS_A_THREAD * threads,
        };
        let band = BandWorkspace {
            strips: kernel.workspace(),
        };
        Self {
            coarser: sizes.map(|size| Array2::zeros(size.dim())).collect(),
            bands: vec![band; bands],
            responses: Samples::zeros(0),
            kernel: kernel.shape(),
            finest,
        }
    }

    /// Whether these buffers are of the right sizes.
    pub(crate) fn fits(&self, mut sizes: impl Iterator<Item = Size>, kernel: &StripKernel) -> bool {
        let coarser = self.coarser.iter().map(|plane| Size::of_dim(plane.dim()));
        sizes.next() == Some(self.finest) && sizes.eq(coarser) && self.kernel == kernel.shape()
    }
}
