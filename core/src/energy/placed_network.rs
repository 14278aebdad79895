//! Networks with their places in the weight block of a model, and the energies that they give.

use super::NetworkShape;
use crate::network::{Dense, Jet, Mlp, Tape, Vectors};
use crate::scalar::{Scalar, WeightFormat};
use heapless::Vec;

/// A network with the place of its first number in the weight block.
#[derive(Clone, Copy, Debug)]
pub struct PlacedNetwork<'a, W, const H: usize, const L: usize> {
    /// The network.
    pub network: Mlp<'a, W, H, L>,
    /// Its first number in the weight block.
    pub start: usize,
}

/// Visitor of the layers in an adjoint pass, last to first: gets the place of the layer in the weight block, the layer, its
/// inputs, and the adjoint of its outputs.
pub(super) trait Visit<W, S, const T: usize> {
    fn layer<const H: usize>(
        &mut self,
        start: usize,
        layer: &Dense<W>,
        x: Vectors<S, T, H>,
        y_bar: Vectors<S, T, H>,
    );
}

/// Visitor that leaves the derivatives in the weights out.
pub(super) struct Ignore;

impl<W, S, const T: usize> Visit<W, S, T> for Ignore {
    #[inline(always)]
    fn layer<const H: usize>(&mut self, _: usize, _: &Dense<W>, _: Vectors<S, T, H>, _: Vectors<S, T, H>) {}
}

/// Visitor that gives its closure, for every weight, the position and the derivative in it of ȳ·y's tangent.
pub(super) struct WeightTangents<R>(pub R);

impl<W: WeightFormat, S: Scalar<Weight = W::Wide>, R: FnMut(usize, S)> Visit<W, S, 1> for WeightTangents<R> {
    fn layer<const H: usize>(
        &mut self,
        start: usize,
        layer: &Dense<W>,
        x: Vectors<S, 1, H>,
        y_bar: Vectors<S, 1, H>,
    ) {
        let (mut x_jets, mut y_jets) = (Vec::new(), Vec::new());
        let (x, y_bar) = (x.jets(&mut x_jets), y_bar.jets(&mut y_jets));
        layer.tangent_gradient(x, y_bar, |i, value| (self.0)(start + i, value));
    }
}

impl<'a, W: WeightFormat, const H: usize, const L: usize> PlacedNetwork<'a, W, H, L> {
    /// Takes a network of this shape from the front of `block`, `start` numbers of which were taken before, and counts `start` on.
    /// `None` where the block is too short, or the network has more than `L` hidden layers or `H` units in one.
    pub(super) fn take(block: &mut &'a [W], start: &mut usize, shape: &NetworkShape) -> Option<Self> {
        shape.check_size::<H, L>().ok()?;
        let network: Mlp<'a, W, H, L> = shape.take(block)?;
        let placed = Self { network, start: *start };
        *start += network.len();
        Some(placed)
    }

    /// U(x) alone, of a network with one output.
    pub(super) fn energy<S: Scalar<Weight = W::Wide>>(&self, x: &[Jet<S, 0>]) -> S {
        let mut y = [Jet::zero(); 1];
        self.network.evaluate::<S, 0>(x, &mut y);
        y[0].value
    }

    /// U(x) with its tangents, and `weight` times its gradient with the gradient's tangents, of a network with one output.
    pub(super) fn differentiate<S: Scalar<Weight = W::Wide>, const T: usize, const I: usize>(
        &self,
        x: &[Jet<S, T>; I],
        weight: S,
        visit: &mut impl Visit<W, S, T>,
    ) -> (Jet<S, T>, [Jet<S, T>; I]) {
        let (mut y, mut x_bar) = ([Jet::zero(); 1], [Jet::zero(); I]);
        self.pull_back::<S, T, _, _>((x, &mut x_bar), &mut y, visit, |_, _| [Jet::constant(weight)]);
        (y[0], x_bar)
    }

    /// y(x) and x̄ = (∂y/∂x)ᵀȳ with their tangents, where ȳ = `bar(y, visit)`; `x_bar` may be empty.
    pub(super) fn pull_back<S, const T: usize, V, B>(
        &self,
        (x, x_bar): (&[Jet<S, T>], &mut [Jet<S, T>]),
        y: &mut [Jet<S, T>],
        visit: &mut V,
        bar: impl FnOnce(&[Jet<S, T>], &mut V) -> B,
    ) where
        S: Scalar<Weight = W::Wide>,
        V: Visit<W, S, T>,
        B: AsRef<[Jet<S, T>]>,
    {
        let mut tape = Tape::<S, T, H, L>::default();
        self.network.forward(x, &mut tape, y);
        let y_bar = bar(y, visit);
        self.descend(&tape, (x, x_bar), y_bar.as_ref(), visit);
    }

    /// [`PlacedNetwork::pull_back`] by an adjoint pass that is compiled once for all its callers: less code where a program has
    /// several.
    #[inline(always)]
    pub(super) fn pull_back_apart<S, const T: usize, V, B>(
        &self,
        (x, x_bar): (&[Jet<S, T>], &mut [Jet<S, T>]),
        y: &mut [Jet<S, T>],
        visit: &mut V,
        bar: impl FnOnce(&[Jet<S, T>], &mut V) -> B,
    ) where
        S: Scalar<Weight = W::Wide>,
        V: Visit<W, S, T>,
        B: AsRef<[Jet<S, T>]>,
    {
        let mut tape = Tape::<S, T, H, L>::default();
        self.network.forward(x, &mut tape, y);
        let y_bar = bar(y, visit);
        self.descend_apart(&tape, (x, x_bar), y_bar.as_ref(), visit);
    }

    #[inline(never)]
    fn descend_apart<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        tape: &Tape<S, T, H, L>,
        (x, x_bar): (&[Jet<S, T>], &mut [Jet<S, T>]),
        y_bar: &[Jet<S, T>],
        visit: &mut impl Visit<W, S, T>,
    ) {
        self.descend(tape, (x, x_bar), y_bar, visit);
    }

    /// x̄ = (∂y/∂x)ᵀȳ with its tangents, from what the forward pass left.
    #[inline]
    fn descend<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        tape: &Tape<S, T, H, L>,
        (x, x_bar): (&[Jet<S, T>], &mut [Jet<S, T>]),
        y_bar: &[Jet<S, T>],
        visit: &mut impl Visit<W, S, T>,
    ) {
        let mut end = self.start + self.network.len();
        self.network.adjoint_with_layers(tape, (x, x_bar), y_bar, |layer, x, y_bar| {
            end -= layer.len();
            visit.layer(end, layer, x, y_bar);
        });
    }

    /// Visits the derivatives in the weights of Σ_k ȳ⁽ᵏ⁾y⁽ᵏ⁾, k = 0 … 2, along a curve of inputs; `x_bar` gets the adjoint
    /// of its inputs, or is empty.
    pub(super) fn series_gradient<S: Scalar<Weight = W::Wide>>(
        &self,
        (x, x_bar): (&[Jet<S, 2>], &mut [Jet<S, 2>]),
        y_bar: &[Jet<S, 2>],
        row: &mut impl FnMut(usize, S),
    ) {
        let mut end = self.start + self.network.len();
        self.network.series_adjoints::<S>(x, y_bar, |layer, x, bar| {
            end -= layer.len();
            let (mut x_jets, mut y_jets) = (Vec::new(), Vec::new());
            let (x, bar) = (x.jets(&mut x_jets), bar.jets(&mut y_jets));
            layer.series_gradient(x, bar, |i, value| row(end + i, value));
            if end == self.start {
                layer.adjoint(bar, x_bar);
            }
        });
    }
}
