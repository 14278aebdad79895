//! A swing-up that is planned for the terms of the table of single swing-ups.
//!
//! The score falls with time, energy, torque, roughness and velocity, each by its tanh. A plan minimises a quadratic cost of torque, its rate and
//! the velocities; after each plan their weights become the slopes of the score there, until plan and weights agree. Energy Σ|Δq τ| is at most
//! Σ½(a Δq²/dt + τ² dt/a), least for a the ratio of torque to velocity. A weight of the distance from upright hurries.

use super::driven::{Driven, wave};
use super::plant::{DoublePendulum, State, UPRIGHT};
use super::policy::{ControlError, Robot, TICK};
use super::ramped::{Ramped, RampedState};
use super::scores::{SINGLE_SECONDS, Slopes, SwingUp};
use super::simulation::{Course, is_up};
use leastaction_core::control::{Cost, Limits, Penalty, Plant, Problem};
use leastaction_core::scalar::Real;
use leastaction_models::parallel;
use leastaction_planning::interior::{FreeMotion, Interior};
use std::ops::Range;

/// Number of ticks over which the plan holds the rate of the torque, and number of such nodes.
const TICKS: u16 = 5;
const NODES: usize = 300;
/// Largest torque of the plan, N m; the rest is for feedback.
const PLANNED: f64 = 5.5;
/// Largest rate of the torque, N m/s.
const RATE: f64 = 1e3;
/// Weights of the angles' distances from upright, 1/(rad² s).
const HURRY: [f64; 2] = [0.006, 0.002];
/// Numbers of nodes of the waves from which searches begin, and number of waves of each length.
const WAVES: [usize; 3] = [120, 160, 200];
const STARTS: usize = 8;
/// Ranges of a wave's amplitude, N m, and of its frequency, Hz.
const AMPLITUDE: Range<f64> = 0.5..4.5;
const FREQUENCY: Range<f64> = 0.5..2.3;
/// Number of plans after each of which the weights are set anew.
const ROUNDS: usize = 6;
/// Maximum number of iterations of a plan, its accuracy, and the largest gap that is accepted.
const ITERATIONS: u16 = 150;
const TOLERANCE: f64 = 1e-4;
const ACCEPTED: f64 = 1e-3;
/// Number of best plans whose first torque is improved, and changes of it that are tried, N m.
const IMPROVED: usize = 4;
const CHANGES: [f64; 4] = [0.8, 0.4, 0.2, 0.1];

type Motion = FreeMotion<5, 1>;

/// A plan and its score.
pub(super) struct Found {
    motion: Motion,
    pub score: f64,
}

/// State and torque of every tick of the best swing-up that is found.
///
/// # Errors
/// [`ControlError::NoSwingUp`].
pub fn plan(robot: Robot, model: &DoublePendulum) -> Result<Vec<(State, f64)>, ControlError> {
    let economy = Economy { plant: Ramped(Driven { pendulum: *model, robot }) };
    let starts = WAVES.len() * STARTS;
    let found = parallel::map(starts, &|start| {
        economy.planned(economy.wave(WAVES[start % WAVES.len()], start as u64)?)
    });
    let mut found: Vec<_> = found.into_iter().flatten().collect();
    found.sort_by(|a, b| b.score.total_cmp(&a.score));
    let best = parallel::map(found.len().min(IMPROVED), &|k| economy.improved(&found[k]));
    let best = best.into_iter().max_by(|a, b| a.score.total_cmp(&b.score));
    let best = best.ok_or(ControlError::NoSwingUp { starts, violation: f64::NAN })?;
    Ok(economy.ticks(&best.motion))
}

/// Weights of a plan's cost, per second.
struct Weights {
    v: [f64; 2],
    torque: f64,
    rate: f64,
}

impl Weights {
    /// The weights whose cost falls as the score rises, near a motion of the driven joint.
    fn of(terms: &SwingUp, motion: &Motion, driven: usize) -> Self {
        let Slopes { energy, torque, smoothness, velocity } = terms.slopes();
        let sum = |i: usize| motion.x.iter().map(|x| x[i] * x[i]).sum::<f64>();
        let ratio = (sum(4) / sum(2 + driven)).sqrt();
        let mut v = [2.0 * velocity; 2];
        v[driven] += energy * ratio;
        // A difference of torques in a tick is TICK · rate; smoothness is the root of the mean of their squares.
        let ticks = SINGLE_SECONDS / TICK;
        Self {
            v,
            torque: 2.0 * torque + energy / ratio,
            rate: smoothness * TICK / (ticks * terms.smoothness),
        }
    }
}

/// The search for a plant.
pub(super) struct Economy {
    pub plant: Ramped,
}

