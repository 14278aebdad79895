use crate::arguments::{Given, call, finite, loaded, output, vectors};
use crate::config::LEASTACTION_COORDINATES as N;
use crate::error::Error;
use crate::motion;
use crate::status::Status;
use crate::storage::Model;

/// Writes the inertia matrix M(q), kg m², kg m or kg: `n` times `n` numbers, row by row; it is symmetric. A computed torque is M(q) times
/// an acceleration, plus the result of leastaction_inverse_dynamics for no acceleration. Other arguments are those of
/// leastaction_acceleration. Fails with statuses 1 to 4 and 71.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "mass_matrix"))]
pub unsafe extern "C" fn leastaction_mass_matrix(
    model: *const Model,
    q: *const f32,
    n: usize,
    mass: *mut f32,
    error: *mut Error,
) -> Status {
    let evaluate = || {
        // SAFETY: the caller's promise.
        let (mechanism, [q]) = unsafe { (loaded(model)?, vectors([q], 2, n)?) };
        let out = Given::new(mass.cast::<[[f32; N]; N]>(), 4)?;
        let mass = motion::mass_matrix(mechanism, &q);
        mass.iter().try_for_each(|row| finite(*row).map(drop))?;
        // SAFETY: the caller's promise.
        unsafe { out.write(mass) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, evaluate) }
}

/// Writes the control force u = V_q(q), N or N m, that holds the mechanism at rest against gravity and springs: `n` numbers. Other
/// arguments are those of leastaction_acceleration. Fails with statuses 1 to 4 and 71.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "gravity_torque"))]
pub unsafe extern "C" fn leastaction_gravity_torque(
    model: *const Model,
    q: *const f32,
    n: usize,
    u: *mut f32,
    error: *mut Error,
) -> Status {
    let evaluate = || {
        // SAFETY: the caller's promise.
        let (mechanism, [q]) = unsafe { (loaded(model)?, vectors([q], 2, n)?) };
        let out = output(u, 4)?;
        // SAFETY: the caller's promise.
        unsafe { out.write(finite(motion::gravity_torque(mechanism, &q))?) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, evaluate) }
}
