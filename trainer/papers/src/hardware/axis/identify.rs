//! Identification of an axis, as the field does it: least squares on the force that a motion needs, and on the motion that a force
//! gives.

use super::motion::Axis;
use super::stretch::Stretch;
use crate::task::TaskError;
use leastaction_learning::torque::linear::Design;
use leastaction_learning::torque::{Preparation, Samples};
use nalgebra::DMatrix;

/// Numbers of an axis that are identified: mass, viscous and Coulomb friction, and an offset or stiffnesses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Numbers {
    /// Whether friction differs between the directions. The offset is then part of Coulomb friction, which sticks over the same interval
    /// of forces.
    pub by_direction: bool,
    /// Whether there are three stiffnesses.
    pub stiffness: bool,
}

/// Cut-off frequencies that are tried, Hz.
const CUT_OFFS: [f64; 5] = [10.0, 20.0, 40.0, 80.0, 160.0];
/// Speed below which a sample counts as at rest, where friction takes any force, relative to the greatest.
const REST: f64 = 0.01;
/// Maximum number of iterations.
const ITERATIONS: usize = 60;
/// Difference for a derivative, relative to the number's scale.
const DIFFERENCE: f64 = 1e-4;
/// Relative fall of the squared error below which iterations end.
const CONVERGED: f64 = 1e-9;
/// Damping beyond which no step lowers the error.
const MOST_DAMPING: f64 = 1e8;

impl Numbers {
    /// How many.
    pub fn count(self) -> usize {
        (if self.by_direction { 5 } else { 4 }) + if self.stiffness { 3 } else { 0 }
    }

    /// The axis with these numbers.
    fn axis(self, x: &[f64]) -> Axis {
        let (friction, stiffness) = x[1..].split_at(self.count() - if self.stiffness { 4 } else { 1 });
        let stiffness = <[f64; 3]>::try_from(stiffness).unwrap_or_default();
        let mass = x[0];
        match *friction {
            [up, down, dry_up, dry_down] => {
                Axis { mass, viscous: [up, down], coulomb: [dry_up, dry_down], offset: 0.0, stiffness }
            }
            [b, c, offset] => Axis { mass, viscous: [b; 2], coulomb: [c; 2], offset, stiffness },
            _ => Axis::default(),
        }
    }

    /// Factors of all numbers in the force that the motion needs.
    fn factors(self, [q, v, a]: [f64; 3]) -> Vec<f64> {
        let (up, down) = (f64::from(v > 0.0), f64::from(v < 0.0));
        let mut row = vec![a];
        if self.by_direction {
            row.extend([up * v, down * v, up, -down]);
        } else {
            row.extend([v, up - down, -1.0]);
        }
        if self.stiffness {
            row.extend([q, q * q, q * q * q]);
        }
        row
    }

    /// Least squares on the force, by derivatives of filtered positions, samples at rest left out. The cut-off frequency is the one whose
    /// numbers predict these stretches best.
    ///
    /// # Errors
    /// If no frequency gives an axis.
    pub fn by_force(self, stretches: &[&Stretch]) -> Result<Axis, TaskError> {
        let found = CUT_OFFS.into_iter().filter_map(|cut_off| self.at(stretches, cut_off));
        let found = found.filter(Axis::is_physical).map(|axis| (squared_error(&axis, stretches), axis));
        let best = found.min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(best.ok_or("least squares finds no axis with positive mass and viscous friction")?.1)
    }

    fn at(self, stretches: &[&Stretch], cut_off: f64) -> Option<Axis> {
        let (mut rows, mut target) = (Vec::new(), Vec::new());
        for stretch in stretches {
            let how = Preparation { step: stretch.h, cut_off, every: 1, margin: 1.0 / cut_off };
            let samples = Samples::of_even((&stretch.q, None, Some(&stretch.u)), &how).ok()?;
            let state = [&samples.q, &samples.v, &samples.a].map(|rows| rows.as_flat());
            let least = REST * state[1].iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            for (k, tau) in samples.tau.as_flat().iter().enumerate() {
                let [q, v, a] = state.map(|values| values[k]);
                if v.abs() > least {
                    rows.extend(self.factors([q, v, a]));
                    target.push(*tau);
                }
            }
        }
        let matrix = DMatrix::from_row_slice(target.len(), self.count(), &rows);
        let solution = Design { matrix, target, coordinates: 1 }.solve()?;
        Some(self.axis(&solution.numbers))
    }

    /// Least squares on the positions that a simulation from each stretch's start predicts: Gauss–Newton with Marquardt's damping,
    /// derivatives by differences, from the numbers of [`Numbers::by_force`] on; stiffnesses are found last.
    ///
    /// # Errors
    /// [`Numbers::by_force`].
    pub fn by_motion(self, stretches: &[&Stretch]) -> Result<Axis, TaskError> {
        let first = match self.stiffness {
            true => Self { stiffness: false, ..self }.by_motion(stretches)?,
            false => self.by_force(stretches)?,
        };
        let mut fit = Fit::new(self, stretches, self.of(&first));
        for _ in 0..ITERATIONS {
            if !fit.iterate() {
                break;
            }
        }
        Ok(self.axis(&fit.x))
    }

