//! Arms by the recursions of core against the programs that are derived from their Lagrangian.

use crate::{ArmArchitecture, Model, Number, tree};
use leastaction_programs::dynamics::{AccelerationSlopes, Accelerations, InverseDynamics};
use leastaction_programs::{Row, WIDTH};

const N: usize = 4;

/// A branched tree with a slide and rotors.
fn branched() -> Model {
    let arm = ArmArchitecture::new(&tree::branched(), |_| false, |k| Number::known(0.1 * k as f64)).unwrap();
    let weights = crate::Family::initial_weights(&arm, 0);
    Model::new(arm, weights)
}

fn state(seed: f64) -> Vec<Row> {
    let number = |i: usize, lane: usize| (seed + 2.3 * i as f64 + 0.7 * lane as f64).sin() * 1.5;
    (0..N).map(|i| Row(std::array::from_fn(|lane| number(i, lane)))).collect()
}

fn assert_close(found: &[Row], expected: &[Row]) {
    let largest = expected.iter().flat_map(|row| row.0).fold(0.0, |most: f64, x| most.max(x.abs()));
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        for lane in 0..WIDTH {
            assert!((found.0[lane] - expected.0[lane]).abs() < 1e-11 * largest, "{found:?} {expected:?}");
        }
    }
}

#[test]
fn recursions_give_the_numbers_of_the_programs() {
    let model = branched();
    let (arm, system, weights) = (model.arm_dynamics().unwrap(), model.system().unwrap(), &model.weights);
    let [q, v, x] = [0.1, 1.2, 2.9].map(state);
    let at = [&*q, &*v, &*x];
    let zeros = |count: usize| vec![Row::default(); count];

    let (program, mut expected) = (system.energies(), zeros(N));
    let mut workspace = program.workspace();
    program.run_outputs(weights, &[&q, &v, &zeros(N)], &mut workspace);
    assert_close(&arm.energies([&q, &v]), &[workspace.output(0)[0], workspace.output(1)[0]]);

    let mut found = zeros(N);
    assert!(!InverseDynamics::new(&system).evaluate(weights, at, &mut expected).any(WIDTH));
    arm.inverse_dynamics(at, &mut found);
    assert_close(&found, &expected);

    let mut accelerations = Accelerations::new(&system);
    assert!(!accelerations.evaluate(weights, at, &mut expected, None).any(WIDTH));
    arm.acceleration(at, &mut found);
    assert_close(&found, &expected);

    let (mut mass, rows) = (zeros(N * N), (0..N * N).map(|k| accelerations.mass(k / N, k % N)));
    arm.mass_matrix(&q, &mut mass);
    assert_close(&mass, &rows.collect::<Vec<_>>());

    let (mut slopes, mut columns) = (AccelerationSlopes::new(&system), zeros(2 * N * N));
    assert!(!slopes.evaluate(weights, at, &mut expected, &mut columns).any(WIDTH));
    columns.extend(slopes.of_control(weights, at));
    let mut found = zeros(3 * N * N);
    arm.acceleration_derivatives(at, &mut found);
    assert_close(&found, &columns);
}

#[test]
fn other_families_have_no_such_dynamics() {
    use leastaction_core::energy::inertia_network::Coordinate;
    let network = crate::InertiaNetworkArchitecture::new(&[Coordinate::Angle], 5);
    let weights = crate::Family::initial_weights(&network, 0);
    assert!(Model::new(network, weights).arm_dynamics().is_none());
}
