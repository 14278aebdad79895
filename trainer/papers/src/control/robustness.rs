//! Robustness: swing-ups of a controller that knows nothing of what is wrong with its machine.

use super::disturbance::limited;
use super::plant::{DoublePendulum, UPRIGHT};
use super::policy::{Maker, Policy, Robot, TICK};
use super::scores::SINGLE_SECONDS;
use super::simulation::{Course, simulate};
use leastaction_core::scalar::Real;
use leastaction_models::parallel;
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use std::array::from_fn;

/// Columns of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Numbers of the pendulum are others.
    Model,
    /// The measured velocities are noisy.
    VelocityNoise,
    /// The torque is noisy.
    TorqueNoise,
    /// The drive carries out a part of each change, or more than it.
    SlowDrive,
    /// The measurement is late.
    Delay,
    /// Torques push.
    Pushes,
}

impl Column {
    /// All columns in their order.
    pub const ALL: [Self; 6] =
        [Self::Model, Self::VelocityNoise, Self::TorqueNoise, Self::SlowDrive, Self::Delay, Self::Pushes];

    /// Name in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Model => "parameters",
            Self::VelocityNoise => "velocity_noise",
            Self::TorqueNoise => "torque_noise",
            Self::SlowDrive => "slow_drive",
            Self::Delay => "delay",
            Self::Pushes => "pushes",
        }
    }
}

/// Number of values of each variation.
const VALUES: usize = 21;
/// Number of runs of each value of noise.
const REPETITIONS: usize = 10;
/// Number of runs with pushes.
const PUSHED: usize = 50;
/// Number of pushes of each joint.
const PUSHES: usize = 3;
/// Shortest time between two pushes, s.
const APART: f64 = 1.0;
/// Shortest and longest standard deviation of a push in time, s.
const WIDTHS: [f64; 2] = [0.05, 0.1];
/// Least and largest torque of a push, N m.
const SIZES: [f64; 2] = [0.5, 5.0];
/// Largest deviations of the end from upright that count: rad and rad/s.
const CLOSE: [f64; 2] = [0.35, 1.0];

/// Push of a joint: size exp(−(t − time)²/2 width²), N m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Time of its peak, s.
    pub time: f64,
    /// Standard deviation, s.
    pub width: f64,
    /// Torque at its peak, N m.
    pub size: f64,
}

impl Push {
    fn torque(&self, t: f64) -> f64 {
        let late = (t - self.time) / self.width;
        self.size * (-0.5 * late * late).exp()
    }
}

/// A machine that is not what its controller thinks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Imperfect {
    /// The pendulum.
    pub pendulum: DoublePendulum,
    /// Standard deviation of the measured velocities, rad/s.
    pub velocity_noise: f64,
    /// Standard deviation of the torque, N m.
    pub torque_noise: f64,
    /// Part r of a change of torque that is carried out in a tick: u ← u_last + r (u − u_last).
    pub response: f64,
    /// Delay of the measurement, s.
    pub delay: f64,
    /// Whether torques push.
    pub pushed: bool,
}

impl Imperfect {
    /// A machine without faults.
    pub const fn nominal() -> Self {
        let pendulum = DoublePendulum::competition();
        Self { pendulum, velocity_noise: 0.0, torque_noise: 0.0, response: 1.0, delay: 0.0, pushed: false }
    }
}

/// `VALUES` numbers from the least to the most.
fn values([least, most]: [f64; 2]) -> [f64; VALUES] {
    let step = (most - least) / (VALUES - 1) as f64;
    from_fn(|k| if k + 1 == VALUES { most } else { least + k as f64 * step })
}

/// Machines with other numbers of the pendulum: ten numbers, each with 21 values.
fn models() -> Vec<Imperfect> {
    type Set = fn(&mut DoublePendulum, f64);
    // A first moment changes by its centre of mass; inertias about the joints stay.
    let numbers: [([f64; 2], Set); 10] = [
        ([0.0, 1e-4], |p, x| p.rotor = x),
        ([0.75, 1.25], |p, x| p.centre[0] *= x),
        ([0.75, 1.25], |p, x| p.inertia[0] *= x),
        ([-0.1, 0.1], |p, x| p.damping[0] = x),
        ([-0.2, 0.2], |p, x| p.coulomb[0] = x),
        ([0.75, 1.25], |p, x| p.centre[1] *= x),
        ([0.75, 1.25], |p, x| p.mass[1] *= x),
        ([0.75, 1.25], |p, x| p.inertia[1] *= x),
        ([-0.1, 0.1], |p, x| p.damping[1] = x),
        ([-0.2, 0.2], |p, x| p.coulomb[1] = x),
    ];
    let of = |(range, set): ([f64; 2], Set)| {
        values(range).map(|x| {
            let mut machine = Imperfect::nominal();
            set(&mut machine.pendulum, x);
            machine
        })
    };
    numbers.into_iter().flat_map(of).collect()
}

