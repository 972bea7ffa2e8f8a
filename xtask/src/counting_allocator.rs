use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Allocations larger than this, a page, count as large.
pub(crate) const LARGE: usize = 4096;

static HELD: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);
static LARGE_ONES: AtomicUsize = AtomicUsize::new(0);

/// The system's allocator, which also tells what the process has asked for.
pub(crate) struct CountingAllocator;

impl CountingAllocator {
    /// Begins to count anew, and gives the bytes that are held.
    pub(crate) fn begin() -> usize {
        let held = HELD.load(Ordering::Relaxed);
        MOST.store(held, Ordering::Relaxed);
        LARGE_ONES.store(0, Ordering::Relaxed);
        held
    }

    /// The most bytes that were held at once since counting began.
    pub(crate) fn most() -> usize {
        MOST.load(Ordering::Relaxed)
    }

    /// Allocations of more than [`LARGE`] bytes since counting began.
    pub(crate) fn large_ones() -> usize {
        LARGE_ONES.load(Ordering::Relaxed)
    }

    fn took(bytes: usize) {
        let held = HELD.fetch_add(bytes, Ordering::Relaxed) + bytes;
        // Small ones are many, and hardly move the most.
        if bytes > LARGE {
            LARGE_ONES.fetch_add(1, Ordering::Relaxed);
        }
        if held > MOST.load(Ordering::Relaxed) {
            MOST.fetch_max(held, Ordering::Relaxed);
        }
    }

    fn gave(bytes: usize) {
        HELD.fetch_sub(bytes, Ordering::Relaxed);
    }
}

#[expect(unsafe_code, reason = "a global allocator is an unsafe trait")]
// SAFETY: every call is handed to the system's allocator unchanged.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        Self::took(layout.size());
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        Self::gave(layout.size());
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        Self::took(layout.size());
        // SAFETY: as above.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // While bytes are moved both places may be held; the system's allocator often moves pages
        // instead, so only what is held after it counts.
        Self::gave(layout.size());
        Self::took(size);
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}
