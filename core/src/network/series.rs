//! A network along a curve of inputs: derivatives in the curve's parameter up to the third.
//!
//! With K tangents, a [`Jet`] here holds y, dy/dt, … dᴷy/dtᴷ, K ≤ 3, instead of derivatives along K directions. Layers are linear and treat
//! both alike; only the activations differ (Faà di Bruno's formula).

use super::{Activation, Curve, Jet, Mlp};
use crate::scalar::{Scalar, WeightFormat};

impl<W: WeightFormat, const H: usize, const L: usize> Mlp<'_, W, H, L> {
    /// y with its first K derivatives along the curve of the inputs `x`.
    pub fn series<S: Scalar<Weight = W::Wide>, const K: usize>(&self, x: &[Jet<S, K>], y: &mut [Jet<S, K>]) {
        self.evaluate_with(x, y, |units| {
            units.map(|unit| self.activation().series(&unit, &self.activation().curve(unit.value)));
        });
    }
}

impl Activation {
    /// σ(z(t)) with its first K ≤ 3 derivatives in t; `c` is the curve of σ at z.
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

/// The first three derivatives; 0 for any that is not carried.
#[inline(always)]
fn derivatives<S: Scalar, const K: usize>(z: &Jet<S, K>) -> [S; 3] {
    let mut derivatives = [S::zero(); 3];
    for (slot, z) in derivatives.iter_mut().zip(&z.tangent) {
        *slot = *z;
    }
    derivatives
}
