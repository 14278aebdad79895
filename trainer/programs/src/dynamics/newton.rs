use super::contact::Contact;
use super::interval::{Balance, Integrals, Interval, Linearised};
use super::{Failures, Lu};
use crate::row::{Row, WIDTH};

/// Limits of Newton's method, as in [`leastaction_core::discrete::Newton`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newton {
    /// Maximum number of updates.
    pub max_iterations: usize,
    /// Relative residual at which the iteration stops.
    pub stop: f64,
    /// Largest relative residual of an accepted solution; above it, the sample fails.
    pub accept: f64,
}

/// Ratio of two successive residuals above which a new matrix is computed.
const SLOW: f64 = 0.05;

/// Factors of every sample's matrix.
pub(crate) type Factors = Vec<Lu>;

/// Progress of each sample.
struct Progress {
    residual: [f64; WIDTH],
    done: [bool; WIDTH],
    failed: Failures,
    /// Whether the motions of coordinates that may stick agree with the path.
    agrees: [bool; WIDTH],
}

/// A balance, the last one with derivatives, and the path of the balance.
type At<'a> = (&'a Balance, &'a Linearised, &'a Interval);

/// Equations of an interval, either with both ends given (`p0` is `None`) or with an unknown end.
pub(crate) struct Equations<'i> {
    pub integrals: &'i mut Integrals,
    pub weights: &'i [f64],
    pub p0: Option<&'i [Row]>,
    /// Motions of coordinates that may stick or strike a stop.
    pub contact: Option<Contact>,
}

impl Equations<'_> {
    /// Number of unknowns of a sample.
    fn count(&self, n: usize) -> usize {
        match (self.p0, self.integrals.order.has_bubble()) {
            (Some(_), true) => 2 * n,
            (Some(_), false) | (None, true) => n,
            (None, false) => 0,
        }
    }

    /// Residual of equation i at a balance. Where a coordinate is held, the equations give w_i and s_i = 0, in the units of those that they replace.
    fn left(&self, (balance, linearised, path): At, i: usize, sample: usize) -> f64 {
        let n = balance.d1_ld.len();
        let (of_momentum, k) = (self.p0.is_some() && i < n, i % n);
        let Some(contact) = &self.contact else { return self.balance(balance, i, sample) };
        let own = |diagonal: &[Row]| diagonal[k * n + k].0[sample];
        if of_momentum && contact.is_held(k, sample) {
            return own(&linearised.momentum_w) * (path.w[k].0[sample] - contact.increment(k, sample));
        }
        if !of_momentum && contact.is_straight(k, sample) {
            return own(&linearised.bubble_s) * path.s[k].0[sample];
        }
        let friction =
            if of_momentum { contact.sliding(k, sample) } else { contact.sliding_bubble(k, sample) };
        self.balance(balance, i, sample) + friction
    }

    /// Sum of the terms of equation i without friction that sticks.
    fn balance(&self, balance: &Balance, i: usize, sample: usize) -> f64 {
        let n = balance.d1_ld.len();
        match self.p0 {
            Some(p0) if i < n => p0[i].0[sample] + balance.d1_ld[i].0[sample],
            Some(_) => balance.dm_ld[i - n].0[sample],
            None => balance.dm_ld[i].0[sample],
        }
    }

    /// Compares the motions of the samples that are not done with a path; returns those whose motions were revised. Between two given ends the
    /// increments tell the motions: no momentum at the start is given that would tell an impulse.
    fn revise(&mut self, (balance, linearised, path): At, done: &[bool; WIDTH]) -> [bool; WIDTH] {
        let (Some(p0), Some(contact)) = (self.p0, &mut self.contact) else { return [false; WIDTH] };
        std::array::from_fn(|sample| {
            let of = |i: usize| {
                let p0 = p0[i].0[sample];
                [
                    path.w[i].0[sample],
                    -(p0 + balance.d1_ld[i].0[sample]),
                    linearised.scale[i].0[sample] + p0.abs(),
                ]
            };
            !done[sample] && contact.revise(sample, of)
        })
    }

    /// Factors the matrices of all samples; those with a singular matrix fail.
    pub fn factor(&self, linearised: &Linearised, factors: &mut Factors) -> Failures {
        let n = linearised.scale.len();
        let mut failures = Failures::default();
        factors.resize_with(WIDTH, Lu::default);
        for (sample, lu) in factors.iter_mut().enumerate() {
            let free = self.p0.is_some();
            let is_given = |contact: &Contact, i: usize| match free && i < n {
                true => contact.is_held(i, sample),
                false => contact.is_straight(i % n, sample),
            };
            failures.0[sample] = !lu.factor(self.count(n), |i, j| {
                let of = match (free && i < n, free && j < n) {
                    (true, true) => &linearised.momentum_w,
                    (true, false) => &linearised.momentum_s,
                    (false, true) => &linearised.bubble_w,
                    (false, false) => &linearised.bubble_s,
                };
                match &self.contact {
                    Some(contact) if is_given(contact, i) && i != j => 0.0,
                    _ => of[i % n * n + j % n].0[sample],
                }
            });
        }
        failures
    }

    /// Measures the residuals of the samples that are not done, after revising their motions; returns whether any was revised.
    fn measure(&mut self, at: At, newton: &Newton, progress: &mut Progress, first: bool) -> bool {
        let revised = self.revise(at, &progress.done);
        let scale = &at.1.scale;
        let n = scale.len();
        for (sample, revised) in revised.into_iter().enumerate() {
            if progress.done[sample] {
                continue;
            }
            let mut worst = 0.0_f64;
            for i in 0..self.count(n) {
                let p0 = self.p0.map_or(0.0, |p0| p0[i % n].0[sample].abs());
                let size = scale[i % n].0[sample] + p0 + f64::MIN_POSITIVE;
                let off = self.left(at, i, sample).abs() / size;
                worst = if off.is_finite() { worst.max(off) } else { f64::NAN };
            }
            let before = std::mem::replace(&mut progress.residual[sample], worst);
            let floor = !first && worst <= newton.accept && worst > 0.5 * before;
            progress.done[sample] = worst.is_nan() || (!revised && (worst <= newton.stop || floor));
            progress.failed.0[sample] |= worst.is_nan();
            progress.agrees[sample] = !revised;
        }
        revised.contains(&true)
    }
}

