use crate::expected::{expected, present};
use crate::network::Jet;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Kind of a coordinate, which decides the features that the network sees.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Coordinate {
    /// A length (m), fed to the network unchanged.
    Translation,
    /// An angle (rad), fed as (cos q, sin q): no seam at ±π.
    Angle,
    /// A coordinate on which the energies do not depend; its momentum is conserved exactly.
    Cyclic,
}

/// Number of features of coordinates of these kinds.
pub fn count(coordinates: &[Coordinate]) -> usize {
    coordinates
        .iter()
        .map(|c| match c {
            Coordinate::Translation => 1,
            Coordinate::Angle => 2,
            Coordinate::Cyclic => 0,
        })
        .sum()
}

/// One feature s(q_i) with s′ and s″, and the index i of its coordinate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Feature<S> {
    pub coordinate: usize,
    pub value: S,
    pub slope: S,
    pub curvature: S,
}

/// Features s(q) in SyMo's order: translations, then the cosines of all angles, then their sines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Features<S, const N: usize> {
    slots: [[Feature<S>; N]; 2],
    count: usize,
}

impl<S: Scalar, const N: usize> Features<S, N> {
    #[inline]
    pub fn new(coordinates: &[Coordinate; N], q: &[S; N]) -> Self {
        let zero = S::zero();
        let none = Feature { coordinate: 0, value: zero, slope: zero, curvature: zero };
        let mut features = Self { slots: [[none; N]; 2], count: 0 };
        let mut sines = [none; N];
        let mut angles = 0;
        for (i, (kind, q)) in coordinates.iter().zip(q).enumerate() {
            if *kind == Coordinate::Translation {
                features.push(Feature { coordinate: i, value: *q, slope: S::one(), curvature: zero });
            }
        }
        for (i, (kind, q)) in coordinates.iter().zip(q).enumerate() {
            if *kind == Coordinate::Angle {
                let (sin, cos) = q.sin_cos();
                features.push(Feature { coordinate: i, value: cos, slope: -sin, curvature: -cos });
                if let Some(slot) = sines.get_mut(angles) {
                    *slot = Feature { coordinate: i, value: sin, slope: cos, curvature: -sin };
                    angles += 1;
                }
            }
        }
        for sine in sines.iter().take(angles) {
            features.push(*sine);
        }
        features
    }

    fn push(&mut self, feature: Feature<S>) {
        if let Some(slot) = self.slots.as_flattened_mut().get_mut(self.count) {
            *slot = feature;
            self.count += 1;
        }
    }

    /// Number of features.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    #[inline(always)]
    fn iter(&self) -> impl Iterator<Item = &Feature<S>> {
        self.slots.as_flattened().iter().take(self.count)
    }

    /// Inputs of the network: features with their tangents along the directions δq.
    #[inline]
    pub fn jets<const T: usize>(&self, directions: &[[S; N]; T]) -> ([[Jet<S, T>; N]; 2], usize) {
        let mut jets = [[Jet::zero(); N]; 2];
        for (jet, f) in jets.as_flattened_mut().iter_mut().zip(self.iter()) {
            jet.value = f.value;
            for (t, direction) in jet.tangent.iter_mut().zip(directions) {
                *t = f.slope * component(direction, f.coordinate);
            }
        }
        (jets, self.count)
    }

    /// Pulls the adjoint of the features back to the coordinates: q̄_i = Σ s̄ s′, and its derivative along direction k, Σ (s̄_k s′ + s̄ s″
    /// δq_k).
    #[inline]
    pub fn adjoint<const A: usize>(&self, bar: &[Jet<S, A>], directions: &[[S; N]; A]) -> [Jet<S, A>; N] {
        let mut q_bar = [Jet::zero(); N];
        for (bar, f) in bar.iter().zip(self.iter()) {
            let Some(q) = present(q_bar.get_mut(f.coordinate)) else { continue };
            q.value += bar.value * f.slope;
            for ((q, bar_k), direction) in q.tangent.iter_mut().zip(&bar.tangent).zip(directions) {
                *q += *bar_k * f.slope + bar.value * f.curvature * component(direction, f.coordinate);
            }
        }
        q_bar
    }
}

#[inline(always)]
fn component<S: Scalar, const N: usize>(direction: &[S; N], i: usize) -> S {
    expected(direction.get(i).copied(), S::zero())
}
