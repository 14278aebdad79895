use super::{Real, Scalar};

/// A running sum that remembers what rounding took from it, whichever of sum and increment is the larger (Kahan, with the
/// two-sum of Knuth).
///
/// Positions and momenta of a long simulation are sums of many small increments; with this carry the f32 trajectory of
/// 3 s at h = 1 ms stays within about 2e-6 rad of the f64 one, instead of 1e-3 rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensated<S> {
    sum: S,
    carry: S,
}

impl<S: Scalar> Compensated<S> {
    /// Starts at `value` with nothing carried.
    pub fn new(value: S) -> Self {
        Self { sum: value, carry: S::zero() }
    }

    /// A sum that was stored as its two parts.
    pub const fn from_parts(value: S, carry: S) -> Self {
        Self { sum: value, carry }
    }

    /// The sum, rounded.
    pub const fn value(&self) -> S {
        self.sum
    }

    /// What rounding took so far: the exact sum is close to `value() + carry()`.
    pub const fn carry(&self) -> S {
        self.carry
    }

    /// The sum after adding `increment`.
    #[must_use]
    pub fn plus(self, increment: S) -> Self {
        let (total, lost) = sum(self.sum, increment);
        // Not larger than the total, unless that is 0: the shorter way to the same two numbers (Dekker).
        let rest = lost + self.carry;
        let sum = total + rest;
        Self { sum, carry: rest - (sum - total) }
    }
}

/// a + b rounded, and what rounding took: their sum is a + b exactly (Knuth).
#[inline(always)]
pub fn sum<S: Scalar>(a: S, b: S) -> (S, S) {
    let sum = a + b;
    let rest = sum - a;
    (sum, (a - (sum - rest)) + (b - rest))
}

/// ab rounded, and what rounding took: their sum is ab exactly, unless a part underflows or overflows (Dekker, Veltkamp).
#[inline(always)]
pub fn product<R: Real>(a: R, b: R) -> (R, R) {
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    let error = a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low);
    (product, error)
}

/// A number as the sum of two of half as many digits.
#[inline(always)]
fn halves<R: Real>(x: R) -> (R, R) {
    // 2^⌈digits/2⌉ + 1, of 24 or 53 binary digits.
    let single = R::EPSILON > R::constant(1e-10);
    let shifted = x * R::constant(if single { 4_097.0 } else { 134_217_729.0 });
    let high = shifted - (shifted - x);
    (high, x - high)
}
