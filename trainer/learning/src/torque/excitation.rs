//! Excitation motions for the identification of an arm: Fourier series within its limits that separate base parameters and friction well.
//!
//! q_i(t) = centre_i + Σ_k a_ik cos 2πkft + b_ik sin 2πkft with Σ k b_ik = 0 and Σ k² a_ik = 0. Velocity and
//! acceleration are 0 at t = 0, so every period starts and ends at rest. The objective is the condition number of the
//! regressor for base parameters and friction (viscous, Coulomb, offset) over one period, with its columns scaled to
//! norm 1. Every coordinate is scaled to its limits of position and velocity, so all candidates respect these. Torques
//! of the tree itself beyond their limits are penalised. The search does not know of obstacles.
//!
//! Source: Swevers et al., "Optimal robot excitation and identification", 1997; Gautier and Khalil, "Exciting trajectories for the
//! identification of base inertial parameters of robots", 1992.

use super::series::Series;
use crate::torque::linear::{BaseParameters, Design, Terms};
use leastaction_models::tree::{INERTIAL, Limits, Tree};
use rand::RngExt;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use std::f64::consts::TAU;
use thiserror::Error;

/// Settings of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Period of the motion (s).
    pub period: f64,
    /// Number of harmonics per coordinate, 3 or more: the start at rest takes two of their coefficients.
    pub harmonics: usize,
    /// Fraction of every limit that may be used, in (0, 1].
    pub share: f64,
    /// Number of searches, each from its own start.
    pub starts: usize,
    /// Number of motions that each search tries.
    pub trials: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for Search {
    /// 10 s, five harmonics, nine tenths of the limits, 8 searches of 500 motions.
    fn default() -> Self {
        Self { period: 10.0, harmonics: 5, share: 0.9, starts: 8, trials: 500, seed: 0 }
    }
}

/// Extent to which a motion uses the limits of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Use {
    /// Least and largest position (rad, m).
    pub position: [f64; 2],
    /// Largest |v| (rad/s, m/s).
    pub velocity: f64,
    /// Largest |τ| of the tree itself, without friction (N m, N).
    pub effort: f64,
}

/// A motion that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Excitation {
    /// The motion.
    pub series: Series,
    /// Condition numbers of the first motion tried and of this motion.
    pub condition: [f64; 2],
    /// Use of the limits by every coordinate.
    pub uses: Vec<Use>,
}

/// The reason why no motion is found.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ExcitationError {
    /// A required limit is missing.
    #[error("joint {joint}: the description has no limit of {what} for it")]
    NoLimit {
        /// Name of the joint.
        joint: String,
        /// "position" or "velocity".
        what: &'static str,
    },
    /// The limits leave no room for a motion.
    #[error("joint {joint}: no motion is within limits of {from} to {to} and a velocity of {velocity}")]
    NoRoom {
        /// Name of the joint.
        joint: String,
        /// Lower position limit.
        from: f64,
        /// Upper position limit.
        to: f64,
        /// Velocity limit.
        velocity: f64,
    },
    /// The search settings are invalid.
    #[error("{0}")]
    Search(&'static str),
    /// Torques exceed their limits even for the best motion.
    #[error(
        "joint {joint}: its own weight and motion take {found:.3} (N m, N) of at most {most:.3}; give a longer period, a smaller share of the \
         limits, or more trials"
    )]
    Effort {
        /// Name of the joint.
        joint: String,
        /// Largest |τ| of the motion.
        found: f64,
        /// Largest |τ| that may be used.
        most: f64,
    },
    /// No motion tried separates all numbers.
    #[error("none of the motions that were tried tells all base parameters and friction apart")]
    NotSeen,
}

/// Samples per period in the cost of a trial.
const LOOKS: usize = 100;
/// Samples per period for the check of limits.
const CHECKS: usize = 2000;
/// Width of Coulomb friction in the regressor (rad/s, m/s).
const WIDTH: f64 = 0.05;
/// Penalty weight: a torque at twice its usable limit costs as much as e^PENALTY times the condition number.
const PENALTY: f64 = 20.0;
/// Number of search variables of a coordinate besides its Fourier coefficients: the fraction of the room that it uses,
/// and the place of its centre.
const PLACE: usize = 2;
/// Initial size of a random step.
const STEP: f64 = 0.3;

