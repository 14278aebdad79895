use super::Jet;
use crate::expected::expected;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// The smooth functions that hidden units apply to their input z.
///
/// Derivatives are exact. `Squareplus` and `Isru` need only a square root, which a floating-point unit has; they
/// square z, so |z| must stay below the root of the largest number (1.8e19 in f32), beyond which their slope is 0.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Activation {
    /// tanh z: σ′ = 1 − σ², σ″ = −2σσ′.
    Tanh,
    /// ln(1 + e^z): σ′ = 1/(1 + e^−z), σ″ = σ′(1 − σ′).
    Softplus,
    /// ½(z + √(z² + 4)) (LGNN): σ′ = ½(1 + z/√(z² + 4)), σ″ = 2/(z² + 4)^{3/2}.
    Squareplus,
    /// z/√(1 + z²): σ′ = (1 + z²)^{−3/2}, σ″ = −3z(1 + z²)^{−5/2}.
    Isru,
    /// z: σ′ = 1, σ″ = 0.
    Identity,
}

/// σ(z), σ′(z), σ″(z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve<S> {
    /// σ(z).
    pub value: S,
    /// σ′(z).
    pub slope: S,
    /// σ″(z).
    pub curvature: S,
}

impl Activation {
    /// All activations, in the order of their numbers in a model file.
    pub const ALL: [Self; 5] = [Self::Tanh, Self::Softplus, Self::Squareplus, Self::Isru, Self::Identity];

    /// σ, σ′ and σ″ at z; finite for every finite z.
    #[inline(always)]
    pub fn curve<S: Scalar>(self, z: S) -> Curve<S> {
        match self {
            Self::Tanh => tanh(z),
            Self::Softplus => softplus(z),
            Self::Squareplus => squareplus(z),
            Self::Isru => isru(z),
            Self::Identity => Curve { value: z, slope: S::one(), curvature: S::zero() },
        }
    }

    /// σ‴(z), from z and the curve there.
    #[inline(always)]
    pub fn third<S: Scalar>(self, z: S, c: &Curve<S>) -> S {
        let minus_two = S::constant(-2.0);
        match self {
            Self::Tanh => minus_two * (c.slope * c.slope + c.value * c.curvature),
            Self::Softplus => c.curvature * (S::one() + minus_two * c.slope),
            Self::Squareplus => S::constant(-3.0) * z * c.curvature / (z * z + S::constant(4.0)),
            Self::Isru => {
                let square = z * z;
                let r = S::one() / (S::one() + square);
                S::constant(3.0) * (S::constant(4.0) * square - S::one()) * c.slope * r * r
            }
            Self::Identity => S::zero(),
        }
    }

    /// Replaces every z by σ(z) with its tangents, and writes σ′(z) with its tangents σ″ż into `slopes`.
    #[inline(always)]
    pub fn apply<S: Scalar, const T: usize>(self, units: &mut [Jet<S, T>], slopes: &mut [Jet<S, T>]) {
        let mut slopes = slopes.iter_mut();
        self.visit(units, |unit, c| {
            if let Some(slope) = slopes.next() {
                *slope = unit.chain(c.slope, c.curvature);
            }
            *unit = unit.chain(c.value, c.slope);
        });
    }

    /// Replaces every z by σ(z) with its tangents.
    #[inline(always)]
    pub fn apply_forward<S: Scalar, const T: usize>(self, units: &mut [Jet<S, T>]) {
        self.visit(units, |unit, c| *unit = unit.chain(c.value, c.slope));
    }