impl Economy {
    /// A motion of hanging under a wave of torque, and then upright.
    pub fn wave(&self, nodes: usize, seed: u64) -> Option<Motion> {
        let node = f64::from(TICKS) * TICK;
        let wave = wave(seed, AMPLITUDE, FREQUENCY, node);
        let mut x = [0.0, 0.0, 0.0, 0.0, wave(0)];
        let mut motion = Motion { x: Vec::new(), u: Vec::new(), end: x };
        for k in 0..nodes {
            let rate = [(wave(k + 1) - wave(k)) / node];
            motion.x.push(x);
            motion.u.push(rate);
            self.plant.advance(&mut x, (TICKS, &rate), &mut [0.0; 5]).ok()?;
        }
        // The nearest whole turn.
        let near = |i: usize| x[i] - (x[i] - UPRIGHT[i]).short_way();
        motion.end = [near(0), near(1), 0.0, 0.0, 0.0];
        motion.x.resize(NODES, motion.end);
        motion.u.resize(NODES, [0.0]);
        motion.x[0][4] = 0.0;
        Some(motion)
    }

    /// Plans near a motion; the best of all rounds.
    pub fn planned(&self, mut motion: Motion) -> Option<Found> {
        let mut best: Option<Found> = None;
        // A motion of middling terms has these slopes.
        let mut weights = Weights { v: [8e-4; 2], torque: 0.02, rate: 2e-5 };
        for _ in 0..ROUNDS {
            let Some(found) = self.solved(&motion, &weights) else { break };
            let terms = SwingUp::of(&self.course(&found));
            weights = Weights::of(&terms, &found, self.plant.0.robot.driven());
            motion = found.clone();
            let found = Found { motion: found, score: terms.score() };
            if best.as_ref().is_none_or(|best| best.score < found.score) {
                best = Some(found);
            }
        }
        best
    }

    /// Changes the first torque as long as the score rises: the competition does not count its jump.
    fn improved(&self, found: &Found) -> Found {
        let mut best = Found { motion: found.motion.clone(), score: found.score };
        for change in CHANGES {
            for change in [change, -change] {
                while let Some(better) = self.begun_with(&best, change) {
                    best = better;
                }
            }
        }
        best
    }

    /// A better plan that begins with another torque.
    fn begun_with(&self, found: &Found, change: f64) -> Option<Found> {
        let mut motion = found.motion.clone();
        let first = motion.x[0][4] + change;
        motion.x[0][4] = first;
        let better = |better: &Found| better.score > found.score;
        if first.abs() < PLANNED { self.planned(motion).filter(better) } else { None }
    }

    /// The best motion for some weights.
    fn solved(&self, motion: &Motion, weights: &Weights) -> Option<Motion> {
        let problem = self.problem(&motion.end, weights);
        let mut search = Interior::new(&problem, motion, TICKS, TOLERANCE).ok()?;
        search.solve(ITERATIONS, |_| true).ok()?;
        Some(Motion { end: motion.end, ..search.within(ACCEPTED)? })
    }

    /// State and torque of every tick. A node begins with its own state: what is left of the gap before it would grow.
    fn ticks(&self, motion: &Motion) -> Vec<(State, f64)> {
        let node = |([q1, q2, v1, v2, tau], [rate]): (&RampedState, &[f64; 1])| {
            self.plant.0.ticks([*q1, *q2, *v1, *v2], Ramped::torques(*tau, *rate, TICKS))
        };
        motion.x.iter().zip(&motion.u).flat_map(node).collect()
    }

    /// Course of a motion that is held at its end.
    fn course(&self, motion: &Motion) -> Course {
        let Driven { pendulum, robot } = self.plant.0;
        let ([q1, q2, ..], ticks) = (motion.end, self.ticks(motion));
        let mut states: Vec<_> = ticks.iter().map(|(x, _)| *x).collect();
        states.push([q1, q2, 0.0, 0.0]);
        let mut torques: Vec<_> = ticks.iter().map(|(_, tau)| robot.torques(*tau)).collect();
        torques.resize((SINGLE_SECONDS / TICK).round() as usize, [0.0; 2]);
        let up = states.iter().map(|x| is_up(&pendulum, *x)).collect();
        Course { states, torques, up }
    }

    fn problem(&self, goal: &RampedState, weights: &Weights) -> Problem<Ramped, f64, 5, 1> {
        let Weights { v: [v1, v2], torque, rate } = *weights;
        let [q1, q2] = HURRY;
        let mut limits = Limits::none();
        (limits.least[4], limits.most[4]) = (-PLANNED, PLANNED);
        Problem {
            plant: self.plant,
            cost: Cost {
                goal: *goal,
                turns: [false; 5],
                x: [q1, q2, v1, v2, torque].map(|weight| TICK * weight),
                u: [TICK * rate],
                end: [[0.0; 5]; 5],
            },
            controls: Limits { least: [-RATE], most: [RATE] },
            hard: Penalty { limits, weights: [1.0; 5] },
            soft: Penalty::none(),
            goal: Penalty { limits: Limits { least: *goal, most: *goal }, weights: [1.0; 5] },
            energy: Penalty::none(),
        }
    }
}
