//! Conservation by RATTLE over many steps, and the time of its steps.

use crate::common::cases::{Case, distance};
use crate::common::particles::{Exact, energy, exact, hanging, rod_error, rods};
use leastaction_core::constraints::{Constraints, Positions};
use leastaction_core::discrete::Order;
use leastaction_core::discrete::rattle::ParticleState;
use leastaction_core::particles::Particles;
use leastaction_core::scalar::Real;
use proptest::prelude::*;
use std::time::Instant;

/// Largest violations, over all steps, of the rods and of A v = 0: rounding only, whatever the lengths, masses,
/// angles and order.
#[derive(Debug)]
struct Violations {
    rods: f64,
    rates: f64,
}

impl Violations {
    fn during<R: Real>(case: &Case<R>, integrator: (f64, Order), steps: usize) -> Self {
        let constraints = &case.constraints[..];
        let mut kept = Self { rods: 0.0, rates: 0.0 };
        case.run(integrator, steps, |_, state| {
            kept.rods = kept.rods.max(rod_error(constraints, state.q()));
            let speed = state.v().as_flattened().iter().fold(0.0_f64, |s, v| s.max(v.to_f64().abs()));
            for k in 0..constraints.equations() {
                let rate = constraints.nodes(k).iter().enumerate().map(|(slot, node)| {
                    let gradient =
                        constraints.gradient(k, slot, Positions::with_carry(state.q(), state.q_carry()));
                    (0..2).map(|i| gradient[i].to_f64() * state.v()[*node][i].to_f64()).sum::<f64>()
                });
                kept.rates = kept.rates.max(rate.sum::<f64>().abs() / (1.0 + speed));
            }
        });
        kept
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(48) })]

    #[test]
    fn rods_of_random_chains_keep_their_length(
        links in prop::collection::vec((0.4..2.0, -3.0..3.0, -3.0..3.0, 0.4..3.0), 1..7),
        hard: bool,
        turn in 0..6usize,
    ) {
        let column = |f: fn(&(f64, f64, f64, f64)) -> f64| links.iter().map(f).collect::<Vec<f64>>();
        let lengths = column(|l| l.0);
        let mut constraints = rods(&lengths, true);
        constraints.rotate_left(turn % links.len());
        let system = Exact::under_gravity(&column(|l| l.3), 10.0);
        let start = hanging(&lengths, &column(|l| l.1), &column(|l| l.2));
        let case = Case { system: if hard { system.hard() } else { system }, constraints, start, force: None };
        let order = if hard { Order::Four } else { Order::Two };
        let kept = Violations::during::<f64>(&case, (0.004, order), 150);
        prop_assert!(kept.rods < 1e-14 && kept.rates < 1e-13, "{kept:?}");
    }
}

/// Energy error of a long run, in f64 from the state without its carries: the largest error, and the mean errors of
/// its two halves, J.
#[derive(Debug)]
struct Energies {
    largest: f64,
    halves: [f64; 2],
    rods: f64,
}

impl Energies {
    fn during<R: Real>(case: &Case<R>, integrator: (f64, Order), steps: usize) -> Self {
        const EVERY: usize = 10;
        let system = case.system.in_f64();
        let mut found = Self { largest: 0.0, halves: [0.0; 2], rods: 0.0 };
        let mut start = None;
        case.run(integrator, steps, |k, state| {
            if k % EVERY == 0 && k < steps {
                let now = energy(&system, state);
                let error = now - *start.get_or_insert(now);
                found.largest = found.largest.max(error.abs());
                found.halves[2 * k / steps] += error * (2 * EVERY) as f64 / steps as f64;
                found.rods = found.rods.max(rod_error(&case.constraints, state.q()));
            }
        });
        found
    }

    /// The energy error is bounded, and its mean in the second half is that of the first within `drift`.
    #[track_caller]
    fn assert_kept(&self, bound: f64, drift: f64, rods: f64) {
        println!("{self:?}");
        assert!(self.largest < bound, "{self:?} beyond {bound}");
        assert!((self.halves[1] - self.halves[0]).abs() < drift, "{self:?} drifts by more than {drift}");
        assert!(self.rods < rods, "{self:?}: rods beyond {rods}");
    }
}

const REGULAR: [f64; 5] = [0.7; 5];
const CHAOTIC: [f64; 5] = [0.9, -0.4, 1.2, 0.3, -0.8];

#[test]
fn energy_and_rods_over_a_hundred_thousand_steps_in_f32() {
    Energies::during::<f32>(&Case::pendulum(&REGULAR), (0.01, Order::Two), 100_000)
        .assert_kept(6e-3, 1e-4, 1e-6);
}

/// A hybrid's motion is chaotic. Its tightest swings cost a step up to 0.1 J now and then, but this test's motion
/// contains none of them.
#[test]
fn energy_and_rods_of_a_hybrid_in_f32() {
    Energies::during::<f32>(&Case::hybrid(), (0.0048, Order::Two), 20_000).assert_kept(3e-2, 3e-3, 1e-6);
}

#[test]
fn energy_and_rods_of_order_4_in_f64() {
    Energies::during::<f64>(&Case::pendulum(&REGULAR), (0.01, Order::Four), 10_000)
        .assert_kept(1e-5, 1e-6, 1e-14);
}

