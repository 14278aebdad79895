//! Two RATTLE steps through three positions as one chain of steps of order 2.
//!
//! With w_k = (x_{k+1} − x_k)/h_k the momentum that a step leaves a point with is what the step before brought, and both
//! halves of the forces there:
//!
//! L_v(w_{k−1}) − L_v(w_k) + ½(h_{k−1} + h_k)(L_q(x_k) + Q(v_k)) + ½(h_{k−1} f_{k−1} + h_k f_k) + A(x_k)ᵀλ_k = 0, φ(x_k) = 0,
//!
//! where λ has the impulses of both steps, and v_k is the velocity that the step before arrives with ([`Arrival`]). So two
//! positions determine what follows without a velocity. What of the points is not logged is solved for, by Newton's method
//! for all of them together.

use super::blocks::{column, finite, set, set_column, set_row};
use super::velocity::{Arrival, Velocity, turned};
use super::{Failed, MAX_ITERATIONS, SETTLED};
use crate::architecture::{Constraint, Family};
use crate::training::loss::Systems;
use crate::training::samples::Sample;
use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};
use leastaction_core::lagrangian::{Hessian, Lagrangian};
use leastaction_core::linear::{Matrix, add_scaled, add_scaled_matrix, multiply, transpose};
use leastaction_core::scalar::max_abs;

/// The points of two steps.
pub(super) struct Chain<const N: usize> {
    /// Lengths of the steps of order 2, s.
    pub h: Vec<f64>,
    /// The external force during each, N.
    force: Vec<[f64; N]>,
    /// Positions x, m.
    pub x: Vec<[f64; N]>,
    /// Impulses λ of every point, N s.
    lambda: Vec<Vec<f64>>,
    /// The points whose positions are solved for.
    pub free: Vec<usize>,
    /// The inner points whose equations are solved; as many.
    pub solved: Vec<usize>,
}

/// The chain's equations and their derivatives.
pub(super) struct Linearised<const N: usize> {
    /// Of every step at its start: L_q of the point, L_v of the increment.
    steps: Vec<Hessian<f64, N>>,
    /// Of every point.
    constraints: Vec<Vec<Constraint<N>>>,
    /// Of every point but the first and the last.
    inner: Vec<Inner<N>>,
}

/// The equation of an inner point.
pub(super) struct Inner<const N: usize> {
    pub velocity: Velocity<N>,
    /// What is left of it, N s.
    pub residual: [f64; N],
    /// Its derivatives in the positions of the point before, of this, and of the one after.
    pub slopes: [Matrix<f64, N>; 3],
}

impl<const N: usize> Linearised<N> {
    /// The equation of point k, 0 < k < number of steps.
    pub fn inner(&self, k: usize) -> &Inner<N> {
        &self.inner[k - 1]
    }

    /// A of point k.
    pub fn gradients(&self, k: usize) -> impl Iterator<Item = &[f64; N]> {
        self.constraints[k].iter().map(|constraint| &constraint.gradient)
    }
}

impl<const N: usize> Chain<N> {
    /// The chain of a sample, each of its two steps made of these; `open`: whether the last position is solved for, else the
    /// equation at the middle one is not.
    ///
    /// Points between the logged ones are first guessed on the parabola through these.
    pub fn new(sample: &Sample<N>, substeps: &[f64], open: bool) -> Self {
        let ([q0, q1, q2], [u0, u1, u2]) = (&sample.states, &sample.controls);
        let (middle, last) = (substeps.len(), 2 * substeps.len());
        let total: f64 = substeps.iter().sum();
        let mean = |a: &[f64; N], b: &[f64; N]| std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
        let h = substeps.repeat(2);
        let force = (0..last).map(|k| if k < middle { mean(u0, u1) } else { mean(u1, u2) }).collect();
        let times = h.iter().scan(-1.0, |time, h| {
            *time += h / total;
            Some(*time)
        });
        let between = |t: f64| -> [f64; N] {
            std::array::from_fn(|i| q1[i] + 0.5 * t * (q2[i] - q0[i] + t * (q2[i] - 2.0 * q1[i] + q0[i])))
        };
        let mut x: Vec<[f64; N]> = std::iter::once(*q0).chain(times.map(between)).collect();
        (x[middle], x[last]) = (*q1, *q2);
        let free = (1..=last).filter(|k| *k != middle && (open || *k != last)).collect();
        let solved = (1..last).filter(|k| open || *k != middle).collect();
        Self { h, force, x, lambda: Vec::new(), free, solved }
    }

