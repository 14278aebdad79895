//! Layers with their tangents one after the other, for scalars whose loops take plain vectors ([`Scalar::APART`]): a
//! controller has registers for the sums of one vector, and one copy of each loop serves any number of tangents.

use super::{Dense, Jet};
use crate::scalar::{Scalar, Stored};

/// Inputs gathered at a time.
const GATHERED: usize = 32;

/// What passes: the value (0), or tangent k − 1.
fn component<S: Scalar, const T: usize>(jet: &Jet<S, T>, k: usize) -> S {
    k.checked_sub(1).map_or(jet.value, |k| jet.tangent.get(k).copied().unwrap_or(S::zero()))
}

fn set<S, const T: usize>(jet: &mut Jet<S, T>, k: usize, to: S) {
    let slot = match k.checked_sub(1) {
        None => Some(&mut jet.value),
        Some(k) => jet.tangent.get_mut(k),
    };
    if let Some(slot) = slot {
        *slot = to;
    }
}

/// Component k of up to P jets; zero where there are fewer.
fn gathered<S: Scalar, const T: usize, const P: usize>(jets: &[Jet<S, T>], k: usize) -> [S; P] {
    let mut x = [S::zero(); P];
    x.iter_mut().zip(jets).for_each(|(x, jet)| *x = component(jet, k));
    x
}

fn scatter<S: Scalar, const T: usize>(x: &[S], jets: &mut [Jet<S, T>], k: usize) {
    jets.iter_mut().zip(x).for_each(|(jet, x)| set(jet, k, *x));
}

/// Panels of a layer that are still to come, and the inputs that are at hand.
struct Panels<'w, 'x, W, S> {
    weights: &'w [W],
    bias: &'w [W],
    /// Of the layer.
    inputs: usize,
    /// Before those at hand.
    first: usize,
    x: &'x [S],
}

impl<'w, W: Stored, S: Scalar<Weight = W::Wide>> Panels<'w, '_, W, S> {
    /// The rows of the next panel that belong to the inputs at hand.
    fn rows<const P: usize>(&mut self, count: usize) -> &'w [[W; P]] {
        let (panel, rest) = self.weights.split_at_checked(self.inputs * P).unwrap_or((&[], &[]));
        self.weights = rest;
        panel.as_chunks().0.get(self.first..self.first + count).unwrap_or(&[])
    }

    /// Adds the inputs' share of component k to all full panels of P outputs, and leaves the other outputs.
    fn forward<'y, const T: usize, const P: usize>(
        &mut self,
        y: &'y mut [Jet<S, T>],
        k: usize,
    ) -> &'y mut [Jet<S, T>] {
        let (panels, rest) = y.as_chunks_mut::<P>();
        for y in panels {
            let (bias, others) = self.bias.split_at_checked(P).unwrap_or((&[], &[]));
            self.bias = others;
            let mut sum = [S::zero(); P];
            if self.first > 0 {
                sum = gathered(y, k);
            } else if k == 0 {
                sum.iter_mut().zip(bias).for_each(|(sum, bias)| *sum = bias.scalar());
            }
            S::accumulate(self.rows(self.x.len()), self.x, &mut sum);
            scatter(&sum, y, k);
        }
        rest
    }

    /// Adds what all full panels of P outputs give to the inputs at hand, and leaves the other outputs.
    fn adjoint<'y, const T: usize, const P: usize>(
        &mut self,
        y_bar: &'y [Jet<S, T>],
        x_bar: &mut [S],
        k: usize,
    ) -> &'y [Jet<S, T>] {
        let (panels, rest) = y_bar.as_chunks::<P>();
        for y_bar in panels {
            S::transposed::<W, P>(self.rows(x_bar.len()), &gathered(y_bar, k), x_bar);
        }
        rest
    }
}

impl<'a, W: Stored> Dense<'a, W> {
    fn panels<'x, S: Scalar<Weight = W::Wide>>(&self, first: usize, x: &'x [S]) -> Panels<'a, 'x, W, S> {
        Panels { weights: self.weights, bias: self.bias, inputs: self.inputs, first, x }
    }

    pub(super) fn forward_apart<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        x: &[Jet<S, T>],
        y: &mut [Jet<S, T>],
    ) {
        for k in 0..=T {
            // Without inputs the outputs are the biases.
            for first in (0..x.len().max(1)).step_by(GATHERED) {
                let chunk = x.get(first..).unwrap_or(&[]);
                let at_hand = gathered::<S, T, GATHERED>(chunk, k);
                let mut panels = self.panels(first, at_hand.get(..chunk.len()).unwrap_or(&at_hand));
                let rest = panels.forward::<T, 8>(y, k);
                let rest = panels.forward::<T, 4>(rest, k);
                panels.forward::<T, 1>(rest, k);
            }
        }
    }

    pub(super) fn adjoint_apart<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        y_bar: &[Jet<S, T>],
        x_bar: &mut [Jet<S, T>],
    ) {
        for k in 0..=T {
            for (chunk, first) in x_bar.chunks_mut(GATHERED).zip((0..).step_by(GATHERED)) {
                let mut sums = [S::zero(); GATHERED];
                let sums = sums.get_mut(..chunk.len()).unwrap_or_default();
                let mut panels = self.panels(first, &[]);
                let rest = panels.adjoint::<T, 8>(y_bar, sums, k);
                let rest = panels.adjoint::<T, 4>(rest, sums, k);
                panels.adjoint::<T, 1>(rest, sums, k);
                scatter(sums, chunk, k);
            }
        }
    }
}
