use crate::lagrangian::Column;
use crate::linear::add_scaled;
use crate::scalar::Real;

/// Balance of momentum over windows, in the units of a force.
///
/// With a smooth weight w that vanishes at both ends of a window of length t_w, ∫ẇp = −∫w (L_q + Q + τ). The true numbers are the model's
/// plus δ, so that the columns satisfy Σ a_j δ_j = b, a_j = −∫(w ∂(L_q + Q)/∂π_j + ẇ ∂p/∂π_j), b = ∫(w (L_q + Q + τ) + ẇp).
/// Here w = (1 − cos 2πt/t_w)/t_w. Windows overlap by half, so that all ticks weigh the same. No acceleration is needed, and a constant error
/// of p falls out.
///
/// Sources: M. Shinbrot, "On the analysis of linear and nonlinear systems", 1957 (modulating functions); H. Preisig and D. Rippin 1993.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance<R, const N: usize, const P: usize> {
    /// Ticks of half a window.
    half: u16,
    /// Ticks since the last window of each kind ended.
    tick: u16,
    /// Turn of a tick, (cos, sin) of π/half.
    turn: (R, R),
    /// (cos, sin) of the present phase.
    phase: (R, R),
    /// 2π/t_w, 1/s.
    rate: R,
    /// 1 over the number of ticks of a window.
    share: R,
    windows: [Window<R, N, P>; 2],
    /// Whether the second window ends next.
    second_ends: bool,
    /// Whether all ticks of each window were taken.
    whole: [bool; 2],
}

/// Sums over a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window<R, const N: usize, const P: usize> {
    /// Row a of every coordinate: N or N m per unit of the number.
    pub rows: [[R; P]; N],
    /// Left side b of every coordinate, N or N m.
    pub values: [R; N],
    /// Weighted mean of what was uncertain in the force of every coordinate, N or N m.
    pub uncertain: [R; N],
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

impl<R: Real, const N: usize, const P: usize> Window<R, N, P> {
    fn new() -> Self {
        let zero = R::zero();
        Self { rows: [[zero; P]; N], values: [zero; N], uncertain: [zero; N] }
    }

    /// Adds a tick with the weights of forces and of momenta.
    fn add(&mut self, terms: &Terms<R, N, P>, force: R, momentum: R) {
        let Terms { columns, momentum: p, force: f, uncertain } = terms;
        for i in 0..N {
            for (sum, column) in self.rows[i].iter_mut().zip(*columns) {
                *sum -= force * column.force[i] + momentum * column.momentum[i];
            }
            self.values[i] += force * f[i] + momentum * p[i];
        }
        self.uncertain = add_scaled(&self.uncertain, force, uncertain);
    }
}

impl<R: Real, const N: usize, const P: usize> Balance<R, N, P> {
    /// Creates the balance over windows of twice `half` ticks of h seconds each; a `half` of 0 is taken as 1.
    pub fn new(half: u16, h: R) -> Self {
        let half = half.max(1);
        let (count, pi) = (R::constant(f64::from(half)), R::constant(core::f64::consts::PI));
        let (sin, cos) = (pi / count).sin_cos();
        let share = R::one() / (count + count);
        Self {
            half,
            tick: 0,
            turn: (cos, sin),
            phase: (R::one(), R::zero()),
            rate: (pi + pi) * share / h,
            share,
            windows: [Window::new(); 2],
            second_ends: true,
            whole: [true, false],
        }
    }

    /// Drops the windows that are open: something in them is not what the model is about.
    pub fn drop_open(&mut self) {
        self.whole = [false; 2];
    }

    /// Takes a tick, and returns the window that ends with it, unless it was dropped.
    #[inline(always)]
    pub fn take(&mut self, terms: &Terms<R, N, P>) -> Option<Window<R, N, P>> {
        let (cos, sin) = self.phase;
        let (one, [first, second]) = (R::one(), &mut self.windows);
        let (slope, share) = (sin * self.rate * self.share, self.share);
        first.add(terms, (one - cos) * share, slope);
        second.add(terms, (one + cos) * share, -slope);
        self.advance()
    }

    /// Passes a tick that no window takes.
    pub fn pass(&mut self) {
        self.advance();
    }

    /// Moves to the next tick.
    fn advance(&mut self) -> Option<Window<R, N, P>> {
        self.tick += 1;
        let ((cos, sin), (c, s)) = (self.phase, self.turn);
        self.phase = (cos * c - sin * s, sin * c + cos * s);
        if self.tick < self.half {
            return None;
        }
        self.tick = 0;
        let ended = usize::from(self.second_ends);
        // The phase is exact again after every half, so that rounding does not add up.
        self.phase = (if self.second_ends { -R::one() } else { R::one() }, R::zero());
        self.second_ends = !self.second_ends;
        let (Some(window), Some(whole)) = (self.windows.get_mut(ended), self.whole.get_mut(ended)) else {
            return None;
        };
        let window = core::mem::replace(window, Window::new());
        core::mem::replace(whole, true).then_some(window)
    }
}
