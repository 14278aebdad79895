//! End of a step with contacts: the momentum that friction and strikes leave.

use super::{Contact, Motion, slack};
use crate::dynamics::interval::{Balance, Integrals, Interval};
use crate::dynamics::{Failures, Lu};
use crate::row::{Row, WIDTH};

/// End of a step.
pub(crate) struct End {
    /// p₁, n rows.
    pub momentum: Vec<Row>,
    pub strikes: Vec<Strike>,
    pub failed: Failures,
}

/// A coordinate that ends a step on a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strike {
    pub coordinate: usize,
    pub sample: usize,
    /// e, or 0 if it stays there.
    pub restitution: f64,
    /// Gain of its velocity over the step, over the velocity of the strike; 0 if it stays there.
    pub gain: f64,
}

/// Momenta before friction and stops act at the end, and their differences to those at the start; n rows each.
pub(crate) struct Before {
    pub momentum: Vec<Row>,
    pub gain: Vec<Row>,
}

/// Number of steps within which forces would give a coordinate the velocity of a strike, below which it does not bounce.
const SLOW: f64 = 4.0;

impl Contact {
    /// Momenta before friction and stops act at the end: p₀ plus the impulses of forces and of friction at the start.
    pub fn before_end(&self, p0: &[Row], balance: &Balance) -> Before {
        let impulse = |i: usize, sample: usize| {
            let needed = -(p0[i].0[sample] + balance.d1_ld[i].0[sample]);
            if self.rests(i, sample) { needed } else { self.sliding(i, sample) }
        };
        let row =
            |i: usize| Row(std::array::from_fn(|sample| balance.impulse[i].0[sample] + impulse(i, sample)));
        let gain: Vec<Row> = (0..p0.len()).map(row).collect();
        let momentum = p0.iter().zip(&gain).map(|(p, gain)| p.zip(gain, |p, gain| p + gain)).collect();
        Before { momentum, gain }
    }

    /// Momenta p₁ at the end of a path, from those before friction and stops act there: velocities M(q₁)⁻¹p₁ and impulses Λ⁺ that agree.
    pub fn end(mut self, integrals: &mut Integrals, weights: &[f64], path: &Interval, before: Before) -> End {
        let (n, zero) = (path.q0.len(), vec![Row::default(); path.q0.len()]);
        let mut end = path.q0.clone();
        end.iter_mut().zip(&path.w).for_each(|(q, w)| q.add_scaled(integrals.h, w));
        integrals.differentiate(weights, [&end, &zero, &zero]);
        let (momentum, failed) = (before.momentum.clone(), Failures::default());
        let mut found = End { momentum, strikes: Vec::new(), failed };
        let mut lu = Lu::default();
        self.revisions = [0; WIDTH];
        for sample in 0..WIDTH {
            let mass = |i: usize, j: usize| integrals.momentum_columns(j)[1][i].0[sample];
            let of = [&before.momentum, &before.gain];
            let [momentum, gain] = of.map(|rows| rows.iter().map(|row| row.0[sample]).collect::<Vec<_>>());
            let before = (&mass as &dyn Fn(usize, usize) -> f64, [&*momentum, &*gain]);
            let strikes = self.strikes(sample, &mut lu, before);
            let momentum = strikes.as_deref().and_then(|of| self.sample_end(sample, &mut lu, before, of));
            found.strikes.extend(strikes.into_iter().flatten().map(|(strike, _)| strike));
            found.failed.0[sample] = momentum.is_none();
            let momentum = momentum.unwrap_or_else(|| vec![f64::NAN; n]);
            found.momentum.iter_mut().zip(momentum).for_each(|(row, p)| row.0[sample] = p);
        }
        found
    }