    /// w_k, m/s.
    pub fn increment(&self, k: usize) -> [f64; N] {
        std::array::from_fn(|i| (self.x[k + 1][i] - self.x[k][i]) / self.h[k])
    }

    /// ½(h_{k−1} + h_k), s.
    pub fn span(&self, k: usize) -> f64 {
        0.5 * (self.h[k - 1] + self.h[k])
    }

    /// Solves for what is not logged.
    pub fn solve<F: Family<N>>(&mut self, systems: &Systems<F, N>) -> Result<(), Failed> {
        if self.free.is_empty() {
            return Ok(());
        }
        let scale = self.x.iter().map(max_abs).fold(0.0, f64::max);
        for _ in 0..MAX_ITERATIONS {
            let linearised = self.linearise(systems)?;
            let change = finite(self.factored(&linearised).solve(self.residuals(&linearised)))?;
            if self.apply(&change) <= SETTLED * scale {
                return Ok(());
            }
        }
        Err(Failed)
    }

    /// The equations as they are.
    pub fn linearise<F: Family<N>>(&mut self, systems: &Systems<F, N>) -> Result<Linearised<N>, Failed> {
        let lagrangian = &systems.one.lagrangian;
        let steps = (0..self.h.len()).map(|k| lagrangian.hessian(&self.x[k], &self.increment(k))).collect();
        let constraints: Vec<_> = self.x.iter().map(|x| systems.family.constraints(x)).collect();
        self.lambda.resize(self.x.len(), vec![0.0; constraints[0].len()]);
        let mut linearised = Linearised { steps, constraints, inner: Vec::new() };
        for k in 1..self.h.len() {
            let inner = self.inner(systems, &linearised, k)?;
            linearised.inner.push(inner);
        }
        Ok(linearised)
    }

    fn inner<F: Family<N>>(
        &self,
        systems: &Systems<F, N>,
        Linearised { steps, constraints, .. }: &Linearised<N>,
        k: usize,
    ) -> Result<Inner<N>, Failed> {
        let (before, after, constraints) = (&steps[k - 1], &steps[k], &constraints[k]);
        let (half, span) = (0.5 * self.h[k - 1], self.span(k));
        let brought = add_scaled(&add_scaled(&before.l_v, half, &after.l_q), half, &self.force[k - 1]);
        let guess = self.increment(k - 1);
        let arrival = Arrival { q: &self.x[k], constraints, half, momentum: brought, guess };
        let velocity = arrival.velocity(&systems.one)?;
        let force = add_scaled(&after.l_q, 1.0, &self.force[k]);
        let kicked = add_scaled(&brought, 0.5 * self.h[k], &force);
        let mut residual = add_scaled(&add_scaled(&kicked, span, &velocity.drag), -1.0, &after.l_v);
        for (constraint, lambda) in constraints.iter().zip(&self.lambda[k]) {
            residual = add_scaled(&residual, *lambda, &constraint.gradient);
        }
        let slopes = self.slopes(k, &velocity, before, after, &turned(constraints, &self.lambda[k]));
        Ok(Inner { velocity, residual, slopes })
    }

