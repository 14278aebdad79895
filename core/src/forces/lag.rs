use super::{Actuator, Control};
use crate::scalar::Real;

/// Integrals A₀ … A₃ of the answer of a lag, over a time L, to an input that jumps from 0 to 1 and stays; all times are in steps.
///
/// With the time constant ϑ, A₀(L) = 1 − exp(−L/ϑ) is the answer itself, and A_k(L) = ∫₀ᴸ A_{k−1} = Lᵏ/k! − ϑ A_{k−1}(L). The answer to a
/// ramp of slope 1 is A₁, with the integrals A₂ and A₃.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rise<R> {
    /// A₀, A₁, A₂ and A₃.
    pub integrals: [R; 4],
}

/// Ratio L/ϑ up to which the integrals are summed as series: beyond it differences of large numbers lose few digits.
const SHORT: f64 = 2.0;
/// Last term of the series; the next one is less than an f64 resolves.
const TERMS: u8 = 26;
const LAST: f64 = TERMS as f64;

impl<R: Real> Rise<R> {
    /// Integrals for a time constant ϑ ≥ 0 and a time L ≥ 0, steps; for ϑ = 0 the answer is the input.
    pub fn new(lag: R, time: R) -> Self {
        if time <= R::zero() {
            return Self { integrals: [R::zero(); 4] };
        }
        if time < R::constant(SHORT) * lag { Self::short(lag, time) } else { Self::long(lag, time) }
    }

    /// A_k = Lᵏ x φ_{k+1}(−x) with x = L/ϑ: φ₄ by its series, the others by φ_k = 1/k! − x φ_{k+1}.
    fn short(lag: R, time: R) -> Self {
        let (one, x) = (R::one(), time / lag);
        let term = |(sum, j): (R, R), _| (one - x * sum / j, j - one);
        let (series, _) = (5..=TERMS).rev().fold((one, R::constant(LAST)), term);
        let fourth = series / R::constant(24.0);
        let third = R::constant(1.0 / 6.0) - x * fourth;
        let second = one.half() - x * third;
        let first = one - x * second;
        let (square, cube) = (time * time, time * time * time);
        Self { integrals: [x * first, time * x * second, square * x * third, cube * x * fourth] }
    }

    /// A_k = Lᵏ/k! − ϑ A_{k−1}.
    fn long(lag: R, time: R) -> Self {
        let gone = if lag > R::zero() { (-(time / lag)).exp() } else { R::zero() };
        let value = R::one() - gone;
        let first = time - lag * value;
        let second = (time * time).half() - lag * first;
        let third = time * time * time * R::constant(1.0 / 6.0) - lag * second;
        Self { integrals: [value, first, second, third] }
    }

    /// ∂A_k/∂ϑ for the ϑ and L of these integrals.
    #[must_use]
    pub fn by_lag(&self, lag: R, time: R) -> Self {
        let [value, first, second, third] = self.integrals;
        if time <= R::zero() {
            return Self { integrals: [R::zero(); 4] };
        }
        if time < R::constant(SHORT) * lag {
            let of = |k: R, before: R, own: R| (k * own - time * before) / lag;
            let gone = -(time / lag) / lag * (-(time / lag)).exp();
            return Self {
                integrals: [
                    gone,
                    of(R::one(), value, first),
                    of(R::constant(2.0), first, second),
                    of(R::constant(3.0), second, third),
                ],
            };
        }
        let rate = if lag > R::zero() { time / lag / lag * (R::one() - value) } else { R::zero() };
        let of_first = lag * rate - value;
        let of_second = -first - lag * of_first;
        Self { integrals: [-rate, of_first, of_second, -second - lag * of_second] }
    }

    /// ∂A_k/∂L = A_{k−1}, and (1 − A₀)/ϑ for A₀; 0 for ϑ = 0.
    #[must_use]
    pub fn by_time(&self, lag: R) -> Self {
        let [value, first, second, _] = self.integrals;
        let rate = if lag > R::zero() { (R::one() - value) / lag } else { R::zero() };
        Self { integrals: [rate, value, first, second] }
    }

