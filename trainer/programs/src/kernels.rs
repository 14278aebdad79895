//! Products with the weights of a layer, in panels of eight outputs, then four, then one
//! ([`Dense`](leastaction_core::network::Dense)), and sums in the same order as there. What a layer is applied to are columns,
//! vectors one after the other; a panel's weights serve all of them before those of the next are read.

use crate::builder::Layer;
use crate::row::{GROUPS, Row};
use leastaction_core::scalar::LANES;
use std::ops::Range;
use wide::f64x8;

/// Wx of every column, and + b where there is one.
pub(crate) fn linear(
    layer: &Layer,
    columns: usize,
    (weights, bias): (&[f64], bool),
    x: &[Row],
    y: &mut [Row],
) {
    for panel in panels(layer) {
        let rows = &weights[panel.weights()];
        let biases = bias.then(|| &weights[panel.biases()]);
        for column in 0..columns {
            let (x, y) = (&x[panel.inputs(column)], &mut y[panel.outputs(column)]);
            match panel.width {
                8 => linear_panel::<8>(rows, biases, x, y),
                4 => linear_panel::<4>(rows, biases, x, y),
                _ => linear_panel::<1>(rows, biases, x, y),
            }
        }
    }
}

#[inline(never)]
fn linear_panel<const P: usize>(rows: &[f64], biases: Option<&[f64]>, x: &[Row], y: &mut [Row]) {
    let biases = biases.and_then(|biases| biases.first_chunk::<P>());
    for group in 0..GROUPS {
        let mut sums: [f64x8; P] = biases.map_or([f64x8::ZERO; P], |biases| biases.map(f64x8::splat));
        for (x, row) in x.iter().zip(rows.as_chunks::<P>().0) {
            let x = x.load()[group];
            sums = std::array::from_fn(|l| sums[l] + f64x8::splat(row[l]) * x);
        }
        for (y, sum) in y.iter_mut().zip(sums) {
            y.0.as_chunks_mut::<LANES>().0[group] = sum.to_array();
        }
    }
}

/// Wᵀy of every column.
pub(crate) fn transposed(layer: &Layer, columns: usize, weights: &[f64], y: &[Row], x: &mut [Row]) {
    x.fill(Row::default());
    for panel in panels(layer) {
        let rows = &weights[panel.weights()];
        for column in 0..columns {
            let (x, y) = (&mut x[panel.inputs(column)], &y[panel.outputs(column)]);
            match panel.width {
                8 => transposed_panel::<8>(rows, y, x),
                4 => transposed_panel::<4>(rows, y, x),
                _ => transposed_panel::<1>(rows, y, x),
            }
        }
    }
}

#[inline(never)]
fn transposed_panel<const P: usize>(rows: &[f64], y: &[Row], x: &mut [Row]) {
    let Some(y) = y.first_chunk::<P>() else { return };
    let y = y.each_ref().map(Row::load);
    for (x, row) in x.iter_mut().zip(rows.as_chunks::<P>().0) {
        let mut sums = [x.load(), [f64x8::ZERO; GROUPS]];
        for (l, (w, y)) in row.iter().zip(&y).enumerate() {
            let (w, sum) = (f64x8::splat(*w), &mut sums[l % 2]);
            for (sum, y) in sum.iter_mut().zip(y) {
                *sum += w * *y;
            }
        }
        let [even, odd] = sums;
        *x = Row::store(std::array::from_fn(|g| even[g] + odd[g]));
    }
}

/// A term of a layer's gradient: ȳxᵀ of every column.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<T> {
    /// Vectors in each of both.
    pub columns: usize,
    /// The adjoint of the outputs.
    pub y_bar: T,
    /// The inputs.
    pub x: T,
    /// Whether ȳ is also the gradient in the biases.
    pub bias: bool,
}

impl<T: Copy> Pair<T> {
    /// The same of what `f` makes of both.
    pub(crate) fn map<U>(&self, f: impl Fn(T) -> U) -> Pair<U> {
        Pair { columns: self.columns, y_bar: f(self.y_bar), x: f(self.x), bias: self.bias }
    }
}

/// Adds Σ ȳxᵀ to the derivatives in a layer's weights, and Σ ȳ to those in its biases for the pairs that say so.
pub(crate) fn outer(layer: &Layer, pairs: &[Pair<&[Row]>], gradient: &mut [Row]) {
    for panel in panels(layer) {
        let own = &mut gradient[panel.weights()];
        for pair in pairs {
            for column in 0..pair.columns {
                let (y_bar, x) = (&pair.y_bar[panel.outputs(column)], &pair.x[panel.inputs(column)]);
                match panel.width {
                    8 => outer_panel::<8>(y_bar, x, own),
                    4 => outer_panel::<4>(y_bar, x, own),
                    _ => outer_panel::<1>(y_bar, x, own),
                }
            }
        }
    }
    let biases = &mut gradient[layer.biases()..layer.end()];
    for pair in pairs.iter().filter(|pair| pair.bias) {
        for column in pair.y_bar.chunks(layer.outputs.max(1)) {
            biases.iter_mut().zip(column).for_each(|(sum, y)| sum.add_scaled(1.0, y));
        }
    }
}

#[inline(never)]
fn outer_panel<const P: usize>(y_bar: &[Row], x: &[Row], gradient: &mut [Row]) {
    let Some(y_bar) = y_bar.first_chunk::<P>() else { return };
    let y_bar = y_bar.each_ref().map(Row::load);
    for (x, places) in x.iter().zip(gradient.as_chunks_mut::<P>().0) {
        let x = x.load();
        for (place, y) in places.iter_mut().zip(&y_bar) {
            let sum = place.load();
            *place = Row::store(std::array::from_fn(|g| sum[g] + y[g] * x[g]));
        }
    }
}

/// Neighbouring outputs of a layer whose weights lie together.
#[derive(Clone, Copy)]
struct Panel<'l> {
    layer: &'l Layer,
    first: usize,
    width: usize,
}

impl Panel<'_> {
    /// Where the inputs of a column are.
    fn inputs(&self, column: usize) -> Range<usize> {
        let start = column * self.layer.inputs;
        start..start + self.layer.inputs
    }

    /// Where its outputs of a column are.
    fn outputs(&self, column: usize) -> Range<usize> {
        let start = column * self.layer.outputs + self.first;
        start..start + self.width
    }

    /// Where its weights are in the weight block.
    fn weights(&self) -> Range<usize> {
        let start = self.layer.start + self.first * self.layer.inputs;
        start..start + self.width * self.layer.inputs
    }

    /// Where its biases are in the weight block.
    fn biases(&self) -> Range<usize> {
        let start = self.layer.biases() + self.first;
        start..start + self.width
    }
}

fn panels(layer: &Layer) -> impl Iterator<Item = Panel<'_>> {
    let (eights, fours, outputs) = (layer.outputs / 8 * 8, layer.outputs / 4 * 4, layer.outputs);
    let of = move |width: usize, range: Range<usize>| {
        range.step_by(width).map(move |first| Panel { layer, first, width })
    };
    of(8, 0..eights).chain(of(4, eights..fours)).chain(of(1, fours..outputs))
}
