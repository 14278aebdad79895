//! Work on all threads, in order.

use rayon::prelude::*;

/// What `work` makes of 0, 1, … `count` − 1, on as many threads as there are.
///
/// A call by reference: a thread pool's loops are large, and every model of every size would otherwise bring its own to
/// compile.
pub fn map<T: Send>(count: usize, work: &(dyn Fn(usize) -> T + Sync)) -> Vec<T> {
    (0..count).into_par_iter().map(work).collect()
}