/// A million steps, in release: `cargo test --release -p leastaction-core --test steps rattle -- --ignored --nocapture
/// --test-threads 1`.
#[test]
#[ignore = "a minute in debug"]
fn energy_and_rods_over_a_million_steps_in_f32() {
    let during = |angles: &[f64], h, order| {
        let start = Instant::now();
        let found = Energies::during::<f32>(&Case::pendulum(angles), (h, order), 1_000_000);
        println!("{h} s, {order:?}: {:.2} µs a step", start.elapsed().as_secs_f64());
        found
    };
    for h in [1e-3, 4e-3] {
        during(&CHAOTIC, h, Order::Two).assert_kept(2e4 * h * h, 2e-3, 1e-6);
    }
    during(&REGULAR, 4e-3, Order::Two).assert_kept(1.5e-3, 5e-4, 1e-6);
    during(&REGULAR, 1e-2, Order::Two).assert_kept(6e-3, 2e-4, 1e-6);
    // The method oscillates less than rounding does: 5·10⁶ roundings of about 20 J, each at random half a unit, make
    // a random walk of 3e-3 J.
    during(&REGULAR, 1e-2, Order::Four).assert_kept(3e-3, 3e-3, 1e-6);
}

/// Time of a step of a ring of springs, s.
fn time_of_springs<R: Real>(nodes: usize, steps: usize) -> f64 {
    let radius = 1.1 * nodes as f64 / core::f64::consts::TAU;
    let turn = |k: usize| (core::f64::consts::TAU * k as f64 / nodes as f64).sin_cos();
    let q = (0..nodes).map(turn).map(|(sin, cos)| [radius * cos, 0.9 * radius * sin]).collect();
    let system = Exact::ring(nodes);
    let case = Case::<R> { system, constraints: vec![], start: (q, vec![[0.0; 2]; nodes]), force: None };
    let mut start = None;
    case.run((0.01, Order::Two), steps, |_, _| {
        start.get_or_insert_with(Instant::now);
    });
    start.map_or(0.0, |start| start.elapsed().as_secs_f64()) / steps as f64
}

/// Springs without rods take time in proportion to their number; measured in release, as above.
#[test]
#[ignore = "a measurement of time"]
fn time_is_linear_in_springs() {
    fn check<R: Real>(name: &str) {
        let [few, many] =
            [(500, 4_000), (5_000, 400)].map(|(nodes, steps)| time_of_springs::<R>(nodes, steps));
        println!("{name}: {:.1} µs a step of 500 springs, {:.1} µs of 5,000", few * 1e6, many * 1e6);
        assert!(many < 20.0 * few, "{} times the time for ten times the springs", many / few);
    }
    check::<f32>("f32");
    check::<f64>("f64");
}

/// Error after stepping forth, reversing the velocities, and stepping back.
fn return_error<R: Real>(case: &Case<R>, order: Order) -> f64 {
    let forth = case.run((0.01, order), 200, |_, _| ());
    let turned = forth.1.iter().map(|v| v.map(|v| -v.to_f64())).collect();
    let system = case.system.clone();
    let back =
        Case { system, constraints: case.constraints.clone(), start: (exact(&forth.0), turned), force: None };
    let found = back.run((0.01, order), 200, |_, _| ());
    distance(&exact(&found.0), &case.start.0)
}

#[test]
fn steps_are_reversible() {
    for order in [Order::Two, Order::Four] {
        assert!(return_error::<f64>(&Case::hybrid(), order) < 1e-11);
        assert!(return_error::<f32>(&Case::pendulum(&REGULAR), order) < 1e-4);
        let mut hard = Case::<f64>::hybrid();
        hard.system.stiffening = 0.4;
        assert!(return_error(&hard, order) < 1e-11);
    }
}

/// (Σp, Σ q × p), with carries.
fn momenta<R: Real>(state: &ParticleState<R, 2>) -> [f64; 3] {
    let whole = |x: &[[R; 2]], carry: &[[R; 2]], i: usize| -> [f64; 2] {
        core::array::from_fn(|k| x[i][k].to_f64() + carry[i][k].to_f64())
    };
    let mut sum = [0.0; 3];
    for i in 0..state.q().len() {
        let (q, p) = (whole(state.q(), state.q_carry(), i), whole(state.p(), state.p_carry(), i));
        sum[0] += p[0];
        sum[1] += p[1];
        sum[2] += q[0] * p[1] - q[1] * p[0];
    }
    sum
}

/// The largest change of the momenta of a chain in free flight.
fn momentum_errors<R: Real>(h: f64, order: Order, steps: usize) -> [f64; 3] {
    let (mut start, mut errors) = (None, [0.0_f64; 3]);
    Case::<R>::free().run((h, order), steps, |_, state| {
        let now = momenta(state);
        let start = start.get_or_insert(now);
        for (error, (now, start)) in errors.iter_mut().zip(now.iter().zip(start)) {
            *error = error.max((now - *start).abs());
        }
    });
    errors
}

#[test]
fn momenta_of_a_free_chain_are_conserved() {
    for order in [Order::Two, Order::Four] {
        let errors = momentum_errors::<f64>(0.01, order, 2_000);
        assert!(errors.iter().all(|error| *error < 2e-13), "{order:?}, f64: {errors:?}");
        let errors = momentum_errors::<f32>(0.01, order, 20_000);
        println!("{order:?}: {errors:?}");
        assert!(errors[..2].iter().all(|error| *error < 1e-6), "{order:?}, f32: {errors:?}");
        assert!(errors[2] < 1e-4, "{order:?}, f32: {errors:?}");
    }
}

#[test]
fn drag_dissipates() {
    let mut case = Case::<f64>::hybrid();
    case.system.drag = [0.5, 0.1];
    let (mut before, mut last) = (f64::INFINITY, 0.0);
    case.run((0.01, Order::Two), 4_000, |_, state| {
        let e = case.system.energies(state.q(), state.v(), &mut []);
        last = e.kinetic + e.potential;
        assert!(last < before + 2e-3, "{last} J after {before} J");
        before = last;
    });
    let (_, v) = case.run((0.01, Order::Two), 4_000, |_, _| ());
    assert!(v.as_flattened().iter().all(|v| v.abs() < 1e-3), "still moving: {v:?}");
}
