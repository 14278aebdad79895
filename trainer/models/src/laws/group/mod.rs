//! Laws of force with numbers for every group of coordinates.

mod kind;

pub use kind::{MOST_LOAD, NumberKind, WIDTH_PARTS, WIDTHS};

use crate::bounds::Range;
use crate::number::Number;
use crate::scales::Scales;
use kind::width_bounds;
use leastaction_core::model::{FrictionNumber, Law, Laws, ModelError};
use leastaction_programs::energies::{Energies, GroupForce, with_group_laws};
use serde::{Deserialize, Serialize};

/// Laws of force with numbers for every group of coordinates, in addition to any forces of the family's own: friction, and servos.
///
/// A law that is absent has no numbers. The others have those of [`NumberKind::of`], group after group. In the weight block, laws stand in the
/// order of [`Law::ALL`]: those before [`Law::Dissipation`] precede the numbers of the correction networks, the others follow them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct GroupLaws {
    /// Damping b of every group.
    pub viscous: Vec<Number>,
    /// Dry friction with a smooth change of sign: c, c_load, τ_s and ε of every group.
    pub coulomb: Vec<Number>,
    /// Stiffness k of the servo of every group; commands are then positions, m or rad, and the force of the drive is k (u − q).
    pub servo: Vec<Number>,
    /// Friction that differs by direction: b, β, c, δ and ε of every group.
    pub directional: Vec<Number>,
    /// Dry friction that sticks: c, δ, c_load, τ_s, s and ε of every group.
    pub sticking: Vec<Number>,
    /// End stops: their middle, half the distance between them, and the restitution e, of every group; all are known.
    pub stops: Vec<Number>,
    /// Speed of every group in the log, m/s or rad/s, which bounds learned widths ([`WIDTH_PARTS`]); empty if no log has been read.
    speeds: Vec<f64>,
}

/// A number of a law with its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawEntry {
    /// Position in the weight block.
    pub position: usize,
    /// The law.
    pub law: Law,
    /// Group of coordinates.
    pub group: usize,
    /// Meaning of the number.
    pub kind: NumberKind,
    /// The number.
    pub number: Number,
}

/// Whether the numbers of a law follow those of the correction networks in the weight block.
fn follows_networks(law: Law) -> bool {
    law > Law::Dissipation
}

/// The numbers of every law of a borrowed [`GroupLaws`], in order.
macro_rules! each {
    ($laws:expr) => {{
        let GroupLaws { viscous, coulomb, servo, directional, sticking, stops, speeds: _ } = $laws;
        [
            (Law::Viscous, viscous),
            (Law::Coulomb, coulomb),
            (Law::Servo, servo),
            (Law::Directional, directional),
            (Law::Sticking, sticking),
            (Law::Stops, stops),
        ]
    }};
}

impl GroupLaws {
    /// Creates viscous damping and smooth dry friction of every group; either is empty if absent.
    pub fn of_friction(viscous: Vec<Number>, dry: Vec<[Number; FrictionNumber::ALL.len()]>) -> Self {
        Self { viscous, coulomb: dry.into_flattened(), ..Self::default() }
    }

    fn each(&self) -> [(Law, &Vec<Number>); 6] {
        each!(self)
    }

    fn each_mut(&mut self) -> [(Law, &mut Vec<Number>); 6] {
        each!(self)
    }

    /// The laws that are there, in order.
    fn present(&self) -> impl Iterator<Item = Law> {
        self.each().into_iter().filter(|(_, numbers)| !numbers.is_empty()).map(|(law, _)| law)
    }

    /// Whether there is no law.
    pub fn is_none(&self) -> bool {
        self.present().next().is_none()
    }

    /// Whether the law is there.
    pub fn has(&self, law: Law) -> bool {
        self.present().any(|own| own == law)
    }

    /// Whether the servos of the drives take positions as commands.
    pub fn has_servos(&self) -> bool {
        !self.servo.is_empty()
    }

    /// Whether there are laws that steps solve as contacts: friction that sticks, or end stops.
    pub fn have_contacts(&self) -> bool {
        [Law::Sticking, Law::Stops].into_iter().any(|law| self.has(law))
    }

    /// Whether there is a law of dry friction.
    pub fn has_dry_friction(&self) -> bool {
        [Law::Coulomb, Law::Directional, Law::Sticking].into_iter().any(|law| self.has(law))
    }

    /// Count of the numbers before those of the correction networks.
    pub(crate) fn count_before_networks(&self) -> usize {
        let before = self.each().into_iter().filter(|(law, _)| !follows_networks(*law));
        before.map(|(_, numbers)| numbers.len()).sum()
    }

