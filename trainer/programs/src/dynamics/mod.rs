//! Motion of systems of any size, with samples side by side: accelerations, and steps of the discrete Euler–Lagrange equation.

mod acceleration;
mod cholesky;
mod contact;
mod del;
mod dense;
mod interval;
mod inverse;
mod matrix;
mod newton;
mod one_sample;
mod rods;
mod slopes;

pub use acceleration::Accelerations;
pub use del::{Del, DelState};
pub use interval::{Balance, Interval, Linearised, Order};
pub use inverse::InverseDynamics;
pub use newton::Newton;
pub use one_sample::OneSampleAccelerations;
pub use rods::Rods;
pub use slopes::AccelerationSlopes;

pub(crate) use acceleration::MotionSolver;
pub(crate) use cholesky::Cholesky;
pub(crate) use contact::Strike;
pub(crate) use dense::{add, contracted, dot, max_abs, product, times};
pub(crate) use interval::{GaussPoint, Integrals, Variation};
pub(crate) use matrix::Lu;
pub(crate) use newton::{Equations, Factors};
pub(crate) use rods::take_out;

use crate::row::{Row, WIDTH};

/// Flags of the samples that could not be computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Failures(pub [bool; WIDTH]);

impl Failures {
    /// Samples that failed in either.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        let mut both = self;
        both.0.iter_mut().zip(other.0).for_each(|(a, b)| *a |= b);
        both
    }

    /// Adds the samples in which some number is not finite.
    pub(crate) fn add_not_finite(&mut self, rows: &[Row]) {
        // Multiplying by 0 turns every number that is not finite into NaN.
        let mut sum = Row::default();
        rows.iter().for_each(|row| sum.add_scaled(0.0, row));
        self.0.iter_mut().zip(sum.0).for_each(|(failed, sum)| *failed |= sum.is_nan());
    }

    /// Whether all samples failed.
    pub fn all(&self) -> bool {
        self.0.iter().all(|failed| *failed)
    }

    /// Whether one of the first `count` samples failed.
    pub fn any(&self, count: usize) -> bool {
        self.0.iter().take(count).any(|failed| *failed)
    }
}
