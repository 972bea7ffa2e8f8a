use std::mem;
use std::process;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::refusal::value_error;

/// The threads of this process, with the process that they belong to.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// How many threads each look of this process uses.
///
/// 0 means as many as there are processors. The results are the same bits for any number.
#[pyfunction]
pub(crate) fn set_threads(threads: usize) -> PyResult<()> {
    let pool = pool_of(threads)?;
    let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    forget_if_forked(held.replace((process::id(), pool)));
    Ok(())
}

/// Runs `work` on the threads of this process, without Python's lock.
///
/// A process that was forked, as those of `multiprocessing` may be, has none of its parent's threads and would wait
/// for them for ever: it gets threads of its own.
pub(crate) fn without_the_lock<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let pool = pool()?;
    Ok(py.detach(|| pool.install(work)))
}

fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match &*held {
        Some((process, pool)) if *process == process::id() => Ok(Arc::clone(pool)),
        _ => {
            let pool = pool_of(0)?;
            forget_if_forked(held.replace((process::id(), Arc::clone(&pool))));
            Ok(pool)
        }
    }
}

fn pool_of(threads: usize) -> PyResult<Arc<ThreadPool>> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map(Arc::new).map_err(value_error)
}

/// Dropping a pool tells its threads to end, which those of another process never hear.
fn forget_if_forked(pool: Option<(u32, Arc<ThreadPool>)>) {
    if let Some((process, pool)) = pool
        && process != process::id()
    {
        mem::forget(pool);
    }
}
