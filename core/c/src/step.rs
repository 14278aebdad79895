use crate::arguments::{Given, call, check_step, loaded, place, started, vectors};
use crate::contents::Started;
use crate::error::Error;
use crate::motion;
use crate::status::Status;
use crate::storage::{Model, State};
use leastaction_core::discrete::{self, Control, Galerkin, Midpoint, Path};

/// Report of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Report {
    /// Number of Newton updates taken: at least 1.
    pub iterations: u32,
    /// Largest residual at the end, relative to the terms of its sum.
    pub residual: f32,
}

/// Bounds of Newton's method in a step.
///
/// For a constant running time, set `stop` = 0 and `max_iterations` to as many updates as the motion needs, two for most.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Newton {
    /// Maximum number of updates; at least 1.
    pub max_iterations: u8,
    /// Relative residual at which to stop early; 0 always takes `max_iterations`.
    pub stop: f32,
    /// Largest accepted relative residual; a step above it is refused.
    pub accept: f32,
}

/// Returns the default bounds: at most 50 updates (12 if the library was built for rods), down to rounding. Up to a step of 50 ms five
/// suffice.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "default_newton"))]
pub extern "C" fn leastaction_default_newton() -> Newton {
    let discrete::Newton { max_iterations, stop, accept } = motion::default_newton();
    Newton { max_iterations, stop, accept }
}

impl Newton {
    fn checked(self) -> Result<discrete::Newton<f32>, Error> {
        let Self { max_iterations, stop, accept } = self;
        let holds = [max_iterations > 0, stop >= 0.0, accept > 0.0 && accept.is_finite()];
        match holds.iter().position(|holds| !holds) {
            Some(bound) => Err(Error::new(Status::BadNewton, [bound + 1])),
            None => Ok(discrete::Newton { max_iterations, stop, accept }),
        }
    }
}

/// Steps a state by h (s) with the discrete Euler-Lagrange equation of order 2, under control forces u0 at the start and u1 at the end of
/// the step, linear between. A library that was built for rods steps every graph by RATTLE, under the mean of u0 and u1 as in training.
///
/// - `u0`, `u1` (N or N m; zeros for none, one array twice for a held force): `n` numbers each.
/// - `n`: LEASTACTION_COORDINATES.
/// - `newton`: bounds of Newton's method; NULL for leastaction_default_newton.
/// - `report`: report of the step, written on success only; may be NULL.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 6, 10 and 70 to 72, with rods also 73; the state is then unchanged.
///
/// # Safety
/// Pointers are NULL or point to values of their type, arrays to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "step2"))]
pub unsafe extern "C" fn leastaction_step2(
    model: *const Model,
    state: *mut State,
    h: f32,
    u0: *const f32,
    u1: *const f32,
    n: usize,
    newton: *const Newton,
    report: *mut Report,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(error, || step::<Midpoint>(model, state, h, [u0, u1], n, (newton, report))) }
}

/// Steps a state like leastaction_step2, with order 4: over twice the work, and exact to the fourth power of h.
///
/// # Safety
/// Pointers are NULL or point to values of their type, arrays to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "step4"))]
pub unsafe extern "C" fn leastaction_step4(
    model: *const Model,
    state: *mut State,
    h: f32,
    u0: *const f32,
    u1: *const f32,
    n: usize,
    newton: *const Newton,
    report: *mut Report,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller's promise.
    unsafe { call(error, || step::<Galerkin>(model, state, h, [u0, u1], n, (newton, report))) }
}

/// # Safety
/// See the functions that call it.
unsafe fn step<P: Path>(
    model: *const Model,
    state: *mut State,
    h: f32,
    given: [*const f32; 2],
    n: usize,
    (newton, report): (*const Newton, *mut Report),
) -> Result<(), Error> {
    // SAFETY: this function's promise.
    let (mechanism, mut next) = unsafe { (loaded(model)?, started(state, 2)?) };
    // SAFETY: this function's promise.
    let [start, end] = unsafe { vectors(given, 4, n) }?;
    let (place, newton, report) =
        (place(state, 2)?, Given::optional(newton, 7)?, Given::optional(report, 8)?);
    check_step(h)?;
    // SAFETY: this function's promise.
    let newton = newton.map_or(leastaction_default_newton(), |newton| unsafe { newton.read() });
    let step = motion::Step { h, newton: newton.checked()? };
    let how = motion::step::<P>(mechanism, &mut next.state, step, &Control { start, end })?;
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
