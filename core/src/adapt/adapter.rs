use super::balance::{Balance, Row, Terms};
use super::filter::{Filter, Measurement};
use super::limits::{Limits, MOVES};
use super::number::{Moment, Number, columns};
use super::unfit::{Unfit, check};
use super::verdict::Changes;
use crate::forces::{Coefficient, Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::add_scaled;
use crate::scalar::Real;

/// Numbers that follow, and how: what an [`Adapter`] is told at every tick. It never changes, so that it may lie in flash.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning<R, const N: usize, const P: usize> {
    /// Numbers in the order of the estimate.
    pub numbers: [Number; P],
    /// Ticks of half a window. A window of 50 to 200 ms suits a fast loop; a slow one needs at least some 20 ticks.
    pub half: u16,
    /// Tick, s.
    pub h: R,
    /// Standard deviation of the balance over a window as far as the numbers do not explain it, for every coordinate, N or N m, above 0.
    /// Errors of a model last longer than a window: the deviation is that of independent windows with as much noise in their mean.
    pub deviation: [R; N],
    /// Standard deviation of every number's distance from the model, before anything was seen; 0 for a number that stays.
    pub prior: [R; P],
    /// Share of the knowledge along a row that is forgotten before the row is taken, from 0 to below 1: about h half over the time that is
    /// to be remembered.
    pub forgotten: R,
    /// Variance that every number gains in a second, up to that of its prior, whether it is excited or not: the square of how far friction
    /// goes as grease warms up. 0 for a number that changes at once or never.
    pub walk: [R; P],
    /// Threshold of [`Changes`]: at 50, independent errors are taken for a change about once in 10⁸ windows.
    pub change: R,
    /// Limits of the numbers in use.
    pub limits: Limits<R, P>,
    /// Dry friction of every coordinate, if the laws have any: at rest it may be anything up to this level, N or N m, and the rows count for
    /// less.
    pub dry: Option<(Coefficient, [R; N])>,
}

/// Numbers of a model that follow the machine: their distance δ from the model, estimated from the balance of momentum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adapter<R, const N: usize, const P: usize, const T: usize> {
    balance: Balance<R, N, P>,
    filter: Filter<R, P, T>,
    changes: Changes<R>,
    /// Agreement of the rows since the last coordinate's window ended.
    open: Agreement<R>,
    due: Due,
    /// The number that walks next.
    turn: u8,
    /// Limited estimate, which the distances in use approach; while there is work due to the limits, an estimate on its way there.
    target: [R; P],
    applied: [R; P],
    /// Balance of the model itself over the last windows, N or N m.
    residuals: [R; N],
    /// Variance of the balance of every coordinate as it is found, at least that of the tuning.
    noise: [R; N],
}

/// Work that would make the tick at the end of a window too long: one piece a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Due {
    Nothing,
    /// The limited estimate becomes the target, after at most this number of moves, one a tick.
    Limits(u8),
    /// All is known as little as at first: something has changed at once.
    Loosening,
    /// The next number walks.
    Walk,
}

/// How well windows of all coordinates agreed with the numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement<R> {
    /// Number of rows that were taken.
    pub rows: u8,
    /// Sum over these rows of the squared innovation over its variance: near `rows` if all is as assumed, less if errors last.
    pub squares: R,
    /// Whether something has changed at once.
    pub changed: bool,
}

impl<R: Real> Agreement<R> {
    fn none() -> Self {
        Self { rows: 0, squares: R::zero(), changed: false }
    }
}

impl<R: Real, const N: usize, const P: usize> Tuning<R, N, P> {
    /// Windows that are remembered: 1/(share that is forgotten), at most 65,535.
    fn memory(&self) -> u16 {
        let (mut count, mut rest) = (1, self.forgotten);
        while rest < R::one() && count < u16::MAX / 2 {
            (count, rest) = (2 * count, rest + rest);
        }
        count
    }

    /// Part of their way that numbers in use go in a tick.
    fn pace(&self) -> R {
        R::one() / R::constant(f64::from(self.half.max(1)))
    }

    /// Friction that rest leaves open, N or N m.
    fn at_rest<L, F: Forces<R, N>>(&self, system: &System<L, F>, v: &[R; N]) -> [R; N] {
        let mut open = [R::zero(); N];
        if let Some((coefficient, level)) = &self.dry {
            let slopes = system.forces.slopes(*coefficient, v);
            for ((open, level), slope) in open.iter_mut().zip(level).zip(slopes) {
                *open = *level * (R::one() - slope.abs()).max(R::zero());
            }
        }
        open
    }
}

