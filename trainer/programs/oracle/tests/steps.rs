//! Steps that carry derivatives with respect to weights, control and start: comparison with differences, and with core.

use leastaction_core::discrete::{self, Control, Galerkin, Midpoint, Path};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia};
use leastaction_core::energy::inertia_network::{InertiaNetwork, InertiaNetworkShape};
use leastaction_core::forces::{System as CoreSystem, Viscous};
use leastaction_core::network::Activation;
use leastaction_programs::dynamics::AccelerationSlopes;
use leastaction_programs::dynamics::Order;
use leastaction_programs::energies::{Energies, InertiaNetworkEnergies};
use leastaction_programs::steps::{
    ControlTangent, ExplicitSteps, RungeKutta, State, Steps, Tangents, VariationalSteps,
};
use leastaction_programs::{Builder, Node, Row, System, WIDTH};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const N: usize = 3;
const H: f64 = 0.05;
const STEPS: usize = 3;

/// A network's energies, with drag that grows with the load, −θτ²v.
struct Loaded(InertiaNetworkEnergies);

impl Energies for Loaded {
    fn n(&self) -> usize {
        self.0.n()
    }

    fn parameters(&self) -> usize {
        self.0.parameters() + N
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        self.0.energies(builder, q, v)
    }

    fn force(&self, builder: &mut Builder, _: Node, v: Node, tau: Node) -> Node {
        let coefficients = builder.parameters(self.0.parameters(), N);
        let square = builder.product(tau, tau);
        let load = builder.product(square, coefficients);
        let drag = builder.product(load, v);
        builder.scaled(-1.0, drag)
    }
}

fn model() -> Loaded {
    let kinds = vec![Coordinate::Angle, Coordinate::Translation, Coordinate::Angle];
    let inertia = Inertia::Cholesky { epsilon: 0.7 };
    Loaded(InertiaNetworkEnergies::new(kinds, (&[5, 4], Activation::Tanh), inertia, false))
}

/// Numbers on which the motion depends: weights, a gain of coordinate 0, an offset of coordinate 2, and the start.
#[derive(Clone)]
struct Numbers {
    weights: Vec<f64>,
    gain: f64,
    offset: f64,
    start: State,
    control: Vec<[Vec<Row>; 2]>,
}

impl Numbers {
    fn random(parameters: usize) -> Self {
        let mut stream = Pcg64::seed_from_u64(3);
        let weights = (0..parameters).map(|_| stream.random_range(-0.6..0.6)).collect();
        let mut rows = |count: usize| -> Vec<Row> {
            (0..count).map(|_| Row(std::array::from_fn(|_| stream.random_range(-1.0..1.0)))).collect()
        };
        let start = rows(2 * N);
        let control = (0..STEPS).map(|_| [rows(N), rows(N)]).collect();
        Self { weights, gain: 0.8, offset: 0.1, start, control }
    }

    /// Control τ of a step, and its derivatives with respect to gain and offset.
    fn acting(&self, step: usize) -> ([Vec<Row>; 2], Vec<ControlTangent>) {
        let tau = self.control[step].each_ref().map(|rows| {
            let mut tau = rows.clone();
            tau[0] = Row(tau[0].0.map(|u| self.gain * u));
            tau[2] = Row(tau[2].0.map(|u| u + self.offset));
            tau
        });
        let gain = ControlTangent {
            number: 0,
            coordinate: 0,
            change: self.control[step].each_ref().map(|rows| rows[0]),
        };
        let offset = ControlTangent { number: 1, coordinate: 2, change: [Row::splat(1.0); 2] };
        (tau, vec![gain, offset])
    }

    fn number(&mut self, column: usize, sample: usize) -> &mut f64 {
        let weights = self.weights.len();
        match column {
            k if k < weights => &mut self.weights[k],
            k if k == weights => &mut self.gain,
            k if k == weights + 1 => &mut self.offset,
            k => &mut self.start[k - weights - 2].0[sample],
        }
    }

