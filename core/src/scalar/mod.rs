//! Scalars: `f32` for the chip, `f64` for the host, [`Lanes`] of f64 for the trainer, and any type that a test defines.
//!
//! Addition, subtraction, multiplication, division and square root are exact IEEE operations on every target and Rust
//! never contracts them; the elementary functions are software. One program therefore gives the same bits everywhere.

mod compensated;
mod float32;
mod float64;
mod lanes;
mod packed;
mod sin_cos;
mod tanh;
mod weight_format;

pub use compensated::{Compensated, product, sum};
pub use lanes::{LANES, Lanes};
pub use leastaction_fpu::{FpuError, check_fpu, f16};
pub use packed::Packed;
pub use weight_format::{FileWeightFormat, WeightFormat, Weights};

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use leastaction_fpu::portable;

/// Number type of the energies: a field with the elementary functions.
pub trait Scalar:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// The type in which network weights are read: `f32` on the chip, `f64` in training. See [`WeightFormat`].
    type Weight: WeightFormat<Wide = Self::Weight>;

    /// The weight as a scalar (broadcast to every lane).
    fn weight(w: Self::Weight) -> Self;
    /// The nearest scalar to a constant; folded at compile time if the argument is a literal.
    fn constant(x: f64) -> Self;
    /// √x, correctly rounded; NaN for x < 0.
    fn sqrt(self) -> Self;
    /// eˣ.
    fn exp(self) -> Self;
    /// ln(1 + x), for x > −1.
    fn ln_1p(self) -> Self;
    /// tanh x.
    fn tanh(self) -> Self;
    /// (sin x, cos x), x in radians.
    fn sin_cos(self) -> (Self, Self);
    /// The angle x rad in [0, 2π), x − 2π⌊x/2π⌋; the largest number below 2π if rounding would give 2π itself. NaN if x is not finite.
    fn wrapped(self) -> Self;
    /// The larger of the two; `other` if `self` is NaN.
    fn max(self, other: Self) -> Self;
    /// −|x|.
    fn neg_abs(self) -> Self;

    /// Whether a layer evaluates its tangents one after the other, by [`Scalar::accumulate`] and [`Scalar::transposed`], instead of side by
    /// side.
    const COMPONENTWISE: bool = false;

    /// Whether [`Scalar::sin_cos_of`] takes less time than the angles one by one.
    const SIDE_BY_SIDE: bool = false;

    /// Sines and cosines of many angles, with the bits of [`Scalar::sin_cos`].
    #[inline(always)]
    fn sin_cos_of<const N: usize>(x: &[Self; N]) -> ([Self; N], [Self; N]) {
        let both = x.map(Self::sin_cos);
        (both.map(|(sin, _)| sin), both.map(|(_, cos)| cos))
    }

    /// Called before the loops over each component of a layer's vectors (0: the values, then the tangents), for scalars that
    /// count operations.
    #[inline(always)]
    fn component(_index: usize) {}

    /// s_l ← ((s_l + w₀ₗx₀) + w₁ₗx₁) + … with `rows[j][l]` = w_jl.
    #[inline(always)]
    fn accumulate<W: WeightFormat<Wide = Self::Weight>, const P: usize>(
        rows: &[[W; P]],
        x: &[Self],
        sum: &mut [Self; P],
    ) {
        portable::accumulate(rows, x, sum, W::scalar);
    }

    /// x̄_j ← x̄_j + Σ_l w_jl ȳ_l, products added in halves: lane l to lane l + P/2, and so on.
    #[inline(always)]
    fn transposed<W: WeightFormat<Wide = Self::Weight>, const P: usize>(
        rows: &[[W; P]],
        y_bar: &[Self; P],
        x_bar: &mut [Self],
    ) {
        portable::transposed(rows, y_bar, x_bar, W::scalar);
    }

    /// 0.
    #[inline(always)]
    fn zero() -> Self {
        Self::constant(0.0)
    }
    /// 1.
    #[inline(always)]
    fn one() -> Self {
        Self::constant(1.0)
    }
    /// ½x.
    #[inline(always)]
    fn half(self) -> Self {
        self * Self::constant(0.5)
    }
}

/// Number type of the solvers: an ordered scalar with a known rounding error.
pub trait Real: Scalar + PartialOrd {
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;
    /// |x|.
    fn abs(self) -> Self;
    /// x − 2π round(x/2π), the angle in [−π, π] (and by rounding a little beyond) that differs from x rad by whole turns.
    fn short_way(self) -> Self;
    /// Whether the number is neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// The value in double precision, for reports on the host.
    fn to_f64(self) -> f64;
}

/// Largest absolute value, NaN if any component is not finite.
pub fn max_abs<R: Real, const N: usize>(x: &[R; N]) -> R {
    x.iter().fold(R::zero(), |largest, x| {
        // 0x is 0, or NaN if x is not finite.
        let largest = largest + *x * R::zero();
        if largest.is_finite() { largest.max(x.abs()) } else { largest }
    })
}

/// Whether every component is finite.
pub fn all_finite<R: Real, const N: usize>(x: &[R; N]) -> bool {
    x.iter().all(|x| x.is_finite())
}
