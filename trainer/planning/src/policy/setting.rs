use leastaction_core::control::riccati::{Regulator, RegulatorError, Weights, stationary};
use leastaction_core::control::{Limits, Plant};
use leastaction_core::linear::multiply;
use leastaction_core::scalar::Real;
use std::array::from_fn;

/// Numbers of a policy; a state is (q, v).
#[derive(Clone, Debug, PartialEq)]
pub struct Aim<const D: usize, const M: usize> {
    /// Posture at rest to be reached.
    pub goal: [f64; D],
    /// Flags of the numbers that are angles of which any whole turn will do.
    pub turns: [bool; D],
    /// Distances from the goal within which the regulator is tried: half-widths of a box.
    pub catch: [f64; D],
    /// Deviations of equal weight, a state.
    pub unit: [f64; D],
    /// Weights of the regulator and of the gains that follow a motion, per second.
    pub weights: Weights<f64, D, M>,
    /// Weights of ½ r u² in a motion, per second.
    pub effort: [f64; M],
    /// Limits of the commands; equal ends hold a command that is not driven.
    pub controls: Limits<f64, M>,
    /// Limits of the commands in a motion, which leave the rest to feedback.
    pub planned: Limits<f64, M>,
    /// Limits of the states.
    pub states: Limits<f64, D>,
    /// Maximum number of nodes of a motion.
    pub longest: usize,
}

impl<const D: usize, const M: usize> Aim<D, M> {
    /// Deviation x − y, angles of any turn the short way.
    pub fn deviation(&self, x: &[f64; D], y: &[f64; D]) -> [f64; D] {
        from_fn(|i| {
            let d = x[i] - y[i];
            if self.turns[i] { d.short_way() } else { d }
        })
    }

    /// The goal that is next to x, and differs from the goal by whole turns.
    pub fn goal_near(&self, x: &[f64; D]) -> [f64; D] {
        let deviation = self.deviation(x, &self.goal);
        from_fn(|i| x[i] - deviation[i]).map(|x: f64| x + 0.0)
    }

    /// Whether a command is driven.
    pub fn is_driven(&self, j: usize) -> bool {
        self.controls.least[j] < self.controls.most[j]
    }

    /// Weights over a time.
    pub fn weights_over(&self, seconds: f64) -> Weights<f64, D, M> {
        let Weights { x, u } = self.weights;
        Weights { x: x.map(|w| w * seconds), u: u.map(|w| w * seconds) }
    }
}

/// A mechanism and its aim.
#[derive(Clone, Debug)]
pub struct Setting<P, const D: usize, const M: usize> {
    /// Plant, which makes the nodes of a motion and the ticks of the controller.
    pub plant: P,
    /// Duration of a tick, s.
    pub h: f64,
    /// Number of ticks in a node of a motion.
    pub ticks: u16,
    /// Numbers of the policy.
    pub aim: Aim<D, M>,
    /// Command that holds the goal.
    pub held: [f64; M],
    /// Regulator about the goal, tick by tick.
    pub regulator: Regulator<f64, D, M>,
}

/// Time for which a caught mechanism must stay at the goal, s.
const HELD: f64 = 1.6;
/// Largest deviation after this time, in units of equal weight.
const SETTLED: f64 = 1.0;
/// Deviation, in units of equal weight, from which on the mechanism is lost.
const LOST: f64 = 30.0;

impl<P: Plant<f64, D, M>, const D: usize, const M: usize> Setting<P, D, M> {
    /// Designs the regulator about the goal, where the command `held` keeps the mechanism at rest.
    ///
    /// # Errors
    /// [`RegulatorError`] if the goal cannot be held.
    pub fn new(
        plant: P,
        (h, ticks): (f64, u16),
        aim: Aim<D, M>,
        held: [f64; M],
    ) -> Result<Self, RegulatorError> {
        let transition =
            plant.linearise_at(&aim.goal, (1, &held)).map_err(|_| RegulatorError::NotStabilisable)?;
        let regulator = stationary(&transition, &aim.weights_over(h))?;
        Ok(Self { plant, h, ticks, aim, held, regulator })
    }

    /// Duration of a node, s.
    pub fn seconds(&self) -> f64 {
        self.h * f64::from(self.ticks)
    }

    /// Command of the regulator about the goal, without limits.
    pub fn holding(&self, x: &[f64; D]) -> [f64; M] {
        let deviation = self.aim.deviation(x, &self.aim.goal);
        let feedback = multiply(&self.regulator.gain, &deviation);
        from_fn(|j| self.held[j] - feedback[j])
    }

    /// Whether the regulator brings the mechanism from x to the goal within the limits.
    pub fn catches(&self, x: &[f64; D]) -> bool {
        let Ok(mut motion) = self.plant.begin(x) else { return false };
        let (mut x, count) = (*x, (HELD / self.h).ceil() as usize);
        for _ in 0..count {
            let u = self.aim.controls.clamped(&self.holding(&x));
            match self.plant.advance(&mut motion, (1, &u), &mut [0.0; D]) {
                Ok(next) => x = next,
                Err(_) => return false,
            }
            if self.distance(&x) > LOST {
                return false;
            }
        }
        self.distance(&x) <= SETTLED
    }

    /// Largest deviation from the goal in units of equal weight.
    pub fn distance(&self, x: &[f64; D]) -> f64 {
        let deviation = self.aim.deviation(x, &self.aim.goal);
        deviation.iter().zip(&self.aim.unit).map(|(d, unit)| (d / unit).abs()).fold(0.0, f64::max)
    }
}
