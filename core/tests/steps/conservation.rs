//! Quantities that a variational integrator keeps, in single precision too: energy over long times, momentum of a cyclic coordinate,
//! reversibility.

use crate::common::shapes::{Angle, Cyclic, Model};
use crate::common::{arms, bodies, trees};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Path, State};
use leastaction_core::energy::inertia_network::Inertia;
use leastaction_core::energy::trigonometric::{CARTPOLE, PENDULUM};
use leastaction_core::forces::System;
use leastaction_core::lagrangian::{Energies, Lagrangian};
use leastaction_core::linear::solve;
use leastaction_core::network::Activation;
use leastaction_core::scalar::Real;

const STEPS: usize = 1_000_000;

/// The energy error of a long run as a line and an oscillation about it, J.
#[derive(Debug)]
struct Trend {
    /// Change of the line over the whole run.
    drift: f64,
    /// Half the distance between the largest and the smallest deviation from the line.
    oscillation: f64,
    /// Largest |T| + |V|, to which rounding is relative.
    size: f64,
    /// Number of coordinates, each of which rounds at every step.
    coordinates: usize,
}

/// T and V in f64 of a state, without its carries.
fn energies_at<R: Real, const N: usize>(
    exact: &impl Lagrangian<f64, N>,
    state: &State<R, N>,
) -> Energies<f64> {
    let (q, p) = (state.q().map(R::to_f64), state.p().map(R::to_f64));
    let v = solve(exact.hessian(&q, &[0.0; N]).l_vv, p).unwrap();
    exact.energies(&q, &v)
}

/// T + V in f64 of a state, without its carries.
fn energy_at<R: Real, const N: usize>(exact: &impl Lagrangian<f64, N>, state: &State<R, N>) -> f64 {
    let e = energies_at(exact, state);
    e.kinetic + e.potential
}

impl Trend {
    /// Fits the line by least squares to the energy at every 50th of 10⁶ steps. Energies are computed in f64 from the state without its
    /// carries.
    fn of<R: Real, P: Path, const N: usize>(
        lagrangian: impl Lagrangian<R, N>,
        exact: &impl Lagrangian<f64, N>,
        q: [f64; N],
        h: f64,
    ) -> Self {
        let system = System::conservative(lagrangian);
        let del = Del::<R, P>::new(R::constant(h));
        let mut state = State::new(&system.lagrangian, q.map(R::constant), [R::zero(); N]).unwrap();
        let (mut energies, mut size) = (vec![], 0.0_f64);
        for k in 0..STEPS {
            if k % 50 == 0 {
                let e = energies_at(exact, &state);
                energies.push(e.kinetic + e.potential);
                size = size.max(e.kinetic.abs() + e.potential.abs());
            }
            del.step(&system, &mut state, &Control::none()).unwrap();
        }
        Self::fit(&energies, size, N)
    }

    fn fit(energies: &[f64], size: f64, coordinates: usize) -> Self {
        let n = energies.len() as f64;
        let middle = (n - 1.0) / 2.0;
        let mean = energies.iter().sum::<f64>() / n;
        let times = (0..energies.len()).map(|k| k as f64 - middle);
        let covariance: f64 = times.clone().zip(energies).map(|(t, e)| t * (e - mean)).sum();
        let slope = covariance / times.clone().map(|t| t * t).sum::<f64>();
        let deviations = times.zip(energies).map(|(t, e)| e - mean - slope * t);
        let (low, high) = deviations.fold((0.0_f64, 0.0_f64), |(low, high), d| (low.min(d), high.max(d)));
        Self { drift: slope * n, oscillation: (high - low) / 2.0, size, coordinates }
    }

    /// Energy may oscillate by `bound` and must not drift by more than it oscillates.
    #[track_caller]
    fn assert_drift_free(&self, name: &str, bound: f64) {
        println!("{name}: {self:?}");
        assert!(self.oscillation < bound, "{name}: {self:?} oscillates more than {bound}");
        assert!(self.drift.abs() < self.oscillation, "{name}: {self:?} drifts");
    }

    /// Bound for a method that oscillates less than rounding does. In every coordinate, 10⁶ roundings of the energy's
    /// size, each at random half a unit, make a random walk of √(10⁶ n) half units. A rounding with a preferred sign
    /// would go a thousand times further.
    #[track_caller]
    fn assert_random_walk(&self, name: &str, bound: f64) {
        println!("{name}: {self:?}");
        let walk = ((STEPS * self.coordinates) as f64).sqrt() * f64::from(f32::EPSILON) / 2.0 * self.size;
        assert!(self.oscillation < bound, "{name}: {self:?} oscillates more than {bound}");
        assert!(self.drift.abs() < walk.max(self.oscillation), "{name}: {self:?} drifts beyond {walk}");
    }
}

