//! The protocol of LGNN's experiments (Bhattoo et al., MLST 2023), as in the authors' program, but with an exact motion
//! in place of the authors' integrator.

use super::logged::{GenerationError, Horizon, Start, logged};
use super::{BadMechanism, Rod, Truss};
use leastaction_data::{Dataset, Rows};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Acceleration of gravity, m/s².
const GRAVITY: f64 = 10.0;

/// A system of LGNN's experiments; all masses and lengths are 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LgnnSystem {
    /// Bobs in Cartesian coordinates, each on a rod that hangs from the bob above; the first rod hangs from the origin.
    Pendulum(usize),
    /// Nodes in a ring of springs, without gravity; at least 3.
    Spring(usize),
    /// Two bobs on rods, and two nodes that each hang by a spring from both bobs.
    Hybrid,
}

/// Springs of the hybrid, as pairs of nodes.
const HYBRID_SPRINGS: [[usize; 2]; 4] = [[0, 2], [2, 1], [1, 3], [3, 0]];

impl LgnnSystem {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pendulum(_) => "rod-pendulum",
            Self::Spring(_) => "n-spring",
            Self::Hybrid => "hybrid",
        }
    }

    /// Number of nodes.
    pub fn nodes(self) -> usize {
        match self {
            Self::Pendulum(nodes) | Self::Spring(nodes) => nodes,
            Self::Hybrid => 4,
        }
    }

    /// Rods.
    pub fn rods(self) -> Vec<Rod> {
        let rod = |to: usize| Rod { from: to.checked_sub(1), to, length: 1.0 };
        match self {
            Self::Pendulum(bobs) => (0..bobs).map(rod).collect(),
            Self::Spring(_) => Vec::new(),
            Self::Hybrid => (0..2).map(rod).collect(),
        }
    }

    /// Springs, as pairs of nodes.
    pub fn springs(self) -> Vec<[usize; 2]> {
        match self {
            Self::Pendulum(_) => Vec::new(),
            Self::Spring(nodes) => (0..nodes).map(|i| [i, (i + 1) % nodes]).collect(),
            Self::Hybrid => HYBRID_SPRINGS.to_vec(),
        }
    }

    fn gravity(self) -> f64 {
        match self {
            Self::Pendulum(_) | Self::Hybrid => GRAVITY,
            Self::Spring(_) => 0.0,
        }
    }
}

/// Settings of the generated data.
#[derive(Clone, Debug, PartialEq)]
pub struct LgnnSettings {
    /// System.
    pub system: LgnnSystem,
    /// Drag c ≥ 0 of every node, N s/m; the authors use 0.1.
    pub drag: f64,
    /// Force along x on the second node, N; the authors use 10 on the hybrid.
    pub pull: f64,
    /// Number of trajectories.
    pub trajectories: usize,
    /// Number of states in each trajectory.
    pub samples: usize,
    /// Time between states, s.
    pub h: f64,
    /// Standard deviation of the noise on positions and velocities, m and m/s.
    pub noise: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl LgnnSettings {
    /// The authors' training set: 100 trajectories of 100 states, at 100 Hz for systems with rods, at 10 Hz for springs.
    pub fn published(system: LgnnSystem, seed: u64) -> Self {
        let h = if system.rods().is_empty() { 0.1 } else { 0.01 };
        Self { system, drag: 0.0, pull: 0.0, trajectories: 100, samples: 100, h, noise: 0.0, seed }
    }

    /// The exact system.
    ///
    /// # Errors
    /// [`BadMechanism`] for a system without nodes, or a ring of fewer than 3.
    pub fn truss(&self) -> Result<Truss, BadMechanism> {
        let system = self.system;
        if let LgnnSystem::Spring(nodes @ ..3) = system {
            let (quantity, range) = ("nodes in a ring:", "at least 3");
            return Err(BadMechanism::OutOfRange { element: 0, quantity, value: nodes as f64, range });
        }
        let (gravity, springs, rods) = (system.gravity(), system.springs(), system.rods());
        let pulls = if self.pull == 0.0 { Vec::new() } else { vec![(1, [self.pull, 0.0])] };
        Truss { gravity, springs, rods, drag: self.drag, pulls, ..Truss::free(system.nodes()) }.checked()
    }
}

/// The initial states of the trajectories, from one random stream.
///
/// Bobs rest at angles from the downward vertical that are whole numbers 0 … 359, *in radians*: the authors draw
/// degrees and use them as radians. Nodes of a ring have x ∈ U(0, 2)² and v ∈ U(0, 0.1)² minus the mean velocity. The
/// free nodes of the hybrid rest within ±1 m of the midpoint of the bobs.
pub fn lgnn_starts(settings: &LgnnSettings) -> Vec<Start> {
    let mut stream = Pcg64::seed_from_u64(settings.seed);
    let one = |_| match settings.system {
        LgnnSystem::Pendulum(bobs) => at_rest(hanging(bobs, &mut stream)),
        LgnnSystem::Spring(nodes) => ring(nodes, &mut stream),
        LgnnSystem::Hybrid => at_rest(hybrid(&mut stream)),
    };
    (0..settings.trajectories).map(one).collect()
}

fn at_rest(x: Vec<[f64; 2]>) -> Start {
    let q = x.into_flattened();
    Start { v: vec![0.0; q.len()], q }
}

fn hanging(bobs: usize, stream: &mut Pcg64) -> Vec<[f64; 2]> {
    let mut end = [0.0, 0.0];
    let bob = |_| {
        let (sin, cos) = f64::from(stream.random_range(0..360u16)).sin_cos();
        end = [end[0] + sin, end[1] - cos];
        end
    };
    (0..bobs).map(bob).collect()
}

fn ring(nodes: usize, stream: &mut Pcg64) -> Start {
    let q = (0..2 * nodes).map(|_| stream.random_range(0.0..2.0)).collect();
    let mut v: Vec<[f64; 2]> = (0..nodes).map(|_| [(); 2].map(|()| stream.random_range(0.0..0.1))).collect();
    let mean = [0, 1].map(|i| v.iter().map(|v| v[i]).sum::<f64>() / nodes as f64);
    v.iter_mut().for_each(|v| *v = [v[0] - mean[0], v[1] - mean[1]]);
    Start { q, v: v.into_flattened() }
}

fn hybrid(stream: &mut Pcg64) -> Vec<[f64; 2]> {
    let mut x = hanging(2, stream);
    let middle = [0, 1].map(|i| 0.5 * (x[0][i] + x[1][i]));
    x.extend([(); 2].map(|()| middle.map(|x| x + stream.random_range(-1.0..1.0))));
    x
}

/// Trajectories with positions, velocities and exact accelerations, and with the force if there is one.
///
/// # Errors
/// [`GenerationError`] for an invalid system, and if the motion cannot be integrated.
pub fn lgnn_set(settings: &LgnnSettings) -> Result<Dataset, GenerationError> {
    let LgnnSettings { h, samples, noise, seed, .. } = *settings;
    let truss = settings.truss()?;
    let mut data = logged(&truss, &lgnn_starts(settings), Horizon { h, samples }, noise, seed)?;
    if !truss.pulls.is_empty() {
        let force = truss.pull().into_flattened();
        for trajectory in &mut data.trajectories {
            trajectory.u = Rows::from_flat(data.n, force.repeat(samples));
        }
    }
    Ok(data)
}
