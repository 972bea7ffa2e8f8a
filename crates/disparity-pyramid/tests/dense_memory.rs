//! How much memory the dense estimator takes.
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use disparity_pyramid::{DenseMatcher, DenseParams, EyeView, SearchRange};
use ndarray::Array2;
use v1_gabor::{Binocular, LumaImage, Size};

/// The system's allocator, counting what is taken and the most that ever was.
struct Counting;

static TAKEN: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

#[expect(unsafe_code, reason = "a global allocator is an unsafe trait")]
// SAFETY: every call is handed to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let taken = TAKEN.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        MOST.fetch_max(taken, Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        TAKEN.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// With 128 shifts: at 1024 x 768 at most 110 bytes a pixel for `fast` and 330 for `best`, the
/// answer included. Two thirds of that size, as a test should be quick, and a little less room, as
/// rows are padded by the search.
#[test]
fn memory_is_bounded() {
    let size = Size {
        width: 683,
        height: 512,
    };
    let see = |shift: usize| {
        let luma = |(y, x): (usize, usize)| {
            let (x, y) = ((x + shift + y / 9) as u64, y as u64);
            let hash = (x ^ y << 20).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            (hash >> 40) as f32 / (1u64 << 24) as f32
        };
        LumaImage::new(Array2::from_shape_fn(size.dim(), luma)).expect("finite samples")
    };
    let eyes = Binocular {
        left: see(0),
        right: see(40),
    };
    let views = eyes.as_ref().map(EyeView::grey);
    let search = SearchRange::new(-127, 0).expect("a range");
    for (name, params, most) in [
        ("fast", DenseParams::fast(), 110.0),
        ("best", DenseParams::best(), 330.0),
    ] {
        let matcher = DenseMatcher::plan(params, size).expect("a plan");
        let before = TAKEN.load(Ordering::Relaxed);
        MOST.store(before, Ordering::Relaxed);
        let field = matcher.estimate(&views, search).expect("a field");
        let taken = MOST.load(Ordering::Relaxed) - before;
        let bytes = taken as f64 / size.area() as f64;
        assert!(bytes <= most, "{name} took {bytes:.1} bytes a pixel");
        drop(field);
    }
}
