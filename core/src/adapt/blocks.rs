use crate::linear::add_scaled;
use crate::scalar::Real;

/// Motion of a fast loop, from its encoders alone: means over blocks of ticks, and velocities from the blocks before and after.
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
    /// The block before.
    middle: Option<Reading<R, N>>,
    /// Position of the block before that one.
    first: Option<[R; N]>,
}

/// Readings at a tick, or their means over a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading<R, const N: usize> {
    /// Position, without jumps by whole turns.
    pub q: [R; N],
    /// Force τ at the outputs of the drives, mean of those before and after, N or N m.
    pub force: [R; N],
}

/// Motion over a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block<R, const N: usize> {
    /// Mean position.
    pub q: [R; N],
    /// Velocity, from the blocks before and after.
    pub v: [R; N],
    /// Mean force τ at the outputs of the drives, N or N m.
    pub force: [R; N],
}

impl<R: Real, const N: usize> Reading<R, N> {
    fn zero() -> Self {
        Self { q: [R::zero(); N], force: [R::zero(); N] }
    }

    fn plus(&self, other: &Self) -> Self {
        let sum = |a, b| add_scaled(a, R::one(), b);
        Self { q: sum(&self.q, &other.q), force: sum(&self.force, &other.force) }
    }

    fn times(&self, factor: R) -> Self {
        let product = |of: [R; N]| of.map(|x| x * factor);
        Self { q: product(self.q), force: product(self.force) }
    }
}

impl<R: Real, const N: usize> Blocks<R, N> {
    /// Creates empty blocks of `ticks` ticks of h seconds each; 0 ticks are taken as 1.
    pub fn new(ticks: u16, h: R) -> Self {
        let ticks = ticks.max(1);
        let both = R::constant(f64::from(ticks)) + R::constant(f64::from(ticks));
        let sums = Some(Reading::zero());
        Self { ticks, rate: R::one() / (both * h), count: 0, sums, middle: None, first: None }
    }

    /// Takes a tick, `None` for one of which nothing can be learned. Returns, at the end of every block, the motion over the block before, if it
    /// and its neighbours are whole.
    pub fn take(&mut self, reading: Option<&Reading<R, N>>) -> Option<Option<Block<R, N>>> {
        self.sums = self.sums.zip(reading).map(|(sums, reading)| sums.plus(reading));
        self.count += 1;
        if self.count < self.ticks {
            return None;
        }
        let share = R::one() / R::constant(f64::from(self.ticks));
        let after = self.sums.map(|sums| sums.times(share));
        let block = self.before(after.as_ref());
        self.first = self.middle.map(|middle| middle.q);
        (self.count, self.sums, self.middle) = (0, Some(Reading::zero()), after);
        Some(block)
    }

    /// Motion over the block before the one given.
    fn before(&self, after: Option<&Reading<R, N>>) -> Option<Block<R, N>> {
        let Reading { q, force } = self.middle?;
        let v = add_scaled(&after?.q, -R::one(), &self.first?).map(|moved| moved * self.rate);
        Some(Block { q, v, force })
    }
}
