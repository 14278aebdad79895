//! A loss over all samples, as the optimisers see it, and that of a learned Lagrangian.

use super::del::DelLoss;
use super::loss::{AccelerationLoss, Components, GroupLoss, OneByOne, Systems, Term, TermKind};
use super::next_state::NextStateLoss;
use super::residuals::{ChunkRows, Failed, Residuals};
use super::rods::RodsLoss;
use super::{LossKind, NormalEquations, Samples};
use crate::architecture::{
    Architecture, Family, FamilySystem, GraphArchitecture, MAX_DISCRETE, Visitor, too_large_for_steps,
};
use crate::runge_kutta::RungeKutta;
use leastaction_core::discrete::{Del, Galerkin, Midpoint, Newton, Path};
use leastaction_core::energy::{Learnable, LearnableForces};
use leastaction_core::forces::System;
use leastaction_core::model::ModelError;
use leastaction_core::scalar::{LANES, Lanes};
use std::ops::Range;

/// A sum of squares to minimise over the weights.
pub trait Objective: Sync {
    /// Numbers in the weight block.
    fn parameters(&self) -> usize;
    /// Samples.
    fn samples(&self) -> usize;
    /// Mean squared residual component; infinite where a sample cannot be evaluated at these weights.
    fn loss(&self, weights: &[f64]) -> f64;
    /// The normal equations at these weights; `None` where a sample cannot be evaluated.
    fn normal_equations(&self, weights: &[f64]) -> Option<NormalEquations>;
    /// Jᵀr and rᵀr alone, over some samples; `None` where one cannot be evaluated.
    fn gradient(&self, weights: &[f64], samples: Range<usize>) -> Option<NormalEquations>;
    /// Brings weights that have a range (damping ≥ 0) back into it.
    fn project(&self, weights: &mut [f64]);
}

/// The objective of a loss over samples for a model of this shape; `order` (2 or 4) matters to the discrete losses and
/// to that of the next state: 2 is the explicit midpoint rule there, 4 the 3/8 rule.
///
/// # Errors
/// Where the shape is beyond what is compiled.
pub fn objective(
    architecture: &Architecture,
    samples: Samples,
    kind: LossKind,
    order: u8,
) -> Result<Box<dyn Objective>, ModelError> {
    architecture.parameters()?;
    architecture.dispatch(Build { architecture: architecture.clone(), samples, kind, order })?
}

struct Build {
    architecture: Architecture,
    samples: Samples,
    kind: LossKind,
    order: u8,
}

impl Visitor for Build {
    type Output = Result<Box<dyn Objective>, ModelError>;

    fn visit<F: Family<N> + Clone + 'static, const N: usize>(self, family: &F) -> Self::Output {
        let h = self.samples.h;
        match (self.kind, self.order) {
            (LossKind::Acceleration, _) => Ok(self.boxed(family, AccelerationLoss)),
            // What is false for a constant is not compiled.
            _ if const { N > MAX_DISCRETE } => too_large_for_steps(N),
            (LossKind::NextState, _) if const { F::CONSTRAINED } && self.has_rods() => {
                let what = "rods under the next-state loss";
                Err(ModelError::Shape { what, found: self.rods(), compiled: 0 })
            }
            (LossKind::NextState, order) => {
                Ok(self.boxed(family, NextStateLoss { h, method: RungeKutta::of_order(order) }))
            }
            (kind, order) if const { F::CONSTRAINED } && self.has_rods() => {
                Ok(self.boxed(family, OneByOne(RodsLoss::new(h, order, kind))))
            }
            (kind, 4) => Ok(self.boxed(family, del_loss::<Galerkin>(h, kind))),
            (kind, _) => Ok(self.boxed(family, del_loss::<Midpoint>(h, kind))),
        }
    }
}

impl Build {
    fn rods(&self) -> usize {
        let graph = self.architecture.graph().and_then(|graph| graph.graph().ok());
        graph.map_or(0, |graph| graph.rods.len())
    }

    fn has_rods(&self) -> bool {
        self.architecture.graph().is_some_and(GraphArchitecture::has_rods)
    }

    fn boxed<F: Family<N> + Clone + 'static, T: GroupLoss<F, N> + 'static, const N: usize>(
        self,
        family: &F,
        loss: T,
    ) -> Box<dyn Objective> {
        let Self { architecture, samples, .. } = self;
        let (fixed, parameters) = (architecture.fixed_positions(), architecture.parameters().unwrap_or(0));
        let project = Box::new(move |weights: &mut [f64]| architecture.project(weights));
        Box::new(Sum { family: family.clone(), parameters, fixed, samples, loss, project })
    }
}

/// The acceleration loss over samples for a family whose weights are all learned, so many of them.
pub(crate) struct Accelerations {
    /// Numbers in the weight block.
    pub parameters: usize,
    /// (q, v, v̇).
    pub samples: Samples,
}

impl Visitor for Accelerations {
    type Output = Box<dyn Objective>;

