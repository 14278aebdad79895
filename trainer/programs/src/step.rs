//! Steps of a program: each computes one vector of the workspace, or adds to gradients with respect to the weights.

use crate::function::{Function, ORDERS};
use crate::kernels::{self, Pair};
use crate::operation::Layer;
use crate::picks::{PickSums, Picks};
use crate::row::Row;
use std::ops::Range;
use wide::f64x8;

/// Number of a vector in a workspace.
pub(crate) type Slot = usize;

/// A step of a program.
#[derive(Clone, Debug)]
pub(crate) enum Step {
    Input {
        number: usize,
        to: Slot,
    },
    Parameters {
        start: usize,
        to: Slot,
    },
    Linear {
        layer: Layer,
        columns: usize,
        bias: bool,
        x: Slot,
        to: Slot,
    },
    Transposed {
        layer: Layer,
        columns: usize,
        y: Slot,
        to: Slot,
    },
    Map {
        function: Function,
        x: Slot,
        to: [Option<Slot>; ORDERS],
    },
    /// The derivative of the given order of a function, times another vector.
    MapProduct {
        function: Function,
        order: usize,
        x: Slot,
        y: Slot,
        to: Slot,
    },
    Product {
        x: Slot,
        y: Slot,
        to: Slot,
    },
    Sum {
        x: Slot,
        y: Slot,
        to: Slot,
    },
    Scaled {
        c: f64,
        x: Slot,
        to: Slot,
    },
    Gather {
        x: Slot,
        index: Box<[u32]>,
        to: Slot,
    },
    Scatter {
        x: Slot,
        index: Box<[u32]>,
        to: Slot,
    },
    /// Rows read from arbitrary positions.
    Pick {
        x: Slot,
        picks: Picks,
        to: Slot,
    },
    /// Rows read from arbitrary positions in an input.
    PickInput {
        number: usize,
        picks: Picks,
        to: Slot,
    },
    /// Sums of rows read from arbitrary positions.
    PickSums {
        x: Slot,
        sums: PickSums,
        to: Slot,
    },
    /// Parameters one after the other.
    PackedParameters {
        range: Range<usize>,
        to: Slot,
    },
    /// Adds to a row of the Jacobian.
    Outer {
        row: usize,
        layer: Layer,
        pairs: Vec<Pair<Slot>>,
    },
    Numbers {
        row: usize,
        start: usize,
        bar: Slot,
    },
}

impl Step {
    pub(crate) fn run(
        &self,
        weights: &[f64],
        inputs: &[&[Row]],
        slots: &mut [Vec<Row>],
        rows: &mut [Vec<Row>],
    ) {
        match self {
            Self::Input { number, to } => slots[*to].copy_from_slice(inputs[*number]),
            Self::Parameters { start, to } => {
                slots[*to].iter_mut().zip(&weights[*start..]).for_each(|(to, w)| *to = Row::splat(*w));
            }
            Self::Linear { layer, columns, bias, x, to } => write(slots, *to, |slots, to| {
                kernels::linear(layer, *columns, (weights, *bias), &slots[*x], to);
            }),
            Self::Transposed { layer, columns, y, to } => write(slots, *to, |slots, to| {
                kernels::transposed(layer, *columns, weights, &slots[*y], to);
            }),
            Self::Map { function, x, to } => map(*function, *x, *to, slots),
            Self::MapProduct { function, order, x, y, to } => write(slots, *to, |slots, to| {
                map_product((*function, *order), &slots[*x], &slots[*y], to);
            }),
            Self::Product { x, y, to } => pairwise(slots, [*x, *y, *to], |x, y| x * y),
            Self::Sum { x, y, to } => pairwise(slots, [*x, *y, *to], |x, y| x + y),
            Self::Scaled { c, x, to } => {
                let c = f64x8::splat(*c);
                pairwise(slots, [*x, *x, *to], |x, _| c * x);
            }
            Self::Gather { x, index, to } => write(slots, *to, |slots, to| {
                let x = &slots[*x];
                to.iter_mut().zip(index).for_each(|(to, i)| *to = x[*i as usize]);
            }),
            Self::Scatter { x, index, to } => write(slots, *to, |slots, to| {
                to.fill(Row::default());
                slots[*x].iter().zip(index).for_each(|(x, i)| to[*i as usize].add_scaled(1.0, x));
            }),
            Self::Pick { x, picks, to } => write(slots, *to, |slots, to| picks.write(&slots[*x], to)),
            Self::PickInput { number, picks, to } => picks.write(inputs[*number], &mut slots[*to]),
            Self::PickSums { x, sums, to } => write(slots, *to, |slots, to| sums.write(&slots[*x], to)),
            Self::PackedParameters { range, to } => {
                let places = slots[*to].iter_mut().flat_map(|row| &mut row.0);
                places.zip(&weights[range.clone()]).for_each(|(to, w)| *to = *w);
            }
            Self::Outer { row, layer, pairs } => {
                let pairs: Vec<_> = pairs.iter().map(|pair| pair.map(|slot| &slots[slot][..])).collect();
                kernels::outer(layer, &pairs, &mut rows[*row]);
            }
            Self::Numbers { row, start, bar } => {
                let places = &mut rows[*row][*start..];
                places.iter_mut().zip(&slots[*bar]).for_each(|(sum, bar)| sum.add_scaled(1.0, bar));
            }
        }
    }
}

