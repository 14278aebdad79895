//! A scalar that counts the operations done in it.

use leastaction_core::scalar::{Real, Scalar};
use std::cell::Cell;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A scalar with its operations counted, thread by thread.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Counted<R>(pub R);

/// Operations done.
#[derive(Clone, Copy, Debug, Default)]
pub struct Operations {
    /// Additions, subtractions and multiplications.
    pub flops: u64,
    /// Divisions and square roots.
    pub divisions: u64,
    /// tanh, exponentials, logarithms, sines with their cosines.
    pub elementary: u64,
}

thread_local! {
    static DONE: Cell<Operations> = Cell::new(Operations::default());
}

/// What `call` does.
pub fn count<O>(call: impl FnOnce() -> O) -> (O, Operations) {
    DONE.set(Operations::default());
    let output = call();
    (output, DONE.get())
}

fn note(change: impl Fn(&mut Operations)) {
    let mut done = DONE.get();
    change(&mut done);
    DONE.set(done);
}

fn elementary<O>(output: O) -> O {
    note(|done| done.elementary += 1);
    output
}

macro_rules! counted {
    ($trait:ident, $method:ident, $op:tt, $kind:ident) => {
        impl<R: Real> $trait for Counted<R> {
            type Output = Self;
            #[allow(clippy::suspicious_arithmetic_impl, reason = "it counts what it does")]
            fn $method(self, other: Self) -> Self {
                note(|done| done.$kind += 1);
                Self(self.0 $op other.0)
            }
        }
    };
}
counted!(Add, add, +, flops);
counted!(Sub, sub, -, flops);
counted!(Mul, mul, *, flops);
counted!(Div, div, /, divisions);

impl<R: Real> Neg for Counted<R> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<R: Real> AddAssign for Counted<R> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<R: Real> SubAssign for Counted<R> {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<R: Real> Scalar for Counted<R> {
    type Weight = R::Weight;

    fn weight(w: R::Weight) -> Self {
        Self(R::weight(w))
    }
    fn constant(x: f64) -> Self {
        Self(R::constant(x))
    }
    fn sqrt(self) -> Self {
        note(|done| done.divisions += 1);
        Self(self.0.sqrt())
    }
    fn exp(self) -> Self {
        elementary(Self(self.0.exp()))
    }
    fn ln_1p(self) -> Self {
        elementary(Self(self.0.ln_1p()))
    }
    fn tanh(self) -> Self {
        elementary(Self(self.0.tanh()))
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0.sin_cos();
        elementary((Self(sin), Self(cos)))
    }
    fn wrapped(self) -> Self {
        Self(self.0.wrapped())
    }
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }
    fn neg_abs(self) -> Self {
        Self(self.0.neg_abs())
    }
}

impl<R: Real> Real for Counted<R> {
    const EPSILON: Self = Self(R::EPSILON);

    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
    fn to_f64(self) -> f64 {
        self.0.to_f64()
    }
}