    fn visit<F: Family<N> + Clone + 'static, const N: usize>(self, family: &F) -> Self::Output {
        let Self { parameters, samples } = self;
        let (family, loss, project) = (family.clone(), AccelerationLoss, Box::new(|_: &mut [f64]| ()));
        Box::new(Sum { family, parameters, fixed: Vec::new(), samples, loss, project })
    }
}

fn del_loss<P: Path>(h: f64, kind: LossKind) -> OneByOne<DelLoss<P>> {
    let newton = Newton { max_iterations: 50, stop: 1e-14, accept: 1e-9 };
    let next_position = kind == LossKind::NextPosition;
    OneByOne(DelLoss { del: Del::with_newton(h, newton), newton, next_position })
}

/// Brings weights that have a range back into it.
type Projection = Box<dyn Fn(&mut [f64]) + Sync>;

struct Sum<F, T, const N: usize> {
    family: F,
    /// Numbers in the weight block.
    parameters: usize,
    /// What the loss is not to be varied in.
    fixed: Vec<usize>,
    samples: Samples,
    loss: T,
    project: Projection,
}

impl<F: Family<N>, T: GroupLoss<F, N>, const N: usize> Sum<F, T, N> {
    fn rows<'s, 'w>(&'s self, systems: &'s Systems<'w, F, N>) -> Rows<'s, FamilySystem<'w, F, Lanes, N>> {
        Rows { system: &systems.eight, kinds: self.loss.kinds(), fixed: &self.fixed }
    }
}

/// Σ r².
fn squares(residual: &[f64]) -> f64 {
    residual.iter().map(|r| r * r).sum()
}

/// Of each kind one term: the components' terms, weighed by the residual.
fn contracted<const N: usize>(residual: &[f64], terms: &[Term<N>], kinds: &[TermKind]) -> Vec<Term<N>> {
    let weighed = |(k, kind): (usize, &TermKind)| {
        let of_kind = || terms.iter().skip(k).step_by(kinds.len()).zip(residual);
        let sum = |field: fn(&Term<N>) -> &[f64; N]| -> [f64; N] {
            std::array::from_fn(|i| of_kind().map(|(term, r)| r * field(term)[i]).sum())
        };
        let first = terms[k];
        let dv = if *kind == TermKind::Residual { first.dv } else { sum(|term| &term.dv) };
        Term { dq: sum(|term| &term.dq), dv, ..first }
    };
    kinds.iter().enumerate().map(weighed).collect()
}

/// What the rows of the Jacobian depend on beside the terms: the family alone, whatever the loss.
struct Rows<'s, Y> {
    system: &'s Y,
    kinds: &'s [TermKind],
    /// What the loss is not to be varied in.
    fixed: &'s [usize],
}

impl<L, Q> Rows<'_, System<L, Q>> {
    /// Adds the derivatives in the weights of one residual component of eight samples; `terms\[lane\]\[k\]` is the term of
    /// kind k.
    fn add<const N: usize>(&self, terms: [&[Term<N>]; LANES], row: &mut [Lanes])
    where
        L: Learnable<Lanes, N>,
        Q: LearnableForces<Lanes, N>,
    {
        let System { lagrangian, forces } = self.system;
        for (k, kind) in self.kinds.iter().enumerate() {
            let lanes = |field: fn(&Term<N>) -> &[f64; N]| -> [Lanes; N] {
                std::array::from_fn(|i| Lanes(std::array::from_fn(|lane| field(&terms[lane][k])[i])))
            };
            let (q, v, dq, dv) = (lanes(|t| &t.q), lanes(|t| &t.v), lanes(|t| &t.dq), lanes(|t| &t.dv));
            let mut add = |i: usize, g: Lanes| row[i] += g;
            match kind {
                TermKind::Along => lagrangian.directional_gradient((&q, &v), (&dq, &dv), &mut add),
                TermKind::Residual => lagrangian.residual_gradient((&q, &v), &dv, &dq, &mut add),
            }
            forces.force_gradient((&q, &v), &dq, &mut add);
        }
        for position in self.fixed {
            row[*position] = Lanes([0.0; LANES]);
        }
    }
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
        let (count, width) = (samples.len(), self.loss.kinds().len());
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
                let terms = terms.each_ref().map(|terms| &terms[i * width..]);
                rows.buffer.fill(Lanes([0.0; LANES]));
                self.rows(&systems).add(terms, &mut rows.buffer);
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
            let weighed: [Vec<Term<N>>; LANES] =
                std::array::from_fn(|lane| contracted(own[lane], &terms[lane], self.loss.kinds()));
            self.rows(&systems).add(weighed.each_ref().map(Vec::as_slice), &mut rows.buffer);
        }
        sum.add_lanes(&rows.buffer, samples.len() * T::Residual::COUNT);
        Ok(())
    }

    fn project(&self, weights: &mut [f64]) {
        (self.project)(weights);
    }
}