    /// The numbers of an axis.
    fn of(self, axis: &Axis) -> Vec<f64> {
        let Axis { mass, viscous: [up, down], coulomb: [dry_up, dry_down], offset, stiffness } = *axis;
        let friction =
            if self.by_direction { vec![up, down, dry_up, dry_down] } else { vec![up, dry_up, offset] };
        let stiffness: &[f64] = if self.stiffness { &stiffness } else { &[] };
        [&[mass], &friction[..], stiffness].concat()
    }
}

/// Sum of squared errors of predicted positions over all stretches, m².
fn squared_error(axis: &Axis, stretches: &[&Stretch]) -> f64 {
    residuals(axis, stretches).iter().map(|r| r * r).sum()
}

/// Logged positions less those predicted, m.
fn residuals(axis: &Axis, stretches: &[&Stretch]) -> Vec<f64> {
    let of = |stretch: &&Stretch| {
        let predicted = axis.roll_out(stretch.start, stretch.forces(), stretch.h);
        stretch.positions().iter().zip(predicted).map(|(q, predicted)| q - predicted).collect::<Vec<_>>()
    };
    stretches.iter().flat_map(of).collect()
}

/// State of the iterations.
struct Fit<'s> {
    numbers: Numbers,
    stretches: &'s [&'s Stretch],
    x: Vec<f64>,
    /// Sizes of the numbers.
    scales: Vec<f64>,
    squared: f64,
    damping: f64,
}

impl<'s> Fit<'s> {
    fn new(numbers: Numbers, stretches: &'s [&'s Stretch], x: Vec<f64>) -> Self {
        let reach = stretches
            .iter()
            .flat_map(|stretch| stretch.positions())
            .fold(0.0, |most: f64, q| most.max(q.abs()));
        let dry = numbers.axis(&x).coulomb[0].abs();
        let mut scales: Vec<f64> = x.iter().map(|x| x.abs().max(0.1 * dry)).collect();
        // A stiffness is as large as Coulomb friction if its force is, at the end of the way.
        if numbers.stiffness {
            let first = scales.len() - 3;
            (1..).zip(&mut scales[first..]).for_each(|(power, scale)| *scale = dry / reach.powi(power));
        }
        let squared = squared_error(&numbers.axis(&x), stretches);
        Self { numbers, stretches, x, scales, squared, damping: 1e-3 }
    }

    /// Lowers the error; whether there may be more to gain.
    fn iterate(&mut self) -> bool {
        let residuals = residuals(&self.numbers.axis(&self.x), self.stretches);
        let jacobian = self.jacobian(&residuals);
        while self.damping < MOST_DAMPING {
            let Some(x) = self.stepped(&jacobian, &residuals) else { return false };
            let axis = self.numbers.axis(&x);
            let squared =
                if axis.is_physical() { squared_error(&axis, self.stretches) } else { f64::INFINITY };
            if squared < self.squared {
                let fall = 1.0 - squared / self.squared;
                (self.x, self.squared, self.damping) = (x, squared, 0.2 * self.damping);
                return fall > CONVERGED;
            }
            self.damping *= 5.0;
        }
        false
    }

    /// Derivatives of predicted positions by the scaled numbers.
    fn jacobian(&self, residuals: &[f64]) -> DMatrix<f64> {
        let mut jacobian = DMatrix::zeros(residuals.len(), self.x.len());
        for (k, mut column) in jacobian.column_iter_mut().enumerate() {
            let mut x = self.x.clone();
            x[k] += DIFFERENCE * self.scales[k];
            let moved = self::residuals(&self.numbers.axis(&x), self.stretches);
            let pairs = residuals.iter().zip(moved);
            column.iter_mut().zip(pairs).for_each(|(to, (r, moved))| *to = (r - moved) / DIFFERENCE);
        }
        jacobian
    }

    /// The numbers after a damped step.
    fn stepped(&self, jacobian: &DMatrix<f64>, residuals: &[f64]) -> Option<Vec<f64>> {
        let (rows, count) = jacobian.shape();
        let mut matrix = jacobian.clone().resize_vertically(rows + count, 0.0);
        for k in 0..count {
            matrix[(rows + k, k)] = self.damping.sqrt() * jacobian.column(k).norm();
        }
        let target = [residuals, &vec![0.0; count]].concat();
        let step = Design { matrix, target, coordinates: 1 }.solve()?.numbers;
        let moved = |((x, step), scale): ((&f64, &f64), &f64)| x + scale * step;
        Some(self.x.iter().zip(&step).zip(&self.scales).map(moved).collect())
    }
}
