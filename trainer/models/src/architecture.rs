//! The shape of a model: energies of a family, friction beside them, and networks that correct both.

use crate::bounds::{Bounds, Range};
use crate::family::Parts;
use crate::laws::{CoordinateFriction, Corrections, FrictionArchitecture, dry_friction};
use crate::registry::AnyFamily;
use leastaction_core::model::{Family as FamilyHeader, FrictionNumber, Header, Law, Laws, ModelError};
use leastaction_programs::dynamics::Rods;
use leastaction_programs::energies::{Energies, WithFriction};
use serde::{Deserialize, Serialize};

/// The shape of a model: energies of a family, friction beside them, and networks that correct both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Architecture {
    /// The energies, with the forces that the family has of its own.
    pub family: AnyFamily,
    /// Friction beside those.
    pub friction: FrictionArchitecture,
    /// Networks beside both.
    pub corrections: Corrections,
}

impl<F: Into<AnyFamily>> From<F> for Architecture {
    fn from(family: F) -> Self {
        Self {
            family: family.into(),
            friction: FrictionArchitecture::default(),
            corrections: Corrections::default(),
        }
    }
}

impl Architecture {
    /// The shape that a model file has; of several trees the first. All numbers of laws are known.
    ///
    /// # Errors
    /// [`ModelError::OtherFamily`] for a family that this program does not know, [`ModelError::Law`] for a law of force that the
    /// family cannot have.
    pub fn from_header(header: &FamilyHeader, laws: Laws, weights: &[f64]) -> Result<Self, ModelError> {
        let family = AnyFamily::from_header(header, laws, weights)?;
        if let Some(law) = laws.iter().next().filter(|_| family.groups() == 0) {
            return Err(ModelError::Law { number: law as u8 });
        }
        let corrections = Corrections::from_laws(laws, weights);
        let weights = weights.get(..weights.len().saturating_sub(corrections.count())).unwrap_or_default();
        let friction = FrictionArchitecture::from_laws(laws, family.laws(), family.groups(), weights);
        Ok(Self { family, friction, corrections })
    }

    /// Word for the mechanisms of a model of several, tree or graph, and the name of the one that is meant.
    pub fn part(&self) -> Option<(&'static str, &str)> {
        self.family.parts().map(|Parts { what, meant, .. }| (what, meant))
    }

    /// Names of all trees or graphs.
    pub fn parts(&self) -> Vec<&str> {
        self.family.parts().map_or(Vec::new(), |parts| parts.names)
    }

    /// The shape with the tree or graph of that name in mind; `None` where there is none.
    #[must_use]
    pub fn with_part_named(&self, name: &str) -> Option<Self> {
        let mut own = self.clone();
        own.family.mean_part(name).then_some(own)
    }

    /// Whether evaluation steps it by the discrete Euler–Lagrange equation: it has no rods.
    pub fn has_steps(&self) -> bool {
        self.rods().is_ok_and(|rods| rods.count() == 0)
    }

    /// Calls `read` with the shape in the words of the model file.
    pub fn with_header<T>(&self, read: impl FnOnce(FamilyHeader) -> T) -> T {
        self.family.with_header(read)
    }

    /// Unit of every coordinate, as a model file has them; of graphs, all of whose coordinates are lengths, one.
    pub fn units(&self) -> String {
        self.family.units()
    }

