//! Derivatives in the weights, for training: the tangent forward, then the adjoint, layer by layer.

use super::{Features, OutputJets, Outputs, Rigid, held, no_outputs};
use crate::energy::Learnable;
use crate::energy::placed_network::WeightTangents;
use crate::expected::{first, first_mut};
use crate::network::Jet;
use crate::scalar::{Scalar, WeightFormat};

impl<S: Scalar, const N: usize, const H: usize, const L: usize> Learnable<S, N>
    for Rigid<'_, S::Weight, N, H, L>
{
    fn directional_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        (dq, dv): (&[S; N], &[S; N]),
        row: impl FnMut(usize, S),
    ) {
        self.gradient_along(q, dq, |outputs| outputs.lagrangian_bar(&Jet::moving(v, dv)), row);
    }

    fn residual_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        a: &[S; N],
        y: &[S; N],
        mut row: impl FnMut(usize, S),
    ) {
        self.gradient_along(q, y, |outputs| outputs.lagrangian_bar(&held(v)), &mut row);
        let rate = |outputs: &Outputs<'_, S, 1, N>| outputs.bilinear_bar(&held(y), &Jet::moving(v, a));
        self.gradient_along(q, v, rate, |i, rate| row(i, -rate));
    }
}

impl<const N: usize, const H: usize, const L: usize, W: WeightFormat> Rigid<'_, W, N, H, L> {
    /// Numbers in the weight block.
    pub fn parameters(&self) -> usize {
        self.network.network.len()
    }

    /// Visits the derivatives in the weights where `bar` gives the adjoint of the network's outputs and of their tangents along
    /// `direction`.
    fn gradient_along<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        direction: &[S; N],
        bar: impl FnOnce(&Outputs<'_, S, 1, N>) -> OutputJets<S, 1, N>,
        row: impl FnMut(usize, S),
    ) {
        let (inputs, count) = Features::new(&self.coordinates, q).jets(&[*direction]);
        let mut o = no_outputs::<S, 1, N>();
        let outputs = first_mut(o.as_flattened_mut().as_flattened_mut(), self.inertia.outputs(N));
        let x = first(inputs.as_flattened(), count);
        self.network.pull_back::<S, 1, _, _>((x, &mut []), outputs, &mut WeightTangents(row), |o, _| {
            Adjoint { bar: bar(&Outputs::new(self.inertia, o)), outputs: o.len() }
        });
    }
}

/// The adjoint of the network's outputs.
struct Adjoint<S, const N: usize> {
    bar: OutputJets<S, 1, N>,
    outputs: usize,
}

impl<S, const N: usize> AsRef<[Jet<S, 1>]> for Adjoint<S, N> {
    fn as_ref(&self) -> &[Jet<S, 1>] {
        first(self.bar.as_flattened().as_flattened(), self.outputs)
    }
}
