//! Friction in addition to a family's energies.

pub mod config;

use crate::bounds::Range;
use crate::number::{Number, known_positions};
use crate::scales::Scales;
use leastaction_core::forces::DryFriction;
use leastaction_core::model::{FrictionNumber, Law, Laws, ModelError};
use leastaction_programs::energies::{DryLaw, FrictionLaws};
use serde::{Deserialize, Serialize};

/// Bounds of a learned width ε where no log is read, m/s or rad/s.
pub const WIDTHS: [f64; 2] = [0.02, 1.0];
/// Bounds of a learned width ε as parts of the log's speed. Below the lower one, a log has hardly a sample within the change of sign, which
/// then cannot be told from a jump: of samples spread evenly over the speeds, three in a thousand. Above the upper one dry friction never comes
/// near its full value (tanh 2 = 0.96 at that speed), and the law can hardly be told from viscous damping.
pub const WIDTH_PARTS: [f64; 2] = [0.003, 0.5];
/// Distance of a width's start from the bounds, as a factor: they make way for a start beyond them.
const START_FACTOR: f64 = 2.0;
/// Upper bound of a learned c_load.
pub const MOST_LOAD: f64 = 0.95;

/// Count of the numbers of dry friction of one group.
const DRY_NUMBERS: usize = FrictionNumber::ALL.len();

/// Friction of every group of coordinates, in addition to any forces of the family's own:
///
/// Q = −(b v + (c + c_load (√(τ² + τ_s²) − τ_s)) tanh(v/ε)), N or N m.
///
/// The numbers are at the end of the weight block, in the order of the laws of a model file: b of every group, then c,
/// c_load, τ_s and ε group after group.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrictionArchitecture {
    /// Damping b ≥ 0 of every group, N s/m or N m s/rad; empty if there is no viscous damping beside the family's own.
    pub viscous: Vec<Number>,
    /// c ≥ 0, 0 ≤ c_load < 1, τ_s > 0 and ε > 0 of every group, in the order of [`FrictionNumber::ALL`]; empty without dry friction.
    pub dry: Vec<[Number; DRY_NUMBERS]>,
    /// Speed of every group in the log, m/s or rad/s, which bounds learned widths ([`WIDTH_PARTS`]); empty if no log has been read.
    speeds: Vec<f64>,
}

impl FrictionArchitecture {
    /// Creates viscous damping and dry friction of every group; either is empty if absent.
    pub fn new(viscous: Vec<Number>, dry: Vec<[Number; DRY_NUMBERS]>) -> Self {
        Self { viscous, dry, speeds: Vec::new() }
    }

    /// Lets the numbers that were not given follow the scales of the groups, which also bound the learned widths.
    pub(crate) fn follow(&mut self, groups: &[Scales]) {
        self.speeds = groups.iter().map(|scales| scales.speed).collect();
        let damping = groups.iter().map(Scales::damping);
        self.viscous.iter_mut().zip(damping).for_each(|(number, scale)| number.follow(scale));
        for (numbers, scales) in self.dry.iter_mut().zip(groups) {
            for (number, kind) in numbers.iter_mut().zip(FrictionNumber::ALL) {
                number.follow(if kind == FrictionNumber::Width { scales.speed } else { scales.force });
            }
        }
    }

    /// Bounds of the width ε of a group.
    pub fn widths(&self, group: usize) -> [f64; 2] {
        let of_speed = |speed: &f64| WIDTH_PARTS.map(|part| part * speed);
        let speed = self.speeds.get(group).filter(|speed| **speed > 0.0);
        let [least, most] = speed.map_or(WIDTHS, of_speed);
        let start = self.dry.get(group).map(|numbers| numbers[FrictionNumber::Width as usize].value);
        start.map_or([least, most], |x| [least.min(x / START_FACTOR), most.max(x * START_FACTOR)])
    }

    /// Replaces the laws that are given; the others stay.
    pub(crate) fn take(&mut self, given: Self) {
        let Self { viscous, dry, speeds } = given;
        if !viscous.is_empty() {
            self.viscous = viscous;
        }
        if !dry.is_empty() {
            (self.dry, self.speeds) = (dry, speeds);
        }
    }

    /// Whether there is no friction.
    pub fn is_none(&self) -> bool {
        self.viscous.is_empty() && self.dry.is_empty()
    }

    /// Returns the friction laws of a model file that are not the family's own, with their numbers, which are at the
    /// end of the weight block; all are known.
    pub(crate) fn from_laws(laws: Laws, own: Laws, groups: usize, weights: &[f64]) -> Self {
        let known = |law: Law| laws.contains(law) && !own.contains(law);
        let viscous = if known(Law::Viscous) { groups } else { 0 };
        let dry = if known(Law::Coulomb) { groups } else { 0 };
        let start = weights.len().saturating_sub(viscous + DRY_NUMBERS * dry);
        let numbers: Vec<Number> =
            weights.get(start..).unwrap_or_default().iter().copied().map(Number::known).collect();
        let (viscous, dry) = numbers.split_at(viscous.min(numbers.len()));
        Self::new(viscous.to_vec(), dry.as_chunks().0.to_vec())
    }

