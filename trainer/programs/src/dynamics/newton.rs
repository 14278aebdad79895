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
}

/// Equations of an interval, either with both ends given (`p0` is `None`) or with an unknown end.
pub(crate) struct Equations<'i> {
    pub integrals: &'i mut Integrals,
    pub weights: &'i [f64],
    pub p0: Option<&'i [Row]>,
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

    /// Residual of equation i at a balance.
    fn left(&self, balance: &Balance, i: usize, sample: usize) -> f64 {
        let n = balance.d1_ld.len();
        match self.p0 {
            Some(p0) if i < n => p0[i].0[sample] + balance.d1_ld[i].0[sample],
            Some(_) => balance.dm_ld[i - n].0[sample],
            None => balance.dm_ld[i].0[sample],
        }
    }

    /// Factors the matrices of all samples; those with a singular matrix fail.
    pub fn factor(&self, linearised: &Linearised, factors: &mut Factors) -> Failures {
        let n = linearised.scale.len();
        let mut failures = Failures::default();
        factors.resize_with(WIDTH, Lu::default);
        for (sample, lu) in factors.iter_mut().enumerate() {
            let free = self.p0.is_some();
            failures.0[sample] = !lu.factor(self.count(n), |i, j| {
                let of = match (free && i < n, free && j < n) {
                    (true, true) => &linearised.momentum_w,
                    (true, false) => &linearised.momentum_s,
                    (false, true) => &linearised.bubble_w,
                    (false, false) => &linearised.bubble_s,
                };
                of[i % n * n + j % n].0[sample]
            });
        }
        failures
    }

    fn measure(
        &self,
        balance: &Balance,
        scale: &[Row],
        newton: &Newton,
        progress: &mut Progress,
        first: bool,
    ) {
        let n = scale.len();
        for sample in 0..WIDTH {
            if progress.done[sample] {
                continue;
            }
            let mut worst = 0.0_f64;
            for i in 0..self.count(n) {
                let p0 = self.p0.map_or(0.0, |p0| p0[i % n].0[sample].abs());
                let size = scale[i % n].0[sample] + p0 + f64::MIN_POSITIVE;
                let off = self.left(balance, i, sample).abs() / size;
                worst = if off.is_finite() { worst.max(off) } else { f64::NAN };
            }
            let before = std::mem::replace(&mut progress.residual[sample], worst);
            let floor = !first && worst <= newton.accept && worst > 0.5 * before;
            progress.done[sample] = worst <= newton.stop || floor || worst.is_nan();
            progress.failed.0[sample] |= worst.is_nan();
        }
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
        let mut progress =
            Progress { residual: [f64::INFINITY; WIDTH], done: [false; WIDTH], failed: Failures::default() };
        if equations.count(interval.q0.len()) == 0 {
            return (equations.integrals.balance(equations.weights, interval), progress.failed);
        }
        let mut linearised = equations.integrals.linearise(equations.weights, interval);
        equations.measure(&linearised.balance, &linearised.scale, self, &mut progress, true);
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
            equations.measure(&balance, &linearised.scale, self, &mut progress, false);
            let slow = (0..WIDTH).any(|k| !progress.done[k] && progress.residual[k] > SLOW * before[k]);
            if slow {
                linearised = equations.integrals.linearise(equations.weights, interval);
                singular = equations.factor(&linearised, factors);
            }
        }
        for k in 0..WIDTH {
            progress.failed.0[k] |= progress.residual[k].is_nan() || progress.residual[k] > self.accept;
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
        let left = |i: usize| equations.left(balance, i, sample);
        let mut change = lu.solve(left);
        if !is_free && !leads_on(change, left) && without_early_friction(linearised, sample, &mut mended) {
            change = mended.solve(left);
        }
        let (of_w, of_s) = if is_free { change.split_at(n) } else { (&[][..], change) };
        let points = order.points().iter().filter(|point| is_free || !point.is_early());
        let part = bends.map_or(1.0, |bends| interval.trusted_part(points, bends, [of_w, of_s], sample));
        interval.w.iter_mut().zip(of_w).for_each(|(w, change)| w.0[sample] -= part * change);
        interval.s.iter_mut().zip(of_s).for_each(|(s, change)| s.0[sample] -= part * change);
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
