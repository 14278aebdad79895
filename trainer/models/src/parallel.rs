//! Parallel work on all threads, with results in order.

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::sync::{LazyLock, Mutex, PoisonError};

/// Stack size of a thread in bytes; the passes through a wide network hand large values to each other on the stack.
const STACK: usize = 16 << 20;

/// Maximum useful number of threads per processor: more threads would only wait and wake up without work.
const FOR_EACH_PROCESSOR: usize = 4;

/// Thread pool with as many threads as processors, or as many as RAYON_NUM_THREADS says; `None` if it cannot be created.
static THREADS: LazyLock<Option<ThreadPool>> = LazyLock::new(|| threads(0).ok());

/// Creates a pool of `count` threads with a stack for wide networks, but at most four per processor; 0 means one per processor, or as many
/// as RAYON_NUM_THREADS says.
///
/// # Errors
/// An error if the threads cannot be created.
pub fn threads(count: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    ThreadPoolBuilder::new().num_threads(useful(count)).stack_size(STACK).build()
}

fn useful(count: usize) -> usize {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let named = || std::env::var("RAYON_NUM_THREADS").ok()?.parse().ok().filter(|count| *count > 0);
    let wanted = if count > 0 { count } else { named().unwrap_or(processors) };
    wanted.min(FOR_EACH_PROCESSOR * processors)
}

/// Runs `work` in the common thread pool; a call from within a pool stays in that pool.
pub fn within<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match (rayon::current_thread_index(), THREADS.as_ref()) {
        (None, Some(threads)) => threads.install(work),
        _ => work(),
    }
}

/// Returns the results of `work` for 0, 1, … `count` − 1, computed in the common thread pool; a call from within a pool stays in that pool.
///
/// `work` is passed by reference: the loops of a thread pool are large, and otherwise every model of every size would compile its own copy.
pub fn map<T: Send>(count: usize, work: &(dyn Fn(usize) -> T + Sync)) -> Vec<T> {
    within(|| (0..count).into_par_iter().map(work).collect())
}

/// Workspaces that threads take in turn; there are as many as are in use at the same time.
pub struct Pool<T> {
    make: Box<dyn Fn() -> T + Send + Sync>,
    free: Mutex<Vec<T>>,
}

impl<T> Pool<T> {
    /// Creates a pool of workspaces made by `make`.
    pub fn new(make: impl Fn() -> T + Send + Sync + 'static) -> Self {
        Self { make: Box::new(make), free: Mutex::new(Vec::new()) }
    }

    /// Calls `work` with a workspace that no other thread uses at the same time. Its previous content must not matter.
    pub fn with<U>(&self, work: impl FnOnce(&mut T) -> U) -> U {
        let free = || self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let taken = free().pop();
        let mut own = taken.unwrap_or_else(&self.make);
        let result = work(&mut own);
        free().push(own);
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_threads_than_are_of_use_are_not_made() {
        let processors = std::thread::available_parallelism().unwrap().get();
        assert_eq!(threads(100_000).unwrap().current_num_threads(), FOR_EACH_PROCESSOR * processors);
        assert_eq!(threads(1).unwrap().current_num_threads(), 1);
    }
}