    /// Visits every unit with the curve of σ at its value, a block of units side by side.
    #[inline(always)]
    pub(super) fn visit<S: Scalar, const T: usize>(
        self,
        units: &mut [Jet<S, T>],
        mut visit: impl FnMut(&mut Jet<S, T>, Curve<S>),
    ) {
        let zero = [S::zero(); BLOCK];
        let (mut z, mut c) = (zero, Curve { value: zero, slope: zero, curvature: zero });
        for units in units.chunks_mut(BLOCK) {
            z.iter_mut().zip(units.iter()).for_each(|(z, unit)| *z = unit.value);
            let Curve { value, slope, curvature } = &mut c;
            self.curves(expected(z.get(..units.len()), &z), [value, slope, curvature]);
            for (((unit, value), slope), curvature) in
                units.iter_mut().zip(c.value).zip(c.slope).zip(c.curvature)
            {
                visit(unit, Curve { value, slope, curvature });
            }
        }
    }

    /// σ, σ′ and σ″ of at most a block of units. A function of its own, so that a compiler sees vectors and not the jets around
    /// them, and there is one copy for any number of tangents.
    #[inline(never)]
    fn curves<S: Scalar>(self, z: &[S], curves: [&mut [S]; 3]) {
        match self {
            Self::Tanh => block(tanh, z, curves),
            Self::Softplus => block(softplus, z, curves),
            Self::Squareplus => block(squareplus, z, curves),
            Self::Isru => block(isru, z, curves),
            Self::Identity => block(|z| Self::Identity.curve(z), z, curves),
        }
    }
}

/// Number of units that σ is applied to side by side.
const BLOCK: usize = 8;

#[inline(always)]
fn block<S: Scalar>(sigma: impl Fn(S) -> Curve<S>, z: &[S], [value, slope, curvature]: [&mut [S]; 3]) {
    // A full block has a length that the compiler knows and arrays of its own, so it becomes vector instructions. Where
    // code size matters more, one loop serves all lengths.
    if !S::COMPONENTWISE
        && let Ok(z) = <&[S; BLOCK]>::try_from(z)
    {
        let mut c = [[S::zero(); BLOCK]; 3];
        let [values, slopes, curvatures] = &mut c;
        for (l, z) in z.iter().enumerate() {
            let c = sigma(*z);
            (values[l], slopes[l], curvatures[l]) = (c.value, c.slope, c.curvature);
        }
        for (workspace, c) in [value, slope, curvature].into_iter().zip(c) {
            if let Some(workspace) = workspace.first_chunk_mut() {
                *workspace = c;
            }
        }
        return;
    }
    for (((z, value), slope), curvature) in z.iter().zip(value).zip(slope).zip(curvature) {
        Curve { value: *value, slope: *slope, curvature: *curvature } = sigma(*z);
    }
}

#[inline(always)]
fn tanh<S: Scalar>(z: S) -> Curve<S> {
    let value = z.tanh();
    let slope = S::one() - value * value;
    Curve { value, slope, curvature: S::constant(-2.0) * value * slope }
}

/// e^−|z| never overflows; e^{min(z, 0)} keeps the relative accuracy of the slope where it is small.
#[inline(always)]
fn softplus<S: Scalar>(z: S) -> Curve<S> {
    let e = z.neg_abs().exp();
    let negative_part = -(-z).max(S::zero());
    let slope = negative_part.exp() / (S::one() + e);
    Curve { value: z.max(S::zero()) + e.ln_1p(), slope, curvature: slope * (S::one() - slope) }
}

/// ½(z + √(z² + 4)) = max(z, 0) + 2/(|z| + √(z² + 4)), in which nothing cancels.
#[inline(always)]
fn squareplus<S: Scalar>(z: S) -> Curve<S> {
    let two = S::constant(2.0);
    let square = z * z + S::constant(4.0);
    let root = square.sqrt();
    let value = z.max(S::zero()) + two / (root - z.neg_abs());
    Curve { value, slope: value / root, curvature: two / (square * root) }
}

#[inline(always)]
fn isru<S: Scalar>(z: S) -> Curve<S> {
    let r = S::one() / (S::one() + z * z).sqrt();
    let slope = r * r * r;
    Curve { value: z * r, slope, curvature: S::constant(-3.0) * z * slope * r * r }
}