#[test]
fn pendulum_energy_over_a_million_steps_of_order_2_in_f32() {
    Trend::of::<f32, Midpoint, 1>(PENDULUM, &PENDULUM, [0.5], 0.01)
        .assert_drift_free("pendulum, 10 ms", 1e-3);
    Trend::of::<f32, Midpoint, 1>(PENDULUM, &PENDULUM, [0.5], 0.05)
        .assert_drift_free("pendulum, 50 ms", 2e-2);
}

#[test]
fn cartpole_energy_over_a_million_steps_of_order_2_in_f32() {
    Trend::of::<f32, Midpoint, 2>(CARTPOLE, &CARTPOLE, [0.0, 0.5], 0.01)
        .assert_drift_free("cart-pole, 10 ms", 1e-4);
}

#[test]
fn pendulum_energy_over_a_million_steps_of_order_4_in_f32() {
    Trend::of::<f32, Galerkin, 1>(PENDULUM, &PENDULUM, [0.5], 0.01)
        .assert_random_walk("pendulum, 10 ms", 3e-5);
}

#[test]
fn cartpole_energy_over_a_million_steps_of_order_4_in_f32() {
    Trend::of::<f32, Galerkin, 2>(CARTPOLE, &CARTPOLE, [0.0, 0.5], 0.01)
        .assert_random_walk("cart-pole, 10 ms", 4e-6);
}

#[test]
fn pendulum_energy_over_a_million_steps_of_order_4_in_f64() {
    Trend::of::<f64, Galerkin, 1>(PENDULUM, &PENDULUM, [0.5], 0.05)
        .assert_drift_free("pendulum, 50 ms, f64", 1e-4);
}

/// Two links of 1 m and 1 kg, released at 0.9 and −0.6 rad, in f32 at 10 ms.
fn tree_trend<P: Path>(learned: bool) -> Trend {
    let tree = trees::double_pendulum(learned).rounded();
    Trend::of::<f32, P, 2>(tree.over(&tree.single()), &tree.in_f64(), [0.9, -0.6], 0.01)
}

#[test]
fn energy_of_a_tree_of_rods_over_a_million_steps_of_order_4_in_f32() {
    tree_trend::<Galerkin>(false).assert_random_walk("two rods, order 4", 3e-5);
}

#[test]
fn energy_of_a_learned_tree_over_a_million_steps_of_order_2_in_f32() {
    tree_trend::<Midpoint>(true).assert_drift_free("two learned links, order 2", 4e-3);
}

#[test]
fn energy_of_bodies_over_a_million_steps_of_order_2_in_f64() {
    let pendulum = bodies::double_pendulum();
    Trend::of::<f64, Midpoint, 2>(pendulum.in_f64(), &pendulum.in_f64(), [0.9, -0.6], 0.01)
        .assert_drift_free("geared double pendulum, order 2, f64", 2e-4);
}

#[test]
fn energy_of_bodies_over_a_million_steps_of_order_4_in_f32() {
    let pendulum = bodies::double_pendulum().rounded();
    Trend::of::<f32, Galerkin, 2>(pendulum.over(&pendulum.single()), &pendulum.in_f64(), [0.9, -0.6], 0.01)
        .assert_random_walk("geared double pendulum, order 4", 1e-5);
}

/// Seven joints with arbitrary axes, under gravity in an arbitrary direction, released at rest, in f32 at 2 ms: their
/// motion is chaotic.
fn arm_trend<P: Path>() -> Trend {
    let arm = arms::chain_of_seven();
    let single = arm.single();
    let rounded = arms::Arm { weights: single.iter().map(|w| f64::from(*w)).collect(), ..arm };
    let q = [0.3, -0.5, 0.2, 0.7, -0.4, 0.6, -0.2];
    Trend::of::<f32, P, 7>(rounded.over(&single), &rounded.in_f64(), q, 0.002)
}

#[test]
#[ignore = "minutes in debug"]
fn energy_of_an_arm_over_a_million_steps_of_order_2_in_f32() {
    arm_trend::<Midpoint>().assert_random_walk("seven joints, order 2", 0.1);
}

