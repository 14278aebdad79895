//! Products with the weights of a layer, in panels of eight outputs, then four, then one
//! ([`Dense`](leastaction_core::network::Dense)), with sums in the same order as there. A layer is applied to columns,
//! which are vectors one after the other; a panel's weights are used for all columns before those of the next panel are
//! read. The panels after those of eight outputs are read together.

use crate::operation::Layer;
use crate::row::{PARTS, Part, Row};
use std::ops::Range;

/// Number of parts of a row for which the sums of eight outputs are kept in registers at once: they fill half of them.
const BESIDE_EIGHT: usize = if cfg!(target_feature = "avx512f") { 2 } else { 1 };

/// Computes Wx for every column, plus b if there is a bias.
pub(crate) fn linear(
    layer: &Layer,
    columns: usize,
    (weights, bias): (&[f64], bool),
    x: &[Row],
    y: &mut [Row],
) {
    for block in blocks(layer) {
        let run = match (block.panel, block.singles) {
            (8, _) => linear_block::<8, 0, BESIDE_EIGHT>,
            (4, 0) => linear_block::<4, 0, 2>,
            (4, 1) => linear_block::<4, 1, 2>,
            (4, 2) => linear_block::<4, 2, 2>,
            (4, _) => linear_block::<4, 3, 2>,
            (_, 1) => linear_block::<0, 1, PARTS>,
            (_, 2) => linear_block::<0, 2, PARTS>,
            _ => linear_block::<0, 3, 2>,
        };
        let biases = bias.then(|| &weights[block.biases()]);
        run(block.weights(weights), biases, (layer, block.first), columns, x, y);
    }
}

/// Applies a panel of P outputs, and S outputs after it, to all columns, to T parts of a row at a time.
#[inline(never)]
fn linear_block<const P: usize, const S: usize, const T: usize>(
    weights: BlockWeights,
    biases: Option<&[f64]>,
    (layer, first): (&Layer, usize),
    columns: usize,
    x: &[Row],
    y: &mut [Row],
) {
    let inputs = layer.inputs;
    let (panel, singles) = weights.split::<P, S>(inputs);
    let bias = |l: usize| Part::splat(biases.map_or(0.0, |biases| biases[l]));
    let (of_panel, of_singles): ([_; P], [_; S]) =
        (std::array::from_fn(bias), std::array::from_fn(|s| bias(P + s)));
    for column in 0..columns {
        let x = &x[column * inputs..][..inputs];
        let y = &mut y[column * layer.outputs + first..][..P + S];
        for part in (0..PARTS).step_by(T) {
            let (mut sums, mut others) = (of_panel.map(|bias| [bias; T]), of_singles.map(|bias| [bias; T]));
            for j in 0..inputs {
                let x: [Part; T] = std::array::from_fn(|t| x[j].part(part + t));
                if P > 0 {
                    (0..P).for_each(|l| add_products(&mut sums[l], panel[j][l], &x));
                }
                (0..S).for_each(|s| add_products(&mut others[s], singles[s][j], &x));
            }
            (0..P).for_each(|l| (0..T).for_each(|t| y[l].set_part(part + t, sums[l][t])));
            (0..S).for_each(|s| (0..T).for_each(|t| y[P + s].set_part(part + t, others[s][t])));
        }
    }
}

/// Adds wx.
#[inline(always)]
fn add_products<const T: usize>(sums: &mut [Part; T], w: f64, x: &[Part; T]) {
    let w = Part::splat(w);
    sums.iter_mut().zip(x).for_each(|(sum, x)| *sum = w.mul_add(*x, *sum));
}

/// Computes Wᵀy for every column.
pub(crate) fn transposed(layer: &Layer, columns: usize, weights: &[f64], y: &[Row], x: &mut [Row]) {
    if layer.outputs == 0 {
        x.fill(Row::default());
    }
    for block in blocks(layer) {
        let run = match (block.panel, block.singles) {
            (8, _) => transposed_block::<8, 0, BESIDE_EIGHT>,
            (4, 0) => transposed_block::<4, 0, 2>,
            (4, 1) => transposed_block::<4, 1, 2>,
            (4, 2) => transposed_block::<4, 2, 2>,
            (4, _) => transposed_block::<4, 3, BESIDE_EIGHT>,
            (_, 1) => transposed_block::<0, 1, 2>,
            (_, 2) => transposed_block::<0, 2, 2>,
            _ => transposed_block::<0, 3, 2>,
        };
        run(block.weights(weights), (layer, block.first), columns, y, x);
    }
}

