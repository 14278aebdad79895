use super::Failures;
use super::contact::{Before, Contact, Strike};
use super::interval::{Balance, Integrals, Interval, Order};
use super::newton::{Equations, Factors, Newton};
use crate::program::{Program, Workspace};
use crate::row::{Row, WIDTH};
use crate::system::System;

/// Number of past increments from which the guess of the next one is extrapolated.
const HISTORY: usize = 3;

/// Variational integrator of a system, for samples side by side.
#[derive(Clone, Debug)]
pub struct Del {
    /// Intervals without the laws of contacts.
    integrals: Integrals,
    /// Friction that sticks and end stops, if there are any.
    contacts: Option<Contacts>,
    newton: Newton,
    factors: Factors,
}

/// Friction that sticks and end stops.
#[derive(Clone, Debug)]
struct Contacts {
    /// Levels and stops.
    laws: (Program, Workspace),
    /// Intervals with the smooth law of the friction, and without stops.
    smooth: Integrals,
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
    /// Coordinates that ended the last step on a stop.
    pub(crate) strikes: Vec<Strike>,
    /// Samples that could not be solved, in this step or an earlier one.
    pub failed: Failures,
}

impl Del {
    /// Creates an integrator with step h > 0, s.
    pub fn new(system: &System, h: f64, order: Order, newton: Newton) -> Self {
        let smooth = Integrals::new(system, h, order);
        let Some((sliding, laws)) = system.contacts() else {
            return Self { integrals: smooth, contacts: None, newton, factors: Factors::new() };
        };
        let contacts = Some(Contacts { laws: laws.with_workspace(), smooth });
        Self { integrals: Integrals::new(&sliding, h, order), contacts, newton, factors: Factors::new() }
    }

    /// Intervals with the smooth law of friction that sticks and without stops, for derivatives.
    pub(crate) fn smooth(&mut self) -> &mut Integrals {
        self.contacts.as_mut().map_or(&mut self.integrals, |contacts| &mut contacts.smooth)
    }

    /// Step h, s.
    pub(crate) fn h(&self) -> f64 {
        self.integrals.h
    }

    /// Order of the steps.
    pub(crate) fn order(&self) -> Order {
        self.integrals.order
    }

    /// Solves an interval: its balance without contacts, the motions of coordinates that may stick or strike a stop, and failures.
    fn solve(
        &mut self,
        weights: &[f64],
        (interval, p0): (&mut Interval, Option<&[Row]>),
    ) -> (Balance, Option<Contact>, Failures) {
        let how = (self.integrals.h, self.integrals.order);
        let contact = self.contacts.as_mut().map(|of| Contact::new(&mut of.laws, weights, how, interval));
        let mut equations = Equations { integrals: &mut self.integrals, weights, p0, contact };
        let (balance, failed) = self.newton.solve(&mut equations, interval, &mut self.factors);
        (balance, equations.contact, failed)
    }

    /// Returns the state at q₁ that is determined by two positions and the controls at them.
    pub fn start(&mut self, weights: &[f64], [q0, q1]: [&[Row]; 2], tau: [&[Row]; 2]) -> DelState {
        let h = self.integrals.h;
        let w: Vec<Row> = q0.iter().zip(q1).map(|(a, b)| b.zip(a, |b, a| (b - a) / h)).collect();
        let mut interval = Interval::new(q0, &w, tau);
        let (balance, contact, failed) = self.solve(weights, (&mut interval, None));
        let (mut p, mut failed) = (balance.end_momentum(), failed);
        if let Some(contact) = contact {
            let before = Before { gain: p.clone(), momentum: p };
            let end = contact.end(&mut self.integrals, weights, &interval, before);
            (p, failed) = (end.momentum, failed.or(end.failed));
        }
        DelState { q: q1.to_vec(), p, history: vec![[w, interval.s]], failed, ..DelState::default() }
    }

    /// Returns the state with these positions and velocities: p = L_v(q, v).
    pub fn start_at(&mut self, weights: &[f64], q: &[Row], v: &[Row]) -> DelState {
        let p = self.integrals.momentum(weights, q, v);
        let straight = [v.to_vec(), vec![Row::default(); q.len()]];
        DelState { q: q.to_vec(), p, history: vec![straight], ..DelState::default() }
    }

    /// Advances the state by one step, under controls τ at both of its ends. Failed samples are NaN from then on.
    pub fn step(&mut self, weights: &[f64], state: &mut DelState, tau: [&[Row]; 2]) {
        let [w, s] = state.guess();
        let mut interval = Interval { s, ..Interval::new(&state.q, &w, tau) };
        let (balance, contact, failed) = self.solve(weights, (&mut interval, Some(&state.p)));
        state.failed = state.failed.or(failed);
        for (q, w) in state.q.iter_mut().zip(&interval.w) {
            q.add_scaled(self.integrals.h, w);
        }
        match contact {
            None => {
                state.p.iter_mut().zip(&balance.impulse).for_each(|(p, impulse)| p.add_scaled(1.0, impulse))
            }
            Some(contact) => {
                let before = contact.before_end(&state.p, &balance);
                contact.land(&mut state.q);
                let end = contact.end(&mut self.integrals, weights, &interval, before);
                (state.p, state.failed) = (end.momentum, state.failed.or(end.failed));
                state.strikes = end.strikes;
            }
        }
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
