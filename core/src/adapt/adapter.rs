use super::balance::{Balance, Terms, Window};
use super::filter::{Filter, Measurement};
use super::number::{Moment, Number, columns};
use crate::forces::{Coefficient, Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::add_scaled;
use crate::scalar::Real;

/// Settings of an [`Adapter`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning<R, const N: usize, const P: usize> {
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
    /// Dry friction of every coordinate, if the laws have any: at rest it may be anything up to this level, N or N m, and the rows count for
    /// less.
    pub dry: Option<(Coefficient, [R; N])>,
}

/// Numbers of a model that follow the machine: their distance δ from the model, estimated from the balance of momentum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adapter<R, const N: usize, const P: usize, const T: usize> {
    numbers: [Number; P],
    tuning: Tuning<R, N, P>,
    balance: Balance<R, N, P>,
    filter: Filter<R, P, T>,
}

/// How well a window agreed with the numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement<R> {
    /// Number of rows that were taken.
    pub rows: u8,
    /// Sum over these rows of the squared innovation over its variance: near `rows` if all is as assumed, less if errors last.
    pub squares: R,
}

impl<R: Real, const N: usize, const P: usize, const T: usize> Adapter<R, N, P, T> {
    /// Creates an adapter that has seen nothing.
    pub fn new(numbers: [Number; P], tuning: Tuning<R, N, P>) -> Self {
        let (balance, filter) = (Balance::new(tuning.half, tuning.h), Filter::new(tuning.prior));
        Self { numbers, tuning, balance, filter }
    }

    /// Numbers in the order of the estimate.
    pub fn numbers(&self) -> &[Number; P] {
        &self.numbers
    }

    /// Estimate of δ with its covariance.
    pub fn filter(&self) -> &Filter<R, P, T> {
        &self.filter
    }

    /// Takes a tick along the model as it was before any adaptation, and returns the agreement of the window that ends with it, if one does.
    pub fn take<L, F>(&mut self, system: &System<L, F>, moment: &Moment<R, N>) -> Option<Agreement<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let columns = columns(system, &self.numbers, moment);
        let Moment { q, v, force: tau, .. } = moment;
        let gradient = system.lagrangian.gradient(q, v);
        let friction = system.forces.force(q, v, tau);
        let force = add_scaled(&add_scaled(&gradient.l_q, R::one(), &friction), R::one(), tau);
        let uncertain = self.at_rest(system, v);
        let terms = Terms { columns: &columns, momentum: gradient.l_v, force, uncertain };
        let window = self.balance.take(&terms)?;
        Some(self.learn(&window))
    }

    /// Drops what was seen of the open windows: a reading was missing, or a drive did not do what it was told.
    pub fn skip(&mut self) {
        self.balance.drop_open();
    }

    /// Friction that rest leaves open, N or N m.
    fn at_rest<L, F: Forces<R, N>>(&self, system: &System<L, F>, v: &[R; N]) -> [R; N] {
        let mut open = [R::zero(); N];
        if let Some((coefficient, level)) = &self.tuning.dry {
            let slopes = system.forces.slopes(*coefficient, v);
            for ((open, level), slope) in open.iter_mut().zip(level).zip(slopes) {
                *open = *level * (R::one() - slope.abs()).max(R::zero());
            }
        }
        open
    }

    /// Takes the rows of a window.
    fn learn(&mut self, window: &Window<R, N, P>) -> Agreement<R> {
        let mut agreement = Agreement { rows: 0, squares: R::zero() };
        let Tuning { deviation, forgotten, .. } = self.tuning;
        let rows = window.rows.iter().zip(window.values).zip(window.uncertain).zip(deviation);
        for (((row, value), uncertain), deviation) in rows {
            let (own, open) = (deviation * deviation, uncertain + uncertain);
            let variance = own + open * open;
            // A coordinate at rest forgets as little as it teaches.
            let forgotten = forgotten * (own / variance);
            let measurement = Measurement { row, value, variance, forgotten };
            if let Some(innovation) = self.filter.take(&measurement) {
                agreement.rows += 1;
                agreement.squares += innovation.normalised_square();
            }
        }
        agreement
    }
}
