//! The loss of the next state under explicit Runge–Kutta steps.

use leastaction_core::continuous::acceleration;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::forces::{ControlKind, Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::ModelError;
use leastaction_core::scalar::LANES;
use leastaction_ground_truth::lgnn_shape;
use leastaction_ground_truth::{LgnnSystem, Mechanism, Settings, generate};
use leastaction_learning::training::{Levenberg, LossKind, Objective, Samples, objective};
use leastaction_models::Family as _;
use leastaction_models::{Architecture, GraphArchitecture, InertiaNetworkArchitecture};

const H: f64 = 0.1;
/// Number of steps; not a multiple of the block width.
const STEPS: usize = LANES + 3;
const CASES: [(u8, ControlKind); 4] =
    [(2, ControlKind::Held), (2, ControlKind::Linear), (4, ControlKind::Held), (4, ControlKind::Linear)];

/// A number between −1 and 1, different for every k.
fn wave(k: usize) -> f64 {
    (1.7 * k as f64 + 0.4).sin()
}

/// A damped shape of these coordinates.
fn shape(coordinates: &[Coordinate]) -> InertiaNetworkArchitecture {
    InertiaNetworkArchitecture {
        damped: true,
        widths: vec![5, 3],
        ..InertiaNetworkArchitecture::new(coordinates, 0)
    }
}

/// Weights with damping.
fn weights(shape: &InertiaNetworkArchitecture) -> Vec<f64> {
    shape.initial_weights(3).iter().enumerate().map(|(k, w)| w + 0.1 * wave(k) + 0.15).collect()
}

/// Forced samples of arbitrary states under a changing control; the next states are wrong.
fn samples(n: usize, control: ControlKind) -> Samples {
    let numbers =
        |k: usize, range: f64| (0..n * STEPS).map(|i| range * wave(7 * i + k)).collect::<Vec<f64>>();
    Samples {
        n,
        h: H,
        states: [numbers(1, 3.0), numbers(2, 2.0), numbers(3, 3.0)],
        next_velocities: numbers(4, 2.0),
        controls: [numbers(5, 3.0), numbers(6, 3.0), numbers(8, 3.0)],
        control,
    }
}

fn loss(shape: &InertiaNetworkArchitecture, samples: Samples, order: u8) -> Box<dyn Objective> {
    objective(&shape.clone().into(), samples, LossKind::NextState, order).expect("compiled")
}

/// The 3/8 rule, written out.
fn three_eighths<const N: usize>(
    accelerate: impl Fn(f64, &[f64; N], &[f64; N]) -> [f64; N],
    q: &[f64; N],
    v: &[f64; N],
) -> [[f64; N]; 2] {
    let add = |x: &[f64; N], rates: &[(f64, [f64; N])]| -> [f64; N] {
        std::array::from_fn(|i| x[i] + H * rates.iter().map(|(c, rate)| c * rate[i]).sum::<f64>())
    };
    let (v1, a1) = (*v, accelerate(0.0, q, v));
    let (c, e) = (1.0 / 3.0, 0.125);
    let v2 = add(v, &[(c, a1)]);
    let a2 = accelerate(c, &add(q, &[(c, v1)]), &v2);
    let v3 = add(v, &[(-c, a1), (1.0, a2)]);
    let a3 = accelerate(2.0 * c, &add(q, &[(-c, v1), (1.0, v2)]), &v3);
    let v4 = add(v, &[(1.0, a1), (-1.0, a2), (1.0, a3)]);
    let a4 = accelerate(1.0, &add(q, &[(1.0, v1), (-1.0, v2), (1.0, v3)]), &v4);
    [
        add(q, &[(e, v1), (3.0 * e, v2), (3.0 * e, v3), (e, v4)]),
        add(v, &[(e, a1), (3.0 * e, a2), (3.0 * e, a3), (e, a4)]),
    ]
}

/// The explicit midpoint rule, written out.
fn midpoint<const N: usize>(
    accelerate: impl Fn(f64, &[f64; N], &[f64; N]) -> [f64; N],
    q: &[f64; N],
    v: &[f64; N],
) -> [[f64; N]; 2] {
    let add =
        |x: &[f64; N], h: f64, rate: &[f64; N]| -> [f64; N] { std::array::from_fn(|i| x[i] + h * rate[i]) };
    let (middle_q, middle_v) = (add(q, 0.5 * H, v), add(v, 0.5 * H, &accelerate(0.0, q, v)));
    [add(q, H, &middle_v), add(v, H, &accelerate(0.5, &middle_q, &middle_v))]
}

/// Replaces the next states by those of the same rule.
fn stepped<L, F, const N: usize>(system: &System<L, F>, samples: Samples, order: u8) -> Samples
where
    L: Lagrangian<f64, N>,
    F: Forces<f64, N>,
{
    let (mut positions, mut velocities) = (Vec::new(), Vec::new());
    let rows = samples.states.each_ref().map(|rows| rows.as_chunks::<N>().0);
    let [first, last, _] = samples.controls.each_ref().map(|rows| rows.as_chunks::<N>().0);
    for (((q, v), first), last) in rows[0].iter().zip(rows[1]).zip(first).zip(last) {
        let accelerate = |c: f64, q: &[f64; N], v: &[f64; N]| {
            let u = match samples.control {
                ControlKind::Held => *first,
                ControlKind::Linear => std::array::from_fn(|i| (1.0 - c) * first[i] + c * last[i]),
            };
            acceleration(system, q, v, &u).expect("regular")
        };
        let [q, v] = if order == 4 { three_eighths(accelerate, q, v) } else { midpoint(accelerate, q, v) };
        positions.extend(q);
        velocities.extend(v);
    }
    let [q, v, _] = samples.states;
    Samples { states: [q, v, positions], next_velocities: velocities, ..samples }
}

fn is_exact_where_the_data_is<const N: usize>(shape: &InertiaNetworkArchitecture) {
    let weights = weights(shape);
    let system = shape.system::<f64, N, 32>(&weights).expect("fits");
    for (order, control) in CASES {
        let exact = stepped::<_, _, N>(&system, samples(N, control), order);
        let own = loss(shape, exact.clone(), order).loss(&weights);
        let other = loss(shape, exact.clone(), 6 - order).loss(&weights);
        assert!(own < 1e-28 && other > 1e-10, "order {order}: {own:e}, by the other rule {other:e}");
        let otherwise = if control == ControlKind::Held { ControlKind::Linear } else { ControlKind::Held };
        let other = loss(shape, Samples { control: otherwise, ..exact }, order).loss(&weights);
        assert!(other > 1e-6, "order {order}, {control:?}: taken for {otherwise:?} {other:e}");
    }
}

#[test]
fn weights_that_made_the_data_have_no_loss() {
    is_exact_where_the_data_is::<1>(&shape(&[Coordinate::Angle]));
    is_exact_where_the_data_is::<2>(&shape(&[Coordinate::Translation, Coordinate::Angle]));
}

/// Checks both gradients, and JᵀJ along a direction d: |Jd|² is the curvature of the residuals' linear model.
fn check_derivatives(objective: &dyn Objective, weights: &[f64], components: usize) {
    let equations = objective.normal_equations(weights).expect("evaluates");
    let gradient = objective.gradient(weights, 0..objective.samples()).expect("evaluates");
    assert_eq!(equations.rows, objective.samples() * components);
    assert_eq!(gradient.rows, equations.rows);
    let (factor, step) = (2.0 / equations.rows as f64, 1e-6);
    assert!((equations.mean_square() / objective.loss(weights) - 1.0).abs() < 1e-12);
    assert!((gradient.squares / equations.squares - 1.0).abs() < 1e-12);
    for k in 0..weights.len() {
        let at = |w: f64| {
            let mut moved = weights.to_vec();
            moved[k] += w;
            objective.loss(&moved)
        };
        let expected = (at(step) - at(-step)) / (2.0 * step);
        for found in [equations.gradient[k], gradient.gradient[k]] {
            let off = (factor * found - expected).abs();
            assert!(off <= 1e-6 * (1.0 + expected.abs()), "weight {k}: {} {expected}", factor * found);
        }
    }
}

/// Checks that JᵀJ, where the residual vanishes, is half the second derivative of the sum of squares.
fn check_gram(objective: &dyn Objective, weights: &[f64]) {
    let equations = objective.normal_equations(weights).expect("evaluates");
    let (step, rows) = (1e-4, equations.rows as f64);
    for (i, j) in (0..weights.len()).step_by(3).flat_map(|i| [(i, i), (i, i / 2)]) {
        let at = |a: f64, b: f64| {
            let mut moved = weights.to_vec();
            moved[i] += a * step;
            moved[j] += b * step;
            rows * objective.loss(&moved)
        };
        let second = (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0)) / (4.0 * step * step);
        let found = equations.gram[(i, j)];
        assert!(
            (found - 0.5 * second).abs() < 1e-4 * (1.0 + found.abs()),
            "{i} {j}: {found} {}",
            0.5 * second
        );
    }
}

