//! Position servos: commands are positions, not forces.

pub mod config;

use crate::bounds::Range;
use crate::number::{Number, known_positions};
use crate::scales::Scales;
use leastaction_core::model::{Law, Laws, ModelError};
use leastaction_programs::energies::{Energies, GroupForce, WithGroupLaw};
use serde::{Deserialize, Serialize};

/// Servos whose commands u are positions (m or rad): the force of the drive is k (u − q), N or N m.
///
/// Their numbers are at the end of the weight block. Damping d of τ = k (u − q) − d v is viscous friction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Servo {
    /// Stiffness k ≥ 0 of every group, N/m or N m/rad; empty if commands are forces.
    pub stiffness: Vec<Number>,
}

impl Servo {
    /// Whether commands are forces.
    pub fn is_none(&self) -> bool {
        self.stiffness.is_empty()
    }

    /// Lets the numbers that were not given follow the scales of the groups.
    pub(crate) fn follow(&mut self, groups: &[Scales]) {
        let each = self.stiffness.iter_mut().zip(groups);
        each.for_each(|(number, scales)| number.follow(scales.stiffness()));
    }

    /// Count of the numbers.
    pub fn count(&self) -> usize {
        self.stiffness.len()
    }

    /// Returns the servos of a model file, whose numbers are at the end of the weight block; all are known.
    pub(crate) fn from_laws(laws: Laws, groups: usize, weights: &[f64]) -> Self {
        let count = if laws.contains(Law::Servo) { groups } else { 0 };
        let own = weights.get(weights.len().saturating_sub(count)..).unwrap_or_default();
        Self { stiffness: own.iter().copied().map(Number::known).collect() }
    }

    /// Returns these laws together with that of the servos.
    pub(crate) fn laws<'a>(&self, laws: Laws<'a>) -> Laws<'a> {
        if self.is_none() { laws } else { laws.with(Law::Servo) }
    }

    /// Whether the scale of L is known without a force, because a stiffness is known.
    pub fn shows_scale(&self) -> bool {
        self.stiffness.iter().any(|stiffness| !stiffness.learned && stiffness.value != 0.0)
    }

    /// Positions of the known numbers, counted from `start`.
    pub(crate) fn fixed_positions(&self, start: usize) -> Vec<usize> {
        known_positions(start, self.stiffness.iter().copied())
    }

    /// Ranges and positions of the learned numbers, with positions counted from `start`.
    pub(crate) fn ranges(&self, start: usize) -> impl Iterator<Item = (usize, Range)> {
        let learned = (start..).zip(&self.stiffness).filter(|(_, number)| number.learned);
        learned.map(|(position, _)| (position, Range::Positive))
    }

    /// Adds the servos to a model whose coordinates have these groups, if there are servos.
    pub(crate) fn energies(
        &self,
        model: Box<dyn Energies>,
        of: Vec<usize>,
    ) -> Result<Box<dyn Energies>, ModelError> {
        if self.is_none() {
            return Ok(model);
        }
        let with = WithGroupLaw::new(model, GroupForce::Servo, self.count(), of);
        Ok(Box::new(with.ok_or(ModelError::OutOfRange { what: "servo" })?))
    }
}
