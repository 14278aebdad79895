use crate::lagrangian::Column;
use crate::scalar::Real;

/// Balance of momentum over windows, in the units of a force.
///
/// With a smooth weight w that vanishes at both ends of a window of length t_w, ∫ẇp = −∫w (L_q + Q + τ). The true numbers are the model's
/// plus δ, so that the columns satisfy Σ a_j δ_j = b, a_j = −∫(w ∂(L_q + Q)/∂π_j + ẇ ∂p/∂π_j), b = ∫(w (L_q + Q + τ) + ẇp).
/// Here w = (1 − cos 2πt/t_w)/t_w. Windows overlap by half, so that all ticks weigh the same. No acceleration is needed, and a constant error
/// of p falls out. The windows of every coordinate end one tick after those of the coordinate before, so that no tick has the work of all.
///
/// Sources: M. Shinbrot, "On the analysis of linear and nonlinear systems", 1957 (modulating functions); H. Preisig and D. Rippin 1993.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance<R, const N: usize, const P: usize> {
    /// Ticks of half a window.
    half: u16,
    /// Ticks since a window of the first coordinate ended.
    tick: u16,
    /// Turn of a tick, (cos, sin) of π/half.
    turn: (R, R),
    /// (cos, sin) of the first coordinate's phase.
    phase: (R, R),
    /// 2π/t_w, 1/s.
    rate: R,
    /// 1 over the number of ticks of a window.
    share: R,
    coordinates: [Windows<R, P>; N],
}

/// The two open windows of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Windows<R, const P: usize> {
    open: [Row<R, P>; 2],
    /// Whether the second window ends next.
    second_ends: bool,
    /// Whether all ticks of each window were taken.
    whole: [bool; 2],
}

/// Balance of a coordinate over a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<R, const P: usize> {
    /// Columns a, N or N m per unit of the number.
    pub columns: [R; P],
    /// Left side b, N or N m.
    pub value: R,
    /// Weighted mean of what was uncertain in the force, N or N m.
    pub uncertain: R,
}

/// Terms of the balance at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms<'a, R, const N: usize, const P: usize> {
    /// Columns of the numbers.
    pub columns: &'a [Column<R, N>; P],
    /// Momentum p of the model.
    pub momentum: [R; N],
    /// L_q + Q + τ of the model.
    pub force: [R; N],
    /// Uncertainty of the force, such as friction at rest.
    pub uncertain: [R; N],
}

impl<R: Real, const P: usize> Row<R, P> {
    fn new() -> Self {
        Self { columns: [R::zero(); P], value: R::zero(), uncertain: R::zero() }
    }
}

impl<R: Real, const P: usize> Windows<R, P> {
    /// The windows of the first coordinate begin at once.
    fn first() -> Self {
        Self { open: [Row::new(); 2], second_ends: true, whole: [true, false] }
    }

    /// The windows of the other coordinates begin when their first turn comes.
    fn later() -> Self {
        Self { second_ends: false, whole: [false; 2], ..Self::first() }
    }

    /// Adds a tick of coordinate i with the weights of forces and of momenta in both windows, whose terms are read once.
    fn add<const N: usize>(&mut self, terms: &Terms<R, N, P>, i: usize, weights: [[R; 2]; 2]) {
        let of = |all: &[R; N]| all.get(i).copied().unwrap_or_else(R::zero);
        let [[force, momentum], [other_force, other_momentum]] = weights;
        let [first, second] = &mut self.open;
        let sums = first.columns.iter_mut().zip(&mut second.columns);
        for ((sum, other), column) in sums.zip(terms.columns) {
            let (f, p) = (of(&column.force), of(&column.momentum));
            *sum -= force * f + momentum * p;
            *other -= other_force * f + other_momentum * p;
        }
        let (f, p, uncertain) = (of(&terms.force), of(&terms.momentum), of(&terms.uncertain));
        first.value += force * f + momentum * p;
        second.value += other_force * f + other_momentum * p;
        first.uncertain += force * uncertain;
        second.uncertain += other_force * uncertain;
    }

