//! A task as a problem of optimal control, its sizes being types.

use crate::Task;
use crate::plant::{PlantStep, Widened};
use crate::task::LimitsOf;
use leastaction_core::control::{Cost, Limits, Options, Penalty, Plant, Problem};
use leastaction_core::discrete::Newton;
use leastaction_core::forces::Actuator;
use leastaction_models::Model;
use leastaction_replica::SystemOf;
use std::array::from_fn;

/// Numbers of a list; 0 beyond its end.
pub fn array<const K: usize>(list: &[f64]) -> [f64; K] {
    from_fn(|i| list.get(i).copied().unwrap_or_default())
}

/// Ends of a list of intervals.
pub fn ends<const K: usize>(list: &[[f64; 2]]) -> Limits<f64, K> {
    let end = |side: usize| from_fn(|i| list.get(i).map_or(0.0, |range| range[side]));
    Limits { least: end(0), most: end(1) }
}

impl LimitsOf {
    /// A range of every command; 0 alone for one that is not driven.
    pub(crate) fn commands<const N: usize>(&self, range: impl Fn(usize) -> [f64; 2]) -> Limits<f64, N> {
        let ranges: [[f64; 2]; N] = from_fn(|i| if self.is_driven(i) { range(i) } else { [0.0; 2] });
        ends(&ranges)
    }
}

impl Task {
    /// The model under the task's steps, one every tick.
    pub(crate) fn plant<'s, const N: usize>(
        &self,
        system: &'s SystemOf<'s, N>,
        model: &Model,
    ) -> Widened<'s, N> {
        self.striding(system, model, 1)
    }

    /// The model under steps of up to `stride` ticks. Coordinates that are not driven have no gain.
    pub(crate) fn striding<'s, const N: usize>(
        &self,
        system: &'s SystemOf<'s, N>,
        model: &Model,
        stride: u16,
    ) -> Widened<'s, N> {
        let actuator = &model.facts.actuator;
        let gain = |i: usize| if self.limits.is_driven(i) { actuator.gain(i) as f32 } else { 0.0 };
        let actuator =
            Actuator { gain: from_fn(gain), offset: from_fn(|i| actuator.offset(i) as f32), delay: 0.0 };
        let (tick, order) = (self.tick, self.order);
        Widened::new(system, PlantStep { tick, order, stride, newton: newton(), actuator })
    }

    /// The problem over a plant.
    pub(crate) fn problem<P: Plant<f64, D, N>, const N: usize, const D: usize>(
        &self,
        plant: P,
    ) -> Problem<P, f64, D, N> {
        let dt = self.tick;
        let weights = |list: &[f64]| list.iter().map(|weight| weight * dt).collect::<Vec<_>>();
        let unit = [1.0; D];
        let energy = self.energy_goal(&plant);
        Problem {
            plant,
            cost: Cost {
                goal: array(&self.goal.middle()),
                turns: from_fn(|i| self.goal.turns.get(i).copied().unwrap_or_default()),
                x: array(&weights(&self.cost.x)),
                u: array(&weights(&self.cost.u)),
                end: [[0.0; D]; D],
            },
            controls: self.limits.commands(|i| self.limits.planned(i)),
            hard: Penalty { limits: ends(&self.limits.x), weights: unit },
            soft: Penalty { limits: ends(&self.soft.0), weights: [self.soft.1 * dt; D] },
            goal: Penalty { limits: ends(&self.goal.state), weights: unit },
            energy,
        }
    }

    /// Goal of the energy; the unit of its deviations is its distance from the energy of the start.
    fn energy_goal<P: Plant<f64, D, N>, const N: usize, const D: usize>(&self, plant: &P) -> Penalty<f64, 1> {
        let (Some(wanted), Some((start, _))) = (self.goal.energy, plant.energy(&array(&self.start))) else {
            return Penalty::none();
        };
        let unit = (wanted - start).abs().max(f64::MIN_POSITIVE.sqrt());
        Penalty { limits: Limits { least: [wanted], most: [wanted] }, weights: [1.0 / (unit * unit)] }
    }

    /// Bounds of the search.
    pub(crate) fn options(&self) -> Options<f64> {
        Options {
            iterations: self.search.iterations,
            tolerance: 1e-5,
            violation: WANTED,
            penalty: 1.0,
            growth: 10.0,
        }
    }
}

/// Bounds of Newton's method: a residual that rounding does not see is carried to the next step, and need not be solved away.
fn newton() -> Newton<f32> {
    Newton { stop: 1e-6, ..Newton::new() }
}

/// Violation at which the search is content, in the units of [`ACCEPTED`].
const WANTED: f64 = 2e-5;
/// Largest accepted violation of limits and goal, rad, m, rad/s or m/s: the steps are in single precision.
pub const ACCEPTED: f64 = 1e-4;
