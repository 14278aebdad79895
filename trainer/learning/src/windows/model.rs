//! Model and settings of a loss over windows.

use super::Calibration;
use crate::training::Bounds;
use leastaction_core::model::{ModelError, TrainedStep};
use leastaction_models::Architecture;
use leastaction_models::rollout::order_of;
use leastaction_programs::System;
use leastaction_programs::steps::{ExplicitSteps, RungeKutta, Steps, VariationalSteps};
use serde::{Deserialize, Serialize};

/// Relative difference below which two steps count as equal: a model file holds the step in single precision.
const SAME_STEP: f64 = 1e-6;

/// Integrator from one sample to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Explicit Runge–Kutta steps, whose length is adapted to motion and noise: gives energies and forces in continuous
    /// time.
    #[default]
    RungeKutta,
    /// Steps of the discrete Euler–Lagrange equation from sample to sample, as in a controller: gives the energies and
    /// forces with which steps of this length predict best.
    Del,
}

impl Integrator {
    /// Integrator, order and steps for a model along samples that are h (s) apart: the integrator of the step that the model was trained with
    /// if that step is h. Otherwise, in steps of at most `longest` (s), Runge–Kutta of order 4 or, for a model with friction that sticks or
    /// end stops, the variational steps that solve these.
    pub fn of_trained(
        step: Option<TrainedStep>,
        system: &System,
        (h, longest): (f64, f64),
    ) -> (Self, u8, f64) {
        let fits = |step: &TrainedStep| (f64::from(step.h) - h).abs() < SAME_STEP * h;
        let parts = (h / longest).ceil().max(1.0);
        match step.filter(fits) {
            Some(step) => (Self::Del, step.order.number(), 1.0),
            None if system.has_contacts() => (Self::Del, 2, parts),
            None => (Self::RungeKutta, 4, parts),
        }
    }

    /// Steps of h (s), with derivatives with respect to the weights at the positions `learned`.
    pub(crate) fn steps(self, system: &System, (h, order): (f64, u8), learned: Vec<usize>) -> Box<dyn Steps> {
        match self {
            Self::RungeKutta => {
                let method = RungeKutta::of_order(order);
                Box::new(ExplicitSteps::new(system, h, method).with_learned(learned))
            }
            Self::Del => Box::new(VariationalSteps::new(system, h, order_of(order)).with_learned(learned)),
        }
    }
}

/// Settings of a loss over windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowSettings {
    /// Steps in a window, at least 1.
    pub steps: usize,
    /// Steps from the start of a window to the start of the next, at least 1.
    pub stride: usize,
    /// Integrator.
    pub integrator: Integrator,
    /// Longest Runge–Kutta step, s; see [`Pace`](super::Pace).
    pub longest_step: f64,
    /// Order of the integrator: 2 or 4.
    pub order: u8,
    /// Settings of sensors and actuators.
    pub calibration: Calibration,
}

/// Moves weights that have a range back into it.
pub(super) type Projection = Box<dyn Fn(&mut [f64]) + Send + Sync>;

/// A model as a loss over windows sees it.
pub struct WindowModel {
    /// Equations of motion.
    pub system: System,
    /// Positions of the weights that are known.
    pub fixed: Vec<usize>,
    /// Ranges of the other weights, which the optimisers see as unbounded numbers.
    pub bounds: Bounds,
    /// Moves weights with another kind of range back into it.
    pub project: Projection,
}

impl WindowModel {
    /// The model of this shape.
    ///
    /// # Errors
    /// [`ModelError`] if the shape is inconsistent or has rods.
    pub fn new(architecture: &Architecture) -> Result<Self, ModelError> {
        architecture.check_without_rods("rods under a loss over windows")?;
        let own = architecture.clone();
        Ok(Self {
            system: System::new(&*architecture.energies()?),
            fixed: architecture.fixed_positions(),
            bounds: architecture.bounds(),
            project: Box::new(move |weights: &mut [f64]| own.project(weights)),
        })
    }

    /// Holds the networks that correct the model as they are.
    #[must_use]
    pub fn with_known_corrections(mut self, architecture: &Architecture) -> Self {
        let start = architecture.corrections_start();
        self.fixed.extend(start..start + architecture.corrections.count());
        self
    }
}
