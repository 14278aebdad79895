//! Forces of a program from the laws of a model file and their numbers.

use super::{Law, LawNetwork, Laws, ModelError};
use crate::expected::expected;
use crate::forces::{
    Coulomb, Directional, DirectionalFriction, Dissipation, DryFriction, Forces, PotentialCorrection, Servo,
    Sticking, StickingFriction, Stop, Stops, Viscous,
};
use crate::scalar::{Scalar, WeightFormat};

/// The laws of a file with their numbers; a program takes them one by one.
#[derive(Clone, Copy, Debug)]
pub struct LawNumbers<'l, 'w, W> {
    laws: Laws<'l>,
    numbers: &'w [W],
    groups: usize,
}

impl<'l, 'w, W> LawNumbers<'l, 'w, W> {
    /// Creates the list of laws whose numbers come first in `numbers`.
    pub const fn new(laws: Laws<'l>, numbers: &'w [W], groups: usize) -> Self {
        Self { laws, numbers, groups }
    }

    /// Laws not taken yet.
    pub const fn laws(&self) -> Laws<'l> {
        self.laws
    }

    /// Takes the numbers of a law if it comes next.
    #[inline(always)]
    pub fn take(&mut self, law: Law) -> Option<&'w [W]> {
        if self.next()? != law as u8 {
            return None;
        }
        let (own, numbers) = self.numbers.split_at_checked(self.laws.parameters_of(law, self.groups)?)?;
        (self.laws.present, self.numbers) = (self.laws.present & !law.bit(), numbers);
        Some(own)
    }

    /// Takes the network of a law and its numbers if the law comes next.
    #[inline(always)]
    pub fn take_network(&mut self, law: Law) -> Option<(LawNetwork<'l>, &'w [W])> {
        let network = self.laws.network(law)?;
        Some((network, self.take(law)?))
    }

    /// Number of the law that comes next.
    fn next(&self) -> Option<u8> {
        let present = self.laws.present;
        (present != 0).then(|| present.trailing_zeros() as u8)
    }

    /// Returns an error if a law is left; the program was not compiled for that law.
    pub(super) fn finish(self) -> Result<(), ModelError> {
        self.next().map_or(Ok(()), |number| Err(ModelError::Law { number }))
    }
}

/// Forces that a program is compiled for. They take those laws of a model file that they know, in the order of the
/// file.
///
/// A pair `(A, B)` takes the laws of A, then those of B, so a program must list its laws in the ascending order of
/// their numbers. A law missing from the file is left out; a law that the program does not have is a loading error.
///
/// The numbers of networks stay in place: `'w` is the lifetime of the weight block, `W` its number type.
pub trait LoadForces<'w, W: WeightFormat<Wide = S::Weight>, S: Scalar, const N: usize>:
    Forces<S, N> + Sized
{
    /// Whether these forces can take the law.
    fn knows(law: Law) -> bool;
    /// Takes the laws that these forces know; coordinate i belongs to group `groups[i]`.
    ///
    /// # Errors
    /// [`ModelError::Shape`] where a network is larger than the program was compiled for.
    fn take(laws: &mut LawNumbers<'_, 'w, W>, groups: &[u8; N]) -> Result<Self, ModelError>;
}

/// Loads the forces of all laws of a file.
///
/// # Errors
/// [`ModelError::Law`] for a law that `F` does not take.
pub(super) fn load_forces<'w, W, S, F, const N: usize>(
    mut laws: LawNumbers<'_, 'w, W>,
    groups: &[u8; N],
) -> Result<F, ModelError>
where
    W: WeightFormat<Wide = S::Weight>,
    S: Scalar,
    F: LoadForces<'w, W, S, N>,
{
    let forces = F::take(&mut laws, groups)?;
    laws.finish()?;
    Ok(forces)
}

/// Gives every coordinate the number of its group.
fn of_groups<S: Scalar, W: WeightFormat<Wide = S::Weight>, const N: usize>(
    numbers: &[W],
    groups: &[u8; N],
) -> [S; N] {
    groups.map(|group| expected(numbers.get(usize::from(group)).map(|number| number.scalar()), S::zero()))
}

