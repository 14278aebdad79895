//! Section of forces: laws beside the Lagrangian, whose numbers follow those of the energies in the weight block.

use super::header::require;
use super::{LawNetwork, ModelError};
use crate::expected::expected;
use crate::scalar::FileWeightFormat;
use serde::Deserialize;

/// Laws of force that a model file can have. Friction has numbers for every *group* of coordinates: a coordinate of inertia networks or of
/// bodies, an element type of modular models. A law with a network says which coordinates it sees ([`LawNetwork`]).
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Law {
    /// [`Viscous`](crate::forces::Viscous): c ≥ 0 of each group.
    Viscous = 0,
    /// [`Coulomb`](crate::forces::Coulomb): c, c_load, τ_s and ε of each group, one group after another.
    Coulomb = 1,
    /// [`Dissipation`](crate::forces::Dissipation): the scale of every seen velocity, then the network's numbers.
    Dissipation = 2,
    /// [`PotentialCorrection`](crate::forces::PotentialCorrection): the network's numbers.
    Potential = 3,
    /// [`Servo`](crate::forces::Servo): k ≥ 0 of each group.
    Servo = 4,
    /// [`Directional`](crate::forces::Directional): b, β, c, δ and ε of each group, one group after another.
    Directional = 5,
    /// [`Sticking`](crate::forces::Sticking): c, δ, c_load, τ_s, s and ε of each group, one group after another.
    Sticking = 6,
    /// [`Stops`](crate::forces::Stops): of each group the middle between its stops, half the distance between them, and the restitution e,
    /// one group after another. Stops at half = [`f32::MAX`] are out of reach.
    Stops = 7,
}

impl Law {
    /// All laws, in the order of a file.
    pub const ALL: [Self; 8] = [
        Self::Viscous,
        Self::Coulomb,
        Self::Dissipation,
        Self::Potential,
        Self::Servo,
        Self::Directional,
        Self::Sticking,
        Self::Stops,
    ];

    /// Name of the law.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Viscous => "viscous",
            Self::Coulomb => "coulomb",
            Self::Dissipation => "dissipation",
            Self::Potential => "potential",
            Self::Servo => "servo",
            Self::Directional => "directional",
            Self::Sticking => "sticking",
            Self::Stops => "stops",
        }
    }

    pub(super) const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// Set of the laws of a model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Laws<'a> {
    /// One bit per law.
    pub(super) present: u8,
    dissipation: Option<LawNetwork<'a>>,
    potential: Option<LawNetwork<'a>>,
}

impl<'a> Laws<'a> {
    /// No laws.
    pub const NONE: Laws<'static> = Laws { present: 0, dissipation: None, potential: None };
    /// Viscous damping alone.
    pub const VISCOUS: Laws<'static> = Laws { present: Law::Viscous.bit(), ..Laws::NONE };
    /// Dry friction alone.
    pub const COULOMB: Laws<'static> = Laws { present: Law::Coulomb.bit(), ..Laws::NONE };
    /// Viscous damping and dry friction.
    pub const FRICTION: Laws<'static> =
        Laws { present: Law::Viscous.bit() | Law::Coulomb.bit(), ..Laws::NONE };

    /// Adds dissipation by a network.
    #[must_use]
    pub const fn with_dissipation(self, network: LawNetwork<'a>) -> Self {
        Self { present: self.present | Law::Dissipation.bit(), dissipation: Some(network), ..self }
    }

    /// Adds a potential from a network.
    #[must_use]
    pub const fn with_potential(self, network: LawNetwork<'a>) -> Self {
        Self { present: self.present | Law::Potential.bit(), potential: Some(network), ..self }
    }

    /// Adds a law without a network.
    #[must_use]
    pub const fn with(self, law: Law) -> Self {
        Self { present: self.present | law.bit(), ..self }
    }

    /// Reads the laws of a model file: one byte per law, in ascending order. The shape of the law's network, if any,
    /// follows the byte.
    ///
    /// # Errors
    /// [`ModelError::Law`] for an unknown law, [`ModelError::Malformed`] if the numbers do not ascend or a shape is
    /// malformed.
    pub fn new(bytes: &'a [u8]) -> Result<Self, ModelError> {
        Self::known(bytes, |_| true)
    }

