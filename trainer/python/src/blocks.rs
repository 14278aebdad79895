//! Rows that are computed in blocks of a fixed size: the threads that take them change no bit.

use leastaction_models::parallel;
use rayon::prelude::*;
use std::sync::LazyLock;

/// Rows of a block in single precision.
pub const BLOCK: usize = 128;

/// Threads of the process for work inside of one call.
static THREADS: LazyLock<usize> = LazyLock::new(|| parallel::within(rayon::current_num_threads));

/// Writes rows of `width` numbers block by block; `work` gets the number of the first row of a block and its place. The first block
/// that fails says why.
///
/// One block, or a process of one thread, stays on the caller's thread: threads of Python then do not wait for each other.
///
/// # Errors
/// That of the first block that has one.
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
