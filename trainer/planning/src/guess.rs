//! Start guesses: motions from which a search begins.

use crate::Task;
use crate::interior::FreeMotion;
use crate::problem::array;
use leastaction_core::continuous::inverse_dynamics;
use leastaction_models::Model;
use leastaction_replica::SystemOf;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::array::from_fn;
use std::f64::consts::TAU;

/// Kind of a start guess.
#[derive(Clone, Debug, PartialEq)]
pub enum Guess {
    /// Commands of every node.
    Given(Vec<Vec<f64>>),
    /// States and commands of every node of a motion that was found, and its last state.
    Near([Vec<Vec<f64>>; 2], Vec<f64>),
    /// States and forces of the straight line from the start to the goal, at rest at both ends.
    Line,
    /// Forces along the motion until the energy is that of the goal.
    Energy,
    /// The best of a few random waves.
    Random(u64),
}

impl Guess {
    /// Name of the guess.
    pub fn name(&self) -> String {
        match self {
            Self::Given(_) => "given".to_owned(),
            Self::Near(..) => "near the best".to_owned(),
            Self::Line => "straight line".to_owned(),
            Self::Energy => "energy".to_owned(),
            Self::Random(k) => format!("random {k}"),
        }
    }

    /// The guesses of a search.
    pub fn of_search(starts: usize) -> Vec<Self> {
        let fixed = [Self::Line, Self::Energy];
        fixed.into_iter().chain((0..).map(Self::Random)).take(starts).collect()
    }
}

/// Motion from which a search begins.
pub struct Motion<const D: usize, const N: usize> {
    /// Motion of free states, if the guess has one.
    pub free: Option<FreeMotion<D, N>>,
    /// Commands of every node that make a motion.
    pub commands: Vec<[f64; N]>,
}

/// Number of random waves of which the best is taken.
const SHOTS: usize = 24;
/// Rate of the feedback to the straight line, times the duration of the motion.
const FEEDBACK: f64 = 20.0;
/// Number of parts of the straight line between which postures are looked at.
const POSTURES: usize = 20;
/// Number of waves that are added up.
const WAVES: usize = 3;

/// Makes commands of K nodes for a system.
pub struct Guesser<'s, const N: usize> {
    /// The task.
    pub task: &'s Task,
    /// The model, whose actuator turns commands into forces.
    pub model: &'s Model,
    /// The system.
    pub system: &'s SystemOf<'s, N>,
}

