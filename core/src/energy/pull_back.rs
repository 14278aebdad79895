//! Energies of a network with one output, and adjoints of its inputs.

use crate::network::{Jet, Mlp, Tape};
use crate::scalar::{Scalar, WeightFormat};

impl<W: WeightFormat, const H: usize, const L: usize> Mlp<'_, W, H, L> {
    /// Energy U(x) of a network with one output.
    pub(super) fn energy<S: Scalar<Weight = W::Wide>>(&self, x: &[Jet<S, 0>]) -> S {
        let mut y = [Jet::zero(); 1];
        self.evaluate::<S, 0>(x, &mut y);
        y[0].value
    }

    /// `weight` times the gradient of U, with tangents, for a network with one output.
    pub(super) fn gradient<S: Scalar<Weight = W::Wide>, const T: usize, const I: usize>(
        &self,
        x: &[Jet<S, T>; I],
        weight: S,
    ) -> [Jet<S, T>; I] {
        let (mut y, mut x_bar) = ([Jet::zero(); 1], [Jet::zero(); I]);
        self.pull_back(x, &mut x_bar, &mut y, |_| [Jet::constant(weight)]);
        x_bar
    }

    /// y(x) and x̄ = (∂y/∂x)ᵀȳ with their tangents, where ȳ = `bar(y)`.
    pub(super) fn pull_back<S: Scalar<Weight = W::Wide>, const T: usize, B: AsRef<[Jet<S, T>]>>(
        &self,
        x: &[Jet<S, T>],
        x_bar: &mut [Jet<S, T>],
        y: &mut [Jet<S, T>],
        bar: impl FnOnce(&[Jet<S, T>]) -> B,
    ) {
        let mut tape = Tape::<S, T, H, L>::default();
        self.forward(x, &mut tape, y);
        self.adjoint(&tape, bar(y).as_ref(), x_bar);
    }

    /// [`Mlp::pull_back`] with an adjoint pass that is compiled once for all callers: a program with several callers
    /// is smaller.
    #[inline(always)]
    pub(super) fn pull_back_apart<S: Scalar<Weight = W::Wide>, const T: usize, B: AsRef<[Jet<S, T>]>>(
        &self,
        x: &[Jet<S, T>],
        x_bar: &mut [Jet<S, T>],
        y: &mut [Jet<S, T>],
        bar: impl FnOnce(&[Jet<S, T>]) -> B,
    ) {
        let mut tape = Tape::<S, T, H, L>::default();
        self.forward(x, &mut tape, y);
        self.adjoint_apart(&tape, bar(y).as_ref(), x_bar);
    }

    #[inline(never)]
    fn adjoint_apart<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        tape: &Tape<S, T, H, L>,
        y_bar: &[Jet<S, T>],
        x_bar: &mut [Jet<S, T>],
    ) {
        self.adjoint(tape, y_bar, x_bar);
    }
}
