//! From the second frame on, a planned bank allocates nothing large.
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use ndarray::Array2;
use v1_gabor::{FilterBank, GaborParams, LumaImage, Size, SteerableParams};

/// The system's allocator, counting what is larger than a thread pool's own bookkeeping.
struct Counting;

/// Bytes above which an allocation counts: less than a row of the image below or of its next two scales, and
/// more than what a thread pool keeps its accounts in, which now and then is two kilobytes.
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
fn a_later_frame_allocates_nothing_large() {
    let size = Size {
        width: 4400,
        height: 60,
    };
    let image = LumaImage::new(Array2::from_elem(size.dim(), 0.5)).unwrap();
    let banks = [
        FilterBank::plan(GaborParams::default().fitted_to(size), size).unwrap(),
        FilterBank::plan(SteerableParams::default().fitted_to(size), size).unwrap(),
    ];
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            for bank in &banks {
                let mut workspace = bank.workspace();
                let mut responses = bank.silence();
                let mut frame = || {
                    let before = COUNT.load(Ordering::Relaxed);
                    bank.respond_into(&image, &mut workspace, &mut responses)
                        .unwrap();
                    COUNT.load(Ordering::Relaxed) - before
                };
                frame();
                for _ in 0..3 {
                    assert_eq!(frame(), 0, "{threads} threads");
                }
            }
        });
    }
}
