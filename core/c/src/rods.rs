use crate::arguments::{Given, call, check_length, started};
use crate::config::LEASTACTION_RODS;
use crate::error::Error;
use crate::status::Status;
use crate::storage::State;

/// Writes the force λ in every rod, N, as the mean over the last step; a positive force pushes the ends apart. `n` = LEASTACTION_RODS
/// numbers in the order of the file, with zeros for rods that the graph does not have, and after leastaction_start. Fails with statuses 1,
/// 2, 3 and 5.
///
/// # Safety
/// Pointers are NULL or point to values of their type, arrays to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "state_lambda"))]
pub unsafe extern "C" fn leastaction_state_lambda(
    state: *const State,
    n: usize,
    lambda: *mut f32,
    error: *mut Error,
) -> Status {
    let read = || {
        // SAFETY: the caller's promise.
        let started = unsafe { started(state, 1) }?;
        check_length(LEASTACTION_RODS, n)?;
        let out = Given::new(lambda.cast::<[f32; LEASTACTION_RODS]>(), 3)?;
        // SAFETY: the caller's promise.
        unsafe { out.write(started.state.lambda()) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, read) }
}
