//! From the second pair on, the dense estimator for robots allocates nothing large, and says what it
//! says without a workspace.
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use disparity_pyramid::{
    DenseMatcher, DenseParams, DenseWorkspace, DisparityField, EyeView, SearchRange,
};
use ndarray::Array2;
use v1_gabor::{Binocular, LumaImage, Size};

/// The system's allocator, counting what is larger than a page.
struct Counting;

const LARGE: usize = 4096;

static COUNT: AtomicUsize = AtomicUsize::new(0);

#[expect(unsafe_code, reason = "a global allocator is an unsafe trait")]
// SAFETY: every call is handed to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if layout.size() > LARGE {
            COUNT.fetch_add(1, Ordering::Relaxed);
        }
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Dots, moved by a shift that differs from one half of the image to the other.
fn pair(size: Size, near: usize) -> Binocular<LumaImage> {
    let see = |eye: usize| {
        let luma = |(y, x): (usize, usize)| {
            let shift = if 2 * x < size.width { 5 } else { near };
            let (x, y) = ((x + eye * shift + y / 9) as u64, y as u64);
            let hash = (x ^ y << 20).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            (hash >> 40) as f32 / (1u64 << 24) as f32
        };
        LumaImage::new(Array2::from_shape_fn(size.dim(), luma)).expect("finite samples")
    };
    Binocular {
        left: see(0),
        right: see(1),
    }
}

#[test]
fn a_later_pair_allocates_nothing_large() {
    // A row of a plane is larger than what counts.
    let size = Size {
        width: 1100,
        height: 90,
    };
    let eyes = pair(size, 20);
    let views = eyes.as_ref().map(EyeView::grey);
    let search = SearchRange::new(-40, 0).expect("a range");
    for params in [
        DenseParams::fast(),
        DenseParams {
            narrow_px: None,
            ..DenseParams::fast()
        },
    ] {
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            pool.install(|| {
                let matcher = DenseMatcher::plan(params, size).expect("a plan");
                let (mut workspace, mut field) = (DenseWorkspace::new(), DisparityField::default());
                let mut look = || {
                    let before = COUNT.load(Ordering::Relaxed);
                    matcher
                        .estimate_into(&views, search, &mut workspace, &mut field)
                        .expect("a field");
                    COUNT.load(Ordering::Relaxed) - before
                };
                assert!(look() > 0);
                for _ in 0..3 {
                    assert_eq!(look(), 0, "{threads} threads");
                }
                let alone = matcher.estimate(&views, search).expect("a field");
                assert!(alone == field, "{threads} threads");
            });
        }
    }
}
