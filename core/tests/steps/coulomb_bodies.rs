//! Random robots with stiff dry friction, and with friction that sticks: every step is solved, through every change of sign.

use crate::common::{Random, bodies::Bodies, bodies::body};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Path, Report, State, StepError};
use leastaction_core::energy::bodies::{BodyParameters, Joint};
use leastaction_core::forces::{Coulomb, DryFriction, Forces, Sticking, StickingFriction, System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::scalar::Real;

/// Speed, rad/s or m/s, beyond which a system no longer resembles a robot.
const SPEED: f64 = 12.0;

/// Random number between two numbers of the same sign, uniform in its logarithm.
fn between(random: &mut Random, [least, most]: [f64; 2]) -> f64 {
    least * (most / least).powf(0.5 + random.symmetric(0.5))
}

/// A machine of a few hundred grams to a few kilograms. Three joints in four turn, and each sits on the previous body
/// or on another one.
fn machine<const N: usize>(random: &mut Random) -> Bodies<N> {
    let tree = core::array::from_fn(|i| {
        let joint = if random.symmetric(1.0) < 0.5 { Joint::Revolute } else { Joint::Prismatic };
        let on = if random.symmetric(1.0) < 0.5 { i } else { random.bits() as usize % (i + 1) };
        body(joint, on.checked_sub(1).map(|parent| parent as u8))
    });
    let numbers = core::array::from_fn(|_| {
        let mass = between(random, [0.1, 3.0]);
        let centre = [0.2 + random.symmetric(0.2), random.symmetric(0.02)];
        let inertia = mass * between(random, [1e-3, 0.05]);
        let (rotor, gear) = (between(random, [1e-6, 1e-4]), between(random, [1.0, 10.0]));
        let place = [0.3 + random.symmetric(0.2), random.symmetric(0.05)];
        BodyParameters { place, angle: random.symmetric(0.5), mass, centre, inertia, rotor, gear }
    });
    Bodies::hanging(tree, numbers)
}

/// Random friction of a robot's joints.
trait Friction<R: Real, const N: usize>: Forces<R, N> {
    fn random(random: &mut Random) -> Self;
}

impl<R: Real, const N: usize> Friction<R, N> for (Viscous<R, N>, Coulomb<R, N>) {
    fn random(random: &mut Random) -> Self {
        friction(random)
    }
}

/// Levels that differ by direction, and up to half as much again at rest.
impl<R: Real, const N: usize> Friction<R, N> for (Viscous<R, N>, Sticking<R, N>) {
    fn random(random: &mut Random) -> Self {
        let (viscous, Coulomb { coordinates }) = friction(random);
        let sticking = coordinates.map(|DryFriction { constant, load, smoothing, width }| {
            let breakaway = R::constant(1.25 + random.symmetric(0.25));
            let asymmetry = R::constant(random.symmetric(0.5));
            StickingFriction { constant, asymmetry, load, smoothing, breakaway, width }
        });
        (viscous, Sticking { coordinates: sticking })
    }
}

fn friction<R: Real, const N: usize>(random: &mut Random) -> (Viscous<R, N>, Coulomb<R, N>) {
    let number = |x: f64| R::constant(x);
    let coordinates = core::array::from_fn(|_| DryFriction {
        constant: number(between(random, [0.02, 1.0])),
        load: number(0.1 + random.symmetric(0.1)),
        smoothing: number(0.05),
        width: number(between(random, [0.02, 1.0])),
    });
    let coefficients = core::array::from_fn(|_| number(between(random, [1e-3, 0.1])));
    (Viscous { coefficients }, Coulomb { coordinates })
}

/// Outcome of the steps of many machines.
#[derive(Debug, Default)]
struct Steps {
    updates: usize,
    solved: usize,
    turning: usize,
    most: u8,
    unsolved: usize,
}

impl Steps {
    fn add<R>(&mut self, step: Result<Report<R>, StepError<R>>) {
        let Ok(report) = step else {
            self.unsolved += 1;
            return;
        };
        self.solved += 1;
        self.updates += usize::from(report.iterations);
        self.most = self.most.max(report.iterations);
    }

    /// Follows a machine for 1 s while every drive pushes to and fro.
    fn follow<R: Real, P: Path, F, L, const N: usize>(&mut self, lagrangian: &L, random: &mut Random)
    where
        L: Lagrangian<R, N>,
        F: Friction<R, N>,
    {
        let (h, forces) = (between(random, [0.001, 0.01]), F::random(random));
        let (del, system) = (Del::<R, P>::new(R::constant(h)), System { lagrangian, forces });
        let mut drive = |most: f64| core::array::from_fn::<f64, N, _>(|_| most + random.symmetric(most));
        let (amplitude, rate, q) = (drive(0.5), drive(15.0), drive(1.0));
        let mut state = State::new(&system.lagrangian, q.map(R::constant), [R::zero(); N]).unwrap();
        for k in 0..(1.0 / h) as usize {
            let u = core::array::from_fn(|i| R::constant(amplitude[i] * (rate[i] * k as f64 * h).sin()));
            let before = state.last_increment();
            if before.iter().any(|v| v.abs() > R::constant(SPEED)) {
                return;
            }
            self.add(del.step(&system, &mut state, &Control::held(u)));
            let turned = |(a, b): (&R, &R)| (*a > R::zero()) != (*b > R::zero());
            self.turning += usize::from(before.iter().zip(&state.last_increment()).any(turned));
        }
    }

    /// Takes single steps near rest: from a momentum with a wrong guess, and from two positions with noise.
    fn strike<R: Real, P: Path, F, L, const N: usize>(&mut self, lagrangian: &L, random: &mut Random)
    where
        L: Lagrangian<R, N>,
        F: Friction<R, N>,
    {
        let system = System { lagrangian, forces: F::random(random) };
        for _ in 0..40 {
            let h = between(random, [0.001, 0.01]);
            let speed = between(random, [0.01, 3.0]);
            let [q, v, off, u] = [3.0, speed, 2.0, 1.0].map(|most| random.array::<N>(most));
            let [q, v, u] = [q, v, u].map(|x| x.map(R::constant));
            let w = core::array::from_fn(|i| v[i] + R::constant(off[i]));
            let (del, u) = (Del::<R, P>::new(R::constant(h)), Control::held(u));
            let p = system.lagrangian.linearization(&q, &v).l_v;
            let mut state = State::with_momentum(q, p, w).unwrap();
            self.add(del.step(&system, &mut state, &u));
            let end = core::array::from_fn(|i| q[i] + R::constant(h) * w[i]);
            let started = del.start(&system, &q, &end, &u);
            self.add(started.and_then(|mut state| del.step(&system, &mut state, &u)));
        }
    }
}

/// Maximum numbers of updates in motion and from bad guesses, in double and in single precision.
const SMOOTH: [[u8; 2]; 2] = [[12, 16], [10, 12]];
/// [`SMOOTH`] for friction that sticks, over all rounds.
const STICKING: [[u8; 2]; 2] = [[24, 48], [20, 48]];

/// Moves many machines of N joints, each in both precisions.
fn check<P: Path, F: Friction<f64, N>, G: Friction<f32, N>, const N: usize>(limits: [[u8; 2]; 2]) {
    let mut all: [[Steps; 2]; 2] = Default::default();
    let [[moving, struck], [moving_f32, struck_f32]] = &mut all;
    for seed in 0..if N > 4 { 25 } else { 100 } {
        let mut random = Random(1_000 * N as u64 + seed);
        let machine = machine::<N>(&mut random);
        let (double, weights) = (machine.in_f64(), machine.single());
        let single = machine.over(&weights);
        moving.follow::<f64, P, F, _, N>(&double, &mut random.clone());
        moving_f32.follow::<f32, P, G, _, N>(&single, &mut random.clone());
        struck.strike::<f64, P, F, _, N>(&double, &mut random.clone());
        struck_f32.strike::<f32, P, G, _, N>(&single, &mut random);
    }
    for (steps, most) in all.iter().flatten().zip(limits.iter().flatten()) {
        let mean = steps.updates as f64 / steps.solved as f64;
        println!("order {}, {N} coordinates: {mean:.2} updates, {steps:?}", P::ORDER);
        assert_eq!(steps.unsolved, 0, "order {}, {N} coordinates", P::ORDER);
        assert!(steps.most <= *most, "order {}, {N} coordinates: {} updates", P::ORDER, steps.most);
    }
    assert!(all.iter().all(|[moving, _]| moving.turning > 100), "{all:?}");
}

#[test]
fn every_step_of_a_robot_with_stiff_friction_is_solved() {
    fn stiff<P: Path, const N: usize>() {
        check::<P, (Viscous<f64, N>, Coulomb<f64, N>), (Viscous<f32, N>, Coulomb<f32, N>), N>(SMOOTH);
    }
    stiff::<Midpoint, 1>();
    stiff::<Galerkin, 1>();
    stiff::<Midpoint, 2>();
    stiff::<Galerkin, 2>();
    stiff::<Midpoint, 3>();
    stiff::<Galerkin, 3>();
    stiff::<Midpoint, 4>();
    stiff::<Galerkin, 4>();
}

#[test]
fn every_step_of_a_robot_whose_joints_stick_is_solved() {
    fn sticking<P: Path, const N: usize>() {
        check::<P, (Viscous<f64, N>, Sticking<f64, N>), (Viscous<f32, N>, Sticking<f32, N>), N>(STICKING);
    }
    sticking::<Midpoint, 1>();
    sticking::<Galerkin, 1>();
    sticking::<Midpoint, 2>();
    sticking::<Galerkin, 2>();
    sticking::<Midpoint, 4>();
    sticking::<Galerkin, 4>();
    sticking::<Midpoint, 7>();
    sticking::<Galerkin, 7>();
}
