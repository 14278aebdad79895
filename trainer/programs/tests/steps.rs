//! Steps that carry derivatives: against differences, in weights, control and start.

use leastaction_core::energy::rigid::{Coordinate, Inertia};
use leastaction_core::network::Activation;
use leastaction_programs::dynamics::AccelerationSlopes;
use leastaction_programs::energies::{Energies, RigidEnergies};
use leastaction_programs::steps::{ControlTangent, ExplicitSteps, RungeKutta, State, Tangents};
use leastaction_programs::{Builder, Node, Row, System, WIDTH};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const N: usize = 3;
const H: f64 = 0.05;
const STEPS: usize = 3;

/// A network's energies, with drag that grows with the load, −θτ²v.
struct Loaded(RigidEnergies);

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
    Loaded(RigidEnergies::new(kinds, (&[5, 4], Activation::Tanh), inertia, false))
}

/// Numbers that the motion depends on: weights, a gain of coordinate 0, an offset of coordinate 2, and the start.
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

    /// τ of a step, and how it moves with gain and offset.
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

    fn end(&self, steps: &mut ExplicitSteps) -> State {
        let mut state = self.start.clone();
        for step in 0..STEPS {
            let (tau, _) = self.acting(step);
            let failures = steps.step(&self.weights, &mut state, [&tau[0], &tau[1]], None);
            assert!(!failures.any(WIDTH));
        }
        state
    }
}

#[test]
fn tangents_are_differences() {
    let model = model();
    let system = System::new(&model);
    for method in [RungeKutta::Midpoint, RungeKutta::ThreeEighths] {
        let mut steps = ExplicitSteps::new(&system, H, method);
        let numbers = Numbers::random(system.parameters());
        let mut tangents = Tangents::at_start(N, system.parameters(), 2);
        let mut state = numbers.start.clone();
        for step in 0..STEPS {
            let (tau, controls) = numbers.acting(step);
            let with = Some((&mut tangents, &controls[..]));
            let failures = steps.step(&numbers.weights, &mut state, [&tau[0], &tau[1]], with);
            assert!(!failures.any(WIDTH));
        }
        assert_eq!(state, numbers.end(&mut steps), "{method:?}");
        assert_eq!(tangents.columns(), system.parameters() + 2 + 2 * N);
        for (column, sample) in (0..tangents.columns()).map(|column| (column, column % WIDTH)) {
            let moved = |by: f64| {
                let mut numbers = numbers.clone();
                *numbers.number(column, sample) += by;
                numbers
            };
            let step = 1e-5;
            let [ahead, behind] = [step, -step].map(|by| moved(by).end(&mut steps));
            for i in 0..2 * N {
                let slope = (ahead[i].0[sample] - behind[i].0[sample]) / (2.0 * step);
                let own = tangents.of(column)[i].0[sample];
                assert!((own - slope).abs() < 1e-7, "{method:?}, ∂x{i}/∂{column}: {own} and {slope}");
            }
        }
    }
}

/// What cannot be computed stays in its own sample.
#[test]
fn a_sample_that_fails_leaves_the_others_alone() {
    let model = model();
    let system = System::new(&model);
    let mut steps = ExplicitSteps::new(&system, H, RungeKutta::ThreeEighths);
    let numbers = Numbers::random(system.parameters());
    let (tau, controls) = numbers.acting(0);
    let run = |start: &State, steps: &mut ExplicitSteps| {
        let (mut state, mut tangents) = (start.clone(), Tangents::at_start(N, system.parameters(), 2));
        let with = Some((&mut tangents, &controls[..]));
        let failures = steps.step(&numbers.weights, &mut state, [&tau[0], &tau[1]], with);
        (state, tangents, failures)
    };
    let mut broken = numbers.start.clone();
    broken[1].0[4] = f64::NAN;
    let ((state, tangents, _), (other, others, failures)) =
        (run(&numbers.start, &mut steps), run(&broken, &mut steps));
    assert!((0..WIDTH).all(|sample| failures.0[sample] == (sample == 4)));
    for sample in (0..WIDTH).filter(|sample| *sample != 4) {
        assert!((0..2 * N).all(|i| state[i].0[sample] == other[i].0[sample]));
        let same = |number: usize| {
            tangents.of(number).iter().zip(others.of(number)).all(|(a, b)| a.0[sample] == b.0[sample])
        };
        assert!((0..tangents.columns()).all(same), "sample {sample}");
    }
}

/// Known weights have no derivatives, and those of the others stay what they are.
#[test]
fn derivatives_are_in_learned_weights_alone() {
    let model = model();
    let system = System::new(&model);
    let numbers = Numbers::random(system.parameters());
    let (tau, controls) = numbers.acting(0);
    let learned: Vec<usize> = (0..system.parameters()).filter(|position| position % 3 != 1).collect();
    let all: Vec<usize> = (0..system.parameters()).collect();
    let [some, every] = [learned.clone(), all].map(|learned| {
        let mut tangents = Tangents::at_start(N, learned.len(), 2);
        let steps = ExplicitSteps::new(&system, H, RungeKutta::ThreeEighths);
        let mut state = numbers.start.clone();
        let with = Some((&mut tangents, &controls[..]));
        let _ = steps.with_learned(learned).step(&numbers.weights, &mut state, [&tau[0], &tau[1]], with);
        tangents
    });
    for (column, position) in learned.iter().enumerate() {
        assert_eq!(some.of(column), every.of(*position));
    }
    for k in 0..2 + 2 * N {
        assert_eq!(some.of(learned.len() + k), every.of(system.parameters() + k));
    }
}

#[test]
fn accelerations_move_with_the_state_as_differences_do() {
    let system = System::new(&model());
    let Numbers { weights, start, control, .. } = Numbers::random(system.parameters());
    let mut of = AccelerationSlopes::new(&system);
    let mut evaluate = |state: &State| {
        let (mut a, mut slopes) = (vec![Row::default(); N], vec![Row::default(); 2 * N * N]);
        let failures = of.evaluate(&weights, [&state[..N], &state[N..], &control[0][0]], &mut a, &mut slopes);
        assert!(!failures.any(WIDTH));
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
