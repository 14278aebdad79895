//! Products of a layer's weights with vectors that carry tangents.
//!
//! A controller takes one component at a time ([`Scalar::COMPONENTWISE`]): its registers hold the sums of one vector, and one copy of the
//! code serves any number of tangents. Elsewhere, values and tangents share each weight that is read.

use super::units::{Panel, Sink, Source};
use super::{Dense, Jet};
use crate::expected::expected;
use crate::scalar::{Scalar, WeightFormat};

impl<'a, W: WeightFormat> Dense<'a, W> {
    /// y = Wx + b and ẏ_k = Wẋ_k; `y` has one place per output of the layer.
    #[inline(always)]
    pub(super) fn forward_into<S, const T: usize>(
        &self,
        x: &(impl Source<S, T> + ?Sized),
        y: &mut (impl Sink<S, T> + ?Sized),
    ) where
        S: Scalar<Weight = W::Wide>,
    {
        if S::COMPONENTWISE {
            return self.by_components::<S, T, false>(x, y);
        }
        y.reserve(self.outputs());
        let mut rest = Rest { inputs: self.inputs, weights: self.weights, bias: self.bias, output: 0 };
        rest.panels::<S, T, 8>(x, y);
        rest.panels::<S, T, 4>(x, y);
        rest.panels::<S, T, 1>(x, y);
    }

    /// x̄ = Wᵀȳ, for the value and every tangent of the adjoint; `x_bar` has one place per input of the layer.
    #[inline(always)]
    pub(super) fn adjoint_into<S, const T: usize>(
        &self,
        y_bar: &(impl Source<S, T> + ?Sized),
        x_bar: &mut (impl Sink<S, T> + ?Sized),
    ) where
        S: Scalar<Weight = W::Wide>,
    {
        self.by_components::<S, T, true>(y_bar, x_bar);
    }

    /// Writes y = Wx + b, from x to y, one component at a time; with `ADJOINT`, x̄ = Wᵀȳ, from ȳ to x̄.
    #[inline(always)]
    fn by_components<S: Scalar<Weight = W::Wide>, const T: usize, const ADJOINT: bool>(
        &self,
        from: &(impl Source<S, T> + ?Sized),
        to: &mut (impl Sink<S, T> + ?Sized),
    ) {
        (0..=T).for_each(|k| self.component::<S, T, ADJOINT>(k, from, to));
    }

    /// Component k of the product. Rows are indices of `to`, columns of `from`.
    #[inline(never)]
    fn component<S: Scalar<Weight = W::Wide>, const T: usize, const ADJOINT: bool>(
        &self,
        k: usize,
        from: &(impl Source<S, T> + ?Sized),
        to: &mut (impl Sink<S, T> + ?Sized),
    ) {
        S::component(k);
        let rows = if ADJOINT { self.inputs } else { self.outputs() };
        to.parts(k, rows, |row, sums| {
            if !ADJOINT && k == 0 {
                let bias = expected(self.bias.get(row..), &[]);
                sums.iter_mut().zip(bias).for_each(|(sum, bias)| *sum = bias.scalar());
            }
            from.parts(k, |column, numbers| {
                if ADJOINT {
                    self.part(column, row).adjoint(numbers, sums);
                } else {
                    self.part(row, column).forward(numbers, sums);
                }
            });
        });
    }

    fn part(&self, output: usize, input: usize) -> Part<'a, W> {
        let weights = expected(self.weights.get(output * self.inputs..), &[]);
        Part { weights, inputs: self.inputs, first: input }
    }
}

/// The weights between some of a layer's outputs and some of its inputs.
struct Part<'w, W> {
    /// The weights, starting with the first of these outputs.
    weights: &'w [W],
    /// Number of inputs of the layer.
    inputs: usize,
    /// Number of the layer's inputs before these.
    first: usize,
}

impl<'w, W: WeightFormat> Part<'w, W> {
    /// Takes the next panel, and returns its rows for these inputs.
    fn rows<const P: usize>(&mut self, count: usize) -> &'w [[W; P]] {
        let (panel, rest) = expected(self.weights.split_at_checked(self.inputs * P), (&[], &[]));
        self.weights = rest;
        expected(panel.as_chunks().0.get(self.first..self.first + count), &[])
    }

    /// y += Wx.
    #[inline(never)]
    fn forward<S: Scalar<Weight = W::Wide>>(mut self, x: &[S], y: &mut [S]) {
        let (eights, rest) = y.as_chunks_mut::<8>();
        let (fours, ones) = rest.as_chunks_mut::<4>();
        eights.iter_mut().for_each(|y| S::accumulate(self.rows::<8>(x.len()), x, y));
        fours.iter_mut().for_each(|y| S::accumulate(self.rows::<4>(x.len()), x, y));
        ones.as_chunks_mut::<1>().0.iter_mut().for_each(|y| S::accumulate(self.rows::<1>(x.len()), x, y));
    }

    /// x̄ += Wᵀȳ.
    #[inline(never)]
    fn adjoint<S: Scalar<Weight = W::Wide>>(mut self, y_bar: &[S], x_bar: &mut [S]) {
        let (eights, rest) = y_bar.as_chunks::<8>();
        let (fours, ones) = rest.as_chunks::<4>();
        eights.iter().for_each(|y| S::transposed(self.rows::<8>(x_bar.len()), y, x_bar));
        fours.iter().for_each(|y| S::transposed(self.rows::<4>(x_bar.len()), y, x_bar));
        ones.as_chunks::<1>().0.iter().for_each(|y| S::transposed(self.rows::<1>(x_bar.len()), y, x_bar));
    }
}

/// Weights and biases of the outputs still to be evaluated, and the number of outputs already evaluated.
struct Rest<'w, W> {
    inputs: usize,
    weights: &'w [W],
    bias: &'w [W],
    output: usize,
}

impl<'w, W: WeightFormat> Rest<'w, W> {
    /// Evaluates all full panels of P outputs.
    #[inline(always)]
    fn panels<S: Scalar<Weight = W::Wide>, const T: usize, const P: usize>(
        &mut self,
        x: &(impl Source<S, T> + ?Sized),
        y: &mut (impl Sink<S, T> + ?Sized),
    ) {
        while let Some((bias, rest)) = self.bias.split_first_chunk::<P>() {
            let (rows, weights) = expected(self.weights.split_at_checked(P * self.inputs), (&[], &[]));
            y.put(self.output, &panel(rows.as_chunks().0, bias, x));
            *self = Self { weights, bias: rest, output: self.output + P, ..*self };
        }
    }
}

/// Evaluates one panel. This is a separate function, so that the sums stay in vector registers and are interleaved only
/// after the last addition.
#[inline(never)]
fn panel<W: WeightFormat, S: Scalar<Weight = W::Wide>, const T: usize, const P: usize>(
    rows: &[[W; P]],
    bias: &[W; P],
    x: &(impl Source<S, T> + ?Sized),
) -> Panel<S, T, P> {
    let mut value = bias.map(W::scalar);
    let mut tangent = [[S::zero(); P]; T];
    for (Jet { value: x, tangent: x_rates }, row) in x.each().zip(rows) {
        let row = row.map(W::scalar);
        accumulate(&mut value, &row, x);
        for (sum, x) in tangent.iter_mut().zip(x_rates) {
            accumulate(sum, &row, x);
        }
    }
    Panel { value, tangent }
}

#[inline(always)]
fn accumulate<S: Scalar, const P: usize>(sum: &mut [S; P], row: &[S; P], x: S) {
    for (sum, w) in sum.iter_mut().zip(row) {
        *sum += *w * x;
    }
}