impl<'w, W: WeightFormat<Wide = S::Weight>, S: Scalar, const N: usize> LoadForces<'w, W, S, N>
    for Viscous<S, N>
{
    #[inline(always)]
    fn knows(law: Law) -> bool {
        law == Law::Viscous
    }

    fn take(laws: &mut LawNumbers<'_, 'w, W>, groups: &[u8; N]) -> Result<Self, ModelError> {
        let mut forces = Self::none();
        if let Some(numbers) = laws.take(Law::Viscous) {
            forces.coefficients = of_groups(numbers, groups);
        }
        Ok(forces)
    }
}

/// Loads a law with `$count` numbers for every group, which `$build` turns into the law of one coordinate.
macro_rules! group_law {
    ($forces:ident, $count:literal, $none:expr, $build:expr) => {
        impl<'w, W: WeightFormat<Wide = S::Weight>, S: Scalar, const N: usize> LoadForces<'w, W, S, N>
            for $forces<S, N>
        {
            #[inline(always)]
            fn knows(law: Law) -> bool {
                law == Law::$forces
            }

            fn take(laws: &mut LawNumbers<'_, 'w, W>, groups: &[u8; N]) -> Result<Self, ModelError> {
                let Some(numbers) = laws.take(Law::$forces) else { return Ok(Self::none()) };
                let (numbers, _) = numbers.as_chunks::<$count>();
                let of = |group: u8| {
                    let own = numbers.get(usize::from(group)).map(|own| own.map(|number| number.scalar()));
                    expected(own.map($build), $none)
                };
                Ok(Self { coordinates: groups.map(of) })
            }
        }
    };
}
group_law!(Coulomb, 4, DryFriction::none(), |[constant, load, smoothing, width]: [S; 4]| DryFriction {
    constant,
    load,
    smoothing,
    width
});
group_law!(Directional, 5, DirectionalFriction::none(), |[
    viscous,
    viscous_asymmetry,
    constant,
    asymmetry,
    width,
]: [S; 5]| DirectionalFriction {
    viscous,
    viscous_asymmetry,
    constant,
    asymmetry,
    width
});
group_law!(Sticking, 6, StickingFriction::none(), |[
    constant,
    asymmetry,
    load,
    smoothing,
    breakaway,
    width,
]: [S; 6]| StickingFriction {
    constant,
    asymmetry,
    load,
    smoothing,
    breakaway,
    width
});

group_law!(Stops, 3, Stop::none(), |[centre, half, restitution]: [S; 3]| Stop::about(
    centre,
    half,
    restitution
));

impl<'w, W: WeightFormat<Wide = S::Weight>, S: Scalar, const N: usize> LoadForces<'w, W, S, N>
    for Servo<S, N>
{
    #[inline(always)]
    fn knows(law: Law) -> bool {
        law == Law::Servo
    }

    fn take(laws: &mut LawNumbers<'_, 'w, W>, groups: &[u8; N]) -> Result<Self, ModelError> {
        Ok(Self { stiffness: laws.take(Law::Servo).map(|numbers| of_groups(numbers, groups)) })
    }
}

macro_rules! network_law {
    ($forces:ident, $law:ident) => {
        impl<'w, W, S, const N: usize, const H: usize, const L: usize> LoadForces<'w, W, S, N>
            for $forces<'w, W, N, H, L>
        where
            W: WeightFormat<Wide = S::Weight>,
            S: Scalar,
        {
            #[inline(always)]
            fn knows(law: Law) -> bool {
                law == Law::$law
            }

            fn take(laws: &mut LawNumbers<'_, 'w, W>, _: &[u8; N]) -> Result<Self, ModelError> {
                let Some((network, mut numbers)) = laws.take_network(Law::$law) else {
                    return Ok(Self::none());
                };
                let taken = Self::take(&mut numbers, network.seen()?, &network.network(Law::$law)?)?;
                taken.ok_or(ModelError::Malformed)
            }
        }
    };
}
network_law!(Dissipation, Dissipation);
network_law!(PotentialCorrection, Potential);

impl<'w, W, S, A, B, const N: usize> LoadForces<'w, W, S, N> for (A, B)
where
    W: WeightFormat<Wide = S::Weight>,
    S: Scalar,
    A: LoadForces<'w, W, S, N>,
    B: LoadForces<'w, W, S, N>,
{
    #[inline(always)]
    fn knows(law: Law) -> bool {
        A::knows(law) || B::knows(law)
    }

    fn take(laws: &mut LawNumbers<'_, 'w, W>, groups: &[u8; N]) -> Result<Self, ModelError> {
        let first = A::take(laws, groups)?;
        Ok((first, B::take(laws, groups)?))
    }
}
