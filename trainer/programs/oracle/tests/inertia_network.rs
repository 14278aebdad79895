//! Comparison of inertia networks, for any size, with core in f64: value, derivatives, and gradients with respect to
//! the weights.

mod common;

use common::{Dual, Motion, Numbers, damping, random_weights};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia, InertiaNetwork, InertiaNetworkShape};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::network::Activation;
use leastaction_core::scalar::{Scalar, WeightFormat};
use leastaction_programs::energies::{Energies, InertiaNetworkEnergies};

const KINDS: [Coordinate; 3] = [Coordinate::Translation, Coordinate::Angle, Coordinate::Cyclic];

struct Case<const N: usize> {
    kinds: [Coordinate; N],
    widths: Vec<u16>,
    activation: Activation,
    inertia: Inertia,
    damped: bool,
}

/// Core's model, with the damping at the end of the block.
fn core<'w, S, const N: usize>(
    case: &Case<N>,
    weights: &'w [S],
) -> System<InertiaNetwork<'w, S, N, 64, 4>, Viscous<S, N>>
where
    S: Scalar<Weight = S> + WeightFormat<Wide = S>,
{
    let shape = InertiaNetworkShape::new(case.kinds, &case.widths, case.activation, case.inertia).unwrap();
    let mut block = weights;
    let lagrangian = InertiaNetwork::take(&mut block, &shape).unwrap();
    assert_eq!(block.len(), if case.damped { N } else { 0 });
    let start = weights.len() - block.len();
    let positions = case.damped.then(|| std::array::from_fn(|i| start + i));
    System { lagrangian, forces: damping(weights, positions) }
}

fn check<const N: usize>(case: &Case<N>, seed: u64) {
    let widths: Vec<usize> = case.widths.iter().map(|w| usize::from(*w)).collect();
    let model = InertiaNetworkEnergies::new(
        case.kinds.to_vec(),
        (&widths, case.activation),
        case.inertia,
        case.damped,
    );
    let mut weights = random_weights(model.parameters(), seed);
    let start = weights.len() - if case.damped { N } else { 0 };
    weights[start..].iter_mut().for_each(|w| *w = w.abs());
    let motion = |weights: &[Dual], at: [&[Dual; N]; 3]| Motion::new(&core(case, weights), at);
    let numbers = Numbers::<N>::new(weights.clone(), 1.5, seed);
    common::check(&model, &core(case, &weights), motion, &numbers, 1.0);
}

/// Makes a test for every number of coordinates, each with widths that are not multiples of a panel, and with another
/// activation.
macro_rules! sizes {
    ($($name:ident: $n:literal, $widths:expr, $activation:ident, $inertia:expr, $damped:literal;)*) => {
        $(
            #[test]
            fn $name() {
                let kinds = std::array::from_fn(|i| KINDS[(i + 1) % 3]);
                let case = Case::<$n> {
                    kinds,
                    widths: $widths.to_vec(),
                    activation: Activation::$activation,
                    inertia: $inertia,
                    damped: $damped,
                };
                check(&case, $n);
            }
        )*
    };
}

const CHOLESKY: Inertia = Inertia::Cholesky { epsilon: 1e-3 };

const fn factor(rows: u8) -> Inertia {
    Inertia::Factor { rows, epsilon: 1e-2 }
}

sizes! {
    one_coordinate: 1, [5], Tanh, Inertia::Diagonal, true;
    two_coordinates: 2, [7, 9], Softplus, CHOLESKY, false;
    three_coordinates: 3, [13, 6, 5], Squareplus, CHOLESKY, true;
    four_coordinates: 4, [4, 3, 5, 6], Isru, CHOLESKY, true;
    five_coordinates: 5, [11, 12], Tanh, Inertia::Diagonal, true;
    six_coordinates: 6, [17], Tanh, CHOLESKY, true;
    seven_coordinates: 7, [33, 15], Tanh, CHOLESKY, true;
    eight_coordinates: 8, [10, 10], Softplus, CHOLESKY, false;
    twelve_coordinates: 12, [9, 20], Tanh, CHOLESKY, true;
    factor_of_two: 2, [7, 3], Tanh, factor(3), true;
    factor_of_seven: 7, [16], Tanh, factor(13), false;
    square_factor_of_three: 3, [5], Softplus, factor(3), true;
    without_a_hidden_layer: 2, [0u16; 0], Identity, CHOLESKY, true;
}
