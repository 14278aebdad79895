use super::Failures;
use super::interval::{Integrals, Interval, Order};
use super::newton::{Equations, Factors, Newton};
use crate::row::{Row, WIDTH};
use crate::system::System;

/// Number of past increments from which the guess of the next one is extrapolated.
const HISTORY: usize = 3;

/// Variational integrator of a system, for samples side by side.
#[derive(Clone, Debug)]
pub struct Del {
    pub(crate) integrals: Integrals,
    newton: Newton,
    factors: Factors,
}

/// State of trajectories: positions, momenta and the paths of the last steps, n rows each.
#[derive(Clone, Debug, Default)]
pub struct DelState {
    /// Position q, m or rad.
    pub q: Vec<Row>,
    /// Momentum p = L_v.
    pub p: Vec<Row>,
    /// Paths (w, s) of the last steps, newest first.
    history: Vec<[Vec<Row>; 2]>,
    /// Samples that could not be solved, in this step or an earlier one.
    pub failed: Failures,
}

impl Del {
    /// Creates an integrator with step h > 0, s.
    pub fn new(system: &System, h: f64, order: Order, newton: Newton) -> Self {
        Self { integrals: Integrals::new(system, h, order), newton, factors: Factors::new() }
    }

    /// Returns the state at q₁ that is determined by two positions and the controls at them.
    pub fn start(&mut self, weights: &[f64], [q0, q1]: [&[Row]; 2], tau: [&[Row]; 2]) -> DelState {
        let h = self.integrals.h;
        let w: Vec<Row> = q0.iter().zip(q1).map(|(a, b)| b.zip(a, |b, a| (b - a) / h)).collect();
        let mut interval = Interval::new(q0, &w, tau);
        let mut equations = Equations { integrals: &mut self.integrals, weights, p0: None };
        let (balance, failed) = self.newton.solve(&mut equations, &mut interval, &mut self.factors);
        DelState { q: q1.to_vec(), p: balance.end_momentum(), history: vec![[w, interval.s]], failed }
    }

    /// Returns the state with these positions and velocities: p = L_v(q, v).
    pub fn start_at(&mut self, weights: &[f64], q: &[Row], v: &[Row]) -> DelState {
        let p = self.integrals.momentum(weights, q, v);
        let straight = [v.to_vec(), vec![Row::default(); q.len()]];
        DelState { q: q.to_vec(), p, history: vec![straight], failed: Failures::default() }
    }

    /// Advances the state by one step, under controls τ at both of its ends. Failed samples are NaN from then on.
    pub fn step(&mut self, weights: &[f64], state: &mut DelState, tau: [&[Row]; 2]) {
        let [w, s] = state.guess();
        let mut interval = Interval { s, ..Interval::new(&state.q, &w, tau) };
        let mut equations = Equations { integrals: &mut self.integrals, weights, p0: Some(&state.p) };
        let (balance, failed) = self.newton.solve(&mut equations, &mut interval, &mut self.factors);
        state.failed = state.failed.or(failed);
        for (q, w) in state.q.iter_mut().zip(&interval.w) {
            q.add_scaled(self.integrals.h, w);
        }
        state.p.iter_mut().zip(&balance.impulse).for_each(|(p, impulse)| p.add_scaled(1.0, impulse));
        state.history.insert(0, [interval.w, interval.s]);
        state.history.truncate(HISTORY);
        state.lose_failed();
    }
}

impl DelState {
    /// Path of the last step: w and s.
    pub(crate) fn last(&self) -> [&[Row]; 2] {
        self.history.first().map_or([&[], &[]], |[w, s]| [w, s])
    }

    /// Guess of w and s, extrapolated by polynomials through their last values.
    fn guess(&self) -> [Vec<Row>; 2] {
        let weights: &[f64] = match self.history.len() {
            0 | 1 => &[1.0],
            2 => &[2.0, -1.0],
            _ => &[3.0, -3.0, 1.0],
        };
        [0, 1].map(|part| {
            let mut sum = vec![Row::default(); self.q.len()];
            for (share, path) in weights.iter().zip(&self.history) {
                sum.iter_mut().zip(&path[part]).for_each(|(sum, x)| sum.add_scaled(*share, x));
            }
            sum
        })
    }

    fn lose_failed(&mut self) {
        for sample in (0..WIDTH).filter(|sample| self.failed.0[*sample]) {
            self.q.iter_mut().chain(&mut self.p).for_each(|row| row.0[sample] = f64::NAN);
        }
    }
}
