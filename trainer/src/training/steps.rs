//! Logged steps as models of another kind see them.

use super::samples::{Sample, Samples};
use crate::runge_kutta::State;
use leastaction_core::linear::add_scaled;
use leastaction_core::scalar::{LANES, Lanes, Scalar};
use std::ops::Range;

/// The steps of eight samples, as logged.
#[derive(Clone, Copy, Debug)]
pub struct Steps<const N: usize> {
    /// (q, v).
    pub start: State<Lanes, N>,
    /// (q₊, v₊).
    pub end: State<Lanes, N>,
    /// u.
    pub control: [Lanes; N],
}

impl<const N: usize> Steps<N> {
    fn new(group: &[Sample<N>; LANES]) -> Self {
        let state = |k: usize| side_by_side(|lane| group[lane].states[k]);
        Self {
            start: [state(0), state(1)],
            end: [state(2), side_by_side(|lane| group[lane].next_velocity)],
            control: side_by_side(|lane| group[lane].controls[0]),
        }
    }

    /// The steps of samples from `start` on; the last of `samples` fills the group up.
    pub fn from_samples(of: &Samples, start: usize, samples: &Range<usize>) -> Self {
        Self::new(&of.group(start, samples))
    }

    /// What a predicted end is off by.
    pub fn errors(&self, [q, v]: &State<Lanes, N>) -> State<Lanes, N> {
        let minus = -Lanes::one();
        [add_scaled(q, minus, &self.end[0]), add_scaled(v, minus, &self.end[1])]
    }
}

/// Row by row from lane by lane.
fn side_by_side<const N: usize>(of: impl Fn(usize) -> [f64; N]) -> [Lanes; N] {
    let rows: [[f64; N]; LANES] = std::array::from_fn(of);
    std::array::from_fn(|i| Lanes(std::array::from_fn(|lane| rows[lane][i])))
}