impl<const N: usize> Guesser<'_, N> {
    /// Motion of `nodes` nodes; `roll` returns how far from the goal the motion of a law ends, infinite if it cannot be computed.
    pub fn motion<const D: usize>(
        &self,
        guess: &Guess,
        nodes: usize,
        roll: impl Fn(&mut dyn FnMut(usize, &[f64]) -> [f64; N]) -> f64,
    ) -> Motion<D, N> {
        let free = match guess {
            Guess::Near([x, u], end) => {
                Some(FreeMotion { x: resampled(x, nodes), u: resampled(u, nodes), end: array(end) })
            }
            // A coordinate that is not driven does not follow a straight line.
            Guess::Line if self.task.is_fully_driven() => {
                let (x, u) = (0..nodes).map(|k| self.line_node((k, nodes))).unzip();
                Some(FreeMotion { x, u, end: self.line_state(1.0, nodes) })
            }
            Guess::Line | Guess::Given(_) | Guess::Energy | Guess::Random(_) => None,
        };
        Motion { free, commands: self.commands(guess, nodes, roll) }
    }

    /// Commands of `nodes` nodes.
    fn commands(
        &self,
        guess: &Guess,
        nodes: usize,
        roll: impl Fn(&mut dyn FnMut(usize, &[f64]) -> [f64; N]) -> f64,
    ) -> Vec<[f64; N]> {
        match guess {
            Guess::Given(rows) | Guess::Near([_, rows], _) => resampled(rows, nodes),
            Guess::Line => recorded(nodes, roll, |k, x| self.on_line((k, nodes), x)),
            Guess::Energy => recorded(nodes, roll, |_, x| self.pumped(x)),
            Guess::Random(k) => {
                let mut random =
                    Pcg64Mcg::seed_from_u64(self.task.search.seed.wrapping_add(k.wrapping_mul(0x9e37_79b9)));
                let shots = (0..SHOTS).map(|_| self.waves(&mut random, nodes));
                let scored = shots.map(|commands| (roll(&mut |k, _| commands[k]), commands));
                let best = scored.min_by(|a, b| a.0.total_cmp(&b.0));
                best.map_or_else(|| vec![[0.0; N]; nodes], |(_, commands)| commands)
            }
        }
    }

    /// Command that a force needs, within the limits.
    fn command(&self, tau: [f64; N]) -> [f64; N] {
        let command = self.unlimited(tau);
        from_fn(|i| match self.task.limits.is_driven(i) {
            true => {
                let [least, most] = self.task.limits.planned(i);
                command[i].clamp(least, most)
            }
            false => 0.0,
        })
    }

    /// Command that a force needs.
    fn unlimited(&self, tau: [f64; N]) -> [f64; N] {
        let actuator = &self.model.facts.actuator;
        from_fn(|i| (tau[i] - actuator.offset(i)) / actuator.gain(i))
    }

    /// Whether the drives hold every posture of the straight line at rest, so that nothing needs to be swung.
    pub fn holds_line(&self) -> bool {
        let Task { limits, .. } = self.task;
        let within = |command: [f64; N]| {
            let range = |i: usize| limits.planned(i);
            (0..N).all(|i| limits.is_driven(i) && (range(i)[0]..=range(i)[1]).contains(&command[i]))
        };
        let rest = [0.0; N];
        (0..=POSTURES).all(|k| {
            let q = self.line(k as f64 / POSTURES as f64, 1).map(|[q, ..]| q as f32);
            let tau = inverse_dynamics(self.system, &q, &rest, &rest);
            tau.is_ok_and(|tau| within(self.unlimited(tau.map(f64::from))))
        })
    }

    /// Command of node k that follows the straight line from the start to the goal, in the time law of least jerk: inverse dynamics, with
    /// feedback of the distance from the line.
    fn on_line(&self, (k, nodes): (usize, usize), x: &[f64]) -> [f64; N] {
        let place = (k as f64 + 0.5) / nodes as f64;
        let (line, omega) = (self.line(place, nodes), FEEDBACK / self.seconds(nodes));
        let now = |i: usize| x.get(i).copied().unwrap_or_default();
        let acceleration = |i: usize| {
            let [q, v, a] = line[i];
            (a + 2.0 * omega * (v - now(N + i)) + omega * omega * (q - now(i))) as f32
        };
        let (q, v) = (from_fn(|i| now(i) as f32), from_fn(|i| now(N + i) as f32));
        let tau = inverse_dynamics(self.system, &q, &v, &from_fn(acceleration));
        tau.map_or([0.0; N], |tau| self.command(tau.map(f64::from)))
    }

    /// Duration of a number of nodes, s.
    fn seconds(&self, nodes: usize) -> f64 {
        nodes as f64 * self.task.node_seconds()
    }

    /// Position, velocity and acceleration of every coordinate after the part s of the straight line, in the time law of least jerk.
    fn line(&self, s: f64, nodes: usize) -> [[f64; 3]; N] {
        let (goal, seconds) = (self.task.goal.middle(), self.seconds(nodes));
        let place = s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
        let rate = 30.0 * s * s * (1.0 - s) * (1.0 - s) / seconds;
        let bend = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (seconds * seconds);
        from_fn(|i| {
            let way = goal[i] - self.task.start[i];
            let way = if self.task.goal.turns[i] { way - TAU * (way / TAU).round() } else { way };
            [self.task.start[i] + way * place, way * rate, way * bend]
        })
    }

    /// State after the part s of the straight line.
    fn line_state<const D: usize>(&self, s: f64, nodes: usize) -> [f64; D] {
        let line = self.line(s, nodes);
        from_fn(|i| if i < N { line[i][0] } else { line[i - N][1] })
    }

    /// State and command of a node of the straight line.
    fn line_node<const D: usize>(&self, (k, nodes): (usize, usize)) -> ([f64; D], [f64; N]) {
        let state = |k: f64| -> [f64; D] { self.line_state(k / nodes as f64, nodes) };
        (state(k as f64), self.on_line((k, nodes), &state(k as f64 + 0.5)))
    }

    /// Command that brings the energy to that of the goal, at full force.
    fn pumped(&self, x: &[f64]) -> [f64; N] {
        let goal = self.task.goal.middle();
        let state = |x: &[f64]| -> [[f32; N]; 2] {
            [
                from_fn(|i| x.get(i).map_or(0.0, |x| *x as f32)),
                from_fn(|i| x.get(N + i).map_or(0.0, |x| *x as f32)),
            ]
        };
        let energy = |[q, v]: [[f32; N]; 2]| {
            let of = self.system.energies(&q, &v);
            f64::from(of.kinetic + of.potential)
        };
        let wanted = self.task.goal.energy.unwrap_or_else(|| energy(state(&goal)));
        let (lack, start) = (wanted - energy(state(x)), energy(state(&self.task.start)));
        let share = lack / (wanted - start).abs().max(1e-9);
        from_fn(|i| match self.task.limits.is_driven(i) {
            true => {
                let [least, most] = self.task.limits.planned(i);
                let v = x.get(N + i).copied().unwrap_or_default();
                let gain = self.model.facts.actuator.gain(i).signum();
                // A little push at rest, where no force adds energy.
                let push = (10.0 * share * (v + 0.01)).clamp(-1.0, 1.0) * gain;
                if push > 0.0 { push * most } else { -push * least }
            }
            false => 0.0,
        })
    }

    /// Sums of random waves within the limits.
    fn waves(&self, random: &mut impl Rng, nodes: usize) -> Vec<[f64; N]> {
        let waves: [[[f64; 3]; WAVES]; N] = from_fn(|_| {
            from_fn(|_| {
                let periods = 0.25 + 5.0 * random.random::<f64>();
                [0.7 * random.random::<f64>(), periods, TAU * random.random::<f64>()]
            })
        });
        let at = |k: usize, i: usize| {
            let s = k as f64 / nodes as f64;
            let sum = waves[i].iter().map(|[size, periods, phase]| size * (TAU * periods * s + phase).sin());
            let [least, most] = self.task.limits.planned(i);
            let middle = 0.5 * (least + most);
            (middle + 0.5 * (most - least) * sum.sum::<f64>()).clamp(least, most)
        };
        let driven = |k: usize, i: usize| if self.task.limits.is_driven(i) { at(k, i) } else { 0.0 };
        (0..nodes).map(|k| from_fn(|i| driven(k, i))).collect()
    }
}

