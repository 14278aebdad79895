//! Derivatives in the weights, for training: the tangent forward, then the adjoint, layer by layer.

use super::{Evaluation, Features, Jets, OutputBar, Rigid, held};
use crate::network::{Dense, Jet, Tape};
use crate::scalar::Scalar;

impl<const N: usize, const H: usize, const D: usize, W: Copy> Rigid<'_, W, N, H, D> {
    /// ∂/∂θ of L_q·δq + L_v·δv at (q, v), θ the weight block in its own order; every parameter is visited once, as
    /// `row(position, value)`.
    ///
    /// All discrete losses are sums of such terms (the chain rule through an implicit step only chooses δq and δv).
    pub fn directional_gradient<S: Scalar<Weight = W>>(
        &self,
        at: (&[S; N], &[S; N]),
        along: (&[S; N], &[S; N]),
        row: impl FnMut(usize, S),
    ) {
        let ((q, v), (dq, dv)) = (at, along);
        let mut tape = Tape::<S, 1, H, D>::default();
        let Evaluation { features, outputs, .. } = self.forward(q, &[*dq], &mut tape);
        let bar = outputs.lagrangian_bar(&moving(v, dv));
        self.weight_gradient(&features, &tape, dq, &bar, row);
    }

    /// ∂/∂θ of y·(d/dt L_v) = y·(L_vq v + L_vv a) at (q, v) with acceleration a and constant y, visited as above.
    ///
    /// With [`Rigid::directional_gradient`] along (y, 0) it gives the gradient of the Euler–Lagrange residual
    /// y·(L_q − d/dt L_v), and so of the acceleration.
    pub fn momentum_rate_gradient<S: Scalar<Weight = W>>(
        &self,
        at: (&[S; N], &[S; N]),
        a: &[S; N],
        y: &[S; N],
        row: impl FnMut(usize, S),
    ) {
        let (q, v) = at;
        let mut tape = Tape::<S, 1, H, D>::default();
        let Evaluation { features, outputs, .. } = self.forward(q, &[*v], &mut tape);
        let bar = outputs.bilinear_bar(&held(y), &moving(v, a));
        self.weight_gradient(&features, &tape, v, &bar, row);
    }

    /// Numbers in the weight block.
    pub fn parameters(&self) -> usize {
        self.network.layers().map(Dense::len).sum()
    }

    fn weight_gradient<S: Scalar<Weight = W>>(
        &self,
        features: &Features<S, N>,
        tape: &Tape<S, 1, H, D>,
        direction: &[S; N],
        bar: &OutputBar<S, 1, N>,
        mut row: impl FnMut(usize, S),
    ) {
        let (inputs, count) = features.jets(&[*direction]);
        let inputs = inputs.as_flattened().get(..count).unwrap_or(&[]);
        let bar = bar.as_flattened().as_flattened().get(..self.network.outputs()).unwrap_or(&[]);
        let mut end = self.parameters();
        self.network.layer_adjoints(tape, inputs, bar, |layer, x, y_bar| {
            let start = end - layer.len();
            layer.tangent_gradient(x, y_bar, |i, value| row(start + i, value));
            end = start;
        });
    }
}

/// v moving along δv.
fn moving<S: Scalar, const N: usize>(v: &[S; N], dv: &[S; N]) -> Jets<S, 1, N> {
    core::array::from_fn(|i| Jet { value: v[i], tangent: [dv[i]] })
}
