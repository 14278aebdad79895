//! Delays and lags of drives as states of a linear system.

use crate::lqr::{LinearSystem, LqrError, MAX_DELAY};
use nalgebra::DMatrix;

/// Parts of a step below which a delay is whole: rounding of a quotient of seconds.
const WHOLE: f64 = 1e-6;

impl LinearSystem {
    /// The system whose commands arrive `steps` steps late, any number ≥ 0. Its state is x and then the commands already sent that have not
    /// yet had their whole step, the latest first.
    ///
    /// With a delay of d whole steps and a part f, the command of d + 1 steps ago acts for the first part f of a step, that of d steps ago
    /// for the rest. A part of a step is the power of the step: x⁺ and u of a whole step are those of its parts, one after another.
    ///
    /// # Errors
    /// [`LqrError::Delay`]; [`LqrError::NoFraction`] if a part of the step is not known.
    pub fn delayed(&self, steps: f64) -> Result<Self, LqrError> {
        if !(0.0..=MAX_DELAY as f64).contains(&steps) {
            return Err(LqrError::Delay { steps });
        }
        let nearest = steps.round();
        let steps = if (steps - nearest).abs() < WHOLE { nearest } else { steps };
        let late = steps.fract();
        let now = if late > 0.0 { self.part(1.0 - late)?.b } else { self.b.clone() };
        Ok(self.with_past(steps as usize, steps.ceil() as usize, &now))
    }

    /// The system whose commands act behind a lag, T ẏ = u − y, with T of `steps` steps, any number ≥ 0. Its state is x and then y of every
    /// command; without a lag, x alone.
    ///
    /// Within a step, x moves as the logarithm of the step says: [A B; 0 1] = exp [F G; 0 0], so that x′ = F x + G y.
    ///
    /// # Errors
    /// [`LqrError::Lag`]; [`LqrError::NoMotion`] if the motion within a step is not known.
    pub fn lagged(&self, steps: f64) -> Result<Self, LqrError> {
        if !(steps >= 0.0 && steps.is_finite()) {
            return Err(LqrError::Lag { steps });
        }
        if steps == 0.0 {
            return Ok(self.clone());
        }
        let (states, controls) = self.b.shape();
        let (whole, unit) = self.with_held_control();
        let own = logarithm(whole, 1.0).ok_or(LqrError::NoMotion)?;
        let (inner, size) = (states + controls, states + 2 * controls);
        let mut flow = DMatrix::zeros(size, size);
        flow.view_mut((0, 0), (states, states)).copy_from(&own.view((0, 0), (states, states)));
        flow.view_mut((0, states), (states, controls)).copy_from(&own.view((0, states), (states, controls)));
        for k in states..inner {
            (flow[(k, k)], flow[(k, k + controls)]) = (-1.0 / steps, 1.0 / steps);
        }
        let flow = Some(flow.exp()).filter(is_finite).ok_or(LqrError::NoMotion)?;
        let mut a: DMatrix<f64> = flow.view((0, 0), (inner, inner)).into();
        let mut b: DMatrix<f64> = flow.view((0, inner), (inner, controls)).into();
        a.view_mut((0, states), (states, controls)).scale_mut(unit);
        b.view_mut((0, 0), (states, controls)).scale_mut(unit);
        Ok(Self { a, b })
    }

    /// The system with `past` commands as states. The command of `whole` steps ago acts through `now`, the one before it through the rest
    /// of B.
    fn with_past(&self, whole: usize, past: usize, now: &DMatrix<f64>) -> Self {
        let (states, controls) = self.b.shape();
        let size = states + past * controls;
        let (mut a, mut b) = (DMatrix::zeros(size, size), DMatrix::zeros(size, controls));
        a.view_mut((0, 0), (states, states)).copy_from(&self.a);
        let mut acts = |age: usize, through: &DMatrix<f64>| match age.checked_sub(1) {
            None => b.view_mut((0, 0), (states, controls)).copy_from(through),
            Some(k) => a.view_mut((0, states + k * controls), (states, controls)).copy_from(through),
        };
        acts(whole, now);
        if past > whole {
            acts(past, &(&self.b - now));
        }
        // Commands grow older; the oldest is forgotten.
        for k in 1..past {
            let (to, from) = (states + k * controls, states + (k - 1) * controls);
            a.view_mut((to, from), (controls, controls)).fill_with_identity();
        }
        if past > 0 {
            b.view_mut((states, 0), (controls, controls)).fill_with_identity();
        }
        Self { a, b }
    }

