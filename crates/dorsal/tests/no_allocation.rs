//! From the second look on, the whole way from what two eyes see to relations allocates nothing large.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use dorsal::disparity_pyramid::{DenseParams, MatchParams, SearchRange};
use dorsal::v1_gabor::Size;
use dorsal::{DenseLook, Estimator, Percept, Range, Rows, Search};

mod rendered_look;
use rendered_look::Frame;

/// The system's allocator, counting what is larger than a page.
struct Counting;

const LARGE: usize = 4096;

static COUNT: AtomicUsize = AtomicUsize::new(0);
static LARGEST: AtomicUsize = AtomicUsize::new(0);

#[expect(unsafe_code, reason = "a global allocator is an unsafe trait")]
// SAFETY: every call is handed to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if layout.size() > LARGE {
            COUNT.fetch_add(1, Ordering::Relaxed);
            LARGEST.fetch_max(layout.size(), Ordering::Relaxed);
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
fn a_later_look_allocates_nothing_large() {
    // A row of a plane is larger than what counts.
    let size = Size {
        width: 1100,
        height: 400,
    };
    let parallel = Frame::parallel(size, 0.06);
    let verged = Frame::verged(size, 0.0);
    let dense = |rows, search| {
        Estimator::Dense(DenseLook {
            params: DenseParams::fast(),
            search,
            rows,
        })
    };
    let found = Search::Found { most_dx: None };
    let given = Search::Given(SearchRange::new(-80, 60).unwrap());
    let (vector, plain) = (Estimator::Vector(Range::Given), MatchParams::default());
    for (what, frame, estimator, matching) in [
        ("vector", &verged, vector, plain),
        ("objects", &verged, vector, MatchParams::for_objects()),
        ("whole", &parallel, dense(Rows::AsTaken, found), plain),
        (
            "whole, rectified",
            &verged,
            dense(Rows::Rectified, found),
            plain,
        ),
        ("dense alone", &parallel, dense(Rows::AsTaken, given), plain),
    ] {
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| {
                let mut dorsal = frame.dorsal(estimator, matching);
                let mut percept = Percept::default();
                let mut look = || {
                    let before = COUNT.load(Ordering::Relaxed);
                    LARGEST.store(0, Ordering::Relaxed);
                    dorsal
                        .look_into(&frame.eyes, &frame.labels, &frame.names, &mut percept)
                        .unwrap();
                    COUNT.load(Ordering::Relaxed) - before
                };
                assert!(look() > 0);
                for _ in 0..3 {
                    let count = look();
                    let largest = LARGEST.load(Ordering::Relaxed);
                    assert_eq!(count, 0, "{what}, {threads} threads: up to {largest} bytes");
                }
                assert!(!percept.egocentric.objects.is_empty(), "{what}");
            });
        }
    }
}
