//! RATTLE: orders of accuracy, what it keeps, and what it refuses.

mod common;

use common::particles::{Exact, Spring, energy, exact, hanging, rod_error, rods, rounded, workspaces};
use common::{Random, assert_close, log_log_slope};
use leastaction_core::constraints::{Constrained, ConstraintError, Constraints, Holonomic, Positions};
use leastaction_core::continuous::{Drive, constrained_acceleration, constrained_workspace};
use leastaction_core::discrete::{Newton, Report};
use leastaction_core::discrete::{
    Order,
    rattle::{ParticleState, Rattle},
};
use leastaction_core::particles::Particles;
use leastaction_core::scalar::Real;
use proptest::prelude::*;
use std::time::Instant;

type Mechanism<'a, R, const D: usize> = Constrained<'a, R, Exact<R, D>, [Holonomic<R, D>], D>;
type Motion<R> = (Vec<[R; 2]>, Vec<[R; 2]>);

/// A system, its constraints, and where it starts.
struct Case<R> {
    system: Exact<R, 2>,
    constraints: Vec<Holonomic<R, 2>>,
    start: Motion<f64>,
    force: Option<Vec<[R; 2]>>,
}

impl<R: Real> Case<R> {
    /// A pendulum of rods of 1 m and masses of 1 kg, released at rest.
    fn pendulum(angles: &[f64]) -> Self {
        let ones = vec![1.0; angles.len()];
        Self {
            system: Exact::under_gravity(&ones, 10.0),
            constraints: rods(&ones, true),
            start: hanging(&ones, angles, &vec![0.0; angles.len()]),
            force: None,
        }
    }

    /// Two bobs on rods, two more on springs between them and the first: gravity on all.
    fn hybrid() -> Self {
        let mut system = Exact::under_gravity(&[1.0, 1.5, 0.7, 1.2], 10.0);
        let spring = |a, b| Spring { nodes: [a, b], stiffness: R::constant(30.0), rest: R::constant(0.9) };
        system.springs = vec![spring(0, 2), spring(2, 1), spring(1, 3), spring(3, 0)];
        let (mut q, mut v) = hanging(&[1.0, 0.8], &[0.7, -0.5], &[0.4, 1.2]);
        q.extend([[0.1, -1.9], [1.3, -1.4]]);
        v.extend([[-0.6, 0.3], [0.2, 0.9]]);
        Self { system, constraints: rods(&[1.0, 0.8], true), start: (q, v), force: None }
    }

    /// A chain in free flight, turning and bending, without a field.
    fn free() -> Self {
        let lengths = [1.0, 0.7, 1.3];
        let (mut q, mut v) = hanging(&lengths, &[0.4, 2.0, -0.9], &[2.0, -1.5, 0.8]);
        q.insert(0, [0.0; 2]);
        v.insert(0, [0.0; 2]);
        let v = v.iter().map(|v| [v[0] + 0.3, v[1] - 0.2]).collect();
        let system = Exact::under_gravity(&[1.0, 0.6, 1.7, 0.9], 0.0);
        Self { system, constraints: rods(&lengths, false), start: (q, v), force: None }
    }

    /// The case with a hard kinetic energy, drag and a force.
    fn forced(mut self) -> Self {
        let push = |node: usize| [R::constant(3.0 - 2.0 * node as f64), R::constant(0.7)];
        self.force = Some((0..self.system.nodes()).map(push).collect());
        Self { system: self.system.hard(), ..self }
    }

