//! A loss over all samples, as the optimisers see it, and those of a learned Lagrangian.

use super::blocks::Blocks;
use super::{Bounds, NormalEquations, Samples};
use leastaction_core::model::ModelError;
use leastaction_models::Architecture;
use leastaction_models::bounds;
use leastaction_models::rollout::order_of;
use leastaction_programs::System;
use leastaction_programs::dynamics::Rods;
use leastaction_programs::energies::WithOffsets;
use leastaction_programs::losses::{AccelerationLoss, DelLoss, Loss, NextStateLoss, RodsLoss, TorqueLoss};
use leastaction_programs::steps::RungeKutta;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// What is minimised. The discrete losses are those of the DEL integrator, and on rods those of RATTLE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LossKind {
    /// The residual of the three-point DEL equation at logged positions (SyMo), in units of momentum.
    DelResidual,
    /// The next position that the implicit step gives (E2E-SyMo), by the implicit function theorem.
    NextPosition,
    /// The acceleration at logged positions and velocities.
    Acceleration,
    /// Position and velocity after an explicit Runge–Kutta step from logged ones (L-NODE); without rods.
    NextState,
    /// The torque that the motion takes, over its standard deviation in the samples (DeLaN); without rods.
    Torque,
}

/// What a loss of torques minimises beside the plain residual.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TorqueTerms {
    /// Units of the coordinates' residuals, N m or N; none: 1 of each.
    pub units: Vec<f64>,
    /// Offsets o of the drives, τ = u + o, behind the weights of the model, N m or N, where there are such.
    pub offsets: Option<Offsets>,
}

/// Where offsets of drives stand behind the weights of a model, and whether they are learned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Offsets {
    /// Numbers between the weights and the offsets, and behind these, that the torque does not depend on.
    pub beside: [usize; 2],
    /// Whether they are known.
    pub are_known: bool,
}

impl LossKind {
    /// Whether it is one of the DEL integrator: positions and controls suffice.
    pub fn is_discrete(self) -> bool {
        matches!(self, Self::DelResidual | Self::NextPosition)
    }
}

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
    /// How many numbers the normal equations are of: the first. Those that follow belong to single samples, and are eliminated.
    fn shared(&self) -> usize {
        self.parameters()
    }
    /// How many of these are weights of the model, which a penalty on weights is of: the first.
    fn weights(&self) -> usize {
        self.shared()
    }
    /// All numbers, from those of an earlier objective or of the model alone.
    fn enter(&self, weights: Vec<f64>) -> Vec<f64> {
        weights
    }
    /// Prepares an iteration from these numbers; whether the loss at them is another one since.
    fn settle(&self, _weights: &mut [f64]) -> bool {
        false
    }
    /// The loss, once the numbers of single samples are solved anew after the shared ones have moved.
    fn completed_loss(&self, weights: &mut [f64]) -> f64 {
        self.loss(weights)
    }
    /// What decides between weights, over samples that they were not learned from.
    fn held_back_loss(&self, weights: &[f64]) -> f64 {
        self.loss(weights)
    }
    /// Whether its numbers are of different kinds and units: steps then do not depend on these units.
    fn is_of_many_units(&self) -> bool {
        false
    }
    /// An iteration that lowers the loss by less than this part of it is the last.
    fn tolerance(&self) -> f64 {
        0.0
    }
    /// Where every number may be, of a loss whose numbers may end at an end of their range: steps are cut off there. Of all others nothing.
    fn limits(&self) -> &[[f64; 2]] {
        &[]
    }
    /// The ranges of weights that the optimisers see as free numbers θ; everything else sees the weights.
    fn bounds(&self) -> &Bounds {
        &bounds::NONE
    }
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
    /// Mean of the squared errors of samples, `None` where one cannot be computed.
    pub fn of(squares: &[Option<f64>]) -> Self {
        let solved = squares.iter().flatten().count();
        Self::new(squares.iter().flatten().sum(), solved, squares.len() - solved)
    }

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
    let (system, h) = (System::new(&*architecture.energies()?), samples.h);
    let rods = architecture.rods()?;
    check_rods(&system, &rods, kind)?;
    let units = if kind == LossKind::Torque { samples.torque_deviations() } else { Vec::new() };
    let place = (architecture, system.parameters(), 0..0);
    of_architecture(place, samples, move || loss(kind, &system, &rods, (h, order, &units)))
}

