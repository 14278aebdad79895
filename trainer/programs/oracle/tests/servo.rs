//! Comparison of servos, whose stiffnesses are read from a weight block, with core in f64.

mod common;

use common::{Numbers, random_weights};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia, InertiaNetwork, InertiaNetworkShape};
use leastaction_core::forces::{Forces, Servo, System as CoreSystem, Viscous};
use leastaction_core::network::Activation;
use leastaction_programs::energies::{Energies, InertiaNetworkEnergies, WithServo};
use leastaction_programs::{System, WIDTH};

const N: usize = 3;
const KINDS: [Coordinate; N] = [Coordinate::Angle, Coordinate::Translation, Coordinate::Angle];
const INERTIA: Inertia = Inertia::Cholesky { epsilon: 1e-2 };
/// The groups of the coordinates.
const OF: [usize; N] = [1, 0, 1];
/// k of both groups.
const STIFFNESS: [f64; 2] = [0.7, 1.9];

/// A damped network with servos, and its weights.
fn driven() -> (WithServo<InertiaNetworkEnergies>, Vec<f64>) {
    let network = InertiaNetworkEnergies::new(KINDS.to_vec(), (&[6, 5], Activation::Tanh), INERTIA, true);
    let mut weights = random_weights(network.parameters(), 3);
    weights.extend(STIFFNESS);
    (WithServo::new(network, 2, OF.to_vec()).unwrap(), weights)
}

fn servo(stiffness: [f64; 2]) -> Servo<f64, N> {
    Servo { stiffness: Some(OF.map(|group| stiffness[group])) }
}

#[test]
fn values_and_derivatives_are_cores() {
    let (model, weights) = driven();
    assert_eq!(model.parameters(), weights.len());
    let shape = InertiaNetworkShape::new(KINDS, &[6, 5], Activation::Tanh, INERTIA).unwrap();
    let lagrangian: InertiaNetwork<'_, f64, N, 8, 2> =
        InertiaNetwork::take(&mut &weights[..], &shape).unwrap();
    let damping: [f64; N] = std::array::from_fn(|i| weights[weights.len() - 2 - N + i]);
    let core = CoreSystem { lagrangian, forces: (Viscous { coefficients: damping }, servo(STIFFNESS)) };
    let numbers = Numbers::<N>::new(weights.clone(), 1.5, 3);
    common::check_values(&System::new(&model), &core, &numbers, 1.0);
}

/// Checks ∂(y·Q)/∂k against central differences of core's force.
#[test]
fn gradients_are_the_differences_of_cores_force() {
    const STEP: f64 = 1e-5;
    let (model, weights) = driven();
    let own = Numbers::<N>::new(weights.clone(), 1.5, 3);
    // Vectors 4 and 3 are y and v̇.
    let (_, rows) = own.run(&System::new(&model).residual(1), &[0, 1, 2, 3, 4]);
    for group in 0..2 {
        let moved = |step: f64| {
            let mut stiffness = STIFFNESS;
            stiffness[group] += step;
            servo(stiffness)
        };
        for sample in 0..WIDTH {
            let [q, v, tau, y] = [0, 1, 2, 4].map(|vector| own.of(vector, sample));
            let work = |law: Servo<f64, N>| -> f64 {
                law.force(&q, &v, &tau).iter().zip(&y).map(|(f, y)| f * y).sum()
            };
            let expected = (work(moved(STEP)) - work(moved(-STEP))) / (2.0 * STEP);
            let found = rows[0][weights.len() - 2 + group].0[sample];
            assert!((found - expected).abs() < 1e-8, "group {group}: {found} {expected}");
        }
    }
}

#[test]
fn groups_must_fit() {
    let network = || InertiaNetworkEnergies::new(KINDS.to_vec(), (&[6, 5], Activation::Tanh), INERTIA, false);
    assert!(WithServo::new(network(), 2, vec![0, 1]).is_none(), "two coordinates of three");
    assert!(WithServo::new(network(), 2, vec![0, 1, 2]).is_none(), "no third group");
}
