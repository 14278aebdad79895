//! L(q, v) = N(s(q), v) with its derivatives, by tangents and adjoints of the network.

use crate::baselines::features::{adjoint, count, inputs};
use crate::baselines::network_lagrangian::ScalarNetwork;
use leastaction_core::network::{Activation, Jet, Mlp, SecondOrderTape, Tape};
use leastaction_core::scalar::Scalar;

/// Hidden layers, as Cranmer et al. have them.
pub(super) const DEPTH: usize = 2;

/// One softplus network with hidden layers of at most H units.
#[derive(Clone, Copy, Debug)]
pub struct LnnNetwork<'w, const H: usize> {
    coordinates: &'w str,
    network: Mlp<'w, f64, H, DEPTH>,
}

impl<'w, const H: usize> LnnNetwork<'w, H> {
    /// Over the front of `weights`; `coordinates` has a letter each, `a` for angles. `None` where hidden layers are wider than H,
    /// or the block is too short.
    pub fn new(coordinates: &'w str, width: usize, mut weights: &'w [f64]) -> Option<Self> {
        let inputs = count(coordinates);
        let network = Mlp::take(&mut weights, inputs, &[width; DEPTH], 1, Activation::Softplus)?;
        (width <= H).then_some(Self { coordinates, network })
    }
}

impl<const H: usize> ScalarNetwork for LnnNetwork<'_, H> {
    fn differentiate<S: Scalar<Weight = f64>, const T: usize>(&self, x: &[Jet<S, T>]) -> (S, Vec<Jet<S, T>>) {
        let x = inputs(self.coordinates, x);
        let (mut l, mut x_bar) = ([Jet::zero()], vec![Jet::zero(); x.len()]);
        let mut tape = Tape::<S, T, H, DEPTH>::default();
        self.network.forward(&x, &mut tape, &mut l);
        self.network.adjoint(&tape, &[Jet::constant(S::one())], &mut x_bar);
        (l[0].value, adjoint(self.coordinates, &x, &x_bar))
    }

    /// Velocities are inputs as they are, so that only the network bends.
    fn bend<S: Scalar<Weight = f64>, const T: usize>(&self, x: &[Jet<S, T>]) -> [[S; T]; T] {
        let x = inputs(self.coordinates, x);
        let (mut l, mut x_bar) = ([Jet::zero()], vec![Jet::zero(); x.len()]);
        let mut bends = SecondOrderTape::<S, T, H, DEPTH>::default();
        self.network.forward_second_order(&x, &mut bends, &mut l);
        self.network.second_order(&bends, &[Jet::constant(S::one())], &mut x_bar)
    }

    fn slope_gradient<S: Scalar<Weight = f64>>(&self, x: &[Jet<S, 1>], mut row: impl FnMut(usize, S)) {
        let x = inputs(self.coordinates, x);
        let mut tape = Tape::<S, 1, H, DEPTH>::default();
        self.network.forward(&x, &mut tape, &mut [Jet::zero()]);
        let mut start = self.network.len();
        self.network.layer_adjoints(&tape, &x, &[Jet::<S, 1>::constant(S::one())], |layer, x, bar| {
            start -= layer.len();
            layer.tangent_gradient(x, bar, |i, value| row(start + i, value));
        });
    }
}

#[cfg(test)]
#[path = "lagrangian_tests.rs"]
mod tests;
