//! A loss over all samples as the optimisers see it, and the losses of a learned Lagrangian.

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

/// Loss to minimise. The discrete losses use the DEL integrator; for a model with rods that is RATTLE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LossKind {
    /// The residual of the three-point DEL equation at logged positions (SyMo), in units of momentum.
    DelResidual,
    /// The error of the next position, which is the solution of the implicit step (E2E-SyMo); it is differentiated by
    /// the implicit function theorem.
    NextPosition,
    /// The error of the acceleration at logged positions and velocities.
    Acceleration,
    /// The errors of position and velocity after an explicit Runge–Kutta step from logged values (L-NODE); without rods.
    NextState,
    /// The error of the torque that the motion requires, divided by the torque's standard deviation in the samples (DeLaN); without rods.
    Torque,
}

/// Units and offsets of a torque loss.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TorqueTerms {
    /// Units of the residuals by coordinate, N m or N; empty: 1 for each.
    pub units: Vec<f64>,
    /// Offsets o of the drives, τ = u + o, N m or N, whose positions follow the model's weights; `None` if there are
    /// none.
    pub offsets: Option<Offsets>,
}

/// Place of the drives' offsets after the weights of a model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Offsets {
    /// Counts of further numbers before and after the offsets; the torque does not depend on these numbers.
    pub beside: [usize; 2],
    /// Whether the offsets are known, not learned.
    pub are_known: bool,
}

impl LossKind {
    /// Whether the loss uses the DEL integrator: positions and controls suffice.
    pub fn is_discrete(self) -> bool {
        matches!(self, Self::DelResidual | Self::NextPosition)
    }
}

/// A sum of squares to minimise over the weights.
pub trait Objective: Sync {
    /// Size of the weight block.
    fn parameters(&self) -> usize;
    /// Number of samples.
    fn samples(&self) -> usize;
    /// Mean squared residual component; infinite if a sample cannot be evaluated at these weights.
    fn loss(&self, weights: &[f64]) -> f64;
    /// The loss over only those samples that can be computed at these weights; in [`Objective::loss`] the others may
    /// count as predicted by a constant velocity.
    fn solved(&self, weights: &[f64]) -> Solved {
        let loss = self.loss(weights);
        let unsolved = if loss.is_finite() { 0 } else { self.samples() };
        Solved { mean_square: Some(loss).filter(|loss| loss.is_finite()), unsolved }
    }
    /// The normal equations at these weights; `None` if a sample cannot be evaluated.
    fn normal_equations(&self, weights: &[f64]) -> Option<NormalEquations>;
    /// Jᵀr and rᵀr alone, over some samples; `None` if a sample cannot be evaluated.
    fn gradient(&self, weights: &[f64], samples: Range<usize>) -> Option<NormalEquations>;
    /// Moves weights that have a range (damping ≥ 0) back into it.
    fn project(&self, weights: &mut [f64]);
    /// Number of parameters in the normal equations, from the first on. The parameters after these belong to single
    /// samples and are eliminated.
    fn shared(&self) -> usize {
        self.parameters()
    }
    /// Number of model weights, from the first parameter on, to which a penalty on weights applies.
    fn weights(&self) -> usize {
        self.shared()
    }
    /// All parameters, given those of an earlier objective or of the model alone.
    fn enter(&self, weights: Vec<f64>) -> Vec<f64> {
        weights
    }
    /// Prepares an iteration from these parameters; returns whether this changes the loss.
    fn settle(&self, _weights: &mut [f64]) -> bool {
        false
    }
    /// The loss after the parameters of single samples are solved for again, so that they follow a change of the shared
    /// ones.
    fn completed_loss(&self, weights: &mut [f64]) -> f64 {
        self.loss(weights)
    }
    /// The criterion that decides between weights, evaluated on samples that were not used for learning.
    fn held_back_loss(&self, weights: &[f64]) -> f64 {
        self.loss(weights)
    }
    /// The loss of a motion with constant velocity in every sample; `None` if it is not defined for this loss.
    fn loss_of_constant_velocity(&self) -> Option<f64> {
        None
    }
    /// Whether the parameters have different units; the steps are then independent of the units.
    fn is_of_many_units(&self) -> bool {
        false
    }
    /// Relative decrease of the loss below which an iteration is the last.
    fn tolerance(&self) -> f64 {
        0.0
    }
    /// Closed ranges of the parameters, to which steps are clipped; empty unless parameters may end at a bound of their
    /// range.
    fn limits(&self) -> &[[f64; 2]] {
        &[]
    }
    /// The ranges of weights. The optimisers see such weights as unbounded numbers θ; everything else sees the weights.
    fn bounds(&self) -> &Bounds {
        &bounds::NONE
    }
}

/// An error over the samples that can be computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// Mean squared component; `None` if no sample can be computed.
    pub mean_square: Option<f64>,
    /// Number of samples that cannot be computed.
    pub unsolved: usize,
}

impl Solved {
    /// Mean of the squared errors of samples; `None` stands for a sample that cannot be computed.
    pub fn of(squares: &[Option<f64>]) -> Self {
        let solved = squares.iter().flatten().count();
        Self::new(squares.iter().flatten().sum(), solved, squares.len() - solved)
    }

    /// The error from a sum of squares over `components` components.
    pub(crate) fn new(squares: f64, components: usize, unsolved: usize) -> Self {
        Self { mean_square: (components > 0).then(|| squares / components as f64), unsolved }
    }

    /// The mean square; infinite if any sample could not be computed.
    pub fn or_infinite(self) -> f64 {
        self.mean_square.filter(|_| self.unsolved == 0).unwrap_or(f64::INFINITY)
    }
}

/// The objective of a loss over samples for a model of this shape. `order` (2 or 4) matters to the discrete losses and to the next-state
/// loss, where 2 is the explicit midpoint rule and 4 the 3/8 rule.
///
/// # Errors
/// [`ModelError`] if the shape is inconsistent, or if the loss does not support its rods.
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

/// The torque loss ([`TorqueLoss`]) for a model of this shape, over states with accelerations and torques.
///
/// # Errors
/// [`ModelError`] if the shape is inconsistent or has rods.
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

/// The objective of a loss with `parameters` parameters. The first of them are the weights of the shape; those in
/// `known` are fixed.
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

/// The objective of any loss over samples, for a model with `parameters` weights, all of them learned. `make` creates a loss for every
/// thread.
pub fn objective_of(
    make: impl Fn() -> Box<dyn Loss> + Send + Sync + 'static,
    parameters: usize,
    samples: Samples,
) -> Box<dyn Objective> {
    Box::new(Blocks::new(make, (parameters, Vec::new()), samples, Box::new(|_| ())))
}

/// Refuses rods for a loss that does not support them, and energies that steps on rods do not support.
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
                // `check_rods` has refused such energies.
                None => Box::new(free()),
            }
        }
    }
}
