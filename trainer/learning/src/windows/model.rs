//! What a loss over windows is made of.

use super::Calibration;
use crate::architecture::Architecture;
use crate::training::Bounds;
use leastaction_core::model::ModelError;
use leastaction_programs::System;

/// How a loss over windows is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowSettings {
    /// Steps of a window, at least 1.
    pub steps: usize,
    /// Steps from the start of one to that of the next, at least 1.
    pub stride: usize,
    /// A Runge–Kutta step at most, s; see [`Pace`](super::Pace).
    pub longest_step: f64,
    /// Their order: 2 or 4.
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
            bounds: Bounds::new(architecture.ranges()),
            project: Box::new(move |weights: &mut [f64]| own.project(weights)),
        })
    }
}
