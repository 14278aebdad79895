//! Work on all threads, in order.

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::sync::{LazyLock, Mutex, PoisonError};

/// Bytes of a thread's stack: what passes through a wide network leave for each other lies there.
const STACK: usize = 16 << 20;

/// Threads for each processor that are of any use: what is beyond them only waits, and wakes for nothing.
const FOR_EACH_PROCESSOR: usize = 4;

/// As many threads as there are processors, or as RAYON_NUM_THREADS says; none where they cannot be had.
static THREADS: LazyLock<Option<ThreadPool>> = LazyLock::new(|| threads(0).ok());

/// So many threads with workspace for wide networks, but at most four for each processor; 0: as many as there are processors, or as
/// RAYON_NUM_THREADS says.
///
/// # Errors
/// Where they cannot be had.
pub fn threads(count: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    ThreadPoolBuilder::new().num_threads(useful(count)).stack_size(STACK).build()
}

fn useful(count: usize) -> usize {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let named = || std::env::var("RAYON_NUM_THREADS").ok()?.parse().ok().filter(|count| *count > 0);
    let wanted = if count > 0 { count } else { named().unwrap_or(processors) };
    wanted.min(FOR_EACH_PROCESSOR * processors)
}

/// Does something on as many threads as there are; within a pool on those of the pool.
pub fn within<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match (rayon::current_thread_index(), THREADS.as_ref()) {
        (None, Some(threads)) => threads.install(work),
        _ => work(),
    }
}

/// What `work` makes of 0, 1, … `count` − 1, on as many threads as there are; within a pool on those of the pool.
///
/// A call by reference: a thread pool's loops are large, and every model of every size would otherwise bring its own to
/// compile.
pub fn map<T: Send>(count: usize, work: &(dyn Fn(usize) -> T + Sync)) -> Vec<T> {
    within(|| (0..count).into_par_iter().map(work).collect())
}

/// Workspaces that threads take turns with: as many are made as are in use at once.
pub struct Pool<T> {
    make: Box<dyn Fn() -> T + Send + Sync>,
    free: Mutex<Vec<T>>,
}

impl<T> Pool<T> {
    /// Of what `make` makes.
    pub fn new(make: impl Fn() -> T + Send + Sync + 'static) -> Self {
        Self { make: Box::new(make), free: Mutex::new(Vec::new()) }
    }

    /// What `work` makes of a workspace that nobody else has meanwhile. Its content must not matter.
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
