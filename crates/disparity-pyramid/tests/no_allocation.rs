//! From the second pair on, a matcher allocates nothing large.
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use disparity_pyramid::{
    DisparityField, MatchParams, MatchWorkspace, VectorMatcher, estimate_into,
};
use ndarray::Array2;
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};

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

#[test]
fn a_later_pair_allocates_nothing_large() {
    // A row of a plane is larger than what counts.
    let size = Size {
        width: 1100,
        height: 90,
    };
    let see = |shift: usize| {
        let luma = |(y, x): (usize, usize)| ((x + shift) * (x + shift) * 7 + y * y * 13) % 97;
        let plane = Array2::from_shape_fn(size.dim(), |pixel| luma(pixel) as f32 / 97.0);
        LumaImage::new(plane).unwrap()
    };
    let eyes = Binocular {
        left: see(0),
        right: see(3),
    };
    let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size).unwrap();
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let params = MatchParams::default();
            let mut matcher = VectorMatcher::plan(bank.clone(), params).unwrap();
            let responses = eyes.as_ref().try_map(|eye| bank.respond(eye)).unwrap();
            let mut workspace = MatchWorkspace::new();
            let (mut field, mut other) = (DisparityField::default(), DisparityField::default());
            let mut pair = || {
                let before = COUNT.load(Ordering::Relaxed);
                matcher.estimate_into(&eyes, &mut field).unwrap();
                estimate_into(&responses, params, &mut workspace, &mut other).unwrap();
                COUNT.load(Ordering::Relaxed) - before
            };
            assert!(pair() > 0);
            for _ in 0..3 {
                assert_eq!(pair(), 0, "{threads} threads");
            }
        });
    }
}
