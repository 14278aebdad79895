//! Shape of a model: the energies of a family, additional friction, and networks that correct both.

use crate::bounds::{Bounds, Range};
use crate::family::Parts;
use crate::laws::{CoordinateFriction, Corrections, FrictionArchitecture, Servo, dry_friction};
use crate::number::Number;
use crate::registry::AnyFamily;
use crate::scales::Scales;
use leastaction_core::model::{Family as FamilyHeader, FrictionNumber, Header, Law, Laws, ModelError};
use leastaction_programs::dynamics::Rods;
use leastaction_programs::energies::{Energies, WithFriction};
use serde::{Deserialize, Serialize};

/// Shape of a model: the energies of a family, additional friction, and networks that correct both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Architecture {
    /// Energies, with the forces that belong to the family.
    pub family: AnyFamily,
    /// Friction in addition to the family's forces.
    pub friction: FrictionArchitecture,
    /// Correction networks.
    pub corrections: Corrections,
    /// Servos, whose commands are positions.
    #[serde(default)]
    pub servo: Servo,
}

impl<F: Into<AnyFamily>> From<F> for Architecture {
    fn from(family: F) -> Self {
        Self {
            family: family.into(),
            friction: FrictionArchitecture::default(),
            corrections: Corrections::default(),
            servo: Servo::default(),
        }
    }
}

impl Architecture {
    /// Returns the shape described by a model file; if the file has several trees, the first one is selected. All
    /// numbers of the laws count as known.
    ///
    /// # Errors
    /// [`ModelError::OtherFamily`] for a family that this program does not know, [`ModelError::Law`] for a law of force that the family
    /// cannot have.
    pub fn from_header(header: &FamilyHeader, laws: Laws, weights: &[f64]) -> Result<Self, ModelError> {
        let family = AnyFamily::from_header(header, laws, weights)?;
        if let Some(law) = laws.iter().next().filter(|_| family.groups() == 0) {
            return Err(ModelError::Law { number: law as u8 });
        }
        let servo = Servo::from_laws(laws, family.groups(), weights);
        let weights = without_last(weights, servo.count());
        let corrections = Corrections::from_laws(laws, weights);
        let weights = without_last(weights, corrections.count());
        let friction = FrictionArchitecture::from_laws(laws, family.laws(), family.groups(), weights);
        Ok(Self { family, friction, corrections, servo })
    }

    /// The word for the mechanisms of the model (tree or graph), and the name of the selected one; `None` for a family
    /// without them.
    pub fn part(&self) -> Option<(&'static str, &str)> {
        self.family.parts().map(|Parts { what, meant, .. }| (what, meant))
    }

    /// Names of all trees or graphs.
    pub fn parts(&self) -> Vec<&str> {
        self.family.parts().map_or(Vec::new(), |parts| parts.names)
    }

    /// Returns the shape with the tree or graph of that name selected; `None` if there is none.
    #[must_use]
    pub fn with_part_named(&self, name: &str) -> Option<Self> {
        let mut own = self.clone();
        own.family.mean_part(name).then_some(own)
    }

    /// Whether evaluation steps the model by the discrete Euler–Lagrange equation, which needs a model without rods.
    pub fn has_steps(&self) -> bool {
        self.rods().is_ok_and(|rods| rods.count() == 0)
    }

    /// Calls `read` with the shape as the model file states it.
    pub fn with_header<T>(&self, read: impl FnOnce(FamilyHeader) -> T) -> T {
        self.family.with_header(read)
    }

    /// Unit of every coordinate, as in a model file; a single one for graphs, whose coordinates are all lengths.
    pub fn units(&self) -> String {
        self.family.units()
    }

