//! Shape of a model: the energies of a family, laws of force beside them, and networks that correct both.

use crate::bounds::{Bounds, Range};
use crate::family::Parts;
use crate::laws::{CoordinateFriction, Corrections, GroupLaws, LawEntry, NumberKind, StopNumbers};
use crate::registry::AnyFamily;
use crate::scales::Scales;
use leastaction_core::model::{Family as FamilyHeader, Header, Law, Laws, ModelError};
use leastaction_programs::dynamics::Rods;
use leastaction_programs::energies::Energies;
use serde::{Deserialize, Serialize};
use std::ops;

/// Shape of a model: the energies of a family, laws of force beside them, and networks that correct both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Architecture {
    /// Energies, with the forces that belong to the family.
    pub family: AnyFamily,
    /// Friction and servos, in addition to the family's forces.
    pub group_laws: GroupLaws,
    /// Correction networks.
    pub corrections: Corrections,
}

impl<F: Into<AnyFamily>> From<F> for Architecture {
    fn from(family: F) -> Self {
        Self { family: family.into(), group_laws: GroupLaws::default(), corrections: Corrections::default() }
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
        let group_laws = GroupLaws::from_laws((laws, family.laws()), family.groups());
        // The corrections read the scales of the velocities that a network sees; other laws follow them.
        let before = without_last(weights, group_laws.count_after_networks());
        let corrections = Corrections::from_laws(laws, before);
        let group_laws = group_laws.with_numbers(weights, corrections.count());
        Ok(Self { family, group_laws, corrections })
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
        self.corrections.laws(self.group_laws.laws(self.family.laws()))
    }

    /// Position of the first number of the laws beside the family's own in the weight block.
    pub fn laws_start(&self) -> usize {
        self.family.parameters().unwrap_or(0)
    }

    /// Position of the first number of the correction networks in the weight block.
    pub fn corrections_start(&self) -> usize {
        self.laws_start() + self.group_laws.count_before_networks()
    }

    /// Place of the numbers of the correction networks in the weight block.
    pub fn corrections_place(&self) -> ops::Range<usize> {
        let start = self.corrections_start();
        start..start + self.corrections.count()
    }

    /// Numbers of friction and servos beside the family's own, with their places in the weight block.
    pub fn law_entries(&self) -> impl Iterator<Item = LawEntry> {
        self.group_laws.entries(self.laws_place())
    }

    /// Whether laws beside the family's own have numbers of this meaning.
    pub fn has_law_number(&self, kind: NumberKind) -> bool {
        self.law_entries().any(|entry| entry.kind == kind)
    }

    /// Positions in the weight block of all numbers to which the friction of the laws with numbers for groups of coordinates is in proportion,
    /// the family's own damping included.
    pub fn friction_positions(&self) -> Vec<usize> {
        let own = self.family.laws().contains(Law::Viscous).then(|| self.family.groups());
        let start = self.laws_start();
        let beside = self.law_entries().filter(|entry| entry.kind.is_of_friction());
        (start.saturating_sub(own.unwrap_or(0))..start).chain(beside.map(|entry| entry.position)).collect()
    }

    fn laws_place(&self) -> (usize, usize) {
        (self.laws_start(), self.corrections.count())
    }