fn has_the_derivatives_of_differences<const N: usize>(shape: &InertiaNetworkArchitecture) {
    let weights = weights(shape);
    let system = shape.system::<f64, N, 32>(&weights).expect("fits");
    for (order, control) in CASES {
        check_derivatives(&*loss(shape, samples(N, control), order), &weights, 2 * N);
        let exact = stepped::<_, _, N>(&system, samples(N, control), order);
        check_gram(&*loss(shape, exact, order), &weights);
    }
}

#[test]
fn one_coordinate_has_the_derivatives_of_differences() {
    has_the_derivatives_of_differences::<1>(&shape(&[Coordinate::Angle]));
}

#[test]
fn two_coordinates_have_the_derivatives_of_differences() {
    has_the_derivatives_of_differences::<2>(&shape(&[Coordinate::Translation, Coordinate::Angle]));
}

#[test]
fn a_pendulum_is_learned_from_states() {
    let settings = Settings::symo(Mechanism::Pendulum, 8, 1);
    let data = Samples::next_states(&generate(&settings).expect("data")).expect("velocities");
    assert_eq!(data.len(), 8 * 33);
    let shape = InertiaNetworkArchitecture {
        widths: vec![12],
        ..InertiaNetworkArchitecture::new(&[Coordinate::Angle], 0)
    };
    for order in [2, 4] {
        let objective = loss(&shape, data.clone(), order);
        let start = shape.initial_weights(1);
        let before = objective.loss(&start);
        let levenberg = Levenberg::new(&*objective, start).run(&*objective, 40, |_, _| ());
        assert!(levenberg.loss < 1e-3 * before, "order {order}: {before:e} to {:e}", levenberg.loss);
    }
}

