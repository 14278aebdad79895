use super::follow::check_plan;
use crate::Program;
use crate::error::{SetupError, require};
use leastaction_core::plan::Plan;

/// Largest number of plans that decisions choose from.
pub const MAX_PLANS: usize = 8;

/// Plans that decisions choose from, in place in flash.
pub type Plans<'p, const N: usize> = heapless::Vec<Plan<'p, N, N>, MAX_PLANS>;

/// Collects plans.
///
/// # Errors
/// The first of the items' errors; [`SetupError::OutOfRange`] for more than [`MAX_PLANS`].
pub(crate) fn collected<'p, E: From<SetupError>, const N: usize>(
    items: impl Iterator<Item = Result<Plan<'p, N, N>, E>>,
) -> Result<Plans<'p, N>, E> {
    let mut plans = Plans::new();
    for (place, item) in items.enumerate() {
        let full = plans.push(item?).is_err();
        require("number of plans", (place + 1) as f32, !full, "at most 8")?;
    }
    Ok(plans)
}

/// Checks that there are plans, each with the tick and the angles of a program.
pub(super) fn check_plans<const N: usize>(
    plans: &[Plan<N, N>],
    program: &Program<N>,
) -> Result<(), SetupError> {
    if plans.is_empty() {
        return Err(SetupError::NoPlan);
    }
    plans.iter().try_for_each(|plan| check_plan(plan, program))
}
