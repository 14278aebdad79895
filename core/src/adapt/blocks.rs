use super::Moment;
use crate::linear::add_scaled;
use crate::scalar::Real;

/// Moments of a fast loop, from its encoders alone: means over blocks of ticks, and velocities from the blocks before and after.
///
/// An observer's velocity follows its model, so a wrong model would explain its own motion. Over blocks of D ticks with the readings' deviation
/// σ, the velocity is known to σ/(√(2D) D h), and nothing of a model is in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blocks<R, const N: usize> {
    /// Ticks of a block, at least 1.
    ticks: u16,
    /// 1/(2Dh), 1/s.
    rate: R,
    /// Ticks of the open block, and their sums; `None` from a tick on that cannot be used.
    count: u16,
    sums: Option<Reading<R, N>>,
    /// The two blocks before.
    before: [Option<Reading<R, N>>; 2],
}

/// Readings at a tick, or their means over a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading<R, const N: usize> {
    /// Position, without jumps by whole turns.
    pub q: [R; N],
    /// Command u, mean of those before and after.
    pub command: [R; N],
    /// Force τ at the outputs of the drives, likewise, N or N m.
    pub force: [R; N],
}

impl<R: Real, const N: usize> Reading<R, N> {
    fn zero() -> Self {
        Self { q: [R::zero(); N], command: [R::zero(); N], force: [R::zero(); N] }
    }

    fn plus(&self, other: &Self) -> Self {
        let sum = |a, b| add_scaled(a, R::one(), b);
        Self {
            q: sum(&self.q, &other.q),
            command: sum(&self.command, &other.command),
            force: sum(&self.force, &other.force),
        }
    }

    fn times(&self, factor: R) -> Self {
        let product = |of: [R; N]| of.map(|x| x * factor);
        Self { q: product(self.q), command: product(self.command), force: product(self.force) }
    }
}

impl<R: Real, const N: usize> Blocks<R, N> {
    /// Creates empty blocks of `ticks` ticks of h seconds each; 0 ticks are taken as 1.
    pub fn new(ticks: u16, h: R) -> Self {
        let ticks = ticks.max(1);
        let both = R::constant(f64::from(ticks)) + R::constant(f64::from(ticks));
        Self { ticks, rate: R::one() / (both * h), count: 0, sums: Some(Reading::zero()), before: [None; 2] }
    }

    /// Takes a tick, `None` for one of which nothing can be learned. Returns, at the end of every block, the moment in the middle of the block
    /// before, if it and its neighbours are whole.
    pub fn take(&mut self, reading: Option<&Reading<R, N>>) -> Option<Option<Moment<R, N>>> {
        self.sums = self.sums.zip(reading).map(|(sums, reading)| sums.plus(reading));
        self.count += 1;
        if self.count < self.ticks {
            return None;
        }
        let share = R::one() / R::constant(f64::from(self.ticks));
        let after = self.sums.map(|sums| sums.times(share));
        let [first, middle] = self.before;
        (self.count, self.sums, self.before) = (0, Some(Reading::zero()), [middle, after]);
        Some(self.moment(first, middle, after))
    }

    fn moment(
        &self,
        first: Option<Reading<R, N>>,
        middle: Option<Reading<R, N>>,
        after: Option<Reading<R, N>>,
    ) -> Option<Moment<R, N>> {
        let Reading { q, command, force } = middle?;
        let v = add_scaled(&after?.q, -R::one(), &first?.q).map(|moved| moved * self.rate);
        Some(Moment { q, v, command, force })
    }
}