    fn mechanism(&self) -> Mechanism<'_, R, 2> {
        Constrained::new(&self.system, &self.constraints[..]).unwrap()
    }

    /// Steps and calls `look` before the first and after each; the state at the end.
    fn run(
        &self,
        (h, order): (f64, Order),
        steps: usize,
        mut look: impl FnMut(usize, &ParticleState<R, 2>),
    ) -> Motion<R> {
        let mechanism = self.mechanism();
        let (mut workspace, mut work) = workspaces(&mechanism);
        let (q, v) = (rounded(&self.start.0), rounded(&self.start.1));
        let mut state = ParticleState::new(&mechanism, &q, &v, &mut workspace, &mut work).unwrap();
        let rattle = Rattle::new(R::constant(h), order);
        look(0, &state);
        for k in 1..=steps {
            rattle.step(&mechanism, &mut state, self.force.as_deref(), &mut work).unwrap();
            look(k, &state);
        }
        (state.q().to_vec(), state.v().to_vec())
    }
}

impl Case<f64> {
    /// Classical Runge–Kutta steps of the constrained acceleration.
    fn reference(&self, end: f64, steps: usize) -> Motion<f64> {
        let mechanism = self.mechanism();
        let drive = Drive { force: self.force.as_deref(), ..Drive::none() };
        let mut workspace = vec![0.0; constrained_workspace(&mechanism)];
        let mut lambda = vec![0.0; mechanism.equations()];
        let mut rate = |(q, v): &Motion<f64>| {
            let mut a = vec![[0.0; 2]; q.len()];
            constrained_acceleration(&mechanism, (q, v), &drive, &mut workspace, (&mut a, &mut lambda))
                .unwrap();
            (v.clone(), a)
        };
        let h = end / steps as f64;
        let mut x = self.start.clone();
        for _ in 0..steps {
            let k1 = rate(&x);
            let k2 = rate(&moved(&x, h / 2.0, &k1));
            let k3 = rate(&moved(&x, h / 2.0, &k2));
            let k4 = rate(&moved(&x, h, &k3));
            for (c, k) in [(h / 6.0, &k1), (h / 3.0, &k2), (h / 3.0, &k3), (h / 6.0, &k4)] {
                x = moved(&x, c, k);
            }
        }
        x
    }

    #[track_caller]
    fn assert_orders(&self, name: &str) {
        const END: f64 = 0.8;
        let expected = self.reference(END, 8_000);
        for (order, slope) in [(Order::Two, 2.0), (Order::Four, 4.0)] {
            let errors = [40, 80, 160, 320].map(|steps| {
                let h = END / steps as f64;
                let found = self.run((h, order), steps, |_, _| ());
                (h, distance(&found.0, &expected.0), distance(&found.1, &expected.1))
            });
            let q = log_log_slope(&errors.map(|(h, q, _)| (h, q)));
            let v = log_log_slope(&errors.map(|(h, _, v)| (h, v)));
            println!("{name}, {order:?}: slope {q:.3} in q, {v:.3} in v, {errors:?}");
            assert!((q - slope).abs() < 0.2 && (v - slope).abs() < 0.2, "{name}, {order:?}: {q}, {v}");
        }
    }
}

fn moved((q, v): &Motion<f64>, c: f64, (dq, dv): &Motion<f64>) -> Motion<f64> {
    let add = |x: &[[f64; 2]], y: &[[f64; 2]]| {
        x.iter().zip(y).map(|(x, y)| [x[0] + c * y[0], x[1] + c * y[1]]).collect()
    };
    (add(q, dq), add(v, dv))
}

fn distance(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let squares = a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>().sqrt()
}

#[test]
fn orders_of_accuracy() {
    Case::pendulum(&[0.9, -0.4, 1.7]).assert_orders("chain");
    Case::hybrid().assert_orders("hybrid");
    Case::hybrid().forced().assert_orders("forced hybrid");
}