    /// Weights of a jump by 1 that happened L before the end of the step.
    pub fn jump(&self) -> [R; 3] {
        let [value, first, second, _] = self.integrals;
        weights(value, first, second)
    }

    /// Weights of a change of slope by 1 that happened L before the end of the step.
    pub fn ramp(&self) -> [R; 3] {
        let [_, value, first, second] = self.integrals;
        weights(value, first, second)
    }
}

/// An answer at the end of the step, and mean and slope of the straight line over the step with the same impulse and moment, from the
/// answer and its two integrals at the end.
fn weights<R: Real>(value: R, first: R, second: R) -> [R; 3] {
    [value, first, R::constant(6.0) * (first - second - second)]
}

/// First-order lag of drives, T ẏ = r − y with the command r(t) = u(t − d) that has arrived, over one step. The force is τ = g y + o.
///
/// y between samples has a closed form. The step uses the straight line with the impulse and the moment of y, as [`Actuator`] does for
/// the jump or bend of a delay; y itself is passed on exactly. T and d are in steps, d in [0, 1].
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag<R> {
    /// Delay d/h.
    pub delay: R,
    /// Answer over the whole step.
    pub whole: Rise<R>,
    /// Answer over the part of the step after the delay.
    pub late: Rise<R>,
}

/// A lagging command over one step.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lagging<R> {
    /// Mean of y over the step.
    pub mean: R,
    /// Slope of the straight line in place of y, per step.
    pub slope: R,
    /// y at the end of the step.
    pub end: R,
}

impl<R: Real> Lag<R> {
    /// Lag with the time constant T/h ≥ 0 behind the delay d/h, in [0, 1].
    pub fn new(lag: R, delay: R) -> Self {
        Self { delay, whole: Rise::new(lag, R::one()), late: Rise::new(lag, R::one() - delay) }
    }

    /// The lagging command over the step that begins at y, when `u` is commanded, with `before` commanded one step earlier; both are held.
    pub fn held(&self, y: R, before: R, u: R) -> Lagging<R> {
        let [whole, late] = [self.whole.jump(), self.late.jump()];
        let (early, jump) = (before - y, u - before);
        let [end, mean, slope] = core::array::from_fn(|k| early * whole[k] + jump * late[k]);
        Lagging { mean: y + mean, slope, end: y + end }
    }

    /// The lagging command over the step between two samples `start` and `end` that begins at y, with `before` the sample before them;
    /// commands are linear between samples.
    pub fn linear(&self, y: R, [before, start, end]: [R; 3]) -> Lagging<R> {
        let (jump, ramp, bent) = (self.whole.jump(), self.whole.ramp(), self.late.ramp());
        let rate = start - before;
        let (early, bend) = (start - self.delay * rate - y, end - start - rate);
        let [end, mean, slope] = core::array::from_fn(|k| early * jump[k] + rate * ramp[k] + bend * bent[k]);
        Lagging { mean: y + mean, slope, end: y + end }
    }
}

impl<R: Real> Lagging<R> {
    /// The straight line in place of y, at the start and at the end of the step.
    pub fn line(&self) -> [R; 2] {
        [self.mean - self.slope.half(), self.mean + self.slope.half()]
    }
}

impl<R: Real, const N: usize> Actuator<R, N> {
    /// The force of lagging commands over a step, and y at its end.
    pub fn lagging(&self, of: impl Fn(usize) -> Lagging<R>) -> (Control<R, N>, [R; N]) {
        let (mut line, mut at_end) = (Control::none(), [R::zero(); N]);
        for (i, ((start, end), y)) in line.start.iter_mut().zip(&mut line.end).zip(&mut at_end).enumerate() {
            let own = of(i);
            ([*start, *end], *y) = (own.line(), own.end);
        }
        (Control { start: self.output(&line.start), end: self.output(&line.end) }, at_end)
    }
}
