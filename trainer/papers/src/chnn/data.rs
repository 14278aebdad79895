//! The authors' chains, starts and training trajectories.

use leastaction_ground_truth::{
    BadMechanism, ExactMotion, Horizon, IntegrationError, Rod, Start, Truss, logged,
};
use leastaction_learning::data::Dataset;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use std::ops::Range;

/// Range of masses, kg, and of lengths of rods, m, which are uniformly distributed.
pub const LENGTHS: Range<f64> = 0.6..1.4;
/// Time between states, s.
pub const STEP: f64 = 0.03;
/// Number of states of a training trajectory.
const CHUNK: usize = 5;
/// Number of such trajectories into which the motion of 3 s from each start is cut; one of them is used.
const CHUNKS: usize = 20;

/// Returns a chain of `count` pendulums, g = 1; lengths are numbers of single precision, as in a model file.
///
/// # Errors
/// An error for an invalid chain.
pub fn chain(count: usize, seed: u64) -> Result<Truss, BadMechanism> {
    let mut stream = Pcg64::seed_from_u64(seed);
    let masses = (0..count).map(|_| stream.random_range(LENGTHS)).collect();
    let rod = |to: usize| Rod {
        from: to.checked_sub(1),
        to,
        length: f64::from(stream.random_range(LENGTHS) as f32),
    };
    let rods = (0..count).map(rod).collect();
    Truss { masses, gravity: 1.0, rods, ..Truss::free(count) }.checked()
}

/// Starts with normally distributed angles and angular velocities; their positions are disturbed by 0.2 m, their velocities halved and
/// disturbed by 0.4 m/s, and both are projected onto the rods.
pub fn starts(truss: &Truss, count: usize, seed: u64) -> Vec<Start> {
    let mut stream = Pcg64::seed_from_u64(seed);
    (0..count).map(|_| start(truss, &mut stream)).collect()
}

fn start(truss: &Truss, stream: &mut Pcg64) -> Start {
    let mut normal = |deviation: f64| -> f64 {
        let z: f64 = StandardNormal.sample(stream);
        deviation * z
    };
    let ([mut x, mut v], mut state) = ([[0.0; 2]; 2], [Vec::new(), Vec::new()]);
    for rod in &truss.rods {
        let ((sin, cos), omega) = (normal(1.0).sin_cos(), normal(1.0));
        let r = rod.length;
        x = [x[0] + r * sin, x[1] - r * cos];
        v = [v[0] + r * cos * omega, v[1] + r * sin * omega];
        state[0].extend(x.map(|x| x + normal(0.2)));
        state[1].extend(v.map(|v| 0.5 * v + normal(0.4)));
    }
    let [q, v] = state;
    let n = q.len();
    let mut state = [q, v].concat();
    // Near these states, the rods of a chain do not contradict each other.
    let _on_rods: Option<()> = truss.project(&mut state);
    let v = state.split_off(n);
    Start { q: state, v }
}

/// Data of five consecutive states from the motion of each start, beginning at one of twenty times.
///
/// # Errors
/// An error if the motion cannot be followed.
pub fn training_set(truss: &Truss, trajectories: usize, seed: u64) -> Result<Dataset, IntegrationError> {
    let horizon = Horizon { h: STEP, samples: CHUNK * CHUNKS };
    let mut data = logged(truss, &starts(truss, trajectories, seed), horizon, 0.0, seed)?;
    let mut stream = Pcg64::new(u128::from(seed), 2);
    for trajectory in &mut data.trajectories {
        let first = CHUNK * stream.random_range(0..CHUNKS);
        let chosen: Vec<usize> = (first..first + CHUNK).collect();
        trajectory.q = trajectory.q.select(&chosen);
        trajectory.v = trajectory.v.as_ref().map(|v| v.select(&chosen));
        trajectory.a = None;
    }
    Ok(data)
}
