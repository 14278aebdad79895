use super::Jet;
use super::units::{Units, sized};
use crate::scalar::Scalar;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Smooth functions that hidden units apply to their input z.
///
/// Derivatives are exact. `Squareplus` and `Isru` need only a square root, which a floating-point unit has. They square z, so |z| must stay
/// below the root of the largest number (1.8e19 in f32); beyond it their slope is 0.
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

    /// σ‴(z), from z and the curve at z.
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
    pub fn apply<S: Scalar, const T: usize, const H: usize>(
        self,
        units: &mut Units<S, T, H>,
        slopes: &mut Units<S, T, H>,
    ) {
        let mut curvatures = Vec::<S, H>::new();
        let (values, tangents) = units.parts_mut();
        let (slopes, slope_tangents) = slopes.resize(values.len()).parts_mut();
        let curvatures = if T > 0 { sized(&mut curvatures, values.len()) } else { &mut [] };
        self.curves(values, slopes, curvatures);
        for (rates, slope_rates) in tangents.iter_mut().zip(slope_tangents) {
            copy(slope_rates, rates);
            scale(slope_rates, curvatures);
            scale(rates, slopes);
        }
    }

    /// Replaces every z by σ(z) with its tangents.
    #[inline(always)]
    pub(super) fn apply_forward<S: Scalar, const T: usize, const H: usize>(self, units: &mut Units<S, T, H>) {
        let mut slopes = Vec::<S, H>::new();
        let (values, tangents) = units.parts_mut();
        let slopes = sized(&mut slopes, values.len());
        self.curves(values, slopes, &mut []);
        tangents.iter_mut().for_each(|rates| scale(rates, slopes));
    }

    /// Writes σ(z) with its tangents into `units` and σ″(z) into `curvatures`; in `z` the tangents stay, and the values become σ′(z).
    #[inline(always)]
    pub(super) fn apply_second_order<S: Scalar, const T: usize, const H: usize>(
        self,
        z: &mut Units<S, T, H>,
        units: &mut Units<S, T, H>,
        curvatures: &mut Vec<S, H>,
    ) {
        let (slopes, z_tangents) = z.parts_mut();
        let (values, tangents) = units.resize(slopes.len()).parts_mut();
        copy(values, slopes);
        self.curves(values, slopes, sized(curvatures, values.len()));
        for (rates, z_rates) in tangents.iter_mut().zip(z_tangents) {
            copy(rates, z_rates);
            scale(rates, slopes);
        }
    }

    /// Replaces every z by σ(z), and writes σ′(z) into `slopes` and, up to its length, σ″(z) into `curvatures`. A separate function, so one
    /// copy serves any number of tangents.
    #[inline(never)]
    fn curves<S: Scalar>(self, z: &mut [S], slopes: &mut [S], curvatures: &mut [S]) {
        match self {
            Self::Tanh => curves(tanh, z, slopes, curvatures),
            Self::Softplus => curves(softplus, z, slopes, curvatures),
            Self::Squareplus => curves(squareplus, z, slopes, curvatures),
            Self::Isru => curves(isru, z, slopes, curvatures),
            Self::Identity => curves(|z| Self::Identity.curve(z), z, slopes, curvatures),
        }
    }
}

/// Softplus ln(1 + e^z) of N numbers with their tangents, and σ′ with its tangents.
pub(crate) fn softplus_jets<S: Scalar, const T: usize, const N: usize>(
    z: &[Jet<S, T>; N],
) -> [[Jet<S, T>; N]; 2] {
    let mut both = [*z; 2];
    let [values, slopes] = &mut both;
    for (value, slope) in values.iter_mut().zip(slopes) {
        let c = softplus(value.value);
        *slope = value.chain(c.slope, c.curvature);
        *value = value.chain(c.value, c.slope);
    }
    both
}

/// Number of units to which σ is applied side by side, if there are vector registers.
const BLOCK: usize = 8;

#[inline(always)]
fn curves<S: Scalar>(sigma: impl Fn(S) -> Curve<S>, z: &mut [S], slopes: &mut [S], curvatures: &mut [S]) {
    let mut done = 0;
    // Componentwise scalars need small code: they use only the loop below, which serves all lengths.
    if !S::COMPONENTWISE {
        let (z, slopes) = (z.as_chunks_mut().0, slopes.as_chunks_mut().0);
        for (z, slopes) in z.iter_mut().zip(slopes) {
            block(&sigma, z, slopes, curvatures.get_mut(done..));
            done += BLOCK;
        }
    }
    let rest = z.iter_mut().zip(slopes).enumerate().skip(done);
    for (i, (z, slope)) in rest {
        let c = sigma(*z);
        (*z, *slope) = (c.value, c.slope);
        if let Some(curvature) = curvatures.get_mut(i) {
            *curvature = c.curvature;
        }
    }
}

/// Applies σ to a full block. The compiler knows the block's length, and the block has arrays of its own, so the loop
/// becomes vector instructions.
#[inline(always)]
fn block<S: Scalar>(
    sigma: impl Fn(S) -> Curve<S>,
    z: &mut [S; BLOCK],
    slopes: &mut [S; BLOCK],
    rest: Option<&mut [S]>,
) {
    let mut c = [[S::zero(); BLOCK]; 3];
    let [values, rates, curvatures] = &mut c;
    for (l, z) in z.iter().enumerate() {
        let c = sigma(*z);
        (values[l], rates[l], curvatures[l]) = (c.value, c.slope, c.curvature);
    }
    [*z, *slopes] = [*values, *rates];
    if let Some(slots) = rest.and_then(|rest| rest.first_chunk_mut()) {
        *slots = *curvatures;
    }
}

/// Copies like [`slice::copy_from_slice`], which would panic if the lengths differ.
#[inline(always)]
fn copy<S: Copy>(x: &mut [S], y: &[S]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x = *y);
}

/// x_i ← c_i x_i.
#[inline(never)]
fn scale<S: Scalar>(x: &mut [S], c: &[S]) {
    let ((fours, ones), (c_fours, c_ones)) = (x.as_chunks_mut::<4>(), c.as_chunks::<4>());
    for (x, c) in fours.iter_mut().zip(c_fours) {
        *x = core::array::from_fn(|i| c[i] * x[i]);
    }
    ones.iter_mut().zip(c_ones).for_each(|(x, c)| *x = *c * *x);
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
