//! Derivatives in the weights, for training: the tangent forward, then the adjoint, layer by layer.

use super::{Evaluation, Features, Jets, OutputBar, Outputs, Rigid, held};
use crate::energy::Learnable;
use crate::network::{Dense, Jet, Tape};
use crate::scalar::{Scalar, Stored};

impl<S: Scalar, const N: usize, const H: usize, const L: usize> Learnable<S, N>
    for Rigid<'_, S::Weight, N, H, L>
{
    fn directional_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        (dq, dv): (&[S; N], &[S; N]),
        row: impl FnMut(usize, S),
    ) {
        self.gradient_along(q, dq, |outputs| outputs.lagrangian_bar(&moving(v, dv)), row);
    }

    fn residual_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        a: &[S; N],
        y: &[S; N],
        mut row: impl FnMut(usize, S),
    ) {
        self.gradient_along(q, y, |outputs| outputs.lagrangian_bar(&held(v)), &mut row);
        let rate = |outputs: &Outputs<S, 1, N>| outputs.bilinear_bar(&held(y), &moving(v, a));
        self.gradient_along(q, v, rate, |i, rate| row(i, -rate));
    }
}

impl<const N: usize, const H: usize, const L: usize, W: Stored> Rigid<'_, W, N, H, L> {
    /// Numbers in the weight block.
    pub fn parameters(&self) -> usize {
        self.network.layers().map(Dense::len).sum()
    }

    /// Of what the network's outputs and their tangents along `direction` have the adjoint `bar`.
    fn gradient_along<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        direction: &[S; N],
        bar: impl FnOnce(&Outputs<S, 1, N>) -> OutputBar<S, 1, N>,
        row: impl FnMut(usize, S),
    ) {
        let mut tape = Tape::<S, 1, H, L>::default();
        let Evaluation { features, outputs, .. } = self.forward(q, &[*direction], &mut tape);
        self.weight_gradient(&features, &tape, direction, &bar(&outputs), row);
    }

    fn weight_gradient<S: Scalar<Weight = W::Wide>>(
        &self,
        features: &Features<S, N>,
        tape: &Tape<S, 1, H, L>,
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
