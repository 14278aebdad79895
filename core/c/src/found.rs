//! Findings of an adapter.

use crate::arguments::{Given, call, following};
use crate::contents::Following;
use crate::error::Error;
use crate::status::Status;
use crate::storage::Adapter;
use leastaction_core::adapt;
use leastaction_core::forces::Coefficient;
use leastaction_core::scalar::Scalar;

/// Findings about the machine as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Found {
    /// Number of numbers that follow.
    pub numbers: u32,
    /// Whether the number that the settings announce differs from the model's, at their rate of false alarms: for a body's mass, whether
    /// something is attached.
    pub announced: u8,
    /// Distance of that number from the model's, such as the attached mass, kg; 0 unless it is announced.
    pub distance: f32,
    /// Standard error of the distance; 0 unless it is announced.
    pub standard_error: f32,
    /// Whether the machine is not the one that was learned: changes follow each other, and no choice of the numbers explains them. Freeze the
    /// numbers, or begin anew.
    pub unlike: u8,
    /// Whether the numbers are frozen.
    pub frozen: u8,
}

/// Writes what was found. Fails with statuses 1, 2 and 15.
///
/// # Safety
/// Pointers are NULL or point to values of their type.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "adapter_found"))]
pub unsafe extern "C" fn leastaction_adapter_found(
    adapter: *const Adapter,
    found: *mut Found,
    error: *mut Error,
) -> Status {
    let read = || {
        // SAFETY: the caller's promise.
        let own = unsafe { following(adapter) }?;
        let out = Given::new(found, 2)?;
        let difference = own.announcement.and_then(|test| test.of(own.adapter.filter()));
        let found = Found {
            numbers: own.count.into(),
            announced: difference.is_some().into(),
            distance: difference.map_or(0.0, |difference| difference.estimate),
            standard_error: difference.map_or(0.0, |difference| difference.error),
            unlike: own.adapter.unlike().into(),
            frozen: own.frozen.into(),
        };
        // SAFETY: the caller's promise.
        unsafe { out.write(found) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, read) }
}

/// A number that follows the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Number {
    /// Kind: 0 none, 1 inertial number of a body, 2 inertia of a rotor, 3 coefficient of friction, 4 offset of a drive, 5 gain of a drive; 6
    /// and 7, of networks, no model of this library has.
    pub kind: u8,
    /// The body or the coordinate, from 0.
    pub coordinate: u8,
    /// Position among the numbers of the body (mass, first moments, inertia), or the coefficient: 0 viscous, 1 Coulomb, 2 viscous by direction,
    /// 3 dry by direction, 4 sticking.
    pub index: u8,
    /// Value in the model file; of offsets and gains, in the settings.
    pub model: f32,
    /// Estimated distance from it, without regard to limits.
    pub estimate: f32,
    /// Standard error of the estimate.
    pub standard_error: f32,
    /// Distance in use, within the limits.
    pub in_use: f32,
    /// Least distance in use.
    pub least: f32,
    /// Largest distance in use.
    pub most: f32,
}

/// Writes number `index` of those that follow, in the order of the settings. Fails with statuses 1, 2, 15 and 16.
///
/// # Safety
/// Pointers are NULL or point to values of their type.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "adapter_number"))]
pub unsafe extern "C" fn leastaction_adapter_number(
    adapter: *const Adapter,
    index: u32,
    number: *mut Number,
    error: *mut Error,
) -> Status {
    let read = || {
        // SAFETY: the caller's promise.
        let own = unsafe { following(adapter) }?;
        let out = Given::new(number, 3)?;
        let number =
            own.number(index as usize).ok_or(Error::of(Status::NoNumber, [index, own.count.into(), 0]))?;
        // SAFETY: the caller's promise.
        unsafe { out.write(number) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, read) }
}

impl Following {
    fn number(&self, j: usize) -> Option<Number> {
        if j >= usize::from(self.count) {
            return None;
        }
        let (limits, filter) = (&self.tuning.limits, self.adapter.filter());
        let [kind, coordinate, index] = named(*self.tuning.numbers.get(j)?);
        Some(Number {
            kind,
            coordinate,
            index,
            model: *limits.model.get(j)?,
            estimate: *filter.estimate().get(j)?,
            standard_error: Scalar::sqrt(filter.variance(j)),
            in_use: *self.adapter.applied().get(j)?,
            least: *limits.lower.get(j)?,
            most: *limits.upper.get(j)?,
        })
    }
}

/// Kind, coordinate and index of a number.
fn named(number: adapt::Number) -> [u8; 3] {
    match number {
        adapt::Number::None => [0; 3],
        adapt::Number::Inertia { body, index } => [1, body, index],
        adapt::Number::Rotor(i) => [2, i, 0],
        adapt::Number::Friction(coefficient, i) => [3, i, coefficient_of(coefficient)],
        adapt::Number::Offset(i) => [4, i, 0],
        adapt::Number::Gain(i) => [5, i, 0],
        adapt::Number::Potential(j) => [6, 0, j],
        adapt::Number::Dissipation(j) => [7, 0, j],
    }
}

fn coefficient_of(coefficient: Coefficient) -> u8 {
    match coefficient {
        Coefficient::Viscous => 0,
        Coefficient::Coulomb => 1,
        Coefficient::DirectionalViscous => 2,
        Coefficient::Directional => 3,
        Coefficient::Sticking => 4,
    }
}
