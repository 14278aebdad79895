//! A scalar that counts the operations done with it; core's benchmarks use it, too.

use leastaction_core::scalar::{Real, Scalar, WeightFormat};
use std::cell::Cell;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A scalar whose operations are counted, separately for every thread.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Counted<R>(pub R);

/// Numbers of operations.
#[derive(Clone, Copy, Debug, Default)]
pub struct Operations {
    /// Additions, subtractions, multiplications and changes of sign outside layers.
    pub flops: u64,
    /// Divisions.
    pub divisions: u64,
    /// Square roots.
    pub roots: u64,
    /// Exponentials eˣ.
    pub exponentials: u64,
    /// Logarithms ln(1 + x).
    pub logarithms: u64,
    /// Hyperbolic tangents.
    pub tangents: u64,
    /// Sines with their cosines.
    pub sines: u64,
    /// Multiply-adds in layers, by panels of eight outputs, of four, and of one.
    pub multiply_adds: [u64; 3],
    /// Panels in layers.
    pub panels: u64,
    /// Passes through panels in layers; a pass has as many inputs and outputs as are gathered at a time.
    pub passes: u64,
    /// Inputs and outputs of these passes.
    pub moved: u64,
    /// Values and tangents computed by layers, each in one pass or more.
    pub components: u64,
    /// Layers evaluated.
    pub layers: u64,
}

thread_local! {
    static DONE: Cell<Operations> = Cell::new(Operations::default());
    /// End address of the last panel's outputs.
    static OUTPUTS_END: Cell<usize> = const { Cell::new(0) };
}

/// Runs `call`; returns its result and the operations it did.
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
        note(|done| done.flops += 1);
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

/// Counts a panel of a layer; if its outputs do not follow those of the last panel, a new pass begins.
fn panel<R, const P: usize>(inputs: usize, outputs: &[Counted<R>; P]) {
    let ends = outputs.as_ptr_range();
    let begins = OUTPUTS_END.replace(ends.end as usize) != ends.start as usize;
    note(|done| {
        let kind = match P {
            8 => 0,
            4 => 1,
            _ => 2,
        };
        done.multiply_adds[kind] += (P * inputs) as u64;
        done.panels += 1;
        done.passes += u64::from(begins);
        done.moved += (P + if begins { inputs } else { 0 }) as u64;
    });
}

impl<R: Real> Scalar for Counted<R> {
    type Weight = R::Weight;

    /// Computes component by component, as on a controller.
    const COMPONENTWISE: bool = true;

    fn component(index: usize) {
        OUTPUTS_END.set(0);
        note(|done| {
            done.components += 1;
            done.layers += u64::from(index == 0);
        });
    }
    fn accumulate<W: WeightFormat<Wide = R::Weight>, const P: usize>(
        rows: &[[W; P]],
        x: &[Self],
        sum: &mut [Self; P],
    ) {
        panel(rows.len().min(x.len()), sum);
        for (row, x) in rows.iter().zip(x) {
            for (sum, w) in sum.iter_mut().zip(row) {
                sum.0 += w.scalar::<R>() * x.0;
            }
        }
    }
    fn transposed<W: WeightFormat<Wide = R::Weight>, const P: usize>(
        rows: &[[W; P]],
        y_bar: &[Self; P],
        x_bar: &mut [Self],
    ) {
        panel(rows.len().min(x_bar.len()), y_bar);
        for (x, row) in x_bar.iter_mut().zip(rows) {
            for (y, w) in y_bar.iter().zip(row) {
                x.0 += w.scalar::<R>() * y.0;
            }
        }
    }
    fn weight(w: R::Weight) -> Self {
        Self(R::weight(w))
    }
    fn constant(x: f64) -> Self {
        Self(R::constant(x))
    }
    fn sqrt(self) -> Self {
        note(|done| done.roots += 1);
        Self(self.0.sqrt())
    }
    fn exp(self) -> Self {
        note(|done| done.exponentials += 1);
        Self(self.0.exp())
    }
    fn ln_1p(self) -> Self {
        note(|done| done.logarithms += 1);
        Self(self.0.ln_1p())
    }
    fn tanh(self) -> Self {
        note(|done| done.tangents += 1);
        Self(self.0.tanh())
    }
    fn sin_cos(self) -> (Self, Self) {
        note(|done| done.sines += 1);
        let (sin, cos) = self.0.sin_cos();
        (Self(sin), Self(cos))
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
    fn short_way(self) -> Self {
        Self(self.0.short_way())
    }
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
    fn to_f64(self) -> f64 {
        self.0.to_f64()
    }
}