    /// Name of the family.
    pub const fn name(&self) -> &'static str {
        self.family.name()
    }

    /// One letter a coordinate: `t` translation, `a` angle, `c` cyclic.
    pub fn coordinates(&self) -> String {
        self.family.coordinates()
    }

    /// Units of every hidden layer of the energies.
    pub fn widths(&self) -> Vec<usize> {
        self.family.networks().concat()
    }

    /// Hidden layers of the deepest network of the energies.
    pub fn depth(&self) -> usize {
        self.family.networks().iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.family.n()
    }

    /// Numbers in the weight block.
    ///
    /// # Errors
    /// Where the shape is out of the format's range.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        self.with_header(|family| Header { laws: self.laws(), ..Header::new(family) }.parameters())
    }

    /// The laws of force beside the energies, whose numbers end the weight block.
    pub fn laws(&self) -> Laws<'_> {
        self.corrections.laws(self.friction_laws())
    }

    /// Laws of force without a network.
    pub fn friction_laws(&self) -> Laws<'static> {
        self.friction.laws(self.family.laws())
    }

    /// Position of the first number of friction that is not the family's own.
    pub fn friction_start(&self) -> usize {
        self.family.parameters().unwrap_or(0)
    }

    /// Position of the first number of the networks that correct.
    pub fn corrections_start(&self) -> usize {
        self.friction_start() + self.friction.count()
    }

    /// Numbers in the weight block that training changes.
    ///
    /// # Errors
    /// Where the shape is out of the format's range.
    pub fn learned_parameters(&self) -> Result<usize, ModelError> {
        Ok(self.parameters()? - self.fixed_positions().len())
    }

    /// Random weights where they are learned, the given numbers elsewhere.
    pub fn initial_weights(&self, seed: u64) -> Vec<f64> {
        self.with_laws(self.family.initial_weights(seed), seed)
    }

    /// The weights of the family with the given numbers of friction and random weights of networks that correct behind them.
    pub fn with_laws(&self, mut weights: Vec<f64>, seed: u64) -> Vec<f64> {
        weights.extend(self.friction.numbers().map(|number| number.value));
        weights.extend(self.corrections.initial_weights(seed));
        weights
    }

    /// The friction of every coordinate at these weights, the family's own damping included; empty where there is no law.
    pub fn friction_of_coordinates(&self, weights: &[f64]) -> Vec<CoordinateFriction> {
        let (laws, groups) = (self.friction_laws(), self.family.groups());
        let end = weights.len().saturating_sub(self.corrections.count());
        let start = end.saturating_sub(laws.parameters(groups).unwrap_or(0));
        let numbers = weights.get(start..end).unwrap_or_default();
        let mut rest = numbers;
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

    /// The numbers of the weight block that training must leave as they are.
    pub fn fixed_positions(&self) -> Vec<usize> {
        let friction = self.friction.fixed_positions(self.friction_start());
        let networks = self.corrections.fixed_positions(self.corrections_start());
        self.family.fixed_positions().into_iter().chain(friction).chain(networks).collect()
    }

    /// The ranges of numbers that are learned as free numbers ([`Bounds`]), by their positions.
    pub fn ranges(&self) -> Vec<(usize, Range)> {
        let friction = self.friction.ranges(self.friction_start());
        self.family.ranges().into_iter().chain(friction).collect()
    }

    /// Ranges of all learned numbers as the optimisers see them.
    pub fn bounds(&self) -> Bounds {
        Bounds::new(self.ranges()).with_bodies(self.family.learned_bodies())
    }

    /// Brings numbers that have a range but are learned as they are (masses, a family's own damping) back into it.
    pub fn project(&self, weights: &mut [f64]) {
        self.family.project(weights);
    }

    /// Energies and forces as a program, for the tree or graph that is meant.
    ///
    /// # Errors
    /// [`ModelError`] where the shape does not fit in itself.
    pub fn energies(&self) -> Result<Box<dyn Energies>, ModelError> {
        let family = self.family.energies()?;
        if self.friction.is_none() {
            return self.corrections.energies(family);
        }
        let groups = self.family.groups();
        self.friction.check(self.family.laws(), groups)?;
        let beside = self.family.group_of_coordinates();
        let all = WithFriction::new(family, self.friction.laws_beside(), groups, beside);
        self.corrections.energies(Box::new(all.ok_or(ModelError::OutOfRange { what: "friction" })?))
    }

    /// Rods of the graph that is meant; none of another family.
    ///
    /// # Errors
    /// Where there is no such graph.
    pub fn rods(&self) -> Result<Rods, ModelError> {
        self.family.rods()
    }

    /// Refuses rods where there must be none; `what` says where.
    ///
    /// # Errors
    /// [`ModelError::Shape`] with their number, or as [`Architecture::rods`].
    pub fn check_without_rods(&self, what: &'static str) -> Result<(), ModelError> {
        match self.rods()?.count() {
            0 => Ok(()),
            found => Err(ModelError::Shape { what, found, compiled: 0 }),
        }
    }
}