impl<R: Real, const N: usize, const P: usize, const T: usize> Adapter<R, N, P, T> {
    /// Creates an adapter that has seen nothing; every method takes the same tuning.
    ///
    /// # Errors
    /// See [`Unfit`].
    pub fn new(tuning: &Tuning<R, N, P>) -> Result<Self, Unfit> {
        check(&tuning.numbers, N)?;
        Ok(Self {
            balance: Balance::new(tuning.half, tuning.h),
            filter: Filter::new(tuning.prior),
            changes: Changes::new(tuning.change, tuning.memory(), R::zero()),
            open: Agreement::none(),
            due: Due::Nothing,
            turn: 0,
            target: [R::zero(); P],
            applied: [R::zero(); P],
            residuals: [R::zero(); N],
            noise: tuning.deviation.map(|deviation| deviation * deviation),
        })
    }

    /// Estimate of δ with its covariance, without regard to limits.
    pub fn filter(&self) -> &Filter<R, P, T> {
        &self.filter
    }

    /// Distances δ that the model in use has from the model of the file: within the limits, and never in a jump. They approach the estimate with
    /// a time constant of half a window.
    pub fn applied(&self) -> &[R; P] {
        &self.applied
    }

    /// Balance of the model without any adaptation over the last windows, N or N m: 0 for a model that explains the machine.
    pub fn residuals(&self) -> &[R; N] {
        &self.residuals
    }

    /// Begins with known distances within the limits; what is known of them is what the prior says.
    pub fn begin_at(&mut self, tuning: &Tuning<R, N, P>, distances: [R; P]) {
        let begun: Filter<R, P, T> = Filter::at(distances, tuning.prior);
        let limited = tuning.limits.within(&tuning.numbers, &begun);
        self.filter = Filter::at(limited, tuning.prior);
        (self.target, self.applied) = (limited, limited);
    }

    /// Whether the machine is not the one that was learned: changes follow each other, and no choice of the numbers explains them.
    pub fn unlike(&self) -> bool {
        self.changes.unlike()
    }

