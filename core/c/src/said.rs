//! Data of the file other than the mechanism: the step, the actuator, the range of the training data.

use crate::arguments::{Given, call, check_step, loaded, numbers, output, vectors};
use crate::config::LEASTACTION_COORDINATES;
use crate::error::Error;
use crate::family::Mechanism;
use crate::status::Status;
use crate::storage::Model;
use leastaction_core::discrete::Order;
use leastaction_core::forces::Actuator;
use leastaction_core::model::ModelError;

/// Writes the step h (s), the order (2 or 4) and the kind of control (0: held from sample to sample, 1: linear between samples) that the
/// model was trained with. With others the model is less accurate, because a model of a discrete Lagrangian absorbs the integrator's error.
/// Fails with statuses 1, 2, 4 and 8.
///
/// # Safety
/// Pointers are NULL or point to values of their type.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "trained_step"))]
pub unsafe extern "C" fn leastaction_trained_step(
    model: *const Model,
    h: *mut f32,
    order: *mut u8,
    control: *mut u8,
    error: *mut Error,
) -> Status {
    let read = || {
        // SAFETY: the caller's promise.
        let mechanism = unsafe { loaded(model) }?;
        let (h, order, control) = (Given::new(h, 2)?, Given::new(order, 3)?, Given::new(control, 4)?);
        let trained = mechanism.step()?;
        // SAFETY: the caller's promise.
        unsafe {
            (h.write(trained.h), order.write(trained.order.number()), control.write(trained.control as u8))
        };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, read) }
}

/// Checks that the model was trained with steps of h (s) and of this order, 2 or 4. Call it once for the stepping function that the program
/// uses. Fails with statuses 2, 4, 8, 12 and 45.
///
/// # Safety
/// Pointers are NULL or point to values of their type.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "check_step"))]
pub unsafe extern "C" fn leastaction_check_step(
    model: *const Model,
    h: f32,
    order: u8,
    error: *mut Error,
) -> Status {
    let check = || {
        // SAFETY: the caller's promise.
        let trained = unsafe { loaded(model) }?.step()?;
        let other = ModelError::Order { found: trained.order.number(), compiled: order };
        trained.check_order(Order::from_number(order).ok_or(other)?)?;
        if h == trained.h { Ok(()) } else { Err(Status::OtherStep.into()) }
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, check) }
}

/// A quantity outside the range of the training data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Outside {
    /// `q`, `v` or `u`; 0 if nothing lies outside.
    pub quantity: u8,
    /// Index of the coordinate, from 0.
    pub coordinate: u32,
}

/// Checks whether a state and control force lie outside the range of the training data, where the model extrapolates. Writes the first
/// quantity that does; infinities and NaN do.
///
/// - `q` (m or rad), `v` (m/s or rad/s), `u` (N or N m): `n` numbers each.
/// - `n`: LEASTACTION_COORDINATES.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 4, 13, 30 and 35.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "check_range"))]
pub unsafe extern "C" fn leastaction_check_range(
    model: *const Model,
    q: *const f32,
    v: *const f32,
    u: *const f32,
    n: usize,
    outside: *mut Outside,
    error: *mut Error,
) -> Status {
    let check = || {
        // SAFETY: the caller's promise.
        let (mechanism, [q, v, u]) = unsafe { (loaded(model)?, numbers([q, v, u], 2, n)?) };
        let out = Given::new(outside, 6)?;
        let found = mechanism.range()?.ok_or(Status::NoRange)?.outside(&q, &v, &u)?;
        let none = Outside { quantity: 0, coordinate: 0 };
        let found = found.map_or(none, |found| Outside {
            quantity: found.quantity as u8,
            coordinate: found.coordinate as u32,
        });
        // SAFETY: the caller's promise.
        unsafe { out.write(found) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, check) }
}

/// The number of whole steps of h seconds by which the file's actuator is late, and the actuator with the rest of its delay.
pub(crate) fn actuator(
    mechanism: &Mechanism,
    h: f32,
) -> Result<(u16, Actuator<f32, LEASTACTION_COORDINATES>), Error> {
    check_step(h)?;
    match mechanism.actuator()? {
        Some(actuator) => Ok(actuator.at_step(h)?),
        None => Ok((0, Actuator::ideal())),
    }
}

/// Writes the number of whole steps of h (s) by which a command is late: leastaction_actuate takes commands that much older. 0 if the file
/// has no actuator. Fails with statuses 1, 2, 4, 6, 30 and 35; 35 also for an actuator with a lag.
///
/// # Safety
/// Pointers are NULL or point to values of their type.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "late_steps"))]
pub unsafe extern "C" fn leastaction_late_steps(
    model: *const Model,
    h: f32,
    steps: *mut u16,
    error: *mut Error,
) -> Status {
    let read = || {
        // SAFETY: the caller's promise.
        let mechanism = unsafe { loaded(model) }?;
        let (out, (steps, _)) = (Given::new(steps, 3)?, actuator(mechanism, h)?);
        // SAFETY: the caller's promise.
        unsafe { out.write(steps) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, read) }
}

/// Writes the control forces over a step of h (s), as the stepping functions take them, from commands held from step to step, with gain,
/// offset and delay of the file: τ(t) = g u(t − d) + o. Without an actuator in the file, they are the command itself; one with a lag is
/// refused with status 35.
///
/// - `before`, `u`: the command one step earlier and the command of this step, both leastaction_late_steps older, `n` numbers each.
/// - `n`: LEASTACTION_COORDINATES.
/// - `u0`, `u1`: the forces (N or N m) at the start and at the end of the step, `n` numbers each, written on success only.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 4, 6, 30, 35 and 71.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "actuate"))]
pub unsafe extern "C" fn leastaction_actuate(
    model: *const Model,
    h: f32,
    before: *const f32,
    u: *const f32,
    n: usize,
    u0: *mut f32,
    u1: *mut f32,
    error: *mut Error,
) -> Status {
    let actuate = || {
        // SAFETY: the caller's promise.
        let (mechanism, [before, u]) = unsafe { (loaded(model)?, vectors([before, u], 3, n)?) };
        let (start, end) = (output(u0, 6)?, output(u1, 7)?);
        let (_, actuator) = actuator(mechanism, h)?;
        let control = actuator.held(&before, &u);
        // SAFETY: the caller's promise.
        unsafe { (start.write(control.start), end.write(control.end)) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, actuate) }
}
