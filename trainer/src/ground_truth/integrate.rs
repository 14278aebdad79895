//! Motion to nearly the last bit: Gragg–Bulirsch–Stoer extrapolation with error control.
//!
//! Source: Hairer, Nørsett and Wanner, "Solving Ordinary Differential Equations I", section II.9.

use leastaction_core::continuous::acceleration;
use leastaction_core::energy::trigonometric::Trigonometric;
use leastaction_core::forces::{System, Viscous};
use thiserror::Error;

/// Substeps of the modified midpoint rule in successive columns of the extrapolation.
const SUBSTEPS: [usize; 8] = [2, 4, 6, 8, 10, 12, 14, 16];
/// How often an interval is halved before giving up.
const MAX_HALVINGS: u32 = 24;

/// The motion could not be followed.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the motion could not be integrated to a relative error of {tolerance:e} near t = {t} s")]
pub struct IntegrationError {
    /// Where, s.
    pub t: f64,
    /// What was asked.
    pub tolerance: f64,
}

/// An adaptive integrator of q̈ = v̇(q, v, u) with u held.
#[derive(Clone, Copy, Debug)]
pub struct Integrator<'a, const N: usize> {
    /// The mechanism with its damping.
    pub system: &'a System<Trigonometric<'a, N>, Viscous<f64, N>>,
    /// Error per step, relative to 1 + |x|.
    pub tolerance: f64,
}

/// Position and velocity.
pub(super) type Motion<const N: usize> = [[f64; N]; 2];

impl<const N: usize> Integrator<'_, N> {
    /// The state (q, v) after `h` seconds under the constant control u.
    pub fn advance(&self, state: Motion<N>, u: &[f64; N], h: f64) -> Result<Motion<N>, IntegrationError> {
        self.advance_within(state, u, h, MAX_HALVINGS)
    }

    fn advance_within(
        &self,
        state: Motion<N>,
        u: &[f64; N],
        h: f64,
        halvings: u32,
    ) -> Result<Motion<N>, IntegrationError> {
        if let Some(end) = self.extrapolate(&state, u, h) {
            return Ok(end);
        }
        if halvings == 0 {
            return Err(IntegrationError { t: 0.0, tolerance: self.tolerance });
        }
        let middle = self.advance_within(state, u, h / 2.0, halvings - 1)?;
        self.advance_within(middle, u, h / 2.0, halvings - 1)
    }

    /// One interval by extrapolation, where its last two columns agree to the tolerance.
    fn extrapolate(&self, state: &Motion<N>, u: &[f64; N], h: f64) -> Option<Motion<N>> {
        let mut row: Vec<Motion<N>> = Vec::with_capacity(SUBSTEPS.len());
        for (k, substeps) in SUBSTEPS.into_iter().enumerate() {
            let mut value = self.modified_midpoint(state, u, h, substeps)?;
            let mut next = Vec::with_capacity(k + 1);
            for (j, previous) in row.iter().enumerate() {
                next.push(value);
                let ratio = substeps as f64 / SUBSTEPS[k - 1 - j] as f64;
                value = combine(&value, previous, 1.0 / (ratio * ratio - 1.0));
            }
            next.push(value);
            if k >= 3 && distance(&next[k], &next[k - 1]) <= self.tolerance {
                return Some(value);
            }
            row = next;
        }
        None
    }

    /// Gragg's rule: its error has only even powers of the substep.
    fn modified_midpoint(
        &self,
        state: &Motion<N>,
        u: &[f64; N],
        h: f64,
        substeps: usize,
    ) -> Option<Motion<N>> {
        let d = h / substeps as f64;
        let (mut before, mut now) = (*state, combine_rate(state, &self.rate(state, u)?, d));
        for _ in 1..substeps {
            let after = combine_rate(&before, &self.rate(&now, u)?, 2.0 * d);
            (before, now) = (now, after);
        }
        let last = combine_rate(&before, &self.rate(&now, u)?, d);
        Some(core::array::from_fn(|k| core::array::from_fn(|i| 0.5 * (now[k][i] + last[k][i]))))
    }

    fn rate(&self, [q, v]: &Motion<N>, u: &[f64; N]) -> Option<Motion<N>> {
        let a = acceleration(self.system, q, v, u).ok()?;
        a.iter().all(|a| a.is_finite()).then_some([*v, a])
    }
}

/// x + c ẋ.
fn combine_rate<const N: usize>(x: &Motion<N>, rate: &Motion<N>, c: f64) -> Motion<N> {
    core::array::from_fn(|k| core::array::from_fn(|i| x[k][i] + c * rate[k][i]))
}

/// a + c(a − b).
fn combine<const N: usize>(a: &Motion<N>, b: &Motion<N>, c: f64) -> Motion<N> {
    core::array::from_fn(|k| core::array::from_fn(|i| a[k][i] + c * (a[k][i] - b[k][i])))
}

/// The largest difference relative to 1 + |a|.
fn distance<const N: usize>(a: &Motion<N>, b: &Motion<N>) -> f64 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.map(|(a, b)| (a - b).abs() / (1.0 + a.abs())).fold(0.0, f64::max)
}
