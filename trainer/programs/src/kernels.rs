//! Products with the weights of a layer, in panels of eight outputs, then four, then one
//! ([`Dense`](leastaction_core::network::Dense)), with sums in the same order as there. A layer is applied to columns,
//! which are vectors one after the other; a panel's weights are used for all columns before those of the next panel are
//! read.

use crate::operation::Layer;
use crate::row::{GROUPS, Row};
use std::ops::Range;
use wide::f64x8;

/// Number of groups of lanes whose sums are kept in registers at once: eight outputs fill half of 32 registers.
const TOGETHER: usize = if cfg!(target_feature = "avx512f") { GROUPS } else { 1 };

/// Computes Wx for every column, plus b if there is a bias.
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
    for first in (0..GROUPS).step_by(TOGETHER) {
        let mut sums = [[f64x8::ZERO; TOGETHER]; P];
        for (sums, bias) in sums.iter_mut().zip(biases.unwrap_or_default()) {
            *sums = [f64x8::splat(*bias); TOGETHER];
        }
        for (x, row) in x.iter().zip(rows.as_chunks::<P>().0) {
            for (sums, w) in sums.iter_mut().zip(row) {
                let w = f64x8::splat(*w);
                sums.iter_mut().enumerate().for_each(|(g, sum)| *sum = w.mul_add(x.group(first + g), *sum));
            }
        }
        for (y, sums) in y.iter_mut().zip(&sums) {
            sums.iter().enumerate().for_each(|(g, sum)| y.set_group(first + g, *sum));
        }
    }
}

/// Computes Wᵀy for every column.
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
    for (x, row) in x.iter_mut().zip(rows.as_chunks::<P>().0) {
        let mut sums = [[f64x8::ZERO; GROUPS]; 2];
        for (l, (w, y)) in row.iter().zip(y).enumerate() {
            let (w, sums) = (f64x8::splat(*w), &mut sums[l % 2]);
            sums.iter_mut().enumerate().for_each(|(g, sum)| *sum = w.mul_add(y.group(g), *sum));
        }
        let [even, odd] = &sums;
        (0..GROUPS).for_each(|g| x.set_group(g, x.group(g) + (even[g] + odd[g])));
    }
}

/// A term of a layer's gradient: the sum of ȳxᵀ over its columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<T> {
    /// Number of columns in both vectors.
    pub columns: usize,
    /// Adjoint of the outputs.
    pub y_bar: T,
    /// Inputs of the layer.
    pub x: T,
    /// Whether ȳ is also the gradient with respect to the biases.
    pub bias: bool,
}

impl<T: Copy> Pair<T> {
    /// Applies `f` to both vectors.
    pub(crate) fn map<U>(&self, f: impl Fn(T) -> U) -> Pair<U> {
        Pair { columns: self.columns, y_bar: f(self.y_bar), x: f(self.x), bias: self.bias }
    }
}

impl<'r> Pair<&'r [Row]> {
    fn each_column(&self, layer: &Layer) -> impl Iterator<Item = Column<'r>> {
        let ((y_bar, outputs), (x, inputs)) = ((self.y_bar, layer.outputs), (self.x, layer.inputs));
        (0..self.columns).map(move |k| (&y_bar[k * outputs..][..outputs], &x[k * inputs..][..inputs]))
    }
}

/// Adds Σ ȳxᵀ to the derivatives with respect to a layer's weights and, for the pairs with a bias, Σ ȳ to those with
/// respect to its biases.
pub(crate) fn outer(layer: &Layer, pairs: &[Pair<&[Row]>], gradient: &mut [Row]) {
    let columns: Vec<_> = pairs.iter().flat_map(|pair| pair.each_column(layer)).collect();
    for panel in panels(layer) {
        let own = &mut gradient[panel.weights()];
        match panel.width {
            8 => outer_panel::<8, 2>(panel.first, &columns, own),
            4 => outer_panel::<4, 4>(panel.first, &columns, own),
            _ => outer_panel::<1, 8>(panel.first, &columns, own),
        }
    }
    let biases = &mut gradient[layer.biases()..layer.end()];
    for pair in pairs.iter().filter(|pair| pair.bias) {
        for (y, _) in pair.each_column(layer) {
            biases.iter_mut().zip(y).for_each(|(sum, y)| sum.add_scaled(1.0, y));
        }
    }
}

/// Vectors ȳ and x of a layer that is applied to a single column.
type Column<'r> = (&'r [Row], &'r [Row]);

/// Processes I inputs at a time, one group of lanes after the other, so that their sums over all columns stay in
/// registers.
fn outer_panel<const P: usize, const I: usize>(first: usize, columns: &[Column], gradient: &mut [Row]) {
    let (tiles, rest) = gradient.as_chunks_mut::<P>().0.as_chunks_mut::<I>();
    let done = I * tiles.len();
    for (i, places) in tiles.iter_mut().enumerate() {
        outer_tile((first, I * i), columns, places);
    }
    for (i, place) in rest.iter_mut().enumerate() {
        outer_tile((first, done + i), columns, std::array::from_mut(place));
    }
}

#[inline(never)]
fn outer_tile<const P: usize, const I: usize>(
    (output, input): (usize, usize),
    columns: &[Column],
    places: &mut [[Row; P]; I],
) {
    for g in 0..GROUPS {
        let mut sums = [[f64x8::ZERO; P]; I];
        for (sums, places) in sums.iter_mut().zip(places.iter()) {
            sums.iter_mut().zip(places).for_each(|(sum, place)| *sum = place.group(g));
        }
        for (y, x) in columns {
            let (Some(y), Some(x)) = (y[output..].first_chunk::<P>(), x[input..].first_chunk::<I>()) else {
                return;
            };
            for (sums, x) in sums.iter_mut().zip(x) {
                let x = x.group(g);
                sums.iter_mut().zip(y).for_each(|(sum, y)| *sum = x.mul_add(y.group(g), *sum));
            }
        }
        for (places, sums) in places.iter_mut().zip(&sums) {
            places.iter_mut().zip(sums).for_each(|(place, sum)| place.set_group(g, *sum));
        }
    }
}

/// Neighbouring outputs of a layer whose weights are stored together.
#[derive(Clone, Copy)]
struct Panel<'l> {
    layer: &'l Layer,
    first: usize,
    width: usize,
}

impl Panel<'_> {
    /// Range of the inputs of a column.
    fn inputs(&self, column: usize) -> Range<usize> {
        let start = column * self.layer.inputs;
        start..start + self.layer.inputs
    }

    /// Range of the panel's outputs of a column.
    fn outputs(&self, column: usize) -> Range<usize> {
        let start = column * self.layer.outputs + self.first;
        start..start + self.width
    }

    /// Range of the panel's weights in the weight block.
    fn weights(&self) -> Range<usize> {
        self.layer.panel(self.first, self.width)
    }

    /// Range of the panel's biases in the weight block.
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