    /// Ends a window, and returns it if it is whole. Another one begins, in which all ticks are taken from now on if the same window of the first
    /// coordinate is `whole`: windows of all coordinates are taken or dropped together.
    fn end(&mut self, [first_whole, second_whole]: [bool; 2]) -> Option<Row<R, P>> {
        let [first, second] = &mut self.open;
        let [own_first, own_second] = &mut self.whole;
        let (open, own, begins) = if self.second_ends {
            (second, own_second, second_whole)
        } else {
            (first, own_first, first_whole)
        };
        self.second_ends = !self.second_ends;
        let row = core::mem::replace(open, Row::new());
        core::mem::replace(own, begins).then_some(row)
    }
}

impl<R: Real, const N: usize, const P: usize> Balance<R, N, P> {
    /// Creates the balance over windows of twice `half` ticks of h seconds each; a `half` of 0 is taken as 1.
    pub fn new(half: u16, h: R) -> Self {
        let half = half.max(1);
        let (count, pi) = (R::constant(f64::from(half)), R::constant(core::f64::consts::PI));
        let (sin, cos) = (pi / count).sin_cos();
        let share = R::one() / (count + count);
        let mut coordinates = [Windows::later(); N];
        if let Some(first) = coordinates.first_mut() {
            *first = Windows::first();
        }
        let (turn, phase) = ((cos, sin), (R::one(), R::zero()));
        Self { half, tick: 0, turn, phase, rate: (pi + pi) * share / h, share, coordinates }
    }

    /// Drops the windows that are open: something in them is not what the model is about.
    pub fn drop_open(&mut self) {
        self.coordinates.iter_mut().for_each(|windows| windows.whole = [false; 2]);
    }

    /// Takes a tick, and calls `ended` with every coordinate of which a window ends with it, and with the window unless it was dropped.
    #[inline(always)]
    pub fn take(&mut self, terms: &Terms<R, N, P>, ended: impl FnMut(usize, Option<Row<R, P>>)) {
        let (one, share, (c, s)) = (R::one(), self.share, self.turn);
        let mut phase = self.phase;
        for (i, windows) in self.coordinates.iter_mut().enumerate() {
            let (cos, slope) = (phase.0, phase.1 * self.rate * share);
            windows.add(terms, i, [[(one - cos) * share, slope], [(one + cos) * share, -slope]]);
            // Every coordinate is a tick behind the one before.
            phase = turned(phase, (c, -s));
        }
        self.advance(ended);
    }

    /// Passes a tick while all windows are dropped.
    pub fn pass(&mut self) {
        self.drop_open();
        self.advance(|_, _| {});
    }

    /// Moves to the next tick.
    #[inline(always)]
    fn advance(&mut self, mut ended: impl FnMut(usize, Option<Row<R, P>>)) {
        self.tick += 1;
        self.phase = turned(self.phase, self.turn);
        if self.tick >= self.half {
            // The phase is exact again after every half, so that rounding does not add up.
            let second_ends = self.coordinates.first().is_some_and(|first| first.second_ends);
            self.phase = (if second_ends { -R::one() } else { R::one() }, R::zero());
            self.tick = 0;
        }
        // The tick at which the windows of a coordinate end, and whether those of the first one are whole.
        let (mut end, mut first) = (0, [true; 2]);
        for (i, windows) in self.coordinates.iter_mut().enumerate() {
            if end == self.tick {
                ended(i, windows.end(first));
            }
            if i == 0 {
                first = windows.whole;
            }
            end = if end + 1 < self.half { end + 1 } else { 0 };
        }
    }
}

/// A phase (cos, sin) after a turn.
fn turned<R: Real>((cos, sin): (R, R), (c, s): (R, R)) -> (R, R) {
    (cos * c - sin * s, sin * c + cos * s)
}
