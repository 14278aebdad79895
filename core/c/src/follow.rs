//! A plan's motion, and the law that follows it.

use crate::arguments::{Given, Vector, call, check_length, finite, output, planned, vectors};
use crate::config::LEASTACTION_COORDINATES as N;
use crate::contents::CorePlan;
use crate::error::Error;
use crate::status::Status;
use crate::storage::Plan;
use leastaction_core::plan::{CommandError, Reference};

/// Writes the plan at a tick: position q̄, velocity v̄ and command ū. A node begins with its record; within it the motion is the cubic
/// polynomial through its ends, and the command is held. From the end on the plan is its last record, whose command holds the goal.
///
/// - `tick`: number of ticks of the plan's h since the start.
/// - `n`: LEASTACTION_COORDINATES.
/// - `q` (m or rad), `v` (m/s or rad/s), `u` (N or N m; 0 where nothing drives): `n` numbers each, written on success only.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 3, 14, and 71 if single precision does not hold the motion.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "plan_reference"))]
pub unsafe extern "C" fn leastaction_plan_reference(
    plan: *const Plan,
    tick: u32,
    n: usize,
    q: *mut f32,
    v: *mut f32,
    u: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(error, || reference(plan, |plan| Ok(plan.reference(tick)), n, [q, v, u])) }
}

/// Writes the plan like leastaction_plan_reference, at the time t after the start, s, on ticks and between them; before the start it is the
/// first record. A time that is short of a node by no more than the rounding of a product of ticks and h counts as that node. Fails also if t
/// is not finite, with status 71.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "plan_reference_at"))]
pub unsafe extern "C" fn leastaction_plan_reference_at(
    plan: *const Plan,
    t: f32,
    n: usize,
    q: *mut f32,
    v: *mut f32,
    u: *mut f32,
    error: *mut Error,
) -> Status {
    let at = |plan: &CorePlan| finite([t]).map(|[t]| plan.reference_at(t));
    // SAFETY: the caller's promise.
    unsafe { call(error, || reference(plan, at, n, [q, v, u])) }
}

/// # Safety
/// See the functions that call it.
unsafe fn reference(
    plan: *const Plan,
    at: impl FnOnce(&CorePlan) -> Result<Reference<N, N>, Error>,
    n: usize,
    [q, v, u]: [*mut f32; 3],
) -> Result<(), Error> {
    // SAFETY: this function's promise.
    let plan = unsafe { planned(plan) }?;
    check_length(N, n)?;
    let out = [output(q, 4)?, output(v, 5)?, output(u, 6)?];
    let reference = at(plan)?;
    // SAFETY: this function's promise.
    unsafe { write(&out, [reference.q, reference.v, plan.spread(&reference.u)]) }
}

/// Writes vectors, if all their numbers are finite.
///
/// # Safety
/// All can be written to.
unsafe fn write(out: &[Given<Vector>; 3], vectors: [Vector; 3]) -> Result<(), Error> {
    vectors.iter().try_for_each(|vector| finite(*vector).map(drop))?;
    for (out, vector) in out.iter().zip(vectors) {
        // SAFETY: this function's promise.
        unsafe { out.write(vector) };
    }
    Ok(())
}

/// Writes planned position q̄, velocity v̄ and acceleration ā at the time t after the start, s, on ticks and between them. Before the start
/// and from the end on they are those of the first and of the last record, without acceleration.
///
/// - `n`: LEASTACTION_COORDINATES.
/// - `q` (m or rad), `v` (m/s or rad/s), `a` (m/s² or rad/s²): `n` numbers each, written on success only.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 3, 14, and 71 if t is not finite or single precision does not hold the motion.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "plan_motion"))]
pub unsafe extern "C" fn leastaction_plan_motion(
    plan: *const Plan,
    t: f32,
    n: usize,
    q: *mut f32,
    v: *mut f32,
    a: *mut f32,
    error: *mut Error,
) -> Status {
    let read = || {
        // SAFETY: the caller's promise.
        let plan = unsafe { planned(plan) }?;
        check_length(N, n)?;
        let (out, [t]) = ([output(q, 4)?, output(v, 5)?, output(a, 6)?], finite([t])?);
        // SAFETY: the caller's promise.
        unsafe { write(&out, plan.motion(t)) }
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, read) }
}

