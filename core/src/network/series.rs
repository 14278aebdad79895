//! A network along a curve of inputs: derivatives in the curve's parameter up to the third, and their derivatives in the
//! weights.
//!
//! A [`Jet`] with K tangents here holds y, dy/dt, … dᴷy/dtᴷ, K ≤ 3, instead of derivatives along K directions: layers are
//! linear and treat both alike, only the activations differ (Faà di Bruno's formula).

use super::units::Units;
use super::{Activation, Curve, Dense, Jet, Mlp, Vectors};
use crate::scalar::{Scalar, WeightFormat};
use heapless::Vec;

impl<'a, W: WeightFormat, const H: usize, const L: usize> Mlp<'a, W, H, L> {
    /// y and its first K derivatives along the curve whose inputs and derivatives are `x`.
    pub fn series<S: Scalar<Weight = W::Wide>, const K: usize>(&self, x: &[Jet<S, K>], y: &mut [Jet<S, K>]) {
        self.evaluate_with(x, y, |units| {
            units.map(|unit| self.activation().series(&unit, &self.activation().curve(unit.value)));
        });
    }

    /// Calls `visit(layer, inputs, adjoint of its outputs)` for every layer, last to first, where `y_bar` is the adjoint of
    /// y and its first two derivatives: the derivative in a weight is Σ_k z̄⁽ᵏ⁾x⁽ᵏ⁾, see [`Dense::series_gradient`].
    pub fn series_adjoints<S: Scalar<Weight = W::Wide>>(
        &self,
        x: &[Jet<S, 2>],
        y_bar: &[Jet<S, 2>],
        mut visit: impl FnMut(&Dense<'a, W>, Vectors<S, 2, H>, Vectors<S, 2, H>),
    ) {
        let mut tape = CurveTape::<S, H, L>::new();
        self.forward_along(x, &mut tape);
        let (mut bar, mut other) = (Units::<S, 2, H>::new(), Units::new());
        let (mut bar, mut other) = (&mut bar, &mut other);
        let (mut layer, mut above) = (self.output(), Vectors::Jets(y_bar));
        let records = tape.slopes.iter().zip(&tape.units).take(self.depth());
        for (below, (slopes, units)) in self.hidden().rev().zip(records.rev()) {
            visit(layer, Vectors::Units(units), above);
            layer.adjoint_from(above, other);
            let mut slopes = slopes.iter();
            other.map(|a| slopes.next().map_or(a, |slope| slope.adjoint(&a)));
            core::mem::swap(&mut bar, &mut other);
            (layer, above) = (below, Vectors::Units(bar));
        }
        visit(layer, Vectors::Jets(x), above);
    }

    /// Evaluates the hidden layers along a curve and records what their adjoint needs.
    fn forward_along<S: Scalar<Weight = W::Wide>>(&self, x: &[Jet<S, 2>], tape: &mut CurveTape<S, H, L>) {
        let mut below = Vectors::Jets(x);
        for ((layer, slopes), units) in self.hidden().zip(&mut tape.slopes).zip(&mut tape.units) {
            layer.forward_from(below, units);
            slopes.clear();
            units.map(|unit| {
                let c = self.activation().curve(unit.value);
                let third = self.activation().third(unit.value, &c);
                let pushed = slopes.push(UnitSlopes { z: unit.tangent, curve: c, third });
                debug_assert!(pushed.is_ok(), "more than {H} units");
                self.activation().series(&unit, &c)
            });
            below = Vectors::Units(units);
        }
    }
}

/// Units σ(z) of every hidden layer along a curve, with the derivatives of σ at each.
struct CurveTape<S, const H: usize, const L: usize> {
    units: [Units<S, 2, H>; L],
    slopes: [Vec<UnitSlopes<S>, H>; L],
}

impl<S: Scalar, const H: usize, const L: usize> CurveTape<S, H, L> {
    fn new() -> Self {
        Self { units: core::array::from_fn(|_| Units::new()), slopes: core::array::from_fn(|_| Vec::new()) }
    }
}

/// The derivatives of σ at z(t), and of z at t.
#[derive(Clone, Copy)]
struct UnitSlopes<S> {
    /// z′ and z″.
    z: [S; 2],
    curve: Curve<S>,
    /// σ‴.
    third: S,
}

impl<S: Scalar> UnitSlopes<S> {
    /// The adjoint of z and its two derivatives from that of σ(z) and its two.
    #[inline(always)]
    fn adjoint(&self, bar: &Jet<S, 2>) -> Jet<S, 2> {
        let Self { z: [z1, z2], curve: c, third } = self;
        let [bar1, bar2] = bar.tangent;
        // d/dt and d²/dt² of σ′(z(t)).
        let first = c.curvature * *z1;
        let second = *third * *z1 * *z1 + c.curvature * *z2;
        Jet {
            value: c.slope * bar.value + first * bar1 + second * bar2,
            tangent: [c.slope * bar1 + (first + first) * bar2, c.slope * bar2],
        }
    }
}

impl Activation {
    /// σ(z(t)) and its first K ≤ 3 derivatives in t, `c` the curve of σ at z.
    #[inline(always)]
    fn series<S: Scalar, const K: usize>(self, z: &Jet<S, K>, c: &Curve<S>) -> Jet<S, K> {
        let [z1, z2, z3] = derivatives(z);
        let mut y = [c.slope * z1, S::zero(), S::zero()];
        if K > 1 {
            y[1] = c.curvature * z1 * z1 + c.slope * z2;
        }
        if K > 2 {
            let mixed = S::constant(3.0) * c.curvature * z1 * z2;
            y[2] = self.third(z.value, c) * z1 * z1 * z1 + mixed + c.slope * z3;
        }
        Jet::series(c.value, y)
    }
}

/// The three derivatives, 0 for those that are not carried.
#[inline(always)]
fn derivatives<S: Scalar, const K: usize>(z: &Jet<S, K>) -> [S; 3] {
    let mut derivatives = [S::zero(); 3];
    for (slot, z) in derivatives.iter_mut().zip(&z.tangent) {
        *slot = *z;
    }
    derivatives
}