    /// The momentum of one sample; `None` if M is singular or no motions agree.
    fn sample_end(
        &mut self,
        sample: usize,
        lu: &mut Lu,
        (mass, [before, _]): AtEnd,
        strikes: &[(Strike, f64)],
    ) -> Option<Vec<f64>> {
        let n = before.len();
        let mut leaving = vec![0.0; n];
        strikes.iter().for_each(|(strike, v)| leaving[strike.coordinate] = -strike.restitution * v);
        loop {
            let is_held: Vec<bool> = (0..n).map(|i| self.is_held(i, sample)).collect();
            let slides = |i: usize| before[i] + self.sliding(i, sample);
            let v = velocities(lu, (mass, &is_held), |i| if is_held[i] { leaving[i] } else { slides(i) })?;
            let p: Vec<f64> = (0..n).map(|i| (0..n).map(|j| mass(i, j) * v[j]).sum()).collect();
            let momentum: Vec<f64> = (0..n).map(|i| if is_held[i] { p[i] } else { slides(i) }).collect();
            if momentum.iter().any(|p| !p.is_finite()) || !self.may_be_revised(sample) {
                return None;
            }
            let known = |i: usize| [v[i], p[i] - before[i], slack(p[i].abs() + before[i].abs())];
            if !self.revise_by(sample, |own, i| own.agreeing_at_end(i, sample, known(i))) {
                return Some(momentum);
            }
        }
    }

    /// Coordinates that end on a stop, each with the velocity of its strike in a motion in which what rests stays at rest; `None` if M is
    /// singular.
    fn strikes(
        &self,
        sample: usize,
        lu: &mut Lu,
        (mass, [before, gain]): AtEnd,
    ) -> Option<Vec<(Strike, f64)>> {
        let n = before.len();
        let is_on_stop = |i: &usize| matches!(self.motion[*i][sample], Motion::AtLower | Motion::AtUpper);
        let strikes = |i: usize| is_on_stop(&i) && !self.rests(i, sample);
        let rests: Vec<bool> = (0..n).map(|i| self.rests(i, sample)).collect();
        let (mut v, mut gained) = (vec![0.0; n], vec![0.0; n]);
        if (0..n).any(strikes) {
            let mut of = |p: &[f64]| velocities(lu, (mass, &rests), |i| if rests[i] { 0.0 } else { p[i] });
            (v, gained) = (of(before)?, of(gain)?);
        }
        let strike = |i: usize| {
            let bounces = strikes(i) && v[i].abs() > SLOW * gained[i].abs();
            let restitution = if bounces { self.stops[2][i].0[sample] } else { 0.0 };
            let gain = if bounces { gained[i] / v[i] } else { 0.0 };
            (Strike { coordinate: i, sample, restitution, gain }, v[i])
        };
        Some((0..n).filter(is_on_stop).map(strike).collect())
    }

    /// The motion of coordinate i that agrees with its velocity at the end or, where that is given, with the impulse that this needs.
    fn agreeing_at_end(&self, i: usize, sample: usize, [v, needed, known_to]: [f64; 3]) -> Motion {
        let [forward, backward, breakaway] = self.grip(i, sample);
        let hold = |level: f64| if self.rests(i, sample) { breakaway * level } else { 0.0 } + known_to;
        match self.motion[i][sample] {
            Motion::Sticks | Motion::AtLower if needed < -hold(forward) => self.moving(i, 1.0, sample),
            Motion::Sticks | Motion::AtUpper if needed > hold(backward) => self.moving(i, -1.0, sample),
            Motion::Forward if v < 0.0 => Motion::Sticks,
            Motion::Backward if v > 0.0 => Motion::Sticks,
            same => same,
        }
    }
}

/// Mass matrix of a sample at the end of a step, its momentum before friction and stops act there, and that momentum's gain.
type AtEnd<'a> = (&'a dyn Fn(usize, usize) -> f64, [&'a [f64]; 2]);

/// Velocities of which those that are given equal the right-hand side, and the others have it as their momentum; `None` if M is singular.
fn velocities(
    lu: &mut Lu,
    (mass, are_given): (&dyn Fn(usize, usize) -> f64, &[bool]),
    right: impl Fn(usize) -> f64,
) -> Option<Vec<f64>> {
    let row = |i: usize, j: usize| if are_given[i] { f64::from(u8::from(i == j)) } else { mass(i, j) };
    lu.factor(are_given.len(), row).then(|| lu.solve(right).to_vec())
}