/// Without constraints: p½ = p + ½hF, q₁ = q + hp½/m, p₁ = p½ + ½hF₁.
#[test]
fn without_constraints_it_is_stoermer_verlet() {
    let mut case = Case::<f64>::hybrid();
    case.constraints.clear();
    case.force = Some(vec![[0.5, -0.3], [1.0, 0.2], [0.0, 0.0], [-2.0, 0.1]]);
    let (h, steps) = (0.01, 300);
    let (mut q, mut v) = case.start.clone();
    let force = |q: &[[f64; 2]]| {
        let mut f = vec![[0.0; 2]; 4];
        case.system.l_q(q, &mut [], &mut f);
        let push = case.force.as_ref().unwrap();
        (0..4).map(|i| [f[i][0] + push[i][0], f[i][1] + push[i][1]]).collect::<Vec<_>>()
    };
    for _ in 0..steps {
        for half in 0..2 {
            let f = force(&q);
            for i in 0..4 {
                for x in 0..2 {
                    v[i][x] += 0.5 * h * f[i][x] / case.system.masses[i];
                    q[i][x] += if half == 0 { h * v[i][x] } else { 0.0 };
                }
            }
        }
    }
    let found = case.run((h, Order::Two), steps, |_, _| ());
    assert!(distance(&found.0, &q) < 1e-11 && distance(&found.1, &v) < 1e-11);
}

/// Rods to rounding and A v = 0 at every step, whatever the lengths, masses, angles and order.
#[derive(Debug)]
struct Kept {
    rods: f64,
    rates: f64,
}

impl Kept {
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
        let kept = Kept::during::<f64>(&case, (0.004, order), 150);
        prop_assert!(kept.rods < 1e-14 && kept.rates < 1e-13, "{kept:?}");
    }
}

/// Energy error of a long run in f64 of the state as it is: the largest, and the means of its two halves, J.
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

    /// Bounded; and the mean of the second half is that of the first within `drift`.
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

/// A chaotic motion whose tightest swings cost a step some energy now and then, by up to 0.1 J; this one has none of them.
#[test]
fn energy_and_rods_of_a_hybrid_in_f32() {
    Energies::during::<f32>(&Case::hybrid(), (0.0048, Order::Two), 20_000).assert_kept(3e-2, 3e-3, 1e-6);
}

#[test]
fn energy_and_rods_of_order_4_in_f64() {
    Energies::during::<f64>(&Case::pendulum(&REGULAR), (0.01, Order::Four), 10_000)
        .assert_kept(1e-5, 1e-6, 1e-14);
}

/// A million steps, in release: `cargo test --release -p leastaction-core --test rattle -- --ignored --nocapture
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
    // Where the method oscillates less than rounding does: 5·10⁶ roundings of about 20 J, each at random half a unit, walk
    // 3e-3 J far.
    during(&REGULAR, 1e-2, Order::Four).assert_kept(3e-3, 3e-3, 1e-6);
}

/// Seconds that a step of a ring of springs takes.
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

/// In release, as above: springs without rods take time in proportion to their number.
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

/// Forth, velocities turned round, and back.
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

/// (Σp, Σ q × p) with what rounding took.
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

/// At rest a rod carries the weight below it; pushed sideways, the pendulum hangs along the whole force.
#[test]
fn multipliers_are_the_forces_of_rods() {
    let mut case = Case::<f64>::pendulum(&[0.75_f64.atan(); 3]);
    case.force = Some(vec![[7.5, 0.0]; 3]);
    let mechanism = case.mechanism();
    let (mut workspace, mut work) = workspaces(&mechanism);
    let mut state =
        ParticleState::new(&mechanism, &case.start.0, &case.start.1, &mut workspace, &mut work).unwrap();
    for order in [Order::Two, Order::Four] {
        Rattle::new(0.01, order).step(&mechanism, &mut state, case.force.as_deref(), &mut work).unwrap();
        for (lambda, below) in state.lambda().iter().zip([3.0, 2.0, 1.0]) {
            assert_close("tension", -lambda, 12.5 * below, 1e-11);
        }
        assert!(distance(state.q(), &case.start.0) < 1e-12);
    }
}

