//! The section of forces: laws beside the Lagrangian, their numbers in the weight block behind those of the energies.

use super::ModelError;
use super::header::require;
use crate::expected::expected;
use crate::forces::{Coulomb, DryFriction, Forces, Viscous};
use crate::scalar::{FileWeightFormat, Scalar, WeightFormat};

/// Laws that a model file can have; each has numbers for every *group* of coordinates: a coordinate of the rigid family or of
/// bodies, an element type of the modular one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Law {
    /// [`Viscous`]: c ≥ 0 of each group.
    Viscous = 0,
    /// [`Coulomb`]: c, c_load, τ_s and ε of each group, one group after another.
    Coulomb = 1,
}

/// The numbers of dry friction in a model file, in this order for every group.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum FrictionNumber {
    /// c ≥ 0, N or N m.
    Constant,
    /// 0 ≤ c_load < 1.
    Load,
    /// τ_s > 0, N or N m.
    Smoothing,
    /// ε > 0, m/s or rad/s.
    Width,
}

impl FrictionNumber {
    /// All, in the order of a file.
    pub const ALL: [Self; 4] = [Self::Constant, Self::Load, Self::Smoothing, Self::Width];

    /// What it is called, and what it must be.
    pub const fn name(self) -> (&'static str, &'static str) {
        match self {
            Self::Constant => ("c", "0 or more"),
            Self::Load => ("c_load", "0 or more and below 1"),
            Self::Smoothing => ("tau_s", "above 0"),
            Self::Width => ("epsilon", "above 0"),
        }
    }

    fn allows(self, value: f32) -> bool {
        match self {
            Self::Constant => value >= 0.0,
            Self::Load => (0.0..1.0).contains(&value),
            Self::Smoothing | Self::Width => value > 0.0,
        }
    }

    /// An error where one of the numbers of all groups is out of range.
    fn validate<W: FileWeightFormat>(numbers: &[W]) -> Result<(), ModelError> {
        let each = numbers.iter().enumerate().zip(Self::ALL.iter().cycle());
        for ((index, value), number) in each {
            if !number.allows(value.wide()) {
                let (number, group, value) = (*number, (index / Self::ALL.len()) as u16, value.wide());
                return Err(ModelError::Friction { number, group, value });
            }
        }
        Ok(())
    }
}

impl Law {
    /// All laws, in the order of a file.
    pub const ALL: [Self; 2] = [Self::Viscous, Self::Coulomb];

    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Viscous => "viscous",
            Self::Coulomb => "coulomb",
        }
    }

    /// Numbers in the weight block.
    const fn parameters(self, groups: usize) -> usize {
        match self {
            Self::Viscous => groups,
            Self::Coulomb => groups.saturating_mul(FrictionNumber::ALL.len()),
        }
    }

    /// Checks its numbers.
    fn validate<W: FileWeightFormat>(self, numbers: &[W]) -> Result<(), ModelError> {
        match self {
            Self::Viscous => require(numbers.iter().all(|c| c.wide() >= 0.0), "damping coefficient"),
            Self::Coulomb => FrictionNumber::validate(numbers),
        }
    }
}

/// The laws of a model, by their numbers in the file, each at most once and rising.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Laws<'a>(&'a [u8]);

impl<'a> Laws<'a> {
    /// None.
    pub const NONE: Self = Self(&[]);
    /// Viscous damping alone.
    pub const VISCOUS: Laws<'static> = Laws(&[Law::Viscous as u8]);
    /// Dry friction alone.
    pub const COULOMB: Laws<'static> = Laws(&[Law::Coulomb as u8]);
    /// Viscous damping and dry friction.
    pub const FRICTION: Laws<'static> = Laws(&[Law::Viscous as u8, Law::Coulomb as u8]);

    /// From a model file: one byte a law.
    ///
    /// # Errors
    /// [`ModelError::Law`] for a number that is no law, [`ModelError::Malformed`] where they do not rise.
    pub fn new(numbers: &'a [u8]) -> Result<Self, ModelError> {
        Self::known(numbers, |_| true)
    }

    /// [`Laws::new`] for a program that knows some laws, and refuses the others before anything else, so that it need not hold
    /// code for them.
    #[inline(always)]
    pub(super) fn known(numbers: &'a [u8], knows: impl Fn(Law) -> bool) -> Result<Self, ModelError> {
        for number in numbers {
            let known = Law::ALL.iter().any(|law| *law as u8 == *number && knows(*law));
            if !known {
                return Err(ModelError::Law { number: *number });
            }
        }
        if numbers.is_sorted_by(|a, b| a < b) { Ok(Self(numbers)) } else { Err(ModelError::Malformed) }
    }

    /// As a model file has them.
    pub const fn numbers(&self) -> &'a [u8] {
        self.0
    }

    /// The laws in order.
    pub fn iter(&self) -> impl Iterator<Item = Law> + use<'a> {
        self.iter_known(|_| true)
    }

    /// Those that a program knows, in order.
    #[inline(always)]
    fn iter_known<K: Fn(Law) -> bool>(self, knows: K) -> impl Iterator<Item = Law> + use<'a, K> {
        Law::ALL.into_iter().filter(move |law| knows(*law) && self.contains(*law))
    }

    /// Whether it is among them.
    #[allow(
        clippy::manual_contains,
        reason = "a search by words would take a quarter kilobyte for two bytes"
    )]
    pub fn contains(&self, law: Law) -> bool {
        self.0.iter().any(|number| *number == law as u8)
    }

    /// Numbers in the weight block, of so many groups; `None` on overflow.
    pub fn parameters(&self, groups: usize) -> Option<usize> {
        self.parameters_knowing(groups, |_| true)
    }

    /// [`Laws::parameters`] where a program knows all of them.
    #[inline(always)]
    pub(super) fn parameters_knowing(&self, groups: usize, knows: impl Fn(Law) -> bool) -> Option<usize> {
        self.iter_known(knows).try_fold(0usize, |sum, law| sum.checked_add(law.parameters(groups)))
    }

    /// Checks their numbers, which end the weight block, where a program knows all of them.
    #[inline(always)]
    pub(super) fn validate<W: FileWeightFormat>(
        &self,
        groups: usize,
        mut numbers: &[W],
        knows: impl Fn(Law) -> bool,
    ) -> Result<(), ModelError> {
        for law in self.iter_known(knows) {
            let own = numbers.split_at_checked(law.parameters(groups));
            let (own, rest) = expected(own, (numbers, &[]));
            law.validate(own)?;
            numbers = rest;
        }
        Ok(())
    }
}