    /// Numbers of a law for the groups of coordinates in a weight block, the family's own damping included; empty for a law that is absent.
    pub(crate) fn law_numbers<'w>(&self, law: Law, weights: &'w [f64]) -> &'w [f64] {
        let groups = self.family.groups();
        let is_own = self.family.laws().contains(law);
        let beside = self.law_entries().find(|entry| entry.law == law).map(|entry| entry.position);
        let own = is_own.then(|| self.laws_start().saturating_sub(groups));
        let numbers =
            beside.or(own).and_then(|start| weights.get(start..)?.get(..groups * law.ranges().len()));
        numbers.unwrap_or_default()
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
        let place = self.corrections_place();
        weights.resize(place.end + self.group_laws.count_after_networks(), 0.0);
        weights.splice(place, self.corrections.initial_weights(seed));
        self.law_entries().for_each(|entry| weights[entry.position] = entry.number.value);
        weights
    }

    /// Lets the numbers of the laws that were not given follow the scales of a log, one of every coordinate, and bounds learned widths by
    /// them. `weights` is the block that training begins with; those numbers are replaced in it.
    pub fn follow(&mut self, scales: &[Scales], weights: &mut [f64]) {
        let mut groups = vec![Scales::default(); self.family.groups()];
        for (group, own) in self.family.group_of_coordinates().into_iter().zip(scales) {
            groups[group] = groups[group].max(own);
        }
        let before: Vec<LawEntry> = self.law_entries().collect();
        self.group_laws.follow(&groups);
        for (now, _) in self.law_entries().zip(before).filter(|(now, before)| now.number != before.number) {
            if let Some(weight) = weights.get_mut(now.position) {
                *weight = now.number.value;
            }
        }
    }

    /// Whether numbers of the laws, or their bounds, follow the scales of a log.
    pub fn follows_scales(&self) -> bool {
        self.group_laws.follows_scales()
    }

    /// Friction of every coordinate at these weights, including the family's own damping; empty if there is no law.
    pub fn friction_of_coordinates(&self, weights: &[f64]) -> Vec<CoordinateFriction> {
        let mut groups = vec![CoordinateFriction::default(); self.family.groups()];
        let (laws, mut is_there) = (self.laws(), false);
        for law in laws.iter().filter(|law| NumberKind::are_of_friction(*law)) {
            is_there = true;
            let numbers = self.law_numbers(law, weights).chunks(law.ranges().len());
            groups.iter_mut().zip(numbers).for_each(|(group, numbers)| group.add(law, numbers));
        }
        let coordinates = if is_there { self.family.group_of_coordinates() } else { Vec::new() };
        coordinates.into_iter().map(|group| groups[group]).collect()
    }

    /// End stops of every coordinate at these weights, `None` where they are out of reach; empty if there is no such law.
    pub fn stops_of_coordinates(&self, weights: &[f64]) -> Vec<Option<StopNumbers>> {
        if !self.group_laws.has(Law::Stops) {
            return Vec::new();
        }
        let numbers: Vec<&[f64]> =
            self.law_numbers(Law::Stops, weights).chunks(Law::Stops.ranges().len()).collect();
        let groups = self.family.group_of_coordinates();
        groups.into_iter().map(|group| numbers.get(group).and_then(|own| StopNumbers::of(own))).collect()
    }

    /// Stiffness of the servo of every coordinate at these weights, N/m or N m/rad; empty if commands are forces.
    pub fn stiffness_of_coordinates(&self, weights: &[f64]) -> Vec<f64> {
        if !self.group_laws.has_servos() {
            return Vec::new();
        }
        let numbers = self.law_numbers(Law::Servo, weights);
        let groups = self.family.group_of_coordinates();
        groups.into_iter().map(|group| numbers.get(group).copied().unwrap_or_default()).collect()
    }

    /// Unit of the force on a coordinate, or of its command if that is a position.
    pub fn command_unit(&self, i: usize) -> &'static str {
        match (self.group_laws.has_servos(), self.coordinates().as_bytes().get(i) == Some(&b't')) {
            (false, true) => "N",
            (false, false) => "N m",
            (true, true) => "m",
            (true, false) => "rad",
        }
    }

    /// Positions of the numbers in the weight block that training must leave unchanged.
    pub fn fixed_positions(&self) -> Vec<usize> {
        let laws = self.law_entries().filter(|entry| !entry.number.learned).map(|entry| entry.position);
        let networks = self.corrections.fixed_positions(self.corrections_start());
        self.family.fixed_positions().into_iter().chain(laws).chain(networks).collect()
    }

    /// Ranges, with positions, of the numbers that are learned through free parameters ([`Bounds`]).
    pub fn ranges(&self) -> Vec<(usize, Range)> {
        self.family.ranges().into_iter().chain(self.group_laws.ranges(self.laws_place())).collect()
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
        if self.group_laws.is_none() {
            return self.corrections.energies(self.family.energies()?);
        }
        let of = self.family.group_of_coordinates();
        let groups = (self.family.groups(), of.as_slice());
        let family = self.group_laws.before_networks(self.family.energies()?, self.family.laws(), groups)?;
        let corrected = self.corrections.energies(family)?;
        self.group_laws.after_networks(corrected, groups)
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
