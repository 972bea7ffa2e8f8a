use std::sync::{Mutex, PoisonError};

/// Planes of pictures that were looked at, for the next ones.
static STORE: Mutex<Vec<Vec<f32>>> = Mutex::new(Vec::new());

/// How many are kept: those of one look. A second look at the same time gets planes of its own.
const MOST_KEPT: usize = 2;

/// A plane of so many samples; what is in it is left over from another picture.
///
/// Memory that the system gives anew costs a fault for every page, which for a megapixel is as much as reading it.
pub(crate) fn plane_of(samples: usize) -> Vec<f32> {
    let mut store = STORE.lock().unwrap_or_else(PoisonError::into_inner);
    let found = store.iter().position(|plane| plane.len() == samples);
    let plane = found.map(|at| store.swap_remove(at));
    drop(store);
    plane.unwrap_or_else(|| vec![0.0; samples])
}

/// Keeps a plane for the next picture of its size, in place of the one that was kept longest.
pub(crate) fn keep(plane: Vec<f32>) {
    let mut store = STORE.lock().unwrap_or_else(PoisonError::into_inner);
    if store.len() == MOST_KEPT {
        store.remove(0);
    }
    store.push(plane);
}