/// Finds a motion of a tree within the limits of its coordinates. It depends on the seed alone, not on the number of threads.
///
/// # Errors
/// [`ExcitationError`].
pub fn excite(tree: &Tree, limits: &[Limits], search: &Search) -> Result<Excitation, ExcitationError> {
    let space = Space::new(tree, limits, search)?;
    let searches = (0..search.starts).into_par_iter().map(|start| space.search(start, search));
    let found: Vec<_> = searches.collect();
    let first = space.condition(&space.motion(&space.begin(0, search).1));
    let best = found.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).filter(|best| best.1.is_finite());
    let series = space.motion(&best.ok_or(ExcitationError::NotSeen)?.0);
    let condition = [first, space.condition(&series)];
    let uses = uses(tree, &series);
    for (k, (own, limits)) in uses.iter().zip(limits).enumerate() {
        if own.effort > limits.effort {
            let joint = tree.coordinate_name(k).to_owned();
            return Err(ExcitationError::Effort { joint, found: own.effort, most: limits.effort });
        }
    }
    Ok(Excitation { series, condition, uses })
}

/// The extent to which a motion uses the limits of every coordinate.
#[must_use]
pub fn uses(tree: &Tree, series: &Series) -> Vec<Use> {
    let samples = series.samples(CHECKS, (series.frequency * CHECKS as f64).recip());
    let n = tree.coordinates();
    let none = Use { position: [f64::INFINITY, -f64::INFINITY], velocity: 0.0, effort: 0.0 };
    let mut uses = vec![none; n];
    for (q, (v, a)) in samples.q.iter().zip(samples.v.iter().zip(samples.a.iter())) {
        let forces = tree.inverse_dynamics(q, v, a);
        for (i, own) in uses.iter_mut().enumerate() {
            own.position = [own.position[0].min(q[i]), own.position[1].max(q[i])];
            own.velocity = own.velocity.max(v[i].abs());
            own.effort = own.effort.max(forces[i].abs());
        }
    }
    uses
}

/// The space of motions within the limits of position and velocity, parametrised by unbounded numbers.
struct Space<'a> {
    tree: &'a Tree,
    limits: &'a [Limits],
    /// Columns of the regressor: base parameters of bodies and rotors, and friction.
    columns: Vec<usize>,
    frequency: f64,
    harmonics: usize,
    share: f64,
}

impl<'a> Space<'a> {
    fn new(tree: &'a Tree, limits: &'a [Limits], search: &Search) -> Result<Self, ExcitationError> {
        let Search { period, harmonics, share, starts, trials, .. } = *search;
        let is_share = share > 0.0 && share <= 1.0;
        if !(period.is_finite() && period > 0.0 && is_share) || harmonics < 3 || starts == 0 || trials == 0 {
            let what = "a period above 0, a share of the limits in (0, 1], at least 3 harmonics, one start and one trial";
            return Err(ExcitationError::Search(what));
        }
        for (k, own) in limits.iter().enumerate() {
            let joint = || tree.coordinate_name(k).to_owned();
            let ([from, to], velocity) = (own.position, own.velocity);
            for (what, is_there) in
                [("position", from.is_finite() && to.is_finite()), ("velocity", velocity.is_finite())]
            {
                if !is_there {
                    return Err(ExcitationError::NoLimit { joint: joint(), what });
                }
            }
            if to <= from || velocity <= 0.0 {
                return Err(ExcitationError::NoRoom { joint: joint(), from, to, velocity });
            }
        }
        let (bodies, n) = (INERTIAL * tree.bodies().len(), tree.coordinates());
        let friction = bodies + n..bodies + 4 * n;
        let columns = BaseParameters::of(tree).independent.into_iter().chain(friction).collect();
        Ok(Self { tree, limits, columns, frequency: period.recip(), harmonics, share })
    }

    /// Number of search variables per coordinate.
    fn width(&self) -> usize {
        2 * self.harmonics + PLACE
    }

    /// The random generator of a start, and its initial variables.
    fn begin(&self, start: usize, search: &Search) -> (Pcg64, Vec<f64>) {
        let mut random = Pcg64::new(u128::from(search.seed), start as u128);
        let mut coordinate = || -> Vec<f64> {
            let waves = (0..2 * self.harmonics).map(|_| normal(&mut random)).collect::<Vec<_>>();
            // The first motion uses nearly all of the available range.
            let place = [3.0, normal(&mut random)];
            waves.into_iter().chain(place).collect()
        };
        let numbers = (0..self.limits.len()).flat_map(|_| coordinate()).collect();
        (random, numbers)
    }