    /// Returns the laws of a family with the laws `own` and this friction.
    pub(crate) fn laws(&self, own: Laws<'static>) -> Laws<'static> {
        let viscous = own.contains(Law::Viscous) || !self.viscous.is_empty();
        match (viscous, self.dry.is_empty()) {
            (true, true) => Laws::VISCOUS,
            (true, false) => Laws::FRICTION,
            (false, true) => Laws::NONE,
            (false, false) => Laws::COULOMB,
        }
    }

    /// Whether dry friction may grow with the load.
    pub(crate) fn grows(&self) -> bool {
        self.dry.iter().any(|[_, load, ..]| load.learned || load.value != 0.0)
    }

    /// Laws of this friction for the host's programs; the load is left out if it is known to have no effect.
    pub(crate) fn laws_beside(&self) -> FrictionLaws {
        let dry = match (self.dry.is_empty(), self.grows()) {
            (true, _) => DryLaw::None,
            (false, false) => DryLaw::Unloaded,
            (false, true) => DryLaw::Loaded,
        };
        FrictionLaws { viscous: !self.viscous.is_empty(), dry }
    }

    /// Refuses a wrong number of groups, and damping beside the family's own.
    pub(crate) fn check(&self, own: Laws, groups: usize) -> Result<(), ModelError> {
        let fits = |found: usize| found == 0 || found == groups;
        let twice = own.contains(Law::Viscous) && !self.viscous.is_empty();
        if fits(self.viscous.len()) && fits(self.dry.len()) && !twice {
            return Ok(());
        }
        Err(ModelError::OutOfRange { what: "friction" })
    }

    /// All numbers, in the order of the weight block.
    pub fn numbers(&self) -> impl Iterator<Item = Number> {
        self.viscous.iter().chain(self.dry.iter().flatten()).copied()
    }

    /// Returns the friction with its numbers taken from the end of a weight block.
    #[must_use]
    pub fn with_numbers(mut self, weights: &[f64]) -> Self {
        let start = weights.len().saturating_sub(self.count());
        let numbers = self.viscous.iter_mut().chain(self.dry.iter_mut().flatten());
        numbers
            .zip(weights.get(start..).unwrap_or_default())
            .for_each(|(number, value)| number.value = *value);
        self
    }

    /// Returns the friction for more groups; the new groups have none.
    #[must_use]
    pub fn with_groups(mut self, groups: usize) -> Self {
        const NONE: [Number; DRY_NUMBERS] =
            [Number::known(0.0), Number::known(0.0), Number::known(1.0), Number::known(1.0)];
        if !self.viscous.is_empty() {
            self.viscous.resize(groups, Number::known(0.0));
        }
        if !self.dry.is_empty() {
            self.dry.resize(groups, NONE);
        }
        self
    }

    /// Whether the scale of L is known without a force, because a friction force is known.
    pub fn shows_scale(&self) -> bool {
        let acts = |number: &Number| !number.learned && number.value != 0.0;
        self.viscous.iter().any(acts) || self.dry.iter().any(|[constant, ..]| acts(constant))
    }

    /// Count of the numbers.
    pub fn count(&self) -> usize {
        self.viscous.len() + DRY_NUMBERS * self.dry.len()
    }

    /// Positions of the known numbers, counted from `start`.
    pub(crate) fn fixed_positions(&self, start: usize) -> Vec<usize> {
        known_positions(start, self.numbers())
    }

    /// Ranges and positions of the learned numbers, with positions counted from `start`.
    pub(crate) fn ranges(&self, start: usize) -> Vec<(usize, Range)> {
        let dry =
            (0..self.dry.len()).flat_map(|group| FrictionNumber::ALL.map(|kind| self.range(group, kind)));
        let ranges = self.viscous.iter().map(|_| Range::Positive).chain(dry);
        let each = (start..).zip(self.numbers().zip(ranges));
        each.filter(|(_, (number, _))| number.learned)
            .map(|(position, (_, range))| (position, range))
            .collect()
    }

    /// Range of a learned number of dry friction.
    fn range(&self, group: usize, kind: FrictionNumber) -> Range {
        match kind {
            FrictionNumber::Constant | FrictionNumber::Smoothing => Range::Positive,
            FrictionNumber::Load => Range::Between(0.0, MOST_LOAD),
            FrictionNumber::Width => {
                let [least, most] = self.widths(group);
                Range::Between(least, most)
            }
        }
    }
}

/// Friction of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateFriction {
    /// Damping b, N s/m or N m s/rad.
    pub viscous: f64,
    /// Dry friction; `None` if the model has none.
    pub dry: Option<DryFriction<f64>>,
}

/// Creates dry friction from a group's four numbers.
pub(crate) fn dry_friction([constant, load, smoothing, width]: [f64; DRY_NUMBERS]) -> DryFriction<f64> {
    DryFriction { constant, load, smoothing, width }
}