    /// Takes a tick along the model as it is without any adaptation. Returns what was learned since the last time if the window of the last
    /// coordinate ends with it.
    #[inline(never)]
    pub fn take<L, F>(
        &mut self,
        tuning: &Tuning<R, N, P>,
        system: &System<L, F>,
        moment: &Moment<R, N>,
    ) -> Option<Agreement<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        self.go_on(tuning);
        let columns = columns(system, &tuning.numbers, moment);
        let Moment { q, v, force: tau, .. } = moment;
        let gradient = system.lagrangian.gradient(q, v);
        let friction = system.forces.force(q, v, tau);
        let force = add_scaled(&add_scaled(&gradient.l_q, R::one(), &friction), R::one(), tau);
        let uncertain = tuning.at_rest(system, v);
        let terms = Terms { columns: &columns, momentum: gradient.l_v, force, uncertain };
        let Self { balance, filter, open, residuals, noise, .. } = self;
        let mut learner = Learner { tuning, filter, open, residuals, noise };
        let mut ended = false;
        balance.take(&terms, |i, row| {
            ended |= i + 1 == N;
            _ = row.and_then(|row| learner.learn(i, &row));
        });
        if ended { self.close() } else { None }
    }

    /// Passes a tick of which nothing can be learned, and drops what was seen of the open windows: a reading was missing, or a drive did not do
    /// what it was told. The numbers in use go on towards the estimate.
    pub fn skip(&mut self, tuning: &Tuning<R, N, P>) {
        self.go_on(tuning);
        self.hold();
    }

    /// Passes a tick while the numbers are frozen: those in use stay what they are, and what was seen of the open windows is dropped.
    pub fn hold(&mut self) {
        self.balance.pass();
        self.open = Agreement::none();
    }

    /// Does a piece of the work that the last windows left, so that the next tick need not: where ticks are blocks of a faster loop, it has time
    /// between them.
    #[inline(never)]
    pub fn work(&mut self, tuning: &Tuning<R, N, P>) {
        match core::mem::replace(&mut self.due, Due::Nothing) {
            Due::Nothing => {}
            Due::Limits(left) => self.limit(tuning, left),
            Due::Loosening => {
                let prior = tuning.prior.iter().enumerate();
                prior.for_each(|(j, prior)| self.filter.loosen(j, *prior * *prior));
            }
            Due::Walk => self.walk(tuning),
        }
    }

    /// Ends the windows of all coordinates, and returns how well they agreed if any was whole.
    fn close(&mut self) -> Option<Agreement<R>> {
        let mut agreement = core::mem::replace(&mut self.open, Agreement::none());
        if agreement.rows == 0 {
            return None;
        }
        agreement.changed = self.changes.take(&agreement);
        self.due = Due::Limits(MOVES);
        if agreement.changed {
            // The open windows began before the change, and are neither of what was nor of what is.
            self.balance.drop_open();
            self.due = Due::Loosening;
        }
        Some(agreement)
    }

    /// Moves the estimate towards the limits, and makes it the target when it is within.
    fn limit(&mut self, tuning: &Tuning<R, N, P>, left: u8) {
        let limits = &tuning.limits;
        if left == MOVES {
            self.target = *self.filter.estimate();
        }
        if left > 0 && limits.approach(&tuning.numbers, &self.filter, &mut self.target) {
            self.due = Due::Limits(left - 1);
        } else {
            self.target = limits.forced(&tuning.numbers, self.target);
        }
    }

    /// Does work that is left, and moves the numbers in use on.
    fn go_on(&mut self, tuning: &Tuning<R, N, P>) {
        self.work(tuning);
        if matches!(self.due, Due::Limits(_)) {
            return;
        }
        self.due = Due::Walk;
        let pace = tuning.pace();
        for (applied, target) in self.applied.iter_mut().zip(self.target) {
            *applied += (target - *applied) * pace;
        }
    }

    /// Lets the next number that walks go on: one a tick, by as much as all of them take to come round.
    fn walk(&mut self, tuning: &Tuning<R, N, P>) {
        let Tuning { walk, prior, h, .. } = tuning;
        let walks = |(_, (walk, _)): &(usize, (&R, &R))| **walk > R::zero();
        let all = || walk.iter().zip(prior).enumerate().filter(walks);
        let next = all().find(|(j, _)| *j >= usize::from(self.turn)).or_else(|| all().next());
        let Some((j, (walk, prior))) = next else { return };
        self.turn = (j + 1) as u8;
        if self.filter.variance(j) < *prior * *prior {
            let round = all().fold(R::zero(), |ticks, _| ticks + R::one());
            self.filter.loosen(j, *walk * *h * round);
        }
    }
}

/// State that the row of a coordinate changes.
struct Learner<'l, R, const N: usize, const P: usize, const T: usize> {
    tuning: &'l Tuning<R, N, P>,
    filter: &'l mut Filter<R, P, T>,
    open: &'l mut Agreement<R>,
    residuals: &'l mut [R; N],
    noise: &'l mut [R; N],
}

impl<R: Real, const N: usize, const P: usize, const T: usize> Learner<'_, R, N, P, T> {
    /// Takes the row of coordinate i.
    fn learn(&mut self, i: usize, row: &Row<R, P>) -> Option<()> {
        *self.residuals.get_mut(i)? = row.value;
        let (noise, deviation) = (self.noise.get_mut(i)?, *self.tuning.deviation.get(i)?);
        let open = row.uncertain + row.uncertain;
        let variance = *noise + open * open;
        // A coordinate at rest forgets as little as it teaches.
        let share = *noise / variance;
        let forgotten = self.tuning.forgotten * share;
        let largest = R::constant(f64::from(LARGEST));
        let measurement = Measurement { row: &row.columns, value: row.value, variance, largest, forgotten };
        let square = self.filter.take(&measurement)?.normalised_square();
        self.open.rows += 1;
        self.open.squares += square;
        *noise = adjusted((*noise, deviation), square, share);
        Some(())
    }
}

/// Number of windows over which the variance of the balance is found.
const NOTICED: u8 = 8;
/// Largest square of an innovation, over its variance, that counts fully: what is larger has another cause.
const LARGEST: u8 = 9;

/// The variance of the balance after an innovation of this square over its own variance. It grows where the numbers are far from the model's,
/// because the noise of velocities counts as many times as the inertia is greater, and is never below the square of the deviation.
fn adjusted<R: Real>((noise, deviation): (R, R), square: R, share: R) -> R {
    let [largest, windows] = [LARGEST, NOTICED].map(|count| R::constant(f64::from(count)));
    let square = if square < largest { square } else { largest };
    let adjusted = noise + noise * share * (square - R::one()) / windows;
    adjusted.max(deviation * deviation)
}
