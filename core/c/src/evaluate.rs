use crate::arguments::{Given, call, finite, loaded, output, vectors};
use crate::error::Error;
use crate::motion;
use crate::status::Status;
use crate::storage::Model;

/// Writes the acceleration a = M⁻¹(L_q − L_vq v + Q + u), m/s² or rad/s², under the control force u. Rods add to u the forces Aᵀλ by which
/// they keep their lengths.
///
/// - `q` (m or rad), `v` (m/s or rad/s), `u` (N or N m; zeros for none): `n` numbers each.
/// - `n`: LEASTACTION_COORDINATES.
/// - `a`: `n` numbers, written on success only; may be one of the arrays before it.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 4, 70 and 71; with rods also 73.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "acceleration"))]
pub unsafe extern "C" fn leastaction_acceleration(
    model: *const Model,
    q: *const f32,
    v: *const f32,
    u: *const f32,
    n: usize,
    a: *mut f32,
    error: *mut Error,
) -> Status {
    let evaluate = || {
        // SAFETY: the caller's promise.
        let (mechanism, [q, v, u]) = unsafe { (loaded(model)?, vectors([q, v, u], 2, n)?) };
        let out = output(a, 6)?;
        let a = finite(motion::acceleration(mechanism, [&q, &v, &u])?)?;
        // SAFETY: the caller's promise.
        unsafe { out.write(a) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, evaluate) }
}

/// Writes the control force u = M a − L_q + L_vq v − Q, N or N m, that gives the acceleration a: inverse dynamics. If a keeps the lengths
/// of rods, u is the force that loads none of them. Other arguments are those of leastaction_acceleration. Fails with statuses 1 to 4 and
/// 71.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "inverse_dynamics"))]
pub unsafe extern "C" fn leastaction_inverse_dynamics(
    model: *const Model,
    q: *const f32,
    v: *const f32,
    a: *const f32,
    n: usize,
    u: *mut f32,
    error: *mut Error,
) -> Status {
    let evaluate = || {
        // SAFETY: the caller's promise.
        let (mechanism, [q, v, a]) = unsafe { (loaded(model)?, vectors([q, v, a], 2, n)?) };
        let out = output(u, 6)?;
        let u = finite(motion::inverse_dynamics(mechanism, [&q, &v, &a])?)?;
        // SAFETY: the caller's promise.
        unsafe { out.write(u) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, evaluate) }
}

/// Writes the kinetic energy T(q, v) and the potential energy V(q), J: two numbers, whose sum is the energy. A potential is known up to a
/// constant. Other arguments are those of leastaction_acceleration. Fails with statuses 1 to 4 and 71.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "energies"))]
pub unsafe extern "C" fn leastaction_energies(
    model: *const Model,
    q: *const f32,
    v: *const f32,
    n: usize,
    energies: *mut f32,
    error: *mut Error,
) -> Status {
    let evaluate = || {
        // SAFETY: the caller's promise.
        let (mechanism, [q, v]) = unsafe { (loaded(model)?, vectors([q, v], 2, n)?) };
        let out = Given::new(energies.cast::<[f32; 2]>(), 5)?;
        let energies = motion::energies(mechanism, [&q, &v])?;
        // SAFETY: the caller's promise.
        unsafe { out.write(finite([energies.kinetic, energies.potential])?) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, evaluate) }
}

/// Writes the momentum p = L_v(q, v), kg m/s or kg m²/s: `n` numbers. Other arguments are those of leastaction_acceleration. Fails with
/// statuses 1 to 4 and 71.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "momentum"))]
pub unsafe extern "C" fn leastaction_momentum(
    model: *const Model,
    q: *const f32,
    v: *const f32,
    n: usize,
    p: *mut f32,
    error: *mut Error,
) -> Status {
    let evaluate = || {
        // SAFETY: the caller's promise.
        let (mechanism, [q, v]) = unsafe { (loaded(model)?, vectors([q, v], 2, n)?) };
        let out = output(p, 5)?;
        let p = finite(motion::momentum(mechanism, [&q, &v])?)?;
        // SAFETY: the caller's promise.
        unsafe { out.write(p) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, evaluate) }
}
