use crate::arguments::{call, check_length, check_step, loaded, output, place, started, vectors};
use crate::config::LEASTACTION_COORDINATES;
use crate::contents::{STARTED, Started};
use crate::error::Error;
use crate::motion::{self, CoreState};
use crate::status::Status;
use crate::storage::{Model, State};
use leastaction_core::discrete::{Control, Galerkin, Midpoint, Path};

/// Starts a state at position q (m or rad) and velocity v (m/s or rad/s), `n` = LEASTACTION_COORDINATES numbers each.
/// Rods must have their lengths to within 3e-4 of them; the part of v that would change them is removed at once. `error` is filled in; it
/// may be NULL. Fails with statuses 1 to 4 and 71, with rods also 70 and 72 to 74; the state is then unchanged.
///
/// # Safety
/// Pointers are NULL or point to values of their type, arrays to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "start"))]
pub unsafe extern "C" fn leastaction_start(
    model: *const Model,
    state: *mut State,
    q: *const f32,
    v: *const f32,
    n: usize,
    error: *mut Error,
) -> Status {
    let start = || {
        // SAFETY: the caller's promise.
        let (mechanism, [q, v]) = unsafe { (loaded(model)?, vectors([q, v], 3, n)?) };
        let place = place(state, 2)?;
        let state = motion::start(mechanism, q, v)?;
        // SAFETY: the caller's promise.
        unsafe { place.write(Started { tag: STARTED, state }) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, start) }
}

/// Starts a state at q1 from two positions, h (s) apart, and the control forces u0 and u1 at their times; no velocity is needed. For steps
/// of order 2 of the same h.
///
/// - `q0`, `q1` (m or rad), `u0`, `u1` (N or N m; zeros for none): `n` numbers each.
/// - `n`: LEASTACTION_COORDINATES.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 4, 6 and 70 to 72, with rods also 73 and 74; the state is then unchanged.
///
/// # Safety
/// Pointers are NULL or point to values of their type, arrays to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "start_from_positions2"))]
pub unsafe extern "C" fn leastaction_start_from_positions2(
    model: *const Model,
    state: *mut State,
    h: f32,
    q0: *const f32,
    q1: *const f32,
    u0: *const f32,
    u1: *const f32,
    n: usize,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(error, || between::<Midpoint>(model, state, h, [q0, q1, u0, u1], n)) }
}

/// Starts a state like leastaction_start_from_positions2, for steps of order 4.
///
/// # Safety
/// Pointers are NULL or point to values of their type, arrays to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "start_from_positions4"))]
pub unsafe extern "C" fn leastaction_start_from_positions4(
    model: *const Model,
    state: *mut State,
    h: f32,
    q0: *const f32,
    q1: *const f32,
    u0: *const f32,
    u1: *const f32,
    n: usize,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(error, || between::<Galerkin>(model, state, h, [q0, q1, u0, u1], n)) }
}

/// # Safety
/// See the functions that call it.
unsafe fn between<P: Path>(
    model: *const Model,
    state: *mut State,
    h: f32,
    given: [*const f32; 4],
    n: usize,
) -> Result<(), Error> {
    // SAFETY: this function's promise.
    let (mechanism, [q0, q1, u0, u1]) = unsafe { (loaded(model)?, vectors(given, 4, n)?) };
    let place = place(state, 2)?;
    check_step(h)?;
    let control = Control { start: u0, end: u1 };
    let state = motion::between::<P>(mechanism, h, [&q0, &q1], &control)?;
    // SAFETY: this function's promise.
    unsafe { place.write(Started { tag: STARTED, state }) };
    Ok(())
}

/// Writes the position q, m or rad: `n` = LEASTACTION_COORDINATES numbers. Fails with statuses 1, 2, 3 and 5.
///
/// # Safety
/// Pointers are NULL or point to values of their type, arrays to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "state_q"))]
pub unsafe extern "C" fn leastaction_state_q(
    state: *const State,
    n: usize,
    q: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(error, || read(state, n, q, CoreState::q)) }
}

/// Writes the momentum p, kg m/s or kg m²/s: `n` = LEASTACTION_COORDINATES numbers. Fails with statuses 1, 2, 3 and 5.
///
/// # Safety
/// Pointers are NULL or point to values of their type, arrays to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "state_p"))]
pub unsafe extern "C" fn leastaction_state_p(
    state: *const State,
    n: usize,
    p: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(error, || read(state, n, p, CoreState::p)) }
}

/// Writes the increment of the last step, w = (q₁ − q₀)/h, m/s or rad/s, which is the mean velocity over it; before the first step, the
/// velocity that the state was started with. `n` = LEASTACTION_COORDINATES numbers. Fails with statuses 1, 2, 3 and 5.
///
/// # Safety
/// Pointers are NULL or point to values of their type, arrays to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "state_w"))]
pub unsafe extern "C" fn leastaction_state_w(
    state: *const State,
    n: usize,
    w: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(error, || read(state, n, w, CoreState::last_increment)) }
}

/// # Safety
/// See the functions that call it.
unsafe fn read(
    state: *const State,
    n: usize,
    out: *mut f32,
    of: impl Fn(&CoreState) -> [f32; LEASTACTION_COORDINATES],
) -> Result<(), Error> {
    // SAFETY: this function's promise.
    let started = unsafe { started(state, 1) }?;
    check_length(LEASTACTION_COORDINATES, n)?;
    // SAFETY: this function's promise.
    unsafe { output(out, 3)?.write(of(&started.state)) };
    Ok(())
}
