//! Potentials of elements and of pairs of elements, with their derivatives in positions.

use super::dot;
use super::tree::{SPACE, Vector, add, scale};
use crate::energy::distance::DistanceFeature;
use crate::network::{Jet, Mlp};
use crate::scalar::{Scalar, WeightFormat};
use serde::{Deserialize, Serialize};

/// Input of a pair potential, from the two positions a and b.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PairInput {
    /// Both positions, symmetrised: ½[U(a, b) + U(b, a)] (ModLaNet).
    Concat,
    /// The difference of the positions, symmetrised: ½[U(a − b) + U(b − a)]. Conserves linear momentum.
    Difference,
    /// The distance: U(|a − b|). Conserves linear and angular momentum; not differentiable where the positions coincide.
    Distance,
    /// The inverse distance: U(1/|a − b|), for forces that fall off with distance. The input of distant
    /// elements is then near 0, not beyond all data.
    InverseDistance,
}

impl PairInput {
    /// Number of inputs of the network.
    pub const fn features(self) -> usize {
        match self {
            Self::Concat => 2 * SPACE,
            Self::Difference => SPACE,
            Self::Distance | Self::InverseDistance => 1,
        }
    }
}

/// A position that moves along T directions.
pub(super) type Moving<S, const T: usize> = [Jet<S, T>; SPACE];

/// The pair potential of a model.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a, W, const H: usize, const L: usize> {
    /// U₂.
    pub potential: Mlp<'a, W, H, L>,
    /// Input of the network.
    pub input: PairInput,
}

impl<W: WeightFormat, const H: usize, const L: usize> Pair<'_, W, H, L> {
    /// U₂ of two positions.
    pub(super) fn energy<S: Scalar<Weight = W::Wide>>(&self, a: &Vector<S>, b: &Vector<S>) -> S {
        let [ax, ay] = a.map(Jet::constant);
        let [bx, by] = b.map(Jet::constant);
        let d = add(a, &scale(-S::one(), b));
        let u = |x: &[Jet<S, 0>]| self.potential.energy::<S>(x);
        let feature = match self.input {
            PairInput::Concat => return (u(&[ax, ay, bx, by]) + u(&[bx, by, ax, ay])).half(),
            PairInput::Difference => {
                return (u(&d.map(Jet::constant)) + u(&d.map(|d| Jet::constant(-d)))).half();
            }
            PairInput::Distance => DistanceFeature::Distance,
            PairInput::InverseDistance => DistanceFeature::Inverse,
        };
        u(&[feature.of_square(dot(&d, &d))])
    }

    /// `weight` times the gradients of U₂ in a and in b, with tangents.
    pub(super) fn gradients<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        [a, b]: [&Moving<S, T>; 2],
        weight: S,
    ) -> [Moving<S, T>; 2] {
        let potential = &self.potential;
        let half = S::one().half();
        let feature = match self.input {
            PairInput::Concat => {
                let [ax, ay, bx, by] = potential.gradient(&[a[0], a[1], b[0], b[1]], weight * half);
                let [cx, cy, dx, dy] = potential.gradient(&[b[0], b[1], a[0], a[1]], weight * half);
                return [[ax.plus(&dx), ay.plus(&dy)], [bx.plus(&cx), by.plus(&cy)]];
            }
            PairInput::Difference => {
                let d = difference(a, b);
                let forth = potential.gradient(&d, weight * half);
                let back = potential.gradient(&negative(&d), weight * half);
                let on_a = difference(&forth, &back);
                return [on_a, negative(&on_a)];
            }
            PairInput::Distance => DistanceFeature::Distance,
            PairInput::InverseDistance => DistanceFeature::Inverse,
        };
        let d = difference(a, b);
        let [z, rate] = feature.of_difference(&d);
        let [slope] = potential.gradient(&[z], weight);
        let along = slope.times(&rate);
        let on_a = d.map(|d| d.times(&along));
        [on_a, negative(&on_a)]
    }
}

#[inline(always)]
fn difference<S: Scalar, const T: usize>(a: &Moving<S, T>, b: &Moving<S, T>) -> Moving<S, T> {
    let [bx, by] = negative(b);
    [a[0].plus(&bx), a[1].plus(&by)]
}

#[inline(always)]
fn negative<S: Scalar, const T: usize>(a: &Moving<S, T>) -> Moving<S, T> {
    a.each_ref().map(|a| a.scaled(-S::one()))
}