/// A pivot may be a node that is held instead of an anchor.
#[test]
fn a_held_node_is_an_anchor() {
    let anchored = Case::<f64>::pendulum(&[1.0, 0.4]);
    let (mut q, mut v) = anchored.start.clone();
    q.insert(0, [0.0; 2]);
    v.insert(0, [0.0; 2]);
    let constraints = Holonomic::held(0, [0.0; 2]).into_iter().chain(rods(&[1.0; 2], false)).collect();
    let system = Exact::under_gravity(&[1.0; 3], 10.0);
    let held = Case { system, constraints, start: (q, v), force: None };
    let found = held.run((0.01, Order::Two), 300, |_, _| ());
    let expected = anchored.run((0.01, Order::Two), 300, |_, _| ());
    assert!(distance(&found.0[1..], &expected.0) < 1e-11);
    assert!(found.0[0].iter().all(|x| x.abs() < 1e-15));
}

/// Velocities along rods go at the start; what is consistent stays.
#[test]
fn initial_velocities_are_projected() {
    let case = Case::<f64>::pendulum(&[0.5, -0.2]);
    let mechanism = case.mechanism();
    let (mut workspace, mut work) = workspaces(&mechanism);
    let along = [case.start.0[0].map(|x| 3.0 * x), [0.0; 2]];
    let state = ParticleState::new(&mechanism, &case.start.0, &along, &mut workspace, &mut work).unwrap();
    let (q, v) = (state.q().to_vec(), state.v().to_vec());
    assert!((q[0][0] * v[0][0] + q[0][1] * v[0][1]).abs() < 1e-15);
    assert!(distance(state.p(), &v) < 1e-30, "masses are 1 kg, and what is left of both is rounding");
    let state = ParticleState::new(&mechanism, &q, &v, &mut workspace, &mut work).unwrap();
    assert!(distance(state.v(), &v) < 1e-15);
}

#[test]
fn a_state_off_its_constraints_is_refused() {
    let mut case = Case::<f64>::pendulum(&[0.5, -0.2]);
    let new = |case: &Case<f64>| {
        let mechanism = case.mechanism();
        let (mut workspace, mut work) = workspaces(&mechanism);
        ParticleState::new(&mechanism, &case.start.0, &case.start.1, &mut workspace, &mut work)
            .map(|_| ())
            .unwrap_err()
    };
    case.start.0[1][0] += 0.01;
    let ConstraintError::Off { constraint: 1, residual } = new(&case) else { panic!("{:?}", new(&case)) };
    assert_close("residual", residual, 0.01 * (-0.2_f64).sin().abs(), 1e-4);
    case.start.0[1][0] = f64::NAN;
    assert_eq!(new(&case), ConstraintError::NotFinite);
    let mut twice = Case::<f64>::pendulum(&[0.5, -0.2]);
    twice.constraints.push(twice.constraints[0]);
    assert_eq!(new(&twice), ConstraintError::Redundant { constraint: 2 });
    let other = Holonomic::Anchor { node: 0, to: [0.0; 2], length: 1.2 };
    twice.constraints[2] = other;
    assert!(matches!(new(&twice), ConstraintError::Off { constraint: 2, .. }));
}

