//! A network along a curve of inputs: derivatives in the curve's parameter up to the third, and their derivatives in the
//! weights.
//!
//! A [`Jet`] with K tangents here holds y, dy/dt, … dᴷy/dtᴷ, K ≤ 3, instead of derivatives along K directions: layers are
//! linear and treat both alike, only the activations differ (Faà di Bruno's formula).

use super::{Activation, Dense, Jet, Mlp};
use crate::scalar::Scalar;

impl<'a, W: Copy, const D: usize> Mlp<'a, W, D> {
    /// y and its first K derivatives along the curve whose inputs and derivatives are `x`.
    pub fn series<S: Scalar<Weight = W>, const K: usize, const H: usize>(
        &self,
        x: &[Jet<S, K>],
        y: &mut [Jet<S, K>],
    ) {
        self.series_on(x, &mut Record::<S, K, H, D>::new(), y);
    }

    fn series_on<S: Scalar<Weight = W>, const K: usize, const H: usize>(
        &self,
        x: &[Jet<S, K>],
        record: &mut Record<S, K, H, D>,
        y: &mut [Jet<S, K>],
    ) {
        let mut input = x;
        let layers = self.hidden().zip(&mut record.sums).zip(&mut record.units);
        for ((layer, sums), units) in layers {
            let sums = sums.get_mut(..layer.outputs()).unwrap_or_default();
            layer.forward(input, sums);
            for (unit, z) in units.iter_mut().zip(&*sums) {
                *unit = self.activation().series(z);
            }
            input = units.get(..layer.outputs()).unwrap_or_default();
        }
        self.output().forward(input, y);
    }

    /// Calls `visit(layer, inputs, adjoint of its outputs)` for every layer, last to first, where `y_bar` is the adjoint of
    /// y and its first two derivatives: the derivative in a weight is Σ_k z̄⁽ᵏ⁾x⁽ᵏ⁾, see [`Dense::series_gradient`].
    pub fn series_adjoints<S: Scalar<Weight = W>, const H: usize>(
        &self,
        x: &[Jet<S, 2>],
        y_bar: &[Jet<S, 2>],
        mut visit: impl FnMut(&Dense<'a, W>, &[Jet<S, 2>], &[Jet<S, 2>]),
    ) {
        let mut record = Record::<S, 2, H, D>::new();
        self.series_on(x, &mut record, &mut []);
        let (mut unit_bar, mut sum_bar) = ([Jet::zero(); H], [Jet::zero(); H]);
        let (mut layer, mut bar) = (self.output(), y_bar);
        let records = record.sums.iter().zip(&record.units).take(self.depth());
        for (below, (sums, units)) in self.hidden().rev().zip(records.rev()) {
            visit(layer, units.get(..layer.inputs()).unwrap_or_default(), bar);
            let unit_bar = unit_bar.get_mut(..layer.inputs()).unwrap_or_default();
            layer.adjoint(bar, unit_bar);
            let slots = sum_bar.get_mut(..layer.inputs()).unwrap_or_default();
            for ((slot, z), a) in slots.iter_mut().zip(sums).zip(unit_bar) {
                *slot = self.activation().series_adjoint(z, a);
            }
            (layer, bar) = (below, slots);
        }
        visit(layer, x, bar);
    }
}

/// Sums z and units σ(z) of every hidden layer.
struct Record<S, const K: usize, const H: usize, const D: usize> {
    sums: [[Jet<S, K>; H]; D],
    units: [[Jet<S, K>; H]; D],
}

impl<S: Scalar, const K: usize, const H: usize, const D: usize> Record<S, K, H, D> {
    fn new() -> Self {
        Self { sums: [[Jet::zero(); H]; D], units: [[Jet::zero(); H]; D] }
    }
}

impl Activation {
    /// σ(z(t)) and its first K ≤ 3 derivatives in t.
    #[inline(always)]
    pub fn series<S: Scalar, const K: usize>(self, z: &Jet<S, K>) -> Jet<S, K> {
        let [z1, z2, z3] = derivatives(z);
        let c = self.curve(z.value);
        let mut y = [c.slope * z1, S::zero(), S::zero()];
        if K > 1 {
            y[1] = c.curvature * z1 * z1 + c.slope * z2;
        }
        if K > 2 {
            let mixed = S::constant(3.0) * c.curvature * z1 * z2;
            y[2] = self.third(z.value, &c) * z1 * z1 * z1 + mixed + c.slope * z3;
        }
        let mut series = Jet::constant(c.value);
        for (slot, y) in series.tangent.iter_mut().zip(y) {
            *slot = y;
        }
        series
    }

    /// The adjoint of z and its two derivatives from that of σ(z) and its two.
    #[inline(always)]
    fn series_adjoint<S: Scalar>(self, z: &Jet<S, 2>, bar: &Jet<S, 2>) -> Jet<S, 2> {
        let ([z1, z2], [bar1, bar2]) = (z.tangent, bar.tangent);
        let c = self.curve(z.value);
        let third = self.third(z.value, &c);
        let bent = c.curvature * z1;
        Jet {
            value: c.slope * bar.value + bent * bar1 + (third * z1 * z1 + c.curvature * z2) * bar2,
            tangent: [c.slope * bar1 + (bent + bent) * bar2, c.slope * bar2],
        }
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