/// Computes one slot from the others.
fn write(slots: &mut [Vec<Row>], to: Slot, compute: impl FnOnce(&[Vec<Row>], &mut [Row])) {
    let mut place = std::mem::take(&mut slots[to]);
    compute(slots, &mut place);
    slots[to] = place;
}

/// Applies `f` to two vectors entry by entry; the shorter one is repeated.
fn pairwise(slots: &mut [Vec<Row>], [x, y, to]: [Slot; 3], f: impl Fn(f64x8, f64x8) -> f64x8) {
    write(slots, to, |slots, to| {
        let (x, y) = (&slots[x], &slots[y]);
        let (of_x, of_y) = (x.len() < to.len(), y.len() < to.len());
        let part = if of_x { x.len() } else { y.len() };
        for (k, to) in to.chunks_mut(part.max(1)).enumerate() {
            let [x, y] = [(x, of_x), (y, of_y)].map(|(x, repeated)| {
                let start = if repeated { 0 } else { k * part };
                &x[start..start + to.len()]
            });
            for ((to, x), y) in to.iter_mut().zip(x).zip(y) {
                let (x, y) = (x.load(), y.load());
                *to = Row::store(std::array::from_fn(|g| f(x[g], y[g])));
            }
        }
    });
}

/// Number of rows of a function that are computed and then multiplied while they are in the cache.
const MAPPED: usize = 32;

/// Computes f⁽ᵒʳᵈᵉʳ⁾(x)y; a shorter y is repeated.
fn map_product((function, order): (Function, usize), x: &[Row], y: &[Row], to: &mut [Row]) {
    let repeated = y.len() < to.len();
    let part = if repeated { y.len() * (MAPPED / y.len()).max(1) } else { MAPPED };
    for ((k, to), x) in to.chunks_mut(part).enumerate().zip(x.chunks(part)) {
        let mut places = [const { None }; ORDERS];
        places[order] = Some(&mut *to);
        function.write(x, places);
        let y = if repeated { y } else { &y[k * part..][..to.len()] };
        for to in to.chunks_mut(y.len()) {
            to.iter_mut().zip(y).for_each(|(to, y)| *to = to.product(y));
        }
    }
}

fn map(function: Function, x: Slot, to: [Option<Slot>; ORDERS], slots: &mut [Vec<Row>]) {
    let mut places = to.map(|to| to.map(|to| std::mem::take(&mut slots[to])));
    function.write(&slots[x], places.each_mut().map(|place| place.as_deref_mut()));
    for (to, place) in to.into_iter().zip(places) {
        if let (Some(to), Some(place)) = (to, place) {
            slots[to] = place;
        }
    }
}
