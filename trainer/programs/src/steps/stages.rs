//! The stages of a Runge–Kutta step, in storage that is used again.

use super::tangents::Tangents;
use super::{RungeKutta, State};
use crate::row::Row;

/// Rates of change of the state and of its derivatives, stage by stage.
pub(super) struct Stages {
    n: usize,
    method: RungeKutta,
    /// The stage that was entered last.
    present: usize,
    /// The state that it is at, and τ there.
    at: State,
    tau: Vec<Row>,
    /// (v, v̇) of every stage.
    rates: Vec<State>,
    /// Of every stage how (v, v̇) moves: 2n rows for each number.
    tangents: Vec<Vec<Row>>,
    /// How the state of the present stage moves with one number.
    moved: Vec<Row>,
}

impl Stages {
    pub fn new(n: usize, method: RungeKutta) -> Self {
        let (state, count) = (vec![Row::default(); 2 * n], method.stages().len());
        Self {
            n,
            method,
            present: 0,
            at: state.clone(),
            tau: vec![Row::default(); n],
            rates: vec![state.clone(); count],
            tangents: vec![Vec::new(); count],
            moved: state,
        }
    }

    /// Begins a stage: from a state with a step of h, where the stages before it say; τ from the start of the step to its end.
    pub fn enter(&mut self, stage: usize, (state, h): (&State, f64), (tau, time): ([&[Row]; 2], f64)) {
        self.present = stage;
        self.at.copy_from_slice(state);
        for (share, rate) in self.method.stages()[stage].iter().zip(&self.rates) {
            self.at.iter_mut().zip(rate).for_each(|(x, rate)| x.add_scaled(h * share, rate));
        }
        let ends = tau[0].iter().zip(tau[1]);
        self.tau.iter_mut().zip(ends).for_each(|(tau, (a, b))| *tau = a.towards(b, time));
        self.rates[stage][..self.n].copy_from_slice(&self.at[self.n..]);
    }

    /// q, v and τ of the stage, and the place of its v̇.
    pub fn motion(&mut self) -> ([&[Row]; 3], &mut [Row]) {
        let (q, v) = self.at.split_at(self.n);
        ([q, v, &self.tau], &mut self.rates[self.present][self.n..])
    }

    /// Its q, v, τ and v̇.
    pub fn moved(&self) -> [&[Row]; 4] {
        let (q, v) = self.at.split_at(self.n);
        [q, v, &self.tau, &self.rates[self.present][self.n..]]
    }

    /// How the stage moves with every number: δv̇ = ∂_q v̇ δq + ∂_v v̇ δv + `own` (of a coordinate and a number), with rows of `slopes` as
    /// long as q, v and τ together.
    pub fn carry(
        &mut self,
        (tangents, h): (&Tangents, f64),
        slopes: &[Row],
        own: impl Fn(usize, usize) -> Row,
    ) {
        let (n, width) = (self.n, 2 * self.n);
        let (before, rest) = self.tangents.split_at_mut(self.present);
        let Some(rates) = rest.first_mut() else { return };
        rates.resize(tangents.columns() * width, Row::default());
        let shares = self.method.stages()[self.present];
        let places = rates.chunks_exact_mut(width).zip(tangents.each());
        for (number, (place, start)) in places.enumerate() {
            self.moved.copy_from_slice(start);
            for (share, rate) in shares.iter().zip(&*before) {
                let rate = &rate[number * width..][..width];
                self.moved.iter_mut().zip(rate).for_each(|(x, rate)| x.add_scaled(h * share, rate));
            }
            let (velocities, accelerations) = place.split_at_mut(n);
            velocities.copy_from_slice(&self.moved[n..]);
            for (i, (place, slopes)) in accelerations.iter_mut().zip(slopes.chunks_exact(3 * n)).enumerate() {
                let mut sum = own(i, number);
                slopes.iter().zip(&self.moved).for_each(|(slope, x)| sum.add_product(slope, x));
                *place = sum;
            }
        }
    }

    /// Adds to how v̇_i of the stage moves with a number.
    pub fn add(&mut self, number: usize, i: usize, change: &Row, slope: &Row) {
        let place = &mut self.tangents[self.present][2 * self.n * number + self.n + i];
        place.add_product(slope, change);
    }

    /// Takes a state, and how it moves, to the end of the step.
    pub fn finish(&self, (state, h): (&mut State, f64), tangents: Option<&mut Tangents>) {
        let shares = || self.method.end().iter().map(|share| h * share);
        for (share, rate) in shares().zip(&self.rates) {
            state.iter_mut().zip(rate).for_each(|(x, rate)| x.add_scaled(share, rate));
        }
        let Some(tangents) = tangents else { return };
        let width = 2 * self.n;
        for (number, moved) in tangents.each_mut().enumerate() {
            for (share, rate) in shares().zip(&self.tangents) {
                let rate = &rate[number * width..][..width];
                moved.iter_mut().zip(rate).for_each(|(x, rate)| x.add_scaled(share, rate));
            }
        }
    }
}