/// The objective of the torque that a motion takes by a model of this shape ([`TorqueLoss`]), over states with accelerations and
/// torques.
///
/// # Errors
/// Where the shape does not fit in itself, or has rods.
pub fn torque_objective(
    architecture: &Architecture,
    samples: Samples,
    TorqueTerms { units, offsets }: TorqueTerms,
) -> Result<Box<dyn Objective>, ModelError> {
    architecture.check_without_rods("rods under the torque loss")?;
    let energies = architecture.energies()?;
    let Offsets { beside, are_known } = offsets.unwrap_or_default();
    let system = match offsets {
        Some(_) => System::new(&WithOffsets::new(energies).among(beside)),
        None => System::new(&*energies),
    };
    let start = architecture.parameters()? + beside[0];
    let known = if are_known { start..start + architecture.n() } else { 0..0 };
    let parameters = system.parameters();
    let make = move || -> Box<dyn Loss> { Box::new(TorqueLoss::new(&system).in_units(&units)) };
    of_architecture((architecture, parameters, known), samples, make)
}

/// That of a loss in so many numbers, of which the shape learns the first and some behind them are known.
fn of_architecture(
    (architecture, parameters, known): (&Architecture, usize, Range<usize>),
    samples: Samples,
    make: impl Fn() -> Box<dyn Loss> + Send + Sync + 'static,
) -> Result<Box<dyn Objective>, ModelError> {
    let place = (parameters, architecture.fixed_positions().into_iter().chain(known).collect());
    let own = architecture.clone();
    let project = Box::new(move |weights: &mut [f64]| own.project(weights));
    let blocks = Blocks::new(make, place, samples, project);
    Ok(Box::new(blocks.with_bounds(architecture.bounds())))
}

/// The objective of any loss over samples, for a model of so many weights, all of which are learned. `make` gives a loss to every
/// thread.
pub fn objective_of(
    make: impl Fn() -> Box<dyn Loss> + Send + Sync + 'static,
    parameters: usize,
    samples: Samples,
) -> Box<dyn Objective> {
    Box::new(Blocks::new(make, (parameters, Vec::new()), samples, Box::new(|_| ())))
}

/// An error for a loss that does not know rods, or energies that its steps on rods do not take.
fn check_rods(system: &System, rods: &Rods, kind: LossKind) -> Result<(), ModelError> {
    let refused = |what| Err(ModelError::Shape { what, found: rods.count(), compiled: 0 });
    match kind {
        _ if rods.count() == 0 => Ok(()),
        LossKind::Acceleration => Ok(()),
        LossKind::NextState => refused("rods under the next-state loss"),
        LossKind::Torque => refused("rods under the torque loss"),
        LossKind::DelResidual | LossKind::NextPosition if system.separable().is_none() => {
            refused("rods of energies that are not T(v) and V(q)")
        }
        LossKind::DelResidual | LossKind::NextPosition => Ok(()),
    }
}

fn loss(kind: LossKind, system: &System, rods: &Rods, (h, order, units): (f64, u8, &[f64])) -> Box<dyn Loss> {
    let next_position = kind == LossKind::NextPosition;
    let free = || DelLoss::new(system, h, order_of(order), next_position);
    match kind {
        LossKind::Acceleration => Box::new(AccelerationLoss::with_rods(system, rods.clone(), true)),
        LossKind::Torque => Box::new(TorqueLoss::new(system).in_units(units)),
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
