//! What a loss over windows is made of.

use super::Calibration;
use crate::training::Bounds;
use leastaction_core::model::{ModelError, TrainedStep};
use leastaction_models::Architecture;
use leastaction_models::rollout::order_of;
use leastaction_programs::System;
use leastaction_programs::steps::{ExplicitSteps, RungeKutta, Steps, VariationalSteps};
use serde::{Deserialize, Serialize};

/// Steps that differ by less than this part are one: a model file has them in single precision.
const SAME_STEP: f64 = 1e-6;

/// What takes a state from one sample to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Explicit Runge–Kutta steps, as long or short as motion and noise ask for: energies and forces in continuous time.
    #[default]
    RungeKutta,
    /// A step of the discrete Euler–Lagrange equation from sample to sample, as a controller takes it: energies and forces
    /// whose steps of this length predict best.
    Del,
}

impl Integrator {
    /// What a model is to be integrated by along samples h apart, s, and of which order: by the step that it was trained with where that is
    /// as long, else by Runge–Kutta steps of order 4.
    pub fn of_trained(step: Option<TrainedStep>, h: f64) -> (Self, u8) {
        let fits = |step: &TrainedStep| (f64::from(step.h) - h).abs() < SAME_STEP * h;
        step.filter(fits).map_or((Self::RungeKutta, 4), |step| (Self::Del, step.order.number()))
    }

    /// Steps of h, s, with derivatives in the weights at these positions.
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

/// How a loss over windows is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowSettings {
    /// Steps of a window, at least 1.
    pub steps: usize,
    /// Steps from the start of one to that of the next, at least 1.
    pub stride: usize,
    /// What windows are integrated by.
    pub integrator: Integrator,
    /// A Runge–Kutta step at most, s; see [`Pace`](super::Pace).
    pub longest_step: f64,
    /// Of the integrator: 2 or 4.
    pub order: u8,
    /// What is learned of sensors and actuators.
    pub calibration: Calibration,
}

/// Brings weights that have a range back into it.
pub(super) type Projection = Box<dyn Fn(&mut [f64]) + Send + Sync>;

/// A model as a loss over windows sees it.
pub struct WindowModel {
    /// Its equations.
    pub system: System,
    /// Positions of the weights that are known.
    pub fixed: Vec<usize>,
    /// Ranges of the others, which the optimisers see as free numbers.
    pub bounds: Bounds,
    /// Brings weights that have a range of another kind back into it.
    pub project: Projection,
}

impl WindowModel {
    /// That of this shape.
    ///
    /// # Errors
    /// Where the shape does not fit in itself, or has rods.
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

    /// The same with networks that correct it as they are.
    #[must_use]
    pub fn with_known_corrections(mut self, architecture: &Architecture) -> Self {
        let start = architecture.corrections_start();
        self.fixed.extend(start..start + architecture.corrections.count());
        self
    }
}
