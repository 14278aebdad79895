//! The pendulum with one driven joint as a plant of optimal control.

use super::plant::{DoublePendulum, State};
use super::policy::{Robot, TICK};
use leastaction_core::control::{Plant, Transition};
use leastaction_core::discrete::StepError;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::array::from_fn;
use std::f64::consts::TAU;
use std::mem::replace;
use std::ops::Range;

/// A double pendulum under a torque of one joint.
#[derive(Clone, Copy, Debug)]
pub struct Driven {
    /// The pendulum.
    pub pendulum: DoublePendulum,
    /// The robot.
    pub robot: Robot,
}

/// A state, if it is finite.
pub fn checked<const D: usize>(x: [f64; D]) -> Result<[f64; D], StepError<f64>> {
    if x.iter().all(|x| x.is_finite()) { Ok(x) } else { Err(StepError::NotFinite) }
}

/// A random wave of torque at the starts of nodes of `node` s, N m: amplitude and frequency (Hz) from their ranges, and any phase.
pub fn wave(seed: u64, amplitude: Range<f64>, frequency: Range<f64>, node: f64) -> impl Fn(usize) -> f64 {
    let mut random = Pcg64::seed_from_u64(seed);
    let [amplitude, frequency, phase] =
        [amplitude, frequency, 0.0..TAU].map(|range| random.random_range(range));
    move |k| amplitude * (TAU * frequency * k as f64 * node + phase).sin()
}

impl Driven {
    /// State and torque of every tick from a state on.
    pub fn ticks(
        self,
        mut x: State,
        torques: impl Iterator<Item = f64>,
    ) -> impl Iterator<Item = (State, f64)> {
        torques.map(move |tau| {
            let next = self.pendulum.step(x, self.robot.torques(tau), TICK);
            (replace(&mut x, next), tau)
        })
    }
}

impl Plant<f64, 4, 1> for Driven {
    type Motion = State;
    type Frame = ();

    fn begin(&self, x: &State) -> Result<State, StepError<f64>> {
        checked(*x)
    }

    fn advance(
        &self,
        x: &mut State,
        (ticks, [u]): (u16, &[f64; 1]),
        _: &mut State,
    ) -> Result<State, StepError<f64>> {
        let tau = self.robot.torques(*u);
        for _ in 0..ticks {
            *x = self.pendulum.step(*x, tau, TICK);
        }
        checked(*x)
    }

    fn frame(&self, _: &State) {}

    fn linearise(
        &self,
        [(x, ()), _]: [(&State, &()); 2],
        (ticks, [u]): (u16, &[f64; 1]),
        _: &State,
    ) -> Result<Transition<f64, 4, 1>, StepError<f64>> {
        let (tau, still) = (self.robot.torques(*u), [0.0; 2]);
        let unit = |k: usize| from_fn(|i| f64::from(u8::from(i == k)));
        // The last change is that of the torque.
        let mut changes: [State; 5] = from_fn(unit);
        let mut x = *x;
        for _ in 0..ticks {
            let each = from_fn(|k| (changes[k], if k < 4 { still } else { self.robot.torques(1.0) }));
            (x, changes) = self.pendulum.step_with_changes(x, tau, TICK, each);
        }
        let [.., by_u] = changes;
        Ok(Transition { a: from_fn(|i| from_fn(|j| changes[j][i])), b: by_u.map(|x| [x]) })
    }
}