    /// The best motion found from a start, with its cost: steps in random directions, whose size adapts to their
    /// success.
    ///
    /// Source: Rechenberg's (1 + 1) evolution strategy with the rule of one fifth.
    fn search(&self, start: usize, search: &Search) -> (Vec<f64>, f64) {
        let (mut random, mut numbers) = self.begin(start, search);
        let mut cost = self.cost(&numbers);
        let mut size = STEP;
        for _ in 1..search.trials {
            // A step changes only some coordinates: it is easier to improve a few numbers than all at once.
            let width = self.width();
            let moved: Vec<bool> = self.limits.iter().map(|_| random.random_range(0.0..1.0) < 0.4).collect();
            let step =
                |(k, x): (usize, &f64)| if moved[k / width] { x + size * normal(&mut random) } else { *x };
            let trial: Vec<f64> = numbers.iter().enumerate().map(step).collect();
            let found = self.cost(&trial);
            if found < cost {
                (numbers, cost) = (trial, found);
                size = (1.5 * size).min(1.0);
            } else {
                size = (0.9 * size).max(0.01);
            }
        }
        (numbers, cost)
    }

    fn cost(&self, numbers: &[f64]) -> f64 {
        let series = self.motion(numbers);
        let torques = self.over_effort(&series);
        self.condition(&series).ln() + PENALTY * torques
    }

    /// Largest relative excess of a torque over the usable part of its limit.
    fn over_effort(&self, series: &Series) -> f64 {
        let samples = series.samples(LOOKS, self.step());
        let over = |(q, (v, a)): (&[f64], (&[f64], &[f64]))| -> f64 {
            let forces = self.tree.inverse_dynamics(q, v, a);
            let part = |(force, own): (&f64, &Limits)| force.abs() / (self.share * own.effort) - 1.0;
            forces.iter().zip(self.limits).map(part).fold(0.0, f64::max)
        };
        samples.q.iter().zip(samples.v.iter().zip(samples.a.iter())).map(over).fold(0.0, f64::max)
    }

    fn step(&self) -> f64 {
        (self.frequency * LOOKS as f64).recip()
    }

    fn condition(&self, series: &Series) -> f64 {
        let terms = Terms { rotors: true, viscous: true, coulomb: Some(WIDTH), offsets: true };
        Design::new(self.tree, &series.samples(LOOKS, self.step()), &terms).condition_of(&self.columns)
    }

    /// The motion for a vector of search variables.
    fn motion(&self, numbers: &[f64]) -> Series {
        let (mut centre, mut waves) = (Vec::new(), Vec::new());
        for (numbers, limits) in numbers.chunks(self.width()).zip(self.limits) {
            let (of_waves, place) = numbers.split_at(2 * self.harmonics);
            let unit = from_rest(of_waves.as_chunks().0);
            let alone = Series { frequency: self.frequency, centre: vec![0.0], waves: vec![unit] };
            let samples = alone.samples(LOOKS, self.step());
            let (low, high) = samples
                .q
                .as_flat()
                .iter()
                .fold((0.0_f64, 0.0_f64), |(low, high), q| (low.min(*q), high.max(*q)));
            let fastest = samples.v.as_flat().iter().fold(f64::MIN_POSITIVE, |most, v| most.max(v.abs()));
            let [from, to] = limits.position;
            let slack = (1.0 - self.share) * (to - from) / 2.0;
            let (from, to) = (from + slack, to - slack);
            let room = ((to - from) / (high - low).max(f64::MIN_POSITIVE))
                .min(self.share * limits.velocity / fastest);
            let scale = room * logistic(place[0]);
            let (least, most) = (from - scale * low, to - scale * high);
            centre.push(least + (most - least) * logistic(place[1]));
            waves.push(alone.waves[0].iter().map(|wave| wave.map(|x| scale * x)).collect());
        }
        Series { frequency: self.frequency, centre, waves }
    }
}

/// Projects waves onto those whose velocity and acceleration are 0 at t = 0.
fn from_rest(waves: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let k = |i: usize| (i + 1) as f64;
    let of = |part: usize, power: i32| {
        let product: f64 = waves.iter().enumerate().map(|(i, wave)| k(i).powi(power) * wave[part]).sum();
        product / (0..waves.len()).map(|i| k(i).powi(2 * power)).sum::<f64>()
    };
    let (a, b) = (of(0, 2), of(1, 1));
    let project = |(i, wave): (usize, &[f64; 2])| [wave[0] - a * k(i).powi(2), wave[1] - b * k(i)];
    waves.iter().enumerate().map(project).collect()
}

fn logistic(x: f64) -> f64 {
    (1.0 + (-x).exp()).recip()
}

/// A normal deviate, by Box and Muller.
fn normal(random: &mut Pcg64) -> f64 {
    let radius = (-2.0 * (1.0 - random.random_range(0.0..1.0_f64)).ln()).sqrt();
    radius * (TAU * random.random_range(0.0..1.0_f64)).cos()
}