/// Commands of a law along the motion that they make.
fn recorded<const N: usize>(
    nodes: usize,
    roll: impl Fn(&mut dyn FnMut(usize, &[f64]) -> [f64; N]) -> f64,
    law: impl Fn(usize, &[f64]) -> [f64; N],
) -> Vec<[f64; N]> {
    let mut commands = vec![[0.0; N]; nodes];
    roll(&mut |k, x| {
        let u = law(k, x);
        if let Some(slot) = commands.get_mut(k) {
            *slot = u;
        }
        u
    });
    commands
}

/// Commands of another number of nodes, by linear interpolation over the same course.
fn resampled<const N: usize>(rows: &[Vec<f64>], nodes: usize) -> Vec<[f64; N]> {
    let at = |row: usize, i: usize| rows.get(row).and_then(|row| row.get(i)).copied().unwrap_or_default();
    let last = rows.len().saturating_sub(1);
    (0..nodes)
        .map(|k| {
            // A log of a plan has one row more, at its end.
            if rows.len() == nodes || rows.len() == nodes + 1 {
                return from_fn(|i| at(k, i));
            }
            let place = (k as f64 + 0.5) / nodes as f64 * rows.len() as f64 - 0.5;
            let place = place.clamp(0.0, last as f64);
            let (low, part) = (place as usize, place.fract());
            from_fn(|i| at(low, i) + part * (at((low + 1).min(last), i) - at(low, i)))
        })
        .collect()
}