    /// Count of the numbers after those of the correction networks.
    pub(crate) fn count_after_networks(&self) -> usize {
        self.count() - self.count_before_networks()
    }

    /// Count of all numbers.
    pub fn count(&self) -> usize {
        self.each().map(|(_, numbers)| numbers.len()).iter().sum()
    }

    /// All numbers in order, with their places in a weight block in which those of the first law begin at `start`, and correction networks
    /// have `networks` numbers.
    pub fn entries(&self, (start, networks): (usize, usize)) -> impl Iterator<Item = LawEntry> {
        let of_law = move |(law, numbers): (Law, &Vec<Number>)| {
            let kinds = NumberKind::of(law);
            let start = start + if follows_networks(law) { networks } else { 0 };
            let groups = numbers.chunks(kinds.len()).enumerate();
            let of_group = move |(group, own): (usize, &[Number])| {
                let each = kinds.iter().zip(own.to_vec());
                each.map(move |(kind, number)| LawEntry { position: start, law, group, kind: *kind, number })
            };
            groups.flat_map(of_group).collect::<Vec<_>>()
        };
        let all = self.each().map(of_law).concat().into_iter().enumerate();
        all.map(|(k, entry)| LawEntry { position: entry.position + k, ..entry })
    }

    /// Lets the numbers that were not given follow the scales of the groups, which also bound the learned widths.
    pub(crate) fn follow(&mut self, groups: &[Scales]) {
        self.speeds = groups.iter().map(|scales| scales.speed).collect();
        self.change(|group, kind, number| {
            let scale = groups.get(group).and_then(|scales| kind.scale(scales));
            scale.into_iter().for_each(|scale| number.follow(scale));
        });
    }

    /// Passes every number to `change`, with its group and meaning.
    pub(crate) fn change(&mut self, mut change: impl FnMut(usize, NumberKind, &mut Number)) {
        for (law, numbers) in self.each_mut() {
            let kinds = NumberKind::of(law);
            for (group, own) in numbers.chunks_mut(kinds.len()).enumerate() {
                own.iter_mut().zip(kinds).for_each(|(number, kind)| change(group, *kind, number));
            }
        }
    }

    /// Sets the numbers of a law, group after group; a law that has no effect with them is left out.
    pub(crate) fn set(&mut self, law: Law, numbers: Vec<Number>) {
        let kinds = NumberKind::of(law).iter().cycle();
        let acts = kinds.zip(&numbers).any(|(kind, number)| kind.is_linear() && number.value != 0.0);
        if let Some((_, own)) = self.each_mut().into_iter().find(|(own, _)| acts && *own == law) {
            *own = numbers;
        }
    }

    /// Whether numbers, or their bounds, follow the scales of a log.
    pub(crate) fn follows_scales(&self) -> bool {
        self.has_dry_friction() || self.each().into_iter().flat_map(|(_, all)| all).any(|x| x.part.is_some())
    }

    /// Bounds of the width ε of a law of dry friction for a group, m/s or rad/s.
    pub fn widths(&self, law: Law, group: usize) -> [f64; 2] {
        let own =
            self.entries((0, 0)).find(|of| (of.law, of.group, of.kind) == (law, group, NumberKind::Width));
        self.width_bounds(group, own.map_or(0.5 * (WIDTHS[0] + WIDTHS[1]), |entry| entry.number.value))
    }

    fn width_bounds(&self, group: usize, start: f64) -> [f64; 2] {
        width_bounds(self.speeds.get(group).copied(), start)
    }

    /// Ranges and positions of the learned numbers.
    pub(crate) fn ranges(&self, place: (usize, usize)) -> impl Iterator<Item = (usize, Range)> {
        let range = |of: LawEntry| of.kind.range(self.width_bounds(of.group, of.number.value));
        let learned = self.entries(place).filter(|entry| entry.number.learned);
        learned.map(move |entry| (entry.position, range(entry)))
    }

    /// Replaces the laws of friction by the given ones. Damping stays where only dry friction is given, and dry friction where only damping is.
    pub(crate) fn take_friction(&mut self, given: Self) {
        let has_both = [&*self, &given].into_iter().any(|laws| laws.has(Law::Directional));
        if has_both || given.has_dry_friction() {
            (self.coulomb, self.directional, self.sticking) =
                (given.coulomb, given.directional, given.sticking);
        }
        if has_both || !given.viscous.is_empty() {
            self.viscous = given.viscous;
        }
        self.speeds = given.speeds;
    }