#[test]
fn refused_steps_leave_the_state() {
    let case = Case::<f64>::pendulum(&[0.5, -0.2, 1.1]);
    let mechanism = case.mechanism();
    let (mut workspace, mut work) = workspaces(&mechanism);
    let (state_workspace, work_workspace) = (workspace.len(), work.len());
    let refused =
        ParticleState::new(&mechanism, &case.start.0, &case.start.1, &mut workspace[1..], &mut work);
    assert_eq!(
        refused.unwrap_err(),
        ConstraintError::Workspace { needed: state_workspace, given: state_workspace - 1 }
    );
    let mut state =
        ParticleState::new(&mechanism, &case.start.0, &case.start.1, &mut workspace, &mut work).unwrap();
    let rattle = Rattle::new(0.01, Order::Four);
    rattle.step(&mechanism, &mut state, None, &mut work).unwrap();
    let before = format!("{state:?}");
    let visible = |state: &ParticleState<f64, 2>| {
        (state.q().to_vec(), state.p().to_vec(), state.v().to_vec(), state.lambda().to_vec())
    };
    let kept = visible(&state);

    let mut refuse = |rattle: &Rattle<f64>, force: Option<&[[f64; 2]]>, work: &mut [f64]| {
        let error = rattle.step(&mechanism, &mut state, force, work).unwrap_err();
        assert_eq!(visible(&state), kept, "{error:?} changed the state");
        error
    };
    let short = refuse(&rattle, None, &mut work[1..]);
    assert_eq!(short, ConstraintError::Workspace { needed: work_workspace, given: work_workspace - 1 });
    let few = refuse(&rattle, Some(&[[0.0; 2]; 2]), &mut work);
    assert_eq!(few, ConstraintError::Shape { expected: 3, given: 2 });
    let infinite = refuse(&rattle, Some(&[[0.0, f64::INFINITY], [0.0; 2], [0.0; 2]]), &mut work);
    assert_eq!(infinite, ConstraintError::NotFinite);
    let hurried = Newton { max_iterations: 1, stop: 1e-15, accept: 1e-15 };
    let error = refuse(&Rattle::with_newton(0.05, Order::Two, hurried), None, &mut work);
    assert!(
        matches!(error, ConstraintError::NotConverged(Report { iterations: 1, residual }) if residual > 1e-15)
    );
    let leap = refuse(&Rattle::new(40.0, Order::Two), None, &mut work);
    assert!(
        matches!(
            leap,
            ConstraintError::NotConverged(_) | ConstraintError::Redundant { .. } | ConstraintError::NotFinite
        ),
        "{leap:?}"
    );
    // And the step goes on from there as if nothing had been tried.
    rattle.step(&mechanism, &mut state, None, &mut work).unwrap();
    assert_ne!(format!("{state:?}"), before);
    let again = case.run((0.01, Order::Four), 2, |_, _| ());
    assert_eq!(state.q(), again.0);

    let other = Case::<f64>::pendulum(&[0.5, -0.2]);
    let wrong = rattle.step(&other.mechanism(), &mut state, None, &mut work).unwrap_err();
    assert_eq!(wrong, ConstraintError::Shape { expected: 2, given: 3 });
}

/// What the start is off by, the first step takes away.
#[test]
fn a_start_slightly_off_is_corrected() {
    let mut case = Case::<f64>::pendulum(&[0.5, -0.2]);
    case.start.0[1][1] -= 1e-9;
    let mut errors = vec![];
    case.run((0.01, Order::Two), 1, |_, state| errors.push(rod_error(&case.constraints, state.q())));
    assert!(errors[0] > 9e-10 && errors[1] < 1e-15, "{errors:?}");
}

/// A bead on the curve y = x⁴/4: a constraint that is none of [`Holonomic`].
struct Curve;

impl Constraints<f64, 2> for Curve {
    fn equations(&self) -> usize {
        1
    }

    fn nodes(&self, _: usize) -> &[usize] {
        &[0]
    }

    fn size(&self, _: usize) -> f64 {
        1.0
    }

    fn value(&self, _: usize, x: Positions<f64, 2>) -> f64 {
        let ([x, y], [x_carry, y_carry]) = x.node(0);
        (y - x.powi(4) / 4.0) + (y_carry - x.powi(3) * x_carry)
    }

    fn gradient(&self, _: usize, _: usize, x: Positions<f64, 2>) -> [f64; 2] {
        [-x.node(0).0[0].powi(3), 1.0]
    }

    fn curvature(&self, _: usize, x: Positions<f64, 2>, v: &[[f64; 2]]) -> f64 {
        -3.0 * (x.node(0).0[0] * v[0][0]).powi(2)
    }
}

