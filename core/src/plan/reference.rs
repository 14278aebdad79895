use super::Record;

/// The plan at one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference<const N: usize, const M: usize> {
    /// Planned positions q̄, m or rad.
    pub q: [f32; N],
    /// Planned velocities v̄, m/s or rad/s.
    pub v: [f32; N],
    /// Planned command ū of every driven coordinate, N or N m.
    pub u: [f32; M],
    /// Rows of the gain, one for every driven coordinate.
    pub gain: [Gain<N>; M],
}

/// Row of the gain: change of one command for a deviation of the state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain<const N: usize> {
    /// Gains of the positions, N/m or N m/rad.
    pub q: [f32; N],
    /// Gains of the velocities, N s/m or N m s/rad.
    pub v: [f32; N],
}

impl<const N: usize> Gain<N> {
    const ZERO: Self = Self { q: [0.0; N], v: [0.0; N] };

    /// Command for a deviation: the row times (q, v).
    pub(super) fn times(&self, q: &[f32; N], v: &[f32; N]) -> f32 {
        let positions = self.q.iter().zip(q);
        positions.chain(self.v.iter().zip(v)).fold(0.0, |sum, (gain, x)| sum + gain * x)
    }

    fn towards(&self, end: &Self, s: f32) -> Self {
        Self { q: linear(&self.q, &end.q, s), v: linear(&self.v, &end.v, s) }
    }
}

impl<const N: usize, const M: usize> Reference<N, M> {
    pub(super) const ZERO: Self = Self { q: [0.0; N], v: [0.0; N], u: [0.0; M], gain: [Gain::ZERO; M] };

    /// Copies a record with at most `M` commands.
    pub(super) fn read(record: &Record) -> Option<Self> {
        let Record { mut q, mut v, u: commands, gain: mut rows } = *record;
        let (mut u, mut gain) = ([0.0; M], [Gain::ZERO; M]);
        for ((u, row), command) in u.iter_mut().zip(&mut gain).zip(commands) {
            (*u, *row) = (*command, Gain { q: take(&mut rows)?, v: take(&mut rows)? });
        }
        Some(Self { q: take(&mut q)?, v: take(&mut v)?, u, gain })
    }

    /// The plan at the fraction s of a node of T seconds: the cubic motion through both ends, the command held, the gain linear.
    pub(super) fn towards(&self, end: &Self, s: f32, t: f32) -> Self {
        let mut between = *self;
        let ends = self.q.iter().zip(&self.v).zip(end.q.iter().zip(&end.v));
        for ((q, v), ((q0, v0), (q1, v1))) in between.q.iter_mut().zip(&mut between.v).zip(ends) {
            [*q, *v, _] = cubic([*q0, *v0], [*q1, *v1], s, t);
        }
        for ((gain, start), end) in between.gain.iter_mut().zip(&self.gain).zip(&end.gain) {
            *gain = start.towards(end, s);
        }
        between
    }

    /// Planned position, velocity and acceleration at the fraction s of a node of T seconds, as in [`Self::towards`].
    pub(super) fn motion(&self, end: &Self, s: f32, t: f32) -> [[f32; N]; 3] {
        let [mut q, mut v, mut a] = [self.q, self.v, [0.0; N]];
        let ends = end.q.iter().zip(&end.v);
        for (((q, v), a), (q1, v1)) in q.iter_mut().zip(&mut v).zip(&mut a).zip(ends) {
            [*q, *v, *a] = cubic([*q, *v], [*q1, *v1], s, t);
        }
        [q, v, a]
    }
}

/// Position, velocity and acceleration on the cubic Hermite polynomial through both ends, with w the mean velocity:
/// q = q₀ + sT(v₀ + s(b + sc)), v = v₀ + s(2b + 3sc), a = (2b + 6sc)/T, b = 3w − 2v₀ − v₁, c = v₀ + v₁ − 2w.
fn cubic([q0, v0]: [f32; 2], [q1, v1]: [f32; 2], s: f32, t: f32) -> [f32; 3] {
    let w = (q1 - q0) / t;
    let (b, c) = (3.0 * w - 2.0 * v0 - v1, v0 + v1 - 2.0 * w);
    [q0 + s * t * (v0 + s * (b + s * c)), v0 + s * (2.0 * b + 3.0 * s * c), (2.0 * b + 6.0 * s * c) / t]
}

fn linear<const N: usize>(start: &[f32; N], end: &[f32; N], s: f32) -> [f32; N] {
    let mut between = *start;
    for (x, end) in between.iter_mut().zip(end) {
        *x += s * (end - *x);
    }
    between
}

/// Takes the first `N` numbers off the front.
fn take<const N: usize>(numbers: &mut &[f32]) -> Option<[f32; N]> {
    let (first, rest) = numbers.split_first_chunk()?;
    *numbers = rest;
    Some(*first)
}