    /// Name of the family.
    pub const fn name(&self) -> &'static str {
        self.family.name()
    }

    /// Kinds of the coordinates, one letter each: `t` translation, `a` angle, `c` cyclic.
    pub fn coordinates(&self) -> String {
        self.family.coordinates()
    }

    /// Number of units in every hidden layer of the energies.
    pub fn widths(&self) -> Vec<usize> {
        self.family.networks().concat()
    }

    /// Number of hidden layers of the deepest network of the energies.
    pub fn depth(&self) -> usize {
        self.family.networks().iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.family.n()
    }

    /// Length of the weight block, in numbers.
    ///
    /// # Errors
    /// An error if the shape is outside the range of the format.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        self.with_header(|family| Header { laws: self.laws(), ..Header::new(family) }.parameters())
    }

    /// Laws of force beside the energies; their numbers are at the end of the weight block.
    pub fn laws(&self) -> Laws<'_> {
        self.servo.laws(self.corrections.laws(self.friction_laws()))
    }

    /// Laws of force without a network.
    pub fn friction_laws(&self) -> Laws<'static> {
        self.friction.laws(self.family.laws())
    }

    /// Position of the first number of the additional friction in the weight block.
    pub fn friction_start(&self) -> usize {
        self.family.parameters().unwrap_or(0)
    }

    /// Position of the first number of the correction networks in the weight block.
    pub fn corrections_start(&self) -> usize {
        self.friction_start() + self.friction.count()
    }

    /// Position of the first number of the servos in the weight block.
    pub fn servo_start(&self) -> usize {
        self.corrections_start() + self.corrections.count()
    }

    /// Number of entries of the weight block that training changes.
    ///
    /// # Errors
    /// An error if the shape is outside the range of the format.
    pub fn learned_parameters(&self) -> Result<usize, ModelError> {
        Ok(self.parameters()? - self.fixed_positions().len())
    }

    /// Returns random values for the learned network weights and the given values for all other numbers.
    pub fn initial_weights(&self, seed: u64) -> Vec<f64> {
        self.with_laws(self.family.initial_weights(seed), seed)
    }

    /// Appends the given numbers of friction and servos and random weights of the correction networks to the family's weights.
    pub fn with_laws(&self, mut weights: Vec<f64>, seed: u64) -> Vec<f64> {
        weights.extend(self.friction.numbers().map(|number| number.value));
        weights.extend(self.corrections.initial_weights(seed));
        weights.extend(self.servo.stiffness.iter().map(|number| number.value));
        weights
    }

    /// Lets the numbers of the laws that were not given follow the scales of a log, one of every coordinate, and bounds learned widths by
    /// them. `weights` is the block that training begins with; those numbers are replaced in it.
    pub fn follow(&mut self, scales: &[Scales], weights: &mut [f64]) {
        let mut groups = vec![Scales::default(); self.family.groups()];
        for (group, own) in self.family.group_of_coordinates().into_iter().zip(scales) {
            groups[group] = groups[group].max(own);
        }
        let before: Vec<Number> = self.law_numbers().map(|(_, number)| number).collect();
        self.friction.follow(&groups);
        self.servo.follow(&groups);
        let followed = self.law_numbers().zip(before).filter(|((_, now), before)| now != before);
        for ((position, number), _) in followed {
            if let Some(weight) = weights.get_mut(position) {
                *weight = number.value;
            }
        }
    }

    /// Numbers of friction and servos with their positions in the weight block.
    fn law_numbers(&self) -> impl Iterator<Item = (usize, Number)> {
        let friction = (self.friction_start()..).zip(self.friction.numbers());
        friction.chain((self.servo_start()..).zip(self.servo.stiffness.iter().copied()))
    }

    /// Whether numbers of the laws, or their bounds, follow the scales of a log.
    pub fn follows_scales(&self) -> bool {
        !self.friction.dry.is_empty() || self.law_numbers().any(|(_, number)| number.part.is_some())
    }

    /// Friction of every coordinate at these weights, including the family's own damping; empty if there is no law.
    pub fn friction_of_coordinates(&self, weights: &[f64]) -> Vec<CoordinateFriction> {
        let (laws, groups) = (self.friction_laws(), self.family.groups());
        let weights = without_last(weights, self.corrections.count() + self.servo.count());
        let start = weights.len().saturating_sub(laws.parameters(groups).unwrap_or(0));
        let mut rest = weights.get(start..).unwrap_or_default();
        let mut of_law = |law: Law, each: usize| {
            let count = if laws.contains(law) { each * groups } else { 0 };
            let (own, others) = rest.split_at(count.min(rest.len()));
            rest = others;
            own
        };
        let viscous = of_law(Law::Viscous, 1);
        let dry = of_law(Law::Coulomb, FrictionNumber::ALL.len()).as_chunks().0;
        let of = |group: usize| CoordinateFriction {
            viscous: viscous.get(group).copied().unwrap_or(0.0),
            dry: dry.get(group).copied().map(dry_friction),
        };
        let coordinates = if laws == Laws::NONE { Vec::new() } else { self.family.group_of_coordinates() };
        coordinates.into_iter().map(of).collect()
    }

    /// Stiffness of the servo of every coordinate at these weights, N/m or N m/rad; empty if commands are forces.
    pub fn stiffness_of_coordinates(&self, weights: &[f64]) -> Vec<f64> {
        let numbers = &weights[weights.len().saturating_sub(self.servo.count())..];
        if numbers.is_empty() {
            return Vec::new();
        }
        let groups = self.family.group_of_coordinates();
        groups.into_iter().map(|group| numbers.get(group).copied().unwrap_or_default()).collect()
    }

    /// Unit of the force on a coordinate, or of its command if that is a position.
    pub fn command_unit(&self, i: usize) -> &'static str {
        match (self.servo.is_none(), self.coordinates().as_bytes().get(i) == Some(&b't')) {
            (true, true) => "N",
            (true, false) => "N m",
            (false, true) => "m",
            (false, false) => "rad",
        }
    }

    /// Positions of the numbers in the weight block that training must leave unchanged.
    pub fn fixed_positions(&self) -> Vec<usize> {
        let friction = self.friction.fixed_positions(self.friction_start());
        let networks = self.corrections.fixed_positions(self.corrections_start());
        let servo = self.servo.fixed_positions(self.servo_start());
        self.family.fixed_positions().into_iter().chain(friction).chain(networks).chain(servo).collect()
    }

    /// Ranges, with positions, of the numbers that are learned through free parameters ([`Bounds`]).
    pub fn ranges(&self) -> Vec<(usize, Range)> {
        let friction = self.friction.ranges(self.friction_start());
        let servo = self.servo.ranges(self.servo_start());
        self.family.ranges().into_iter().chain(friction).chain(servo).collect()
    }

    /// Ranges of all learned numbers, as the optimisers see them.
    pub fn bounds(&self) -> Bounds {
        Bounds::new(self.ranges()).with_bodies(self.family.learned_bodies())
    }

    /// Moves numbers that have a range but are learned directly (masses, a family's own damping) back into it.
    pub fn project(&self, weights: &mut [f64]) {
        self.family.project(weights);
    }

    /// Energies and forces as a program, for the selected tree or graph.
    ///
    /// # Errors
    /// [`ModelError`] if the shape is inconsistent.
    pub fn energies(&self) -> Result<Box<dyn Energies>, ModelError> {
        let corrected = self.corrections.energies(self.with_friction(self.family.energies()?)?)?;
        self.servo.energies(corrected, self.family.group_of_coordinates())
    }

    fn with_friction(&self, family: Box<dyn Energies>) -> Result<Box<dyn Energies>, ModelError> {
        if self.friction.is_none() {
            return Ok(family);
        }
        let groups = self.family.groups();
        self.friction.check(self.family.laws(), groups)?;
        let beside = self.family.group_of_coordinates();
        let all = WithFriction::new(family, self.friction.laws_beside(), groups, beside);
        Ok(Box::new(all.ok_or(ModelError::OutOfRange { what: "friction" })?))
    }

    /// Rods of the selected graph; none for any other family.
    ///
    /// # Errors
    /// An error if there is no such graph.
    pub fn rods(&self) -> Result<Rods, ModelError> {
        self.family.rods()
    }

    /// Refuses a model with rods; `what` names, in the error, the feature that does not support them.
    ///
    /// # Errors
    /// [`ModelError::Shape`] with the number of rods; see also [`Architecture::rods`].
    pub fn check_without_rods(&self, what: &'static str) -> Result<(), ModelError> {
        match self.rods()?.count() {
            0 => Ok(()),
            found => Err(ModelError::Shape { what, found, compiled: 0 }),
        }
    }
}

/// The numbers without the last `count`.
fn without_last(weights: &[f64], count: usize) -> &[f64] {
    weights.get(..weights.len().saturating_sub(count)).unwrap_or_default()
}