/// (1 + x⁶) ẍ = −3x⁵ ẋ² − g x³, by Runge–Kutta.
fn bead(mut x: [f64; 2], end: f64, steps: usize) -> [f64; 2] {
    let h = end / steps as f64;
    let rate = |[x, v]: [f64; 2]| [v, -(3.0 * x.powi(5) * v * v + 10.0 * x.powi(3)) / (1.0 + x.powi(6))];
    let shift = |x: [f64; 2], c: f64, k: [f64; 2]| [x[0] + c * k[0], x[1] + c * k[1]];
    for _ in 0..steps {
        let k1 = rate(x);
        let k2 = rate(shift(x, h / 2.0, k1));
        let k3 = rate(shift(x, h / 2.0, k2));
        let k4 = rate(shift(x, h, k3));
        for (c, k) in [(h / 6.0, k1), (h / 3.0, k2), (h / 3.0, k3), (h / 6.0, k4)] {
            x = shift(x, c, k);
        }
    }
    x
}

#[test]
fn a_bead_follows_a_curve_of_the_callers_own() {
    let system = Exact::<f64, 2>::under_gravity(&[1.7], 10.0);
    let mechanism = Constrained::new(&system, &Curve).unwrap();
    let mut workspace = vec![0.0; ParticleState::<f64, 2>::workspace(1, 1)];
    let mut work = vec![0.0; Rattle::workspace(&mechanism)];
    let (x, v) = (0.9_f64, 1.1);
    let (q, velocity) = ([[x, x.powi(4) / 4.0]], [[v, x.powi(3) * v]]);

    let (mut a, mut lambda) = ([[0.0; 2]], [0.0]);
    let drive = Drive::none();
    constrained_acceleration(&mechanism, (&q, &velocity), &drive, &mut work, (&mut a, &mut lambda)).unwrap();
    let expected = -(3.0 * x.powi(5) * v * v + 10.0 * x.powi(3)) / (1.0 + x.powi(6));
    assert_close("acceleration", a[0][0], expected, 1e-14);

    let mut state = ParticleState::new(&mechanism, &q, &velocity, &mut workspace, &mut work).unwrap();
    let rattle = Rattle::new(1e-3, Order::Four);
    for _ in 0..1_000 {
        rattle.step(&mechanism, &mut state, None, &mut work).unwrap();
    }
    let [x, v] = bead([x, v], 1.0, 20_000);
    assert_close("x", state.q()[0][0], x, 1e-10);
    assert_close("v", state.v()[0][0], v, 1e-9);
    let [x, y] = state.q()[0];
    assert!((y - x.powi(4) / 4.0).abs() < 1e-15);
}

/// On the chip the workspace of a state is an array.
#[test]
fn the_room_of_a_state_is_known_at_compile_time() {
    const WORKSPACE: usize = ParticleState::<f32, 2>::workspace(2, 2);
    const WORK: usize = Rattle::<f32>::workspace_of::<2>(2, 2, 1, 0);
    let case = Case::<f32>::pendulum(&[0.5, -0.2]);
    let mechanism = case.mechanism();
    assert_eq!(WORK, Rattle::workspace(&mechanism));
    let (mut workspace, mut work) = ([0.0_f32; WORKSPACE], [0.0; WORK]);
    let (q, v) = (rounded(&case.start.0), rounded(&case.start.1));
    let mut state = ParticleState::new(&mechanism, &q, &v, &mut workspace, &mut work).unwrap();
    let mut random = Random(1);
    for _ in 0..50 {
        let push = [random.array::<2>(3.0), random.array(3.0)].map(|f| f.map(|f| f as f32));
        Rattle::new(0.01, Order::Two).step(&mechanism, &mut state, Some(&push), &mut work).unwrap();
    }
    assert!(rod_error(&case.constraints, state.q()) < 1e-6);
}