/// The laws of a file with their numbers, of which a program takes one after another.
#[derive(Clone, Copy, Debug)]
pub struct LawNumbers<'l, 'w, W> {
    laws: Laws<'l>,
    numbers: &'w [W],
    groups: usize,
}

impl<'l, 'w, W> LawNumbers<'l, 'w, W> {
    /// Laws whose numbers are in front of `numbers`.
    pub const fn new(laws: Laws<'l>, numbers: &'w [W], groups: usize) -> Self {
        Self { laws, numbers, groups }
    }

    /// The numbers of a law, where it comes next.
    pub fn take(&mut self, law: Law) -> Option<&'w [W]> {
        let (next, rest) = self.laws.0.split_first()?;
        if *next != law as u8 {
            return None;
        }
        let (own, numbers) = self.numbers.split_at_checked(law.parameters(self.groups))?;
        (self.laws, self.numbers) = (Laws(rest), numbers);
        Some(own)
    }

    /// An error where a law is left, which the program was not compiled for.
    pub(super) fn finish(self) -> Result<(), ModelError> {
        self.laws.0.first().map_or(Ok(()), |number| Err(ModelError::Law { number: *number }))
    }
}

/// Forces that a program is compiled for: they take the laws of a model file that they know, in the order of the file.
///
/// A pair `(A, B)` takes those of A, then those of B: laws stand in it by their numbers, rising. A law that the file does not have
/// is absent; a law that the program does not have is an error of loading.
pub trait LoadForces<S: Scalar, const N: usize>: Forces<S, N> + Sized {
    /// Whether it takes this law, where a file has it.
    fn knows(law: Law) -> bool;
    /// Takes its laws; coordinate i is of group `groups[i]`.
    fn take<W: WeightFormat<Wide = S::Weight>>(laws: &mut LawNumbers<'_, '_, W>, groups: &[u8; N]) -> Self;
}

/// The forces of a file's laws, all of them.
///
/// # Errors
/// [`ModelError::Law`] for a law that `F` does not take.
pub(super) fn load_forces<
    S: Scalar,
    W: WeightFormat<Wide = S::Weight>,
    F: LoadForces<S, N>,
    const N: usize,
>(
    mut laws: LawNumbers<'_, '_, W>,
    groups: &[u8; N],
) -> Result<F, ModelError> {
    let forces = F::take(&mut laws, groups);
    laws.finish()?;
    Ok(forces)
}

/// The number of every coordinate's group.
fn of_groups<S: Scalar, W: WeightFormat<Wide = S::Weight>, const N: usize>(
    numbers: &[W],
    groups: &[u8; N],
) -> [S; N] {
    groups.map(|group| expected(numbers.get(usize::from(group)).map(|number| number.scalar()), S::zero()))
}

impl<S: Scalar, const N: usize> LoadForces<S, N> for Viscous<S, N> {
    #[inline(always)]
    fn knows(law: Law) -> bool {
        law == Law::Viscous
    }

    fn take<W: WeightFormat<Wide = S::Weight>>(laws: &mut LawNumbers<'_, '_, W>, groups: &[u8; N]) -> Self {
        let mut forces = Self::none();
        if let Some(numbers) = laws.take(Law::Viscous) {
            forces.coefficients = of_groups(numbers, groups);
        }
        forces
    }
}

impl<S: Scalar, const N: usize> LoadForces<S, N> for Coulomb<S, N> {
    #[inline(always)]
    fn knows(law: Law) -> bool {
        law == Law::Coulomb
    }

    fn take<W: WeightFormat<Wide = S::Weight>>(laws: &mut LawNumbers<'_, '_, W>, groups: &[u8; N]) -> Self {
        let Some(numbers) = laws.take(Law::Coulomb) else { return Self::none() };
        let (numbers, _) = numbers.as_chunks();
        Self { coordinates: groups.map(|group| dry_friction(numbers.get(usize::from(group)))) }
    }
}

/// Of a group's numbers.
fn dry_friction<S: Scalar, W: WeightFormat<Wide = S::Weight>>(numbers: Option<&[W; 4]>) -> DryFriction<S> {
    let numbers = numbers.map(|numbers| numbers.map(|number| number.scalar()));
    let of = |[constant, load, smoothing, width]: [S; 4]| DryFriction { constant, load, smoothing, width };
    expected(numbers.map(of), DryFriction::none())
}

impl<S: Scalar, A: LoadForces<S, N>, B: LoadForces<S, N>, const N: usize> LoadForces<S, N> for (A, B) {
    #[inline(always)]
    fn knows(law: Law) -> bool {
        A::knows(law) || B::knows(law)
    }

    fn take<W: WeightFormat<Wide = S::Weight>>(laws: &mut LawNumbers<'_, '_, W>, groups: &[u8; N]) -> Self {
        let first = A::take(laws, groups);
        (first, B::take(laws, groups))
    }
}