    /// [`Laws::new`] for a program that knows only some laws: it refuses all other laws first, and needs no code for them.
    #[inline(always)]
    pub(super) fn known(mut bytes: &'a [u8], knows: impl Fn(Law) -> bool) -> Result<Self, ModelError> {
        let mut laws = Self::default();
        while let Some((number, rest)) = bytes.split_first() {
            let law = Law::ALL.into_iter().find(|law| *law as u8 == *number && knows(*law));
            let law = law.ok_or(ModelError::Law { number: *number })?;
            if laws.present >= law.bit() {
                return Err(ModelError::Malformed);
            }
            (laws.present, bytes) = (laws.present | law.bit(), rest);
            if knows(Law::Dissipation) && law == Law::Dissipation {
                laws.dissipation = Some(network(&mut bytes)?);
            }
            if knows(Law::Potential) && law == Law::Potential {
                laws.potential = Some(network(&mut bytes)?);
            }
        }
        Ok(laws)
    }

    /// The laws in order.
    pub fn iter(&self) -> impl Iterator<Item = Law> + use<'a> {
        self.iter_known(|_| true)
    }

    /// The laws that the program knows, in order.
    #[inline(always)]
    fn iter_known<K: Fn(Law) -> bool>(self, knows: K) -> impl Iterator<Item = Law> + use<'a, K> {
        Law::ALL.into_iter().filter(move |law| knows(*law) && self.contains(*law))
    }

    /// Whether the set contains the law.
    pub const fn contains(&self, law: Law) -> bool {
        self.present & law.bit() != 0
    }

    /// The network of a law, if the set contains the law and it has one.
    pub const fn network(&self, law: Law) -> Option<LawNetwork<'a>> {
        match law {
            Law::Dissipation => self.dissipation,
            Law::Potential => self.potential,
            _ => None,
        }
    }

    /// Length of one law's part of the weight block, in numbers; `None` on overflow, or if its network cannot exist.
    #[inline(always)]
    pub(super) fn parameters_of(&self, law: Law, groups: usize) -> Option<usize> {
        match law {
            Law::Dissipation | Law::Potential => self.network(law)?.parameters(law),
            _ => groups.checked_mul(law.ranges().len()),
        }
    }

    /// Length of the laws' part of the weight block, in numbers, for `groups` groups; `None` on overflow, or if a network cannot exist.
    pub fn parameters(&self, groups: usize) -> Option<usize> {
        self.parameters_knowing(groups, |_| true)
    }

    /// [`Laws::parameters`] for a program that knows all laws of the set.
    #[inline(always)]
    pub(super) fn parameters_knowing(&self, groups: usize, knows: impl Fn(Law) -> bool) -> Option<usize> {
        self.iter_known(knows).try_fold(0usize, |sum, law| sum.checked_add(self.parameters_of(law, groups)?))
    }

    /// Checks the networks of the laws for a model of at least the given number of coordinates; the program must know all laws.
    #[inline(always)]
    pub(super) fn validate_networks(
        &self,
        coordinates: impl Fn() -> usize,
        knows: impl Fn(Law) -> bool,
    ) -> Result<(), ModelError> {
        let mut networks = self.iter_known(knows).filter_map(|law| Some((law, self.network(law)?)));
        networks.try_for_each(|(law, network)| network.validate(law, coordinates()))
    }

    /// Checks the numbers of the laws, which end the weight block; the program must know all laws.
    #[inline(always)]
    pub(super) fn validate<W: FileWeightFormat>(
        &self,
        groups: usize,
        mut numbers: &[W],
        knows: impl Fn(Law) -> bool,
    ) -> Result<(), ModelError> {
        for law in self.iter_known(knows) {
            let own = self.parameters_of(law, groups).and_then(|own| numbers.split_at_checked(own));
            let (own, rest) = expected(own, (numbers, &[]));
            match law {
                Law::Dissipation => {
                    let mut scales = own.iter().take(self.dissipation.map_or(0, |of| of.count()));
                    require(scales.all(|scale| scale.wide() > 0.0), "scale of a velocity")?;
                }
                Law::Potential => {}
                _ => law.validate(own)?,
            }
            numbers = rest;
        }
        Ok(())
    }
}

/// Takes the shape of a network from the front of the section.
fn network<'a>(bytes: &mut &'a [u8]) -> Result<LawNetwork<'a>, ModelError> {
    let mut from = postcard::Deserializer::from_bytes(bytes);
    let network = LawNetwork::deserialize(&mut from).map_err(|_| ModelError::Malformed)?;
    *bytes = from.finalize().map_err(|_| ModelError::Malformed)?;
    Ok(network)
}