/// Machines of a column, and how often each is run.
pub fn machines(column: Column) -> (Vec<Imperfect>, usize) {
    let nominal = Imperfect::nominal();
    let each = |range: [f64; 2], of: &dyn Fn(f64) -> Imperfect| values(range).map(of).to_vec();
    match column {
        Column::Model => (models(), 1),
        Column::VelocityNoise => {
            (each([0.0, 0.5], &|velocity_noise| Imperfect { velocity_noise, ..nominal }), REPETITIONS)
        }
        Column::TorqueNoise => {
            (each([0.0, 1.1], &|torque_noise| Imperfect { torque_noise, ..nominal }), REPETITIONS)
        }
        Column::SlowDrive => (each([0.1, 2.0], &|response| Imperfect { response, ..nominal }), 1),
        Column::Delay => (each([0.0, 0.04], &|delay| Imperfect { delay, ..nominal }), 1),
        Column::Pushes => (vec![Imperfect { pushed: true, ..nominal }; PUSHED], 1),
    }
}

/// Share of a column's machines on which more than half of the runs succeed. The random numbers are those of the seed.
pub fn share(column: Column, robot: Robot, maker: &Maker, seed: u64) -> f64 {
    let (machines, repetitions) = machines(column);
    let succeeds = parallel::map(machines.len() * repetitions, &|run| {
        let stream = (column as u128) << 64 | run as u128;
        let random = Pcg64::new(u128::from(seed), stream);
        is_upright(&course(&machines[run / repetitions], robot, &mut *maker(), random))
    });
    let survives = |runs: &&[bool]| 2 * runs.iter().filter(|run| **run).count() > runs.len();
    succeeds.chunks_exact(repetitions).filter(survives).count() as f64 / machines.len() as f64
}

/// Whether the last state counts as upright at rest. A state that is not finite does not.
pub fn is_upright(course: &Course) -> bool {
    let Some(x) = course.states.last() else { return false };
    (0..4).all(|i| {
        let d = x[i] - UPRIGHT[i];
        if i < 2 { d.short_way().abs() < CLOSE[0] } else { d.abs() < CLOSE[1] }
    })
}

/// Course of a swing-up. The order is that of DFKI's `Simulator`: measurement, late and noisy; command; drive with the torque before,
/// noise, limit, push.
///
/// A push of the passive joint has no effect, as there: the plant of its robustness table multiplies torques by a matrix that keeps those of
/// the driven joint alone.
pub fn course(machine: &Imperfect, robot: Robot, policy: &mut dyn Policy, mut random: Pcg64) -> Course {
    policy.reset();
    let pushes = machine.pushed.then(|| pushes(&mut random));
    let late = (machine.delay / TICK) as usize;
    let (mut last, mut tick) = (0.0, 0_u32);
    simulate(&machine.pendulum, SINGLE_SECONDS, |t, states| {
        let [q1, q2, v1, v2] = states[states.len().saturating_sub(1 + late)];
        let v = [v1, v2].map(|v| v + machine.velocity_noise * normal(&mut random));
        let command = policy.torque(t, [q1, q2], v);
        let driven = last + machine.response * (command - last) + machine.torque_noise * normal(&mut random);
        let time = f64::from(tick) * TICK;
        let pushed: f64 =
            pushes.iter().flat_map(|both| &both[robot.driven()]).map(|push| push.torque(time)).sum();
        last = limited(driven) + pushed;
        tick += 1;
        robot.torques(last)
    })
}

fn normal(random: &mut Pcg64) -> f64 {
    StandardNormal.sample(random)
}

/// Pushes of both joints, as DFKI's `get_random_gauss_perturbation_array` draws them: six times, one after the other and shuffled; widths;
/// sizes of either sign.
pub fn pushes(random: &mut Pcg64) -> [[Push; PUSHES]; 2] {
    const ALL: usize = 2 * PUSHES;
    let room = (SINGLE_SECONDS - (ALL + 1) as f64 * APART) / ALL as f64;
    let mut time = 0.0;
    let mut times: [f64; ALL] = from_fn(|_| {
        time += APART + random.random_range(0.0..1.0) * room;
        time
    });
    times.shuffle(random);
    let widths: [f64; ALL] = from_fn(|_| random.random_range(WIDTHS[0]..WIDTHS[1]));
    let range = SIZES[1] - SIZES[0];
    let sizes: [f64; ALL] = from_fn(|_| {
        let size: f64 = random.random_range(-range..range);
        size + SIZES[0].copysign(size)
    });
    let push = |k: usize| Push { time: times[k], width: widths[k], size: sizes[k] };
    from_fn(|joint| from_fn(|k| push(joint * PUSHES + k)))
}
