//! Comparison of laws whose numbers are read from a weight block, group after group, with core in f64.

mod common;

use common::{Numbers, random_weights};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia, InertiaNetwork, InertiaNetworkShape};
use leastaction_core::forces::{
    Directional, DirectionalFriction, Forces, Servo, Sticking, StickingFriction, System as CoreSystem,
    Viscous,
};
use leastaction_core::network::Activation;
use leastaction_programs::energies::{Energies, GroupForce, InertiaNetworkEnergies, WithGroupLaw};
use leastaction_programs::{System, WIDTH};

const N: usize = 3;
const KINDS: [Coordinate; N] = [Coordinate::Angle, Coordinate::Translation, Coordinate::Angle];
const INERTIA: Inertia = Inertia::Cholesky { epsilon: 1e-2 };
/// The groups of the coordinates.
const OF: [usize; N] = [1, 0, 1];

/// A law of both packages: its program, its numbers, and core's law of such numbers.
trait Tested {
    type Law: Forces<f64, N>;
    const FORCE: GroupForce;
    fn numbers() -> Vec<f64>;
    fn core(numbers: &[f64]) -> Self::Law;
}

/// k of both groups.
struct Servos;

impl Tested for Servos {
    type Law = Servo<f64, N>;
    const FORCE: GroupForce = GroupForce::Servo;

    fn numbers() -> Vec<f64> {
        vec![0.7, 1.9]
    }

    fn core(numbers: &[f64]) -> Self::Law {
        Servo { stiffness: Some(OF.map(|group| numbers[group])) }
    }
}

struct ByDirection;

impl Tested for ByDirection {
    type Law = Directional<f64, N>;
    const FORCE: GroupForce = GroupForce::Directional;

    fn numbers() -> Vec<f64> {
        vec![0.4, 0.7, 0.3, 0.55, 0.45, 0.5, 0.2, 0.65, 0.15, 0.8]
    }

    fn core(numbers: &[f64]) -> Self::Law {
        let coordinates = OF.map(|group| {
            let [viscous, viscous_asymmetry, constant, asymmetry, width] =
                numbers[5 * group..][..5].try_into().unwrap();
            DirectionalFriction { viscous, viscous_asymmetry, constant, asymmetry, width }
        });
        Directional { coordinates }
    }
}

struct AtRest;

impl Tested for AtRest {
    type Law = Sticking<f64, N>;
    const FORCE: GroupForce = GroupForce::Sticking { loaded: true };

    fn numbers() -> Vec<f64> {
        vec![0.4, 0.7, 0.3, 0.55, 1.2, 0.45, 0.5, 0.2, 0.65, 0.15, 1.4, 0.8]
    }

    fn core(numbers: &[f64]) -> Self::Law {
        let coordinates = OF.map(|group| {
            let [constant, asymmetry, load, smoothing, breakaway, width] =
                numbers[6 * group..][..6].try_into().unwrap();
            StickingFriction { constant, asymmetry, load, smoothing, breakaway, width }
        });
        Sticking { coordinates }
    }
}

/// A damped network with the law, and its weights.
fn model<T: Tested>() -> (WithGroupLaw<InertiaNetworkEnergies>, Vec<f64>) {
    let network = InertiaNetworkEnergies::new(KINDS.to_vec(), (&[6, 5], Activation::Tanh), INERTIA, true);
    let mut weights = random_weights(network.parameters(), 3);
    weights.extend(T::numbers());
    (WithGroupLaw::new(network, T::FORCE, 2, OF.to_vec()).unwrap(), weights)
}

fn check_values<T: Tested>() {
    let (model, weights) = model::<T>();
    assert_eq!(model.parameters(), weights.len());
    let shape = InertiaNetworkShape::new(KINDS, &[6, 5], Activation::Tanh, INERTIA).unwrap();
    let lagrangian: InertiaNetwork<'_, f64, N, 8, 2> =
        InertiaNetwork::take(&mut &weights[..], &shape).unwrap();
    let own = T::numbers().len();
    let coefficients: [f64; N] = std::array::from_fn(|i| weights[weights.len() - own - N + i]);
    let core = CoreSystem { lagrangian, forces: (Viscous { coefficients }, T::core(&T::numbers())) };
    let numbers = Numbers::<N>::new(weights.clone(), 1.5, 3);
    common::check_values(&System::new(&model), &core, &numbers, 1.0);
}

/// Checks ∂(y·Q)/∂(number) against central differences of core's force.
fn check_gradients<T: Tested>() {
    const STEP: f64 = 1e-5;
    let (model, weights) = model::<T>();
    let own = Numbers::<N>::new(weights.clone(), 1.5, 3);
    // Vectors 4 and 3 are y and v̇.
    let (_, rows) = own.run(&System::new(&model).residual(1), &[0, 1, 2, 3, 4]);
    let count = T::numbers().len();
    for number in 0..count {
        let moved = |step: f64| {
            let mut numbers = T::numbers();
            numbers[number] += step;
            T::core(&numbers)
        };
        for sample in 0..WIDTH {
            let [q, v, tau, y] = [0, 1, 2, 4].map(|vector| own.of(vector, sample));
            let work =
                |law: T::Law| -> f64 { law.force(&q, &v, &tau).iter().zip(&y).map(|(f, y)| f * y).sum() };
            let expected = (work(moved(STEP)) - work(moved(-STEP))) / (2.0 * STEP);
            let found = rows[0][weights.len() - count + number].0[sample];
            assert!((found - expected).abs() < 1e-8, "number {number}: {found} instead of {expected}");
        }
    }
}

#[test]
fn values_and_derivatives_are_cores() {
    check_values::<Servos>();
    check_values::<ByDirection>();
    check_values::<AtRest>();
}

#[test]
fn gradients_are_the_differences_of_cores_force() {
    check_gradients::<Servos>();
    check_gradients::<ByDirection>();
    check_gradients::<AtRest>();
}

#[test]
fn groups_must_fit() {
    let network = || InertiaNetworkEnergies::new(KINDS.to_vec(), (&[6, 5], Activation::Tanh), INERTIA, false);
    let with = |of| WithGroupLaw::new(network(), GroupForce::Servo, 2, of);
    assert!(with(vec![0, 1]).is_none(), "two coordinates of three");
    assert!(with(vec![0, 1, 2]).is_none(), "no third group");
}
