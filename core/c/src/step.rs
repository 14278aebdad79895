use crate::arguments::{Given, call, check_step, loaded, place, started, vectors};
use crate::contents::Started;
use crate::error::Error;
use crate::status::Status;
use crate::storage::{Model, State};
use leastaction_core::discrete::{self, Control, Del, Galerkin, Midpoint, Path};

/// How a step went.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Report {
    /// Newton updates taken: at least 1, at most 8.
    pub iterations: u32,
    /// Largest residual at the end, relative to the terms it is the sum of.
    pub residual: f32,
}

/// Steps a state by h (s) with the discrete Euler-Lagrange equation of order 2, under control forces u0 at the start and u1
/// at the end of the step, linear between.
///
/// - `u0`, `u1` (N or N m; zeros for none, twice the same for one that is held): `n` numbers each.
/// - `n`: LEASTACTION_COORDINATES.
/// - `report`: how it went, written on success alone; may be NULL.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 6 and 70 to 72, and the state is as it was.
///
/// # Safety
/// Pointers are NULL or point to what their type says, and to so many numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn leastaction_step2(
    model: *const Model,
    state: *mut State,
    h: f32,
    u0: *const f32,
    u1: *const f32,
    n: usize,
    report: *mut Report,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(error, || step::<Midpoint>(model, state, h, [u0, u1], n, report)) }
}

/// As leastaction_step2, of order 4: over twice the work, and exact to the fourth power of h.
///
/// # Safety
/// Pointers are NULL or point to what their type says, and to so many numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn leastaction_step4(
    model: *const Model,
    state: *mut State,
    h: f32,
    u0: *const f32,
    u1: *const f32,
    n: usize,
    report: *mut Report,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(error, || step::<Galerkin>(model, state, h, [u0, u1], n, report)) }
}

/// # Safety
/// As of the functions that call it.
unsafe fn step<P: Path>(
    model: *const Model,
    state: *mut State,
    h: f32,
    given: [*const f32; 2],
    n: usize,
    report: *mut Report,
) -> Result<(), Error> {
    // SAFETY: this function's promise.
    let (mechanism, mut next) = unsafe { (loaded(model)?, started(state, 2)?) };
    // SAFETY: this function's promise.
    let [start, end] = unsafe { vectors(given, 4, n) }?;
    let (place, report) = (place(state, 2)?, Given::optional(report, 7)?);
    check_step(h)?;
    let del = Del::<f32, P>::new(h);
    let how = del.step(&mechanism.system(), &mut next.state, &Control { start, end })?;
    // SAFETY: this function's promise.
    unsafe { finish(&place, next, report, how) };
    Ok(())
}

/// # Safety
/// Both can be written to.
unsafe fn finish(
    place: &Given<Started>,
    next: Started,
    report: Option<Given<Report>>,
    how: discrete::Report<f32>,
) {
    // SAFETY: this function's promise.
    unsafe { place.write(next) };
    if let Some(report) = report {
        // SAFETY: this function's promise.
        unsafe { report.write(Report { iterations: how.iterations.into(), residual: how.residual }) };
    }
}
