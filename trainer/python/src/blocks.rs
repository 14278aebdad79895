//! Computation of rows in blocks of a fixed size: the result has the same bits on any number of threads.

use leastaction_models::parallel;
use rayon::prelude::*;
use std::sync::LazyLock;

/// Number of rows per block in single precision.
pub const BLOCK: usize = 128;

/// Number of threads for the work within one call.
static THREADS: LazyLock<usize> = LazyLock::new(|| parallel::within(rayon::current_num_threads));

/// Writes rows of `width` numbers block by block; `work` gets the index of a block's first row and the block's slice.
///
/// A single block, or a process with one thread, is computed on the caller's thread, so that Python threads do not wait
/// for each other.
///
/// # Errors
/// The error of the first block that fails.
pub fn fill<T: Send + Sync, E: Send>(
    (to, width, block): (&mut [T], usize, usize),
    work: impl Fn(usize, &mut [T]) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let size = width * block;
    if size == 0 {
        return Ok(());
    }
    if to.len() <= size || *THREADS == 1 {
        return to.chunks_mut(size).enumerate().try_for_each(|(k, rows)| work(k * block, rows));
    }
    let blocks = |to: &mut [T]| -> Vec<Result<(), E>> {
        to.par_chunks_mut(size).enumerate().map(|(k, rows)| work(k * block, rows)).collect()
    };
    parallel::within(|| blocks(to)).into_iter().collect()
}