impl Newton {
    /// Solves an interval from a guess by repeated updates, until the residual of every sample vanishes or cannot be
    /// reduced further. A matrix is reused as long as the residuals fall fast.
    pub(crate) fn solve(
        &self,
        equations: &mut Equations,
        interval: &mut Interval,
        factors: &mut Factors,
    ) -> (Balance, Failures) {
        let mut progress = Progress {
            residual: [f64::INFINITY; WIDTH],
            done: [false; WIDTH],
            failed: Failures::default(),
            agrees: [true; WIDTH],
        };
        if equations.count(interval.q0.len()) == 0 {
            return (equations.integrals.balance(equations.weights, interval), progress.failed);
        }
        let mut linearised = equations.integrals.linearise(equations.weights, interval);
        equations.measure((&linearised.balance, &linearised, interval), self, &mut progress, true);
        let mut balance = linearised.balance.clone();
        let mut singular = equations.factor(&linearised, factors);
        let bends = equations.integrals.bends(equations.weights);
        for _ in 0..self.max_iterations {
            progress.failed =
                progress.failed.or(Failures(std::array::from_fn(|k| singular.0[k] && !progress.done[k])));
            (0..WIDTH).for_each(|k| progress.done[k] |= progress.failed.0[k]);
            if progress.done.iter().all(|done| *done) {
                break;
            }
            let before = progress.residual;
            let matrix = (&mut *factors, &linearised, bends.as_deref());
            update(equations, &balance, interval, matrix, &progress.done);
            balance = equations.integrals.balance(equations.weights, interval);
            let revised = equations.measure((&balance, &linearised, interval), self, &mut progress, false);
            let slow =
                revised || (0..WIDTH).any(|k| !progress.done[k] && progress.residual[k] > SLOW * before[k]);
            if slow {
                linearised = equations.integrals.linearise(equations.weights, interval);
                singular = equations.factor(&linearised, factors);
            }
        }
        for k in 0..WIDTH {
            progress.failed.0[k] |= progress.residual[k].is_nan() || progress.residual[k] > self.accept;
            progress.failed.0[k] |= !progress.agrees[k];
        }
        (balance, progress.failed)
    }
}

/// Updates w and s of the samples that are not done, as far as the matrix can be trusted where forces bend; for an
/// interval with given ends, only the late Gauss point limits the update.
fn update(
    equations: &Equations,
    balance: &Balance,
    interval: &mut Interval,
    (factors, linearised, bends): (&mut Factors, &Linearised, Option<&[Row]>),
    done: &[bool; WIDTH],
) {
    let (n, order, is_free) = (interval.q0.len(), equations.integrals.order, equations.p0.is_some());
    let mut mended = Lu::default();
    for (sample, lu) in factors.iter_mut().enumerate().filter(|(sample, _)| !done[*sample]) {
        let left = |i: usize| equations.left((balance, linearised, &*interval), i, sample);
        let mut change = lu.solve(left);
        if !is_free && !leads_on(change, left) && without_early_friction(linearised, sample, &mut mended) {
            change = mended.solve(left);
        }
        let (of_w, of_s) = if is_free { change.split_at(n) } else { (&[][..], change) };
        let points = order.points().iter().filter(|point| is_free || !point.is_early());
        let part = bends.map_or(1.0, |bends| interval.trusted_part(points, bends, [of_w, of_s], sample));
        interval.w.iter_mut().zip(of_w).for_each(|(w, change)| w.0[sample] -= part * change);
        interval.s.iter_mut().zip(of_s).for_each(|(s, change)| s.0[sample] -= part * change);
        // To the last bit, which the solution of the linear equations is not.
        equations.contact.iter().for_each(|contact| contact.settle(interval, sample));
    }
}

/// Whether a change of the bubble between two given ends points in the direction of its equation's residual.
///
/// A growing bubble speeds up the early Gauss point and slows down the late one. Friction at the late point therefore
/// opposes the growth, as inertia does, but friction at the early point supports it. Where the early friction bends
/// sharply, the equation is not monotonic, and an update may have the wrong direction. The update is then repeated
/// without the derivative of the early friction, which gives the right direction, though it may converge more slowly.
fn leads_on(change: &[f64], left: impl Fn(usize) -> f64) -> bool {
    change.iter().enumerate().map(|(i, change)| change * left(i)).sum::<f64>() > 0.0
}

/// Factors the matrix of a bubble between two given ends without the derivative of the early friction; returns `false` if it is singular.
fn without_early_friction(linearised: &Linearised, sample: usize, lu: &mut Lu) -> bool {
    let n = linearised.scale.len();
    let of = |rows: &[Row], i: usize, j: usize| rows[i * n + j].0[sample];
    lu.factor(n, |i, j| of(&linearised.bubble_s, i, j) - of(&linearised.early_force_s, i, j))
}
