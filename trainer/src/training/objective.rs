//! A loss over all samples, as the optimisers see it, and that of a learned Lagrangian.

use super::blocks::Blocks;
use super::loss::{AccelerationLoss as ConstrainedAcceleration, Components, GroupLoss, Systems, Term};
use super::residuals::{ChunkRows, Failed, Residuals};
use super::{LossKind, NormalEquations, Samples};
use crate::architecture::{Architecture, Family, Visitor};
use leastaction_core::energy::{Learnable, LearnableForces};
use leastaction_core::forces::System as TypedSystem;
use leastaction_core::model::ModelError;
use leastaction_core::scalar::{LANES, Lanes};
use leastaction_programs::System;
use leastaction_programs::dynamics::{Order, Rods};
use leastaction_programs::losses::{AccelerationLoss, DelLoss, Loss, NextStateLoss, RodsLoss, RungeKutta};
use std::ops::Range;

/// A sum of squares to minimise over the weights.
pub trait Objective: Sync {
    /// Numbers in the weight block.
    fn parameters(&self) -> usize;
    /// Samples.
    fn samples(&self) -> usize;
    /// Mean squared residual component; infinite where a sample cannot be evaluated at these weights.
    fn loss(&self, weights: &[f64]) -> f64;
    /// The same of those samples alone that can be computed at these weights; the others may count as predicted by a constant
    /// velocity in the loss.
    fn solved(&self, weights: &[f64]) -> Solved {
        let loss = self.loss(weights);
        let unsolved = if loss.is_finite() { 0 } else { self.samples() };
        Solved { mean_square: Some(loss).filter(|loss| loss.is_finite()), unsolved }
    }
    /// The normal equations at these weights; `None` where a sample cannot be evaluated.
    fn normal_equations(&self, weights: &[f64]) -> Option<NormalEquations>;
    /// Jᵀr and rᵀr alone, over some samples; `None` where one cannot be evaluated.
    fn gradient(&self, weights: &[f64], samples: Range<usize>) -> Option<NormalEquations>;
    /// Brings weights that have a range (damping ≥ 0) back into it.
    fn project(&self, weights: &mut [f64]);
}

/// An error over what can be computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// Mean squared component; `None` where nothing can be computed.
    pub mean_square: Option<f64>,
    /// Samples that cannot.
    pub unsolved: usize,
}

impl Solved {
    /// Of a sum of squares of so many components.
    pub(crate) fn new(squares: f64, components: usize, unsolved: usize) -> Self {
        Self { mean_square: (components > 0).then(|| squares / components as f64), unsolved }
    }

    /// The mean square; infinite where a sample could not be computed.
    pub fn or_infinite(self) -> f64 {
        self.mean_square.filter(|_| self.unsolved == 0).unwrap_or(f64::INFINITY)
    }
}

/// The objective of a loss over samples for a model of this shape; `order` (2 or 4) matters to the discrete losses and
/// to that of the next state: 2 is the explicit midpoint rule there, 4 the 3/8 rule.
///
/// # Errors
/// Where the shape does not fit in itself, or the loss does not know its rods.
pub fn objective(
    architecture: &Architecture,
    samples: Samples,
    kind: LossKind,
    order: u8,
) -> Result<Box<dyn Objective>, ModelError> {
    let parameters = architecture.parameters()?;
    let (system, h) = (System::new(&*architecture.energies()?), samples.h);
    let rods = architecture.rods()?;
    check_rods(&system, &rods, kind)?;
    let make = move || loss(kind, &system, &rods, (h, order));
    let (fixed, architecture) = (architecture.fixed_positions(), architecture.clone());
    let project = Box::new(move |weights: &mut [f64]| architecture.project(weights));
    Ok(Box::new(Blocks::new(make, (parameters, fixed), samples, project)))
}

/// An error for a loss that does not know rods, or energies that its steps on rods do not take.
fn check_rods(system: &System, rods: &Rods, kind: LossKind) -> Result<(), ModelError> {
    let refused = |what| Err(ModelError::Shape { what, found: rods.count(), compiled: 0 });
    match kind {
        _ if rods.count() == 0 => Ok(()),
        LossKind::Acceleration => Ok(()),
        LossKind::NextState => refused("rods under the next-state loss"),
        LossKind::DelResidual | LossKind::NextPosition if system.separable().is_none() => {
            refused("rods of energies that are not T(v) and V(q)")
        }
        LossKind::DelResidual | LossKind::NextPosition => Ok(()),
    }
}

fn loss(kind: LossKind, system: &System, rods: &Rods, (h, order): (f64, u8)) -> Box<dyn Loss> {
    let next_position = kind == LossKind::NextPosition;
    let free = || DelLoss::new(system, h, order_of(order), next_position);
    match kind {
        LossKind::Acceleration => Box::new(AccelerationLoss::with_rods(system, rods.clone(), true)),
        LossKind::NextState => Box::new(NextStateLoss::new(system, h, RungeKutta::of_order(order))),
        LossKind::DelResidual | LossKind::NextPosition if rods.count() == 0 => Box::new(free()),
        LossKind::DelResidual | LossKind::NextPosition => {
            match RodsLoss::new(system, rods.clone(), h, order_of(order), next_position) {
                Some(loss) => Box::new(loss),
                // Refused before: see `check_rods`.
                None => Box::new(free()),
            }
        }
    }
}

