//! The numbers of a layer with their tangents, each component in an array of its own: the values together, and the tangents along each
//! direction together. Loops over a layer's weights then read and write them in place.

use super::Jet;
use crate::expected::{expected, present};
use crate::scalar::Scalar;
use heapless::Vec;

/// At most `H` numbers with `T` tangents.
#[derive(Clone, Debug)]
pub struct Units<S, const T: usize, const H: usize> {
    value: Vec<S, H>,
    tangents: [Vec<S, H>; T],
}

/// Resizes to `n` ≤ `H` numbers of unspecified value: earlier numbers or zeros. [`Mlp::take`](super::Mlp::take) refuses wider layers.
#[inline(always)]
pub(super) fn sized<S: Scalar, const H: usize>(numbers: &mut Vec<S, H>, n: usize) -> &mut [S] {
    let resized = numbers.resize(n, S::zero());
    debug_assert!(resized.is_ok(), "a layer of {n} units in a network of at most {H}");
    numbers
}

impl<S: Scalar, const T: usize, const H: usize> Units<S, T, H> {
    /// No units.
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { value: Vec::new(), tangents: core::array::from_fn(|_| Vec::new()) }
    }

    /// Creates units from jets; `None` for more than `H`.
    pub fn of(jets: &[Jet<S, T>]) -> Option<Self> {
        let mut units = Self::new();
        for jet in jets {
            units.value.push(jet.value).ok()?;
            units.tangents.iter_mut().zip(jet.tangent).try_for_each(|(tangent, x)| tangent.push(x)).ok()?;
        }
        Some(units)
    }

    /// Resizes to `n` units, whose numbers are still to be written.
    #[inline(always)]
    pub(super) fn resize(&mut self, n: usize) -> &mut Self {
        sized(&mut self.value, n);
        self.tangents.iter_mut().for_each(|tangent| {
            sized(tangent, n);
        });
        self
    }

    /// Values, and tangents along each direction, for writing.
    #[inline(always)]
    pub(super) fn parts_mut(&mut self) -> (&mut [S], &mut [Vec<S, H>; T]) {
        (&mut self.value, &mut self.tangents)
    }

    /// Unit j as a jet.
    #[inline(always)]
    pub(super) fn jet(&self, j: usize) -> Option<Jet<S, T>> {
        let value = *self.value.get(j)?;
        let tangent = self.tangents.each_ref().map(|tangent| expected(tangent.get(j).copied(), S::zero()));
        Some(Jet { value, tangent })
    }

    /// Every unit as a jet.
    #[inline(always)]
    pub(super) fn jets(&self) -> impl Iterator<Item = Jet<S, T>> {
        let mut tangents = self.tangents.each_ref().map(|tangent| tangent.iter());
        self.value.iter().map(move |value| Jet {
            value: *value,
            tangent: tangents.each_mut().map(|tangent| expected(tangent.next().copied(), S::zero())),
        })
    }

    /// Replaces every unit.
    #[inline(always)]
    pub(super) fn map(&mut self, mut f: impl FnMut(Jet<S, T>) -> Jet<S, T>) {
        let Self { value, tangents } = self;
        for (i, value) in value.iter_mut().enumerate() {
            let tangent = tangents.each_ref().map(|tangent| expected(tangent.get(i).copied(), S::zero()));
            let jet = f(Jet { value: *value, tangent });
            *value = jet.value;
            for (tangent, x) in tangents.iter_mut().zip(jet.tangent) {
                if let Some(slot) = present(tangent.get_mut(i)) {
                    *slot = x;
                }
            }
        }
    }

    /// Multiplies by other units, which have at least as many tangents: xy and ẋ_k y + x ẏ_k.
    #[inline(always)]
    pub(super) fn multiply<const U: usize>(&mut self, other: &Units<S, U, H>) {
        for (x, y) in self.tangents.iter_mut().zip(&other.tangents) {
            let values = self.value.iter().zip(&other.value);
            for ((x, y), (a, b)) in x.iter_mut().zip(y).zip(values) {
                *x = *x * *b + *a * *y;
            }
        }
        self.value.iter_mut().zip(&other.value).for_each(|(x, y)| *x = *x * *y);
    }
}

/// Number of jets from which a component is gathered at a time; a multiple of the widest panel.
const GATHERED: usize = 32;

/// P jets as vector registers hold them: their values side by side, and the tangents along each direction side by side.
pub(super) struct Panel<S, const T: usize, const P: usize> {
    pub value: [S; P],
    pub tangent: [[S; P]; T],
}

/// Source of a layer: vectors with T tangents.
pub(super) trait Source<S, const T: usize> {
    /// Visits component k (0: the values, then the tangents) in parts. A part is the index of its first number, and
    /// the numbers that lie side by side or are gathered at a time.
    fn parts(&self, k: usize, visit: impl FnMut(usize, &[S]));
    /// Every jet.
    fn each(&self) -> impl Iterator<Item = Jet<S, T>>;
}