    fn slopes(
        &self,
        k: usize,
        velocity: &Velocity<N>,
        before: &Hessian<f64, N>,
        after: &Hessian<f64, N>,
        turned: &Matrix<f64, N>,
    ) -> [Matrix<f64, N>; 3] {
        let (half, span) = (0.5 * self.h[k - 1], self.span(k));
        let drag = product(&velocity.slope, &velocity.v_p);
        let braked = |gain: &Matrix<f64, N>| product(&drag, gain);
        let in_w = add_scaled_matrix(&before.l_vv, span, &braked(&before.l_vv));
        let q_v = add_scaled_matrix(&product(&velocity.slope, &velocity.v_q), half, &braked(&after.l_qq));
        let in_x = add_scaled_matrix(turned, span, &add_scaled_matrix(&after.l_qq, 1.0, &q_v));
        let (before, after) = (scaled(&in_w, 1.0 / self.h[k - 1]), scaled(&after.l_vv, 1.0 / self.h[k]));
        let here = add_scaled_matrix(&add_scaled_matrix(&in_x, 1.0, &before), 1.0, &after);
        [scaled(&before, -1.0), here, scaled(&after, -1.0)]
    }

    /// Where the unknowns λ, and the equations φ = 0, begin.
    fn multipliers(&self) -> usize {
        self.free.len() * N
    }

    /// The derivatives of all equations in all unknowns: motion of the solved points and then φ of the free ones, in x of the
    /// free points and then λ of the solved ones.
    pub fn factored(&self, linearised: &Linearised<N>) -> PartialPivLu<f64> {
        let (start, rods) = (self.multipliers(), linearised.constraints[0].len());
        let size = start + self.free.len() * rods;
        let mut matrix = Mat::zeros(size, size);
        for (i, k) in self.solved.iter().enumerate() {
            let row = i * N;
            self.neighbours(linearised, *k, |column, slope| set(&mut matrix, (row, column), slope));
            for (rod, gradient) in linearised.gradients(*k).enumerate() {
                set_column(&mut matrix, (row, start + i * rods + rod), gradient);
            }
        }
        for (i, k) in self.free.iter().enumerate() {
            for (rod, gradient) in linearised.gradients(*k).enumerate() {
                set_row(&mut matrix, (start + i * rods + rod, i * N), gradient);
            }
        }
        matrix.partial_piv_lu()
    }

    /// Calls `set` with the place of x of each free neighbour of point k among the unknowns, and the slope of k's equation in it.
    pub fn neighbours(
        &self,
        linearised: &Linearised<N>,
        k: usize,
        mut set: impl FnMut(usize, &Matrix<f64, N>),
    ) {
        for (point, slope) in (k - 1..).zip(&linearised.inner(k).slopes) {
            if let Ok(place) = self.free.binary_search(&point) {
                set(place * N, slope);
            }
        }
    }

    fn residuals(&self, linearised: &Linearised<N>) -> Mat<f64> {
        let (start, rods) = (self.multipliers(), linearised.constraints[0].len());
        let mut residuals = Mat::zeros(start + self.free.len() * rods, 1);
        for (i, k) in self.solved.iter().enumerate() {
            set_column(&mut residuals, (i * N, 0), &linearised.inner(*k).residual);
        }
        for (i, k) in self.free.iter().enumerate() {
            for (rod, constraint) in linearised.constraints[*k].iter().enumerate() {
                residuals[(start + i * rods + rod, 0)] = constraint.value;
            }
        }
        residuals
    }

    /// Takes the change from the unknowns; the largest of positions.
    fn apply(&mut self, change: &Mat<f64>) -> f64 {
        let (start, mut largest) = (self.multipliers(), 0.0_f64);
        for (i, k) in self.free.iter().enumerate() {
            let dx = column(change, (i * N, 0));
            self.x[*k] = add_scaled(&self.x[*k], -1.0, &dx);
            largest = largest.max(max_abs(&dx));
        }
        for (i, k) in self.solved.iter().enumerate() {
            let rods = self.lambda[*k].len();
            for (rod, lambda) in self.lambda[*k].iter_mut().enumerate() {
                *lambda -= change[(start + i * rods + rod, 0)];
            }
        }
        largest
    }
}

/// AB.
pub(super) fn product<const N: usize>(a: &Matrix<f64, N>, b: &Matrix<f64, N>) -> Matrix<f64, N> {
    let columns = transpose(b);
    std::array::from_fn(|i| multiply(&columns, &a[i]))
}

fn scaled<const N: usize>(a: &Matrix<f64, N>, c: f64) -> Matrix<f64, N> {
    a.map(|row| row.map(|entry| c * entry))
}