/// The integrator's order: 4, or 2 for whatever else.
pub(crate) fn order_of(order: u8) -> Order {
    if order == 4 { Order::Four } else { Order::Two }
}

/// The acceleration loss over samples for a family whose weights are all learned, so many of them.
pub struct Accelerations {
    /// Numbers in the weight block.
    pub parameters: usize,
    /// (q, v, v̇).
    pub samples: Samples,
}

impl Visitor for Accelerations {
    type Output = Box<dyn Objective>;

    fn visit<F: Family<N> + Clone + 'static, const N: usize>(self, family: &F) -> Self::Output {
        let Self { parameters, samples } = self;
        Box::new(Sum { family: family.clone(), parameters, samples, loss: ConstrainedAcceleration })
    }
}

struct Sum<F, T, const N: usize> {
    family: F,
    /// Numbers in the weight block.
    parameters: usize,
    samples: Samples,
    loss: T,
}

/// Σ r².
fn squares(residual: &[f64]) -> f64 {
    residual.iter().map(|r| r * r).sum()
}

/// The components' terms in one, weighed by the residual.
fn contracted<const N: usize>(residual: &[f64], terms: &[Term<N>]) -> Term<N> {
    let y = |i| terms.iter().zip(residual).map(|(term, r)| r * term.y[i]).sum();
    Term { y: std::array::from_fn(y), ..terms[0] }
}

/// Adds the derivatives in the weights of one residual component of eight samples.
fn add_rows<L, Q, const N: usize>(
    TypedSystem { lagrangian, forces }: &TypedSystem<L, Q>,
    terms: [&Term<N>; LANES],
    row: &mut [Lanes],
) where
    L: Learnable<Lanes, N>,
    Q: LearnableForces<Lanes, N>,
{
    let lanes = |field: fn(&Term<N>) -> &[f64; N]| -> [Lanes; N] {
        std::array::from_fn(|i| Lanes(std::array::from_fn(|lane| field(terms[lane])[i])))
    };
    let (q, v, y, a) = (lanes(|t| &t.q), lanes(|t| &t.v), lanes(|t| &t.y), lanes(|t| &t.a));
    let mut add = |i: usize, g: Lanes| row[i] += g;
    lagrangian.residual_gradient((&q, &v), &a, &y, &mut add);
    forces.force_gradient((&q, &v), &y, &mut add);
}

impl<F: Family<N>, T: GroupLoss<F, N>, const N: usize> Residuals for Sum<F, T, N> {
    fn parameters(&self) -> usize {
        self.parameters
    }

    fn samples(&self) -> usize {
        self.samples.len()
    }

    fn components(&self) -> usize {
        T::Residual::COUNT
    }

    fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed> {
        let systems = Systems::new(&self.family, weights)?;
        let mut sum = 0.0;
        for start in samples.clone().step_by(LANES) {
            let residuals = self.loss.residuals(&systems, &self.samples.group(start, &samples))?;
            let own = residuals.iter().take(samples.end - start);
            sum += own.map(|residual| squares(residual.as_slice())).sum::<f64>();
        }
        Ok(sum)
    }

    fn linearise(&self, weights: &[f64], samples: Range<usize>, rows: &mut ChunkRows) -> Result<(), Failed> {
        let systems = Systems::new(&self.family, weights)?;
        let count = samples.len();
        rows.reset(count * T::Residual::COUNT, weights.len());
        for start in (0..count).step_by(LANES) {
            let mut terms = [const { Vec::new() }; LANES];
            let group = self.samples.group(samples.start + start, &samples);
            let residuals = self.loss.linearise_group(&systems, &group, &mut terms)?;
            for (k, residual) in (start..count).zip(residuals) {
                for (i, residual) in residual.as_slice().iter().enumerate() {
                    rows.residual[i * count + k] = *residual;
                }
            }
            for i in 0..T::Residual::COUNT {
                let terms = terms.each_ref().map(|terms| &terms[i]);
                rows.buffer.fill(Lanes([0.0; LANES]));
                add_rows(&systems.eight, terms, &mut rows.buffer);
                rows.store(i * count + start, (count - start).min(LANES));
            }
        }
        Ok(())
    }

    /// Without the Jacobian: the terms are linear in their weights, so a sample's components are added before the network is
    /// differentiated.
    fn add_gradient(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        rows: &mut ChunkRows,
        sum: &mut NormalEquations,
    ) -> Result<(), Failed> {
        let systems = Systems::new(&self.family, weights)?;
        rows.reset_buffer(weights.len());
        for start in samples.clone().step_by(LANES) {
            let mut terms = [const { Vec::new() }; LANES];
            let group = self.samples.group(start, &samples);
            let residuals = self.loss.linearise_group(&systems, &group, &mut terms)?;
            // What fills the group up has no residual.
            let none = vec![0.0; T::Residual::COUNT];
            let own: [&[f64]; LANES] = std::array::from_fn(|lane| {
                if lane < samples.end - start { residuals[lane].as_slice() } else { &none }
            });
            sum.squares += own.iter().copied().flatten().map(|r| r * r).sum::<f64>();
            let weighed: [Term<N>; LANES] = std::array::from_fn(|lane| contracted(own[lane], &terms[lane]));
            add_rows(&systems.eight, weighed.each_ref(), &mut rows.buffer);
        }
        sum.add_lanes(&rows.buffer, samples.len() * T::Residual::COUNT);
        Ok(())
    }
}
