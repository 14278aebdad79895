//! The discrete losses on rods: those of RATTLE, which steps what has rods.
//!
//! A step is a chain of steps of order 2 ([`Chain`]). With y the weights of the points' equations in a residual component, and
//! z = ∂v/∂pᵀ Q_vᵀ ½(h_{k−1} + h_k) y those of the equations of v, its derivative in θ is the sum over points of
//! ∂/∂θ [F(x_k, v_k)·(½(h_{k−1} + h_k) y_k + ½h_{k−1} z_k) − L_v(v_k)·z_k] and over steps of
//! ∂/∂θ [L_v(w_k)·(y_{k+1} + z_{k+1} − y_k)]: the multipliers and what is not logged follow by the implicit function theorem.

mod blocks;
mod chain;
mod velocity;

use super::loss::{SampleLoss, Systems, Term, TermKind, identity, take_out};
use super::samples::Sample;
use super::{Failed, LossKind};
use crate::architecture::Family;
use blocks::{column, finite, set};
use chain::{Chain, Linearised, product};
use faer::Mat;
use faer::linalg::solvers::Solve;
use leastaction_core::discrete::Order;
use leastaction_core::linear::{Matrix, add_scaled, multiply, transpose};

/// Newton updates at most.
const MAX_ITERATIONS: u8 = 12;
/// An update of this relative size is the last: the next would be of the size of its square.
const SETTLED: f64 = 1e-9;

/// A loss of three consecutive positions under RATTLE. The force is the mean of the controls at both ends of a step.
pub(super) struct RodsLoss {
    /// Lengths of the steps of order 2 that a step is made of, s.
    substeps: Vec<f64>,
    /// Whether the residual is that of the next position; else that of the DEL equation at the middle position, along what the
    /// constraints there leave free.
    next_position: bool,
}

impl RodsLoss {
    /// Of a step h, s, and order 4, or 2 whatever else.
    pub fn new(h: f64, order: u8, kind: LossKind) -> Self {
        let order = if order == 4 { Order::Four } else { Order::Two };
        Self { substeps: order.substeps(h).collect(), next_position: kind == LossKind::NextPosition }
    }

    fn solve<F: Family<N>, const N: usize>(
        &self,
        systems: &Systems<F, N>,
        sample: &Sample<N>,
    ) -> Result<Chain<N>, Failed> {
        let mut chain = Chain::new(sample, &self.substeps, self.next_position);
        chain.solve(systems)?;
        Ok(chain)
    }

    /// The point at the middle position.
    fn middle(&self) -> usize {
        self.substeps.len()
    }

    /// From the logged next position to that of the chain.
    fn missed<const N: usize>(&self, chain: &Chain<N>, sample: &Sample<N>) -> [f64; N] {
        add_scaled(&chain.x[2 * self.middle()], -1.0, &sample.states[2])
    }

    /// The projection to what the constraints at the middle position leave free: their impulses Aᵀλ have no part there.
    fn tangent<const N: usize>(&self, linearised: &Linearised<N>) -> Result<Matrix<f64, N>, Failed> {
        let mut tangent = identity();
        for gradient in linearised.gradients(self.middle()) {
            take_out(&mut tangent, gradient, true)?;
        }
        Ok(tangent)
    }

    /// For every residual component r_i the weights y of all points' equations, zero at both ends: of what is solved −K⁻ᵀ ∂r_i,
    /// of the middle equation, where it is not, the tangent's row.
    fn weights<const N: usize>(
        &self,
        chain: &Chain<N>,
        linearised: &Linearised<N>,
        tangent: &Matrix<f64, N>,
    ) -> Result<[Vec<[f64; N]>; N], Failed> {
        let mut weights = std::array::from_fn(|_| vec![[0.0; N]; chain.x.len()]);
        if !self.next_position {
            weights.iter_mut().zip(tangent).for_each(|(y, row)| y[self.middle()] = *row);
        }
        if chain.free.is_empty() {
            return Ok(weights);
        }
        let factored = chain.factored(linearised);
        let mut varied = Mat::zeros(factored.L().nrows(), N);
        if self.next_position {
            set(&mut varied, ((chain.free.len() - 1) * N, 0), &identity::<N>());
        } else {
            // The tangent is symmetric.
            chain.neighbours(linearised, self.middle(), |place, slope| {
                set(&mut varied, (place, 0), &product(&transpose(slope), tangent));
            });
        }
        let solution = finite(factored.solve_transpose(&varied))?;
        for (i, y) in weights.iter_mut().enumerate() {
            for (j, k) in chain.solved.iter().enumerate() {
                y[*k] = column(&solution, (j * N, i)).map(|x| -x);
            }
        }
        Ok(weights)
    }
}

/// The terms of one residual component: first of the steps, then of the inner points.
fn push_terms<const N: usize>(
    chain: &Chain<N>,
    linearised: &Linearised<N>,
    y: &[[f64; N]],
    terms: &mut Vec<Term<N>>,
) {
    let inner = 1..chain.h.len();
    let mut z = vec![[0.0; N]; chain.x.len()];
    for k in inner.clone() {
        let velocity = &linearised.inner(k).velocity;
        let braked = multiply(&transpose(&velocity.slope), &y[k]).map(|x| chain.span(k) * x);
        z[k] = multiply(&transpose(&velocity.v_p), &braked);
    }
    terms.extend((0..chain.h.len()).map(|k| {
        let dv = std::array::from_fn(|i| y[k + 1][i] + z[k + 1][i] - y[k][i]);
        Term { q: chain.x[k], v: chain.increment(k), dq: [0.0; N], dv }
    }));
    terms.extend(inner.map(|k| {
        let dq = std::array::from_fn(|i| chain.span(k) * y[k][i] + 0.5 * chain.h[k - 1] * z[k][i]);
        Term { q: chain.x[k], v: linearised.inner(k).velocity.v, dq, dv: z[k].map(|z| -z) }
    }));
}

impl<F: Family<N>, const N: usize> SampleLoss<F, N> for RodsLoss {
    fn kinds(&self) -> &'static [TermKind] {
        if self.middle() == 1 { &[TermKind::Along; 3] } else { &[TermKind::Along; 19] }
    }

    fn residual(&self, systems: &Systems<F, N>, sample: &Sample<N>) -> Result<[f64; N], Failed> {
        let mut chain = self.solve(systems, sample)?;
        if self.next_position {
            return Ok(self.missed(&chain, sample));
        }
        let linearised = chain.linearise(systems)?;
        Ok(multiply(&self.tangent(&linearised)?, &linearised.inner(self.middle()).residual))
    }

    fn linearise(
        &self,
        systems: &Systems<F, N>,
        sample: &Sample<N>,
        terms: &mut Vec<Term<N>>,
    ) -> Result<[f64; N], Failed> {
        let mut chain = self.solve(systems, sample)?;
        let linearised = chain.linearise(systems)?;
        let tangent = self.tangent(&linearised)?;
        let weights = self.weights(&chain, &linearised, &tangent)?;
        weights.iter().for_each(|y| push_terms(&chain, &linearised, y, terms));
        if self.next_position {
            return Ok(self.missed(&chain, sample));
        }
        Ok(multiply(&tangent, &linearised.inner(self.middle()).residual))
    }
}