    /// The transition over a part of the step, by the power of \[A B; 0 1\].
    fn part(&self, part: f64) -> Result<Self, LqrError> {
        let (states, controls) = self.b.shape();
        let (whole, unit) = self.with_held_control();
        let power = power(whole, part).ok_or(LqrError::NoFraction)?;
        Ok(Self {
            a: power.view((0, 0), (states, states)).into(),
            b: unit * power.view((0, states), (states, controls)),
        })
    }

    /// \[A B; 0 1\] with B in units of its largest entry, and that unit.
    fn with_held_control(&self) -> (DMatrix<f64>, f64) {
        let (states, controls) = self.b.shape();
        // Units of u do not matter to the power; these make its part of the matrix of size 1.
        let unit = Some(self.b.amax()).filter(|size| *size > 0.0).unwrap_or(1.0);
        let mut whole = DMatrix::identity(states + controls, states + controls);
        whole.view_mut((0, 0), (states, states)).copy_from(&self.a);
        whole.view_mut((0, states), (states, controls)).copy_from(&(&self.b / unit));
        (whole, unit)
    }
}

/// Distance from 1 below which a logarithm is a short series.
const NEAR_ONE: f64 = 0.25;
/// Maximum number of square roots that bring a matrix near 1.
const MAX_ROOTS: i32 = 40;

/// Mᵖ = exp(p log M) of the principal logarithm; `None` if M has a real eigenvalue ≤ 0.
fn power(matrix: DMatrix<f64>, exponent: f64) -> Option<DMatrix<f64>> {
    Some(logarithm(matrix, exponent)?.exp()).filter(is_finite)
}

/// p log M of the principal logarithm; `None` if M has a real eigenvalue ≤ 0.
fn logarithm(mut matrix: DMatrix<f64>, exponent: f64) -> Option<DMatrix<f64>> {
    let one = DMatrix::identity(matrix.nrows(), matrix.ncols());
    let mut scale = exponent;
    for _ in 0..MAX_ROOTS {
        if (&matrix - &one).norm() < NEAR_ONE {
            // log M = 2 artanh Z with Z = (M + 1)⁻¹(M − 1), which is below 1/7: ten terms are exact.
            let z = (&matrix + &one).lu().solve(&(&matrix - &one))?;
            let square = &z * &z;
            let series = (0..10).rev().fold(0.0 * &one, |sum, k| &square * sum + &one / f64::from(2 * k + 1));
            return Some(2.0 * scale * z * series);
        }
        (matrix, scale) = (root(&matrix)?, 2.0 * scale);
    }
    None
}

/// Maximum number of iterations towards a square root, which converge quadratically.
const MAX_ITERATIONS: usize = 60;
/// Relative error of the square of a square root.
const ACCURATE: f64 = 1e-9;

/// The principal square root by the iteration of Denman and Beavers; `None` if there is none.
///
/// Source: Denman and Beavers, "The matrix sign function and computations in systems", 1976.
fn root(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (mut y, mut z) = (matrix.clone(), DMatrix::identity(matrix.nrows(), matrix.ncols()));
    for _ in 0..MAX_ITERATIONS {
        let next = 0.5 * (&y + z.clone().try_inverse()?);
        z = 0.5 * (z + y.clone().try_inverse()?);
        let change = (&next - &y).amax();
        y = next;
        if change <= 1e-14 * y.amax() {
            break;
        }
    }
    Some(y).filter(|y| (y * y - matrix).amax() <= ACCURATE * matrix.amax())
}

fn is_finite(matrix: &DMatrix<f64>) -> bool {
    matrix.iter().all(|x| x.is_finite())
}
