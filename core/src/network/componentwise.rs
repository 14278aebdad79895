//! Layers that take their tangents one after the other, for scalars whose loops take plain vectors
//! ([`Scalar::COMPONENTWISE`]): a controller has registers for the sums of one vector, and one copy of the code serves any
//! number of tangents.

use super::{Dense, Jet};
use crate::expected::{expected, first_mut, present};
use crate::scalar::{Scalar, WeightFormat};

/// Jets of which a component is gathered at a time; a multiple of the widest panel.
const GATHERED: usize = 32;

/// Workspace for one component of [`GATHERED`] jets.
type Workspace<S> = [S; GATHERED];

/// Copies component k of at most [`GATHERED`] jets into the workspace: the value for k = 0, else tangent k − 1.
#[inline(never)]
fn gather<'r, S: Scalar, const T: usize>(
    workspace: &'r mut Workspace<S>,
    jets: &[Jet<S, T>],
    k: usize,
) -> &'r [S] {
    match k.checked_sub(1) {
        None => workspace.iter_mut().zip(jets).for_each(|(x, jet)| *x = jet.value),
        Some(k) => workspace.iter_mut().zip(jets).for_each(|(x, jet)| {
            *x = expected(jet.tangent.get(k).copied(), S::zero());
        }),
    }
    expected(workspace.get(..jets.len()), workspace)
}

/// Writes component k of the jets, the inverse of [`gather`].
#[inline(never)]
fn scatter<S: Scalar, const T: usize>(sums: &[S], jets: &mut [Jet<S, T>], k: usize) {
    match k.checked_sub(1) {
        None => jets.iter_mut().zip(sums).for_each(|(jet, x)| jet.value = *x),
        Some(k) => jets.iter_mut().zip(sums).for_each(|(jet, x)| {
            if let Some(slot) = present(jet.tangent.get_mut(k)) {
                *slot = *x;
            }
        }),
    }
}

/// The weights between some of a layer's outputs and some of its inputs, in panels.
struct Panels<'w, W> {
    /// The weights from the first of these outputs on.
    weights: &'w [W],
    /// Number of inputs of the layer.
    inputs: usize,
    /// Number of inputs before these.
    first: usize,
}

impl<'w, W: WeightFormat> Panels<'w, W> {
    /// Takes the next panel, and returns its rows of these inputs.
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

impl<'a, W: WeightFormat> Dense<'a, W> {
    fn part(&self, output: usize, first: usize) -> Panels<'a, W> {
        let weights = expected(self.weights.get(output * self.inputs..), &[]);
        Panels { weights, inputs: self.inputs, first }
    }

    /// Starts the sums of outputs from `output` on: with their biases for the values (k = 0), with 0 for a tangent.
    #[inline(never)]
    fn begin<S: Scalar<Weight = W::Wide>>(&self, k: usize, output: usize, sums: &mut [S]) {
        sums.fill(S::zero());
        if k == 0 {
            let bias = expected(self.bias.get(output..), &[]);
            sums.iter_mut().zip(bias).for_each(|(sum, bias)| *sum = bias.scalar());
        }
    }

    /// Writes y = Wx + b, from x to y; with `ADJOINT` x̄ = Wᵀȳ, from ȳ to x̄.
    pub(super) fn componentwise<S: Scalar<Weight = W::Wide>, const T: usize, const ADJOINT: bool>(
        &self,
        from: &[Jet<S, T>],
        to: &mut [Jet<S, T>],
    ) {
        let (mut numbers, mut sums) = ([S::zero(); GATHERED], [S::zero(); GATHERED]);
        (0..=T).for_each(|k| self.component::<S, T, ADJOINT>(k, from, to, (&mut numbers, &mut sums)));
    }

    /// Component k of it. Rows are numbers of `to`, columns of `from`.
    #[inline(never)]
    fn component<S: Scalar<Weight = W::Wide>, const T: usize, const ADJOINT: bool>(
        &self,
        k: usize,
        from: &[Jet<S, T>],
        to: &mut [Jet<S, T>],
        (numbers, sums): (&mut Workspace<S>, &mut Workspace<S>),
    ) {
        S::component(k);
        let mut row = 0;
        for to in to.chunks_mut(GATHERED) {
            let sums = first_mut(sums, to.len());
            if ADJOINT {
                sums.fill(S::zero());
            } else {
                self.begin(k, row, sums);
            }
            let mut column = 0;
            for from in from.chunks(GATHERED) {
                let numbers = gather(numbers, from, k);
                if ADJOINT {
                    self.part(column, row).adjoint(numbers, sums);
                } else {
                    self.part(row, column).forward(numbers, sums);
                }
                column += GATHERED;
            }
            scatter(sums, to, k);
            row += GATHERED;
        }
    }
}