/// Sink of a layer: vectors with T tangents.
pub(super) trait Sink<S, const T: usize> {
    /// Visits component k of the `count` numbers to be written, each 0 before, in parts. A part is the index of its
    /// first number, and the numbers that lie side by side or are scattered at a time.
    fn parts(&mut self, k: usize, count: usize, visit: impl FnMut(usize, &mut [S]));
    /// Makes room for `count` numbers with their tangents.
    fn reserve(&mut self, count: usize);
    /// Writes P jets, starting at `from`; there is room for them.
    fn put<const P: usize>(&mut self, from: usize, panel: &Panel<S, T, P>);
}

impl<S: Scalar, const T: usize> Source<S, T> for [Jet<S, T>] {
    #[inline(always)]
    fn parts(&self, k: usize, mut visit: impl FnMut(usize, &[S])) {
        let mut workspace = Vec::new();
        for (part, jets) in self.chunks(GATHERED).enumerate() {
            visit(part * GATHERED, gather(jets, k, &mut workspace));
        }
    }

    #[inline(always)]
    fn each(&self) -> impl Iterator<Item = Jet<S, T>> {
        self.iter().copied()
    }
}

/// Component k of the jets.
#[inline(never)]
fn gather<'w, S: Scalar, const T: usize>(
    jets: &[Jet<S, T>],
    k: usize,
    workspace: &'w mut Vec<S, GATHERED>,
) -> &'w [S] {
    let places = sized(workspace, jets.len()).iter_mut().zip(jets);
    match k.checked_sub(1) {
        None => places.for_each(|(x, jet)| *x = jet.value),
        Some(k) => places.for_each(|(x, jet)| *x = expected(jet.tangent.get(k).copied(), S::zero())),
    }
    workspace
}

/// Writes component k of the jets, the inverse of [`gather`].
#[inline(never)]
fn scatter<S: Scalar, const T: usize>(numbers: &[S], jets: &mut [Jet<S, T>], k: usize) {
    let places = jets.iter_mut().zip(numbers);
    match k.checked_sub(1) {
        None => places.for_each(|(jet, x)| jet.value = *x),
        Some(k) => places.for_each(|(jet, x)| {
            if let Some(slot) = present(jet.tangent.get_mut(k)) {
                *slot = *x;
            }
        }),
    }
}

impl<S: Scalar, const T: usize> Sink<S, T> for [Jet<S, T>] {
    #[inline(always)]
    fn parts(&mut self, k: usize, _: usize, mut visit: impl FnMut(usize, &mut [S])) {
        let mut workspace = Vec::<_, GATHERED>::new();
        for (part, jets) in self.chunks_mut(GATHERED).enumerate() {
            workspace.clear();
            visit(part * GATHERED, sized(&mut workspace, jets.len()));
            scatter(&workspace, jets, k);
        }
    }

    #[inline(always)]
    fn reserve(&mut self, _: usize) {}

    #[inline(always)]
    fn put<const P: usize>(&mut self, from: usize, panel: &Panel<S, T, P>) {
        for (l, jet) in expected(self.get_mut(from..), &mut []).iter_mut().take(P).enumerate() {
            jet.value = panel.value[l];
            jet.tangent.iter_mut().zip(&panel.tangent).for_each(|(x, lanes)| *x = lanes[l]);
        }
    }
}

impl<S: Scalar, const T: usize, const H: usize> Source<S, T> for Units<S, T, H> {
    #[inline(always)]
    fn parts(&self, k: usize, mut visit: impl FnMut(usize, &[S])) {
        let component = match k.checked_sub(1) {
            None => Some(&self.value),
            Some(k) => self.tangents.get(k),
        };
        if let Some(numbers) = present(component) {
            visit(0, numbers);
        }
    }

    #[inline(always)]
    fn each(&self) -> impl Iterator<Item = Jet<S, T>> {
        self.jets()
    }
}

impl<S: Scalar, const T: usize, const H: usize> Sink<S, T> for Units<S, T, H> {
    #[inline(always)]
    fn parts(&mut self, k: usize, count: usize, mut visit: impl FnMut(usize, &mut [S])) {
        let component = match k.checked_sub(1) {
            None => Some(&mut self.value),
            Some(k) => self.tangents.get_mut(k),
        };
        if let Some(numbers) = present(component) {
            numbers.clear();
            visit(0, sized(numbers, count));
        }
    }

    #[inline(always)]
    fn reserve(&mut self, count: usize) {
        self.resize(count);
    }

    #[inline(always)]
    fn put<const P: usize>(&mut self, from: usize, panel: &Panel<S, T, P>) {
        let write = |numbers: &mut Vec<S, H>, lanes: &[S; P]| {
            if let Some(slots) = present(numbers.get_mut(from..).and_then(|slots| slots.first_chunk_mut())) {
                *slots = *lanes;
            }
        };
        write(&mut self.value, &panel.value);
        self.tangents.iter_mut().zip(&panel.tangent).for_each(|(numbers, lanes)| write(numbers, lanes));
    }
}
