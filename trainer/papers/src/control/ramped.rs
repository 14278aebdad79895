//! The pendulum with one driven joint whose torque ramps, as a plant of optimal control.

use super::driven::{Driven, checked};
use super::plant::State;
use super::policy::TICK;
use leastaction_core::control::{Plant, Transition};
use leastaction_core::discrete::StepError;
use std::array::from_fn;

/// State (q₁, q₂, v₁, v₂, τ) of a pendulum and its torque.
pub type RampedState = [f64; 5];

/// A double pendulum whose control is the rate of its torque, N m/s. A tick holds the torque of its middle.
#[derive(Clone, Copy, Debug)]
pub struct Ramped(pub Driven);

impl Ramped {
    /// Torques of the ticks of a node.
    pub fn torques(tau: f64, rate: f64, ticks: u16) -> impl Iterator<Item = f64> {
        (0..ticks).map(move |tick| tau + (f64::from(tick) + 0.5) * TICK * rate)
    }
}

/// The state of the pendulum.
fn of_pendulum([q1, q2, v1, v2, _]: RampedState) -> State {
    [q1, q2, v1, v2]
}

impl Plant<f64, 5, 1> for Ramped {
    type Motion = RampedState;
    type Frame = ();

    fn begin(&self, x: &RampedState) -> Result<RampedState, StepError<f64>> {
        checked(*x)
    }

    fn advance(
        &self,
        x: &mut RampedState,
        (ticks, [rate]): (u16, &[f64; 1]),
        _: &mut RampedState,
    ) -> Result<RampedState, StepError<f64>> {
        let Driven { pendulum, robot } = self.0;
        let step = |x: State, tau: f64| pendulum.step(x, robot.torques(tau), TICK);
        let [q1, q2, v1, v2] = Self::torques(x[4], *rate, ticks).fold(of_pendulum(*x), step);
        *x = [q1, q2, v1, v2, x[4] + f64::from(ticks) * TICK * rate];
        checked(*x)
    }

    fn frame(&self, _: &RampedState) {}

    fn linearise(
        &self,
        [(x, ()), _]: [(&RampedState, &()); 2],
        (ticks, [rate]): (u16, &[f64; 1]),
        _: &RampedState,
    ) -> Result<Transition<f64, 5, 1>, StepError<f64>> {
        let Driven { pendulum, robot } = self.0;
        // The last changes are those of the torque and of its rate, which ramps like the torque itself.
        let mut changes: [State; 6] = from_fn(|k| from_fn(|i| f64::from(u8::from(i == k))));
        let mut state = of_pendulum(*x);
        let ramp = Self::torques(0.0, 1.0, ticks);
        for (tau, by_rate) in Self::torques(x[4], *rate, ticks).zip(ramp) {
            let by_tau = [0.0, 0.0, 0.0, 0.0, 1.0, by_rate];
            let each = from_fn(|k| (changes[k], robot.torques(by_tau[k])));
            (state, changes) = pendulum.step_with_changes(state, robot.torques(tau), TICK, each);
        }
        let torque = [0.0, 0.0, 0.0, 0.0, 1.0, f64::from(ticks) * TICK];
        let row = |i: usize| from_fn(|k| changes[k].get(i).copied().unwrap_or(torque[k]));
        let rows: [[f64; 6]; 5] = from_fn(row);
        Ok(Transition { a: from_fn(|i| from_fn(|j| rows[i][j])), b: rows.map(|row| [row[5]]) })
    }
}