    fn end(&self, steps: &mut dyn Steps) -> State {
        let mut state = self.start.clone();
        steps.begin(&self.weights, &mut state, None);
        for step in 0..STEPS {
            let (tau, _) = self.acting(step);
            let failures = steps.step(&self.weights, &mut state, [&tau[0], &tau[1]], None);
            assert!(!failures.any(WIDTH));
        }
        state
    }
}

/// Every kind of steps.
fn all_steps(system: &System) -> Vec<(String, Box<dyn Steps>)> {
    let explicit = [RungeKutta::Midpoint, RungeKutta::ThreeEighths].map(|method| {
        let steps: Box<dyn Steps> = Box::new(ExplicitSteps::new(system, H, method));
        (format!("{method:?}"), steps)
    });
    let variational = [Order::Two, Order::Four].map(|order| {
        let steps: Box<dyn Steps> = Box::new(VariationalSteps::new(system, H, order));
        (format!("order {order:?}"), steps)
    });
    explicit.into_iter().chain(variational).collect()
}

#[test]
fn tangents_are_differences() {
    let model = model();
    let system = System::new(&model);
    for (method, mut steps) in all_steps(&system) {
        let steps = &mut *steps;
        let numbers = Numbers::random(system.parameters());
        let mut tangents = Tangents::at_start(N, system.parameters(), 2);
        let mut state = numbers.start.clone();
        steps.begin(&numbers.weights, &mut state, Some(&mut tangents));
        for step in 0..STEPS {
            let (tau, controls) = numbers.acting(step);
            let with = Some((&mut tangents, &controls[..]));
            let failures = steps.step(&numbers.weights, &mut state, [&tau[0], &tau[1]], with);
            assert!(!failures.any(WIDTH));
        }
        assert_eq!(state, numbers.end(steps), "{method}");
        assert_eq!(tangents.columns(), system.parameters() + 2 + 2 * N);
        for (column, sample) in (0..tangents.columns()).map(|column| (column, column % WIDTH)) {
            let moved = |by: f64| {
                let mut numbers = numbers.clone();
                *numbers.number(column, sample) += by;
                numbers
            };
            let step = 1e-5;
            let [ahead, behind] = [step, -step].map(|by| moved(by).end(steps));
            for i in 0..2 * N {
                let slope = (ahead[i].0[sample] - behind[i].0[sample]) / (2.0 * step);
                let own = tangents.of(column)[i].0[sample];
                assert!((own - slope).abs() < 1e-7, "{method}, ∂x{i}/∂{column}: {own} and {slope}");
            }
        }
    }
}

/// A failure affects only its own sample.
#[test]
fn a_sample_that_fails_leaves_the_others_alone() {
    let model = model();
    let system = System::new(&model);
    let numbers = Numbers::random(system.parameters());
    let (tau, controls) = numbers.acting(0);
    let run = |start: &State, steps: &mut dyn Steps| {
        let (mut state, mut tangents) = (start.clone(), Tangents::at_start(N, system.parameters(), 2));
        steps.begin(&numbers.weights, &mut state, Some(&mut tangents));
        let with = Some((&mut tangents, &controls[..]));
        let failures = steps.step(&numbers.weights, &mut state, [&tau[0], &tau[1]], with);
        (state, tangents, failures)
    };
    let mut broken = numbers.start.clone();
    broken[1].0[4] = f64::NAN;
    for (method, mut steps) in all_steps(&system) {
        let ((state, tangents, _), (other, others, failures)) =
            (run(&numbers.start, &mut *steps), run(&broken, &mut *steps));
        assert!((0..WIDTH).all(|sample| failures.0[sample] == (sample == 4)), "{method}");
        assert!(other.iter().any(|row| row.0[4].is_nan()), "{method}");
        for sample in (0..WIDTH).filter(|sample| *sample != 4) {
            assert!((0..2 * N).all(|i| state[i].0[sample] == other[i].0[sample]), "{method}");
            let same = |number: usize| {
                tangents.of(number).iter().zip(others.of(number)).all(|(a, b)| a.0[sample] == b.0[sample])
            };
            assert!((0..tangents.columns()).all(same), "{method}, sample {sample}");
        }
    }
}