    /// Returns the laws of a model file that are not the family's own, all numbers known to be 0 ([`GroupLaws::with_numbers`] reads them).
    pub(crate) fn from_laws((laws, own): (Laws, Laws), groups: usize) -> Self {
        let mut all = Self::default();
        for (law, numbers) in all.each_mut() {
            let is_there = laws.contains(law) && !own.contains(law);
            let count = if is_there { groups * law.ranges().len() } else { 0 };
            *numbers = vec![Number::known(0.0); count];
        }
        all
    }

    /// Returns the laws with their numbers taken from the end of a weight block, in which correction networks have `networks` numbers.
    #[must_use]
    pub(crate) fn with_numbers(mut self, weights: &[f64], networks: usize) -> Self {
        let start = weights.len().saturating_sub(self.count() + networks);
        let places: Vec<usize> = self.entries((start, networks)).map(|entry| entry.position).collect();
        let numbers = self.each_mut().into_iter().flat_map(|(_, numbers)| numbers);
        for (number, place) in numbers.zip(places) {
            number.value = weights.get(place).copied().unwrap_or(number.value);
        }
        self
    }

    /// Returns the laws for more groups, on which they have no effect.
    #[must_use]
    pub(crate) fn with_groups(mut self, groups: usize) -> Self {
        for (law, numbers) in self.each_mut().into_iter().filter(|(_, numbers)| !numbers.is_empty()) {
            let neutral = NumberKind::of(law).iter().map(|kind| Number::known(kind.neutral()));
            let missing = (groups * law.ranges().len()).saturating_sub(numbers.len());
            numbers.extend(neutral.cycle().take(missing));
        }
        self
    }

    /// Returns these laws in addition to others.
    pub(crate) fn laws<'l>(&self, others: Laws<'l>) -> Laws<'l> {
        self.present().fold(others, Laws::with)
    }

    /// Whether damping is given, be it as 0.
    pub(crate) fn damps(&self) -> bool {
        let acts = |of: &LawEntry| of.number.learned || of.number.value != 0.0;
        let mut damping = self.entries((0, 0)).filter(|entry| entry.kind == NumberKind::Damping);
        !self.viscous.is_empty() || damping.any(|entry| acts(&entry))
    }

    /// Whether friction may grow with the load.
    pub(crate) fn grows(&self) -> bool {
        self.present().any(|law| self.law_grows(law))
    }

    fn law_grows(&self, law: Law) -> bool {
        let mut loads = self.entries((0, 0)).filter(|of| (of.law, of.kind) == (law, NumberKind::Load));
        loads.any(|entry| entry.number.learned || entry.number.value != 0.0)
    }

    /// Whether the scale of L is known without a logged force, because a force of a law is known.
    pub fn shows_scale(&self) -> bool {
        let is_known = |of: &LawEntry| !of.number.learned && of.number.value != 0.0;
        self.entries((0, 0)).any(|entry| entry.kind.shows_scale() && is_known(&entry))
    }

    /// Adds the laws on one side of the correction networks to a model whose coordinates have the groups `of`; the load is left out of
    /// friction that is known not to grow with it.
    fn add(
        &self,
        model: Box<dyn Energies>,
        (groups, of): (usize, &[usize]),
        is_on_side: impl Fn(Law) -> bool,
    ) -> Result<Box<dyn Energies>, ModelError> {
        let wrong = ModelError::OutOfRange { what: "numbers of a law for groups of coordinates" };
        let fits =
            |(law, numbers): (Law, &Vec<Number>)| [0, groups * law.ranges().len()].contains(&numbers.len());
        if !self.each().into_iter().all(fits) {
            return Err(wrong);
        }
        let force =
            |law: Law| GroupForce::new(law, self.law_grows(law)).ok_or(ModelError::Law { number: law as u8 });
        let forces =
            self.present().filter(|law| is_on_side(*law)).map(force).collect::<Result<Vec<_>, _>>()?;
        with_group_laws(model, &forces, (groups, of)).ok_or(wrong)
    }

    /// Adds the laws before the correction networks to a model with the laws `own` whose coordinates have these groups.
    pub(crate) fn before_networks(
        &self,
        model: Box<dyn Energies>,
        own: Laws,
        groups: (usize, &[usize]),
    ) -> Result<Box<dyn Energies>, ModelError> {
        if let Some(law) = self.present().find(|law| own.contains(*law)) {
            return Err(ModelError::Law { number: law as u8 });
        }
        self.add(model, groups, |law| !follows_networks(law))
    }

    /// Adds the laws after the correction networks.
    pub(crate) fn after_networks(
        &self,
        model: Box<dyn Energies>,
        groups: (usize, &[usize]),
    ) -> Result<Box<dyn Energies>, ModelError> {
        self.add(model, groups, follows_networks)
    }
}