#[test]
fn the_order_of_samples_does_not_matter() {
    let shape = shape(&[Coordinate::Translation, Coordinate::Angle]);
    let weights = weights(&shape);
    let samples = samples(2, ControlKind::Linear);
    let all = loss(&shape, samples.clone(), 4).loss(&weights);
    assert!((loss(&shape, samples.shuffled(4), 4).loss(&weights) / all - 1.0).abs() < 1e-12);
    let [first, rest] = samples.split(4);
    let part = |part: Samples| part.len() as f64 * loss(&shape, part.clone(), 4).loss(&weights);
    assert!(((part(first) + part(rest)) / (STEPS as f64 * all) - 1.0).abs() < 1e-12);
}

#[test]
fn rods_are_refused_and_springs_are_not() {
    let objective = |graph: GraphArchitecture| {
        let samples = samples(graph.n(), ControlKind::Held);
        objective(&Architecture::from(graph), samples, LossKind::NextState, 4)
            .map(|objective| objective.samples())
    };
    let graph = |system| lgnn_shape(system, false, false).expect("a shape");
    let refused = objective(graph(LgnnSystem::Pendulum(3))).expect_err("rods");
    assert!(refused.to_string().contains("rods under the next-state loss"), "{refused}");
    assert!(matches!(refused, ModelError::Shape { .. }));
    assert_eq!(objective(graph(LgnnSystem::Spring(3))), Ok(STEPS));
}

#[test]
fn velocities_are_asked_for() {
    let mut data = generate(&Settings::symo(Mechanism::Pendulum, 1, 1)).expect("data");
    data.trajectories[0].v = None;
    assert!(Samples::next_states(&data).is_err_and(|error| error.to_string().contains("velocities")));
}