#[test]
#[ignore = "minutes in debug"]
fn energy_of_an_arm_over_a_million_steps_of_order_4_in_f32() {
    arm_trend::<Galerkin>().assert_random_walk("seven joints, order 4", 0.05);
}

/// Damping takes energy out at every step, and leaves the mechanism at rest at the bottom.
#[test]
fn damping_dissipates() {
    fn check<P: Path>() {
        let mut tree = trees::cart_and_pole(true);
        tree.set_damping(0.4);
        let tree = tree.rounded();
        let (single, exact) = (tree.single(), tree.in_f64());
        let system = tree.damped::<f32>(&single);
        assert_eq!(system.forces.coefficients, [0.4; 2]);
        let mut state = State::new(&system.lagrangian, [0.2, 1.4], [0.5, -3.0]).unwrap();
        let (del, mut before) = (Del::<f32, P>::new(0.01), energy_at(&exact, &state));
        for k in 0..6_000 {
            del.step(&system, &mut state, &Control::none()).unwrap();
            let now = energy_at(&exact, &state);
            assert!(now < before + 2e-6 * before.abs(), "step {k}: {now} J after {before} J");
            before = now;
        }
        let bottom = exact.energies(&[0.0; 2], &[0.0; 2]).potential;
        assert!(before - bottom < 1e-4, "{} J above the bottom after 60 s", before - bottom);
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

/// Steps under a force on the other coordinate alone, to and fro; the momentum of the cyclic coordinate must not change.
fn check_cyclic_momentum<R, P, L>(name: &str, lagrangian: L, cyclic: usize)
where
    R: Real,
    P: Path,
    L: Lagrangian<R, 2>,
{
    let push = |k: usize| {
        let mut u = [R::constant(if (k / 40).is_multiple_of(2) { 0.1 } else { -0.1 }); 2];
        u[cyclic] = R::zero();
        Control::held(u)
    };
    let start =
        State::new(&lagrangian, [R::constant(0.3), R::constant(0.7)], [R::constant(0.4), R::constant(-1.2)]);
    let (system, mut state) = (System::conservative(lagrangian), start.unwrap());
    let (del, initial) = (Del::<R, P>::new(R::constant(0.01)), state.p()[cyclic]);
    let mut before = state.q();
    for k in 0..10_000 {
        before = state.q();
        del.step(&system, &mut state, &push(k)).unwrap();
    }
    assert_eq!(state.p()[cyclic], initial, "{name}, order {}", P::ORDER);
    // The momentum from positions alone is conserved as well. Positions reach 100 m, so their rounding is 1 mm/s in
    // f32.
    let positions = del.start(&system, &before, &state.q(), &push(9_999)).unwrap();
    let error = (positions.p()[cyclic] - initial).abs().to_f64();
    let rounding = 2.0 * R::EPSILON.to_f64() * (1.0 + before[cyclic].abs().to_f64()) / 0.01;
    assert!(error < rounding, "{name}, order {}: {error} beyond rounding, {rounding}", P::ORDER);
}

#[test]
fn momentum_of_the_cart_is_conserved() {
    check_cyclic_momentum::<f32, Midpoint, _>("cart-pole f32", CARTPOLE, 0);
    check_cyclic_momentum::<f32, Galerkin, _>("cart-pole f32", CARTPOLE, 0);
    check_cyclic_momentum::<f64, Midpoint, _>("cart-pole f64", CARTPOLE, 0);
    check_cyclic_momentum::<f64, Galerkin, _>("cart-pole f64", CARTPOLE, 0);
}

#[test]
fn momentum_of_a_cyclic_coordinate_of_a_network_is_conserved() {
    let inertia = Inertia::Cholesky { epsilon: 0.05 };
    let model = Model::new([Angle, Cyclic], &[9, 5], Activation::Tanh, inertia, 21);
    check_cyclic_momentum::<f64, Midpoint, _>("network f64", model.in_f64(), 1);
    check_cyclic_momentum::<f64, Galerkin, _>("network f64", model.in_f64(), 1);
    let weights: Vec<f32> = model.weights.iter().map(|w| *w as f32).collect();
    check_cyclic_momentum::<f32, Midpoint, _>("network f32", model.over(&weights), 1);
    check_cyclic_momentum::<f32, Galerkin, _>("network f32", model.over(&weights), 1);
}

#[test]
fn momentum_of_a_slide_that_carries_a_learned_link_is_conserved() {
    let tree = trees::cart_and_pole(true);
    let single = tree.single();
    check_cyclic_momentum::<f64, Midpoint, _>("tree f64", tree.in_f64(), 0);
    check_cyclic_momentum::<f64, Galerkin, _>("tree f64", tree.in_f64(), 0);
    check_cyclic_momentum::<f32, Midpoint, _>("tree f32", tree.over(&single), 0);
    check_cyclic_momentum::<f32, Galerkin, _>("tree f32", tree.over(&single), 0);
}

#[test]
fn momentum_of_a_geared_cart_that_carries_a_body_is_conserved() {
    let tree = bodies::cart_and_pole();
    let single = tree.single();
    check_cyclic_momentum::<f64, Midpoint, _>("bodies f64", tree.in_f64(), 0);
    check_cyclic_momentum::<f64, Galerkin, _>("bodies f64", tree.in_f64(), 0);
    check_cyclic_momentum::<f32, Midpoint, _>("bodies f32", tree.over(&single), 0);
    check_cyclic_momentum::<f32, Galerkin, _>("bodies f32", tree.over(&single), 0);
}

/// 500 steps forth; then the last two positions in reverse order, and 500 steps back.
fn check_reversible<R: Real, P: Path>(lagrangian: impl Lagrangian<R, 2>, tolerance: f64) {
    const FORTH: usize = 500;
    let system = System::conservative(lagrangian);
    let del = Del::<R, P>::new(R::constant(0.02));
    let u = Control::held([R::constant(0.2), R::zero()]);
    let start = [R::constant(0.1), R::constant(2.4)];
    let mut state = State::new(&system.lagrangian, start, [R::constant(0.3), R::constant(0.5)]).unwrap();
    let mut path = vec![start];
    for _ in 0..FORTH {
        del.step(&system, &mut state, &u).unwrap();
        path.push(state.q());
    }
    let flipped = |state: &State<R, 2>| {
        State::with_momentum(state.q(), state.p().map(|p| -p), state.last_increment().map(|w| -w)).unwrap()
    };
    let mut back = flipped(&state);
    for q in path.iter().rev().skip(1) {
        del.step(&system, &mut back, &u).unwrap();
        for (found, q) in back.q().into_iter().zip(q) {
            let error = (found - *q).abs().to_f64();
            assert!(error < tolerance, "order {}: {error} off on the way back", P::ORDER);
        }
    }
    let mut from_positions = del.start(&system, &path[FORTH], &path[FORTH - 1], &u).unwrap();
    for _ in 1..FORTH {
        del.step(&system, &mut from_positions, &u).unwrap();
    }
    let error = (from_positions.q()[1] - start[1]).abs().to_f64();
    // The start momentum now carries the rounding of a position over one step.
    assert!(error < 100.0 * tolerance, "order {}: {error} off from reversed positions", P::ORDER);
}

#[test]
fn steps_are_reversible() {
    check_reversible::<f64, Midpoint>(CARTPOLE, 2e-13);
    check_reversible::<f64, Galerkin>(CARTPOLE, 2e-13);
    check_reversible::<f32, Midpoint>(CARTPOLE, 1e-4);
    check_reversible::<f32, Galerkin>(CARTPOLE, 1e-4);
    let tree = trees::cart_and_pole(true);
    let single = tree.single();
    check_reversible::<f64, Midpoint>(tree.in_f64(), 2e-12);
    check_reversible::<f64, Galerkin>(tree.in_f64(), 2e-12);
    check_reversible::<f32, Midpoint>(tree.over(&single), 1e-3);
    check_reversible::<f32, Galerkin>(tree.over(&single), 1e-3);
}

#[test]
fn energy_of_a_learned_system_is_bounded() {
    let inertia = Inertia::Cholesky { epsilon: 0.05 };
    let model = Model::new([Angle, Angle], &[8, 7], Activation::Tanh, inertia, 33);
    let weights: Vec<f32> = model.weights.iter().map(|w| *w as f32).collect();
    let inertia_network = model.over(&weights);
    let system = System::conservative(inertia_network);
    let del = Del::<f32, Galerkin>::new(0.01);
    let mut state = State::new(&inertia_network, [0.4, -0.8], [0.6, 1.1]).unwrap();
    let in_double = model.in_f64();
    let initial = energy_at(&in_double, &state);
    for _ in 0..20_000 {
        del.step(&system, &mut state, &Control::none()).unwrap();
        let error = (energy_at(&in_double, &state) - initial).abs();
        assert!(error < 1e-5 * (1.0 + initial.abs()), "energy off by {error}");
    }
}