/// Known weights have no derivatives, and the derivatives with respect to learned weights stay the same.
#[test]
fn derivatives_are_in_learned_weights_alone() {
    let model = model();
    let system = System::new(&model);
    let numbers = Numbers::random(system.parameters());
    let (tau, controls) = numbers.acting(0);
    let learned: Vec<usize> = (0..system.parameters()).filter(|position| position % 3 != 1).collect();
    let carried = |steps: &mut dyn Steps, learned: usize| {
        let (mut tangents, mut state) = (Tangents::at_start(N, learned, 2), numbers.start.clone());
        steps.begin(&numbers.weights, &mut state, Some(&mut tangents));
        let with = Some((&mut tangents, &controls[..]));
        let _ = steps.step(&numbers.weights, &mut state, [&tau[0], &tau[1]], with);
        tangents
    };
    let explicit = || ExplicitSteps::new(&system, H, RungeKutta::ThreeEighths);
    let variational = || VariationalSteps::new(&system, H, Order::Four);
    let pairs: [[Box<dyn Steps>; 2]; 2] = [
        [Box::new(explicit().with_learned(learned.clone())), Box::new(explicit())],
        [Box::new(variational().with_learned(learned.clone())), Box::new(variational())],
    ];
    for [mut of_some, mut of_all] in pairs {
        let some = carried(&mut *of_some, learned.len());
        let every = carried(&mut *of_all, system.parameters());
        for (column, position) in learned.iter().enumerate() {
            assert_eq!(some.of(column), every.of(*position));
        }
        for k in 0..2 + 2 * N {
            assert_eq!(some.of(learned.len() + k), every.of(system.parameters() + k));
        }
    }
}

#[test]
fn accelerations_move_with_state_and_control_as_differences_do() {
    let system = System::new(&model());
    let Numbers { weights, start, control, .. } = Numbers::random(system.parameters());
    let start: State = start.iter().chain(&control[0][0]).copied().collect();
    let mut of = AccelerationSlopes::new(&system);
    let mut evaluate = |at: &State| {
        let (mut a, mut slopes) = (vec![Row::default(); N], vec![Row::default(); 2 * N * N]);
        let at = [&at[..N], &at[N..2 * N], &at[2 * N..]];
        let failures = of.evaluate(&weights, at, &mut a, &mut slopes);
        assert!(!failures.any(WIDTH));
        slopes.extend(of.of_control(&weights, at));
        (a, slopes)
    };
    let (_, slopes) = evaluate(&start);
    for (j, column) in slopes.chunks_exact(N).enumerate() {
        let mut moved = |step: f64| {
            let mut state = start.clone();
            state[j].0.iter_mut().for_each(|x| *x += step);
            evaluate(&state).0
        };
        let (forth, back) = (moved(1e-5), moved(-1e-5));
        for ((slope, forth), back) in column.iter().zip(&forth).zip(&back) {
            for lane in 0..WIDTH {
                let difference = (forth.0[lane] - back.0[lane]) / 2e-5;
                assert!((slope.0[lane] - difference).abs() < 1e-6 * (1.0 + difference.abs()), "{j} {lane}");
            }
        }
    }
}

#[test]
fn velocities_after_a_beginning_are_those_of_the_start() {
    let system = System::new(&model());
    let Numbers { weights, start, .. } = Numbers::random(system.parameters());
    let mut steps = VariationalSteps::new(&system, H, Order::Four);
    let (mut state, known) = (start.clone(), Tangents::at_start(N, system.parameters(), 1));
    let mut tangents = known.clone();
    steps.begin(&weights, &mut state, Some(&mut tangents));
    let far = |one: &[Row], other: &[Row]| {
        let pairs = one.iter().zip(other).flat_map(|(one, other)| one.0.into_iter().zip(other.0));
        pairs.fold(0.0f64, |most, (one, other)| most.max((one - other).abs()))
    };
    let moved = |one: &Tangents| one.each().zip(known.each()).any(|(one, other)| far(one, other) > 0.1);
    assert!(far(&state, &start) > 0.1 && moved(&tangents));
    assert!(!steps.finish(&weights, &mut state, Some(&mut tangents)).any(WIDTH));
    assert!(far(&state, &start) < 1e-13);
    for (found, known) in tangents.each().zip(known.each()) {
        assert!(far(found, known) < 1e-13);
    }
}