/// Adds the part of a panel of P outputs, and of S outputs after it, to all columns, to T parts of a row at a time. The first block of a
/// layer sets x.
#[inline(never)]
fn transposed_block<const P: usize, const S: usize, const T: usize>(
    weights: BlockWeights,
    (layer, first): (&Layer, usize),
    columns: usize,
    y: &[Row],
    x: &mut [Row],
) {
    let inputs = layer.inputs;
    let (panel, singles) = weights.split::<P, S>(inputs);
    for column in 0..columns {
        let x = &mut x[column * inputs..][..inputs];
        let y = &y[column * layer.outputs + first..][..P + S];
        for part in (0..PARTS).step_by(T) {
            let of = |l: usize| -> [Part; T] { std::array::from_fn(|t| y[l].part(part + t)) };
            let (own, others): ([_; P], [_; S]) =
                (std::array::from_fn(of), std::array::from_fn(|s| of(P + s)));
            for j in 0..inputs {
                let mut sums: [Part; T] = match first {
                    0 => [Part::ZERO; T],
                    _ => std::array::from_fn(|t| x[j].part(part + t)),
                };
                if P > 0 {
                    let mut halves = [[Part::ZERO; T]; 2];
                    for (l, (w, y)) in panel[j].iter().zip(&own).enumerate() {
                        add_products(&mut halves[l % 2], *w, y);
                    }
                    let [even, odd] = halves;
                    (0..T).for_each(|t| sums[t] += even[t] + odd[t]);
                }
                for (w, y) in singles.iter().zip(&others) {
                    let mut product = [Part::ZERO; T];
                    add_products(&mut product, w[j], y);
                    (0..T).for_each(|t| sums[t] += product[t] + Part::ZERO);
                }
                (0..T).for_each(|t| x[j].set_part(part + t, sums[t]));
            }
        }
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
        let own = &mut gradient[layer.panel(panel.first, panel.width)];
        match panel.width {
            8 => outer_panel::<8, BESIDE_EIGHT>(panel.first, &columns, own),
            4 => outer_panel::<4, { 2 * BESIDE_EIGHT }>(panel.first, &columns, own),
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

/// Processes I inputs at a time, one part of a row after the other, so that their sums over all columns stay in
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
    for part in 0..PARTS {
        let mut sums = [[Part::ZERO; P]; I];
        for (sums, places) in sums.iter_mut().zip(places.iter()) {
            sums.iter_mut().zip(places).for_each(|(sum, place)| *sum = place.part(part));
        }
        for (y, x) in columns {
            let (Some(y), Some(x)) = (y[output..].first_chunk::<P>(), x[input..].first_chunk::<I>()) else {
                return;
            };
            for (sums, x) in sums.iter_mut().zip(x) {
                let x = x.part(part);
                sums.iter_mut().zip(y).for_each(|(sum, y)| *sum = x.mul_add(y.part(part), *sum));
            }
        }
        for (places, sums) in places.iter_mut().zip(&sums) {
            places.iter_mut().zip(sums).for_each(|(place, sum)| place.set_part(part, *sum));
        }
    }
}

/// Neighbouring outputs of a layer whose weights are stored together.
#[derive(Clone, Copy)]
struct Panel {
    first: usize,
    width: usize,
}

fn panels(layer: &Layer) -> impl Iterator<Item = Panel> {
    let (eights, fours, outputs) = (layer.outputs / 8 * 8, layer.outputs / 4 * 4, layer.outputs);
    let of = move |width: usize, range: Range<usize>| {
        range.step_by(width).map(move |first| Panel { first, width })
    };
    of(8, 0..eights).chain(of(4, eights..fours)).chain(of(1, fours..outputs))
}

/// Outputs of a layer whose weights are read together: a panel of eight, or all outputs after those.
#[derive(Clone, Copy)]
struct Block<'l> {
    layer: &'l Layer,
    first: usize,
    /// Width of the panel: 8, 4 or 0.
    panel: usize,
    /// Number of outputs after the panel, at most 3.
    singles: usize,
}

fn blocks(layer: &Layer) -> impl Iterator<Item = Block<'_>> {
    let (eights, rest) = (layer.outputs / 8 * 8, layer.outputs % 8);
    let whole = (0..eights).step_by(8).map(move |first| Block { layer, first, panel: 8, singles: 0 });
    let rest = (rest > 0).then_some(Block { layer, first: eights, panel: rest / 4 * 4, singles: rest % 4 });
    whole.chain(rest)
}

impl Block<'_> {
    /// Range of the biases in the weight block.
    fn biases(&self) -> Range<usize> {
        let start = self.layer.biases() + self.first;
        start..start + self.panel + self.singles
    }

    fn weights<'w>(&self, weights: &'w [f64]) -> BlockWeights<'w> {
        let after = self.first + self.panel;
        let single = |s: usize| match s < self.singles {
            true => &weights[self.layer.panel(after + s, 1)],
            false => &[],
        };
        BlockWeights {
            panel: &weights[self.layer.panel(self.first, self.panel)],
            singles: std::array::from_fn(single),
        }
    }
}

/// Weights of a block: those of its panel, and those of each output after it.
#[derive(Clone, Copy)]
struct BlockWeights<'w> {
    panel: &'w [f64],
    singles: [&'w [f64]; 3],
}

impl<'w> BlockWeights<'w> {
    /// Weights input by input: P of the panel and S others.
    #[inline(always)]
    fn split<const P: usize, const S: usize>(self, inputs: usize) -> (&'w [[f64; P]], [&'w [f64]; S]) {
        let panel = if P > 0 { &self.panel.as_chunks().0[..inputs] } else { &[] };
        (panel, std::array::from_fn(|s| &self.singles[s][..inputs]))
    }
}