/// Writes the command for a measured state at a tick: u = ū − K (x − x̄), x = (q, v), within the plan's limits. Differences of the angles that
/// the plan marks are taken the short way, in [−π, π]. From the end on the last record is held, by its gains. Ticks are the plan's h, counted
/// from the first command; a missed one counts. A command is that of the model's actuator (leastaction_actuate), without one a force.
///
/// - `q` (m or rad), `v` (m/s or rad/s): the state when the command takes effect, `n` numbers each.
/// - `n`: LEASTACTION_COORDINATES.
/// - `u`: the command (N or N m; 0 where nothing drives), `n` numbers, written on success only; may be one of the arrays before it.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 3, 14, 71 and 75.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "plan_command"))]
pub unsafe extern "C" fn leastaction_plan_command(
    plan: *const Plan,
    tick: u32,
    q: *const f32,
    v: *const f32,
    n: usize,
    u: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(error, || command(plan, |plan, q, v| plan.force(tick, q, v), [q, v], n, u)) }
}

/// Writes the command like leastaction_plan_command, at the time t after the first command, s, for a loop whose ticks are not the plan's: the
/// plan is that of leastaction_plan_reference_at. Fails also if t is not finite, with status 71.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "plan_command_at"))]
pub unsafe extern "C" fn leastaction_plan_command_at(
    plan: *const Plan,
    t: f32,
    q: *const f32,
    v: *const f32,
    n: usize,
    u: *mut f32,
    error: *mut Error,
) -> Status {
    let at = || {
        let [t] = finite([t])?;
        // SAFETY: the caller's promise.
        unsafe { command(plan, |plan, q, v| plan.force_at(t, q, v), [q, v], n, u) }
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, at) }
}

/// # Safety
/// See the functions that call it.
unsafe fn command(
    plan: *const Plan,
    law: impl FnOnce(&CorePlan, &Vector, &Vector) -> Result<Vector, CommandError>,
    state: [*const f32; 2],
    n: usize,
    u: *mut f32,
) -> Result<(), Error> {
    // SAFETY: this function's promise.
    let (plan, [q, v]) = unsafe { (planned(plan)?, vectors(state, 3, n)?) };
    let out = output(u, 6)?;
    let u = law(plan, &q, &v)?;
    // SAFETY: this function's promise.
    unsafe { out.write(u) };
    Ok(())
}

/// Writes the whole turns by which the first measured position is off the plan's start: `turns`, rad, `n` numbers, 0 where nothing turns over.
/// Encoders forget whole turns, of which the plan knows the right ones: subtract these from every measured position. Not needed for an angle
/// that the plan itself marks, whose differences are taken the short way anyhow, but for one with limits, which the plan takes as a length.
///
/// - `q`: the first measured position (m or rad), `n` numbers.
/// - `angle`: `n` marks, 0 for a coordinate that keeps its measured position, anything else for one whose encoder forgets turns.
/// - `n`: LEASTACTION_COORDINATES.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 3, 14 and 71.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "plan_turns"))]
pub unsafe extern "C" fn leastaction_plan_turns(
    plan: *const Plan,
    q: *const f32,
    angle: *const u8,
    n: usize,
    turns: *mut f32,
    error: *mut Error,
) -> Status {
    let read = || {
        // SAFETY: the caller's promise.
        let (plan, [q]) = unsafe { (planned(plan)?, vectors([q], 2, n)?) };
        let (angle, out) = (Given::new(angle.cast::<[u8; N]>(), 3)?, output(turns, 5)?);
        // SAFETY: the caller's promise.
        let angle = unsafe { angle.read() }.map(|mark| mark != 0);
        let turns = finite(plan.turns(&q, &angle))?;
        // SAFETY: the caller's promise.
        unsafe { out.write(turns) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, read) }
}