const KINDS: [Coordinate; N] = [Coordinate::Angle, Coordinate::Translation, Coordinate::Angle];

/// Checks steps from positions and velocities, under a control that differs at the two ends of a step.
fn check_against_core<P: Path>(order: Order) {
    let inertia = Inertia::Cholesky { epsilon: 0.7 };
    let model = InertiaNetworkEnergies::new(KINDS.to_vec(), (&[5, 4], Activation::Tanh), inertia, true);
    let system = System::new(&model);
    let mut numbers = Numbers::random(system.parameters());
    let damping = system.parameters() - N;
    numbers.weights[damping..].copy_from_slice(&[0.3, 0.1, 0.2]);
    let shape = InertiaNetworkShape::new(KINDS, &[5, 4], Activation::Tanh, inertia).unwrap();
    let lagrangian: InertiaNetwork<f64, N, 5, 2> =
        InertiaNetwork::take(&mut &numbers.weights[..], &shape).unwrap();
    let forces = Viscous { coefficients: std::array::from_fn(|i| numbers.weights[damping + i]) };
    let core = CoreSystem { lagrangian, forces };
    let found = numbers.end(&mut VariationalSteps::new(&system, H, order));
    for sample in 0..WIDTH {
        let at = |rows: &[Row]| -> [f64; N] { std::array::from_fn(|i| rows[i].0[sample]) };
        let (q, v) = (at(&numbers.start), at(&numbers.start[N..]));
        let mut state = discrete::State::new(&core.lagrangian, q, v).unwrap();
        for step in 0..STEPS {
            let (tau, _) = numbers.acting(step);
            let control = Control { start: at(&tau[0]), end: at(&tau[1]) };
            discrete::Del::<f64, P>::new(H).step(&core, &mut state, &control).unwrap();
        }
        let expected = state.q().into_iter().chain(state.p());
        for (found, expected) in found.iter().zip(expected) {
            assert!((found.0[sample] - expected).abs() < 1e-11, "{order:?}: {} {expected}", found.0[sample]);
        }
    }
}

/// Compares with many small explicit steps, under a constant control.
#[test]
fn errors_of_variational_steps_fall_with_their_order() {
    let model = model();
    let system = System::new(&model);
    let numbers = Numbers::random(system.parameters());
    let (tau, _) = numbers.acting(0);
    let end = |steps: &mut dyn Steps, count: usize| {
        let mut state = numbers.start.clone();
        steps.begin(&numbers.weights, &mut state, None);
        for _ in 0..count {
            let _ = steps.step(&numbers.weights, &mut state, [&tau[0], &tau[0]], None);
        }
        state
    };
    let time = 0.4;
    let exact = end(&mut ExplicitSteps::new(&system, time / 512.0, RungeKutta::ThreeEighths), 512);
    for (order, power) in [(Order::Two, 2.0), (Order::Four, 4.0)] {
        let error = |count: usize| {
            let found = end(&mut VariationalSteps::new(&system, time / count as f64, order), count);
            let off = |i: usize, k: usize| (found[i].0[k] - exact[i].0[k]).powi(2);
            (0..N).flat_map(|i| (0..WIDTH).map(move |k| (i, k))).map(|(i, k)| off(i, k)).sum::<f64>().sqrt()
        };
        let slope = (error(8) / error(16)).log2();
        assert!((slope - power).abs() < 0.15, "{order:?}: {slope}");
    }
}

#[test]
fn variational_steps_are_cores() {
    check_against_core::<Midpoint>(Order::Two);
    check_against_core::<Galerkin>(Order::Four);
}
