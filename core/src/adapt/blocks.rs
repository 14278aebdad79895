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
    sums: Option<Means<R, N>>,
    /// The two blocks before.
    before: [Option<Means<R, N>>; 2],
}

/// Means over a block.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Means<R, const N: usize> {
    q: [R; N],
    command: [R; N],
    force: [R; N],
}

impl<R: Real, const N: usize> Means<R, N> {
    fn zero() -> Self {
        Self { q: [R::zero(); N], command: [R::zero(); N], force: [R::zero(); N] }
    }
}

/// Readings at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading<R, const N: usize> {
    /// Position, without jumps by whole turns.
    pub q: [R; N],
    /// Command u, mean of those before and after.
    pub command: [R; N],
    /// Force τ at the outputs of the drives, likewise, N or N m.
    pub force: [R; N],
}

impl<R: Real, const N: usize> Blocks<R, N> {
    /// Creates empty blocks of `ticks` ticks of h seconds each; 0 ticks are taken as 1.
    pub fn new(ticks: u16, h: R) -> Self {
        let ticks = ticks.max(1);
        let both = R::constant(f64::from(ticks)) + R::constant(f64::from(ticks));
        Self { ticks, rate: R::one() / (both * h), count: 0, sums: Some(Means::zero()), before: [None; 2] }
    }

    /// Takes a tick, `None` for one of which nothing can be learned. Returns, at the end of every block, the moment in the middle of the block
    /// before, if it and its neighbours are whole.
    pub fn take(&mut self, reading: Option<&Reading<R, N>>) -> Option<Option<Moment<R, N>>> {
        let (one, sums) = (R::one(), self.sums);
        self.sums = sums.zip(reading).map(|(sums, Reading { q, command, force })| Means {
            q: add_scaled(&sums.q, one, q),
            command: add_scaled(&sums.command, one, command),
            force: add_scaled(&sums.force, one, force),
        });
        self.count += 1;
        if self.count < self.ticks {
            return None;
        }
        let share = one / R::constant(f64::from(self.ticks));
        let mean = |sum: [R; N]| sum.map(|sum| sum * share);
        let after = self.sums.map(|Means { q, command, force }| Means {
            q: mean(q),
            command: mean(command),
            force: mean(force),
        });
        let [first, middle] = self.before;
        (self.count, self.sums, self.before) = (0, Some(Means::zero()), [middle, after]);
        Some(self.moment(first, middle, after))
    }

    fn moment(
        &self,
        first: Option<Means<R, N>>,
        middle: Option<Means<R, N>>,
        after: Option<Means<R, N>>,
    ) -> Option<Moment<R, N>> {
        let Means { q, command, force } = middle?;
        let v = add_scaled(&after?.q, -R::one(), &first?.q).map(|moved| moved * self.rate);
        Some(Moment { q, v, command, force })
    }
}
