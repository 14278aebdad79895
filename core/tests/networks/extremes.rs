//! Nothing panics for any input, however extreme or NaN; errors are allowed, and leave the state unchanged.

use crate::common::shapes::{Angle, Cyclic, Model, Translation};
use crate::common::trees::{self, Tree};
use leastaction_core::continuous::{
    ContinuousState, acceleration, energy, inverse_dynamics, midpoint_step, momentum, rk4_step,
};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Newton, Path, State};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia};
use leastaction_core::energy::modular::{Input, PairInput, TreeElement};
use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::{Forces, System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::network::Activation;
use leastaction_core::scalar::{Compensated, Scalar, all_finite, max_abs};
use proptest::prelude::*;

/// Any f32, with many at the edges of the range.
fn extreme() -> impl Strategy<Value = f32> {
    let edges =
        [0.0, -0.0, 1e30, -1e30, f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1e-45, -1e-45, 65_536.0, 1.0, -3.1];
    let not_finite = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    prop_oneof![
        8 => prop::sample::select(edges.to_vec()),
        4 => any::<f32>(),
        4 => -10.0_f32..10.0,
        1 => prop::sample::select(not_finite.to_vec()),
    ]
}

fn pair() -> impl Strategy<Value = [f32; 2]> {
    [extreme(), extreme()]
}

fn steps<P: Path, L: Lagrangian<f32, 2>>(
    system: &System<L, Viscous<f32, 2>>,
    h: f32,
    q: [f32; 2],
    v: [f32; 2],
    u: [f32; 2],
) {
    let control = Control { start: u, end: v };
    for newton in [Newton::default(), Newton { max_iterations: 2, stop: 0.0, accept: 1e-3 }] {
        let del = Del::<f32, P>::with_newton(h, newton);
        if let Ok(mut state) = State::new(&system.lagrangian, q, v) {
            for _ in 0..3 {
                let before = state;
                if del.step(system, &mut state, &control).is_err() {
                    assert_eq!(state, before);
                }
                assert!(all_finite(&state.q()) && all_finite(&state.p()));
            }
        }
        if let Ok(state) = del.start(system, &q, &v, &control) {
            assert!(all_finite(&state.p()));
        }
    }
}

fn everything<L>(lagrangian: L, damping: [f32; 2], h: f32, q: [f32; 2], v: [f32; 2], u: [f32; 2])
where
    L: Lagrangian<f32, 2>,
{
    let system = System { lagrangian, forces: Viscous { coefficients: damping } };
    let _ = (system.lagrangian.energies(&q, &v), system.lagrangian.hessian(&q, &v));
    let _ = (acceleration(&system, &q, &v, &u), inverse_dynamics(&system, &q, &v, &u));
    let _ = (energy(&system.lagrangian, &q, &v), momentum(&system.lagrangian, &q, &v));
    let _ = (system.forces.force(&q, &v, &q), system.forces.derivatives(&q, &v, &q));
    let state = ContinuousState { q, v };
    let _ = (rk4_step(&system, &state, &u, h), midpoint_step(&system, &state, &u, h));
    steps::<Midpoint, L>(&system, h, q, v, u);
    steps::<Galerkin, L>(&system, h, q, v, u);
}

const KINDS: [[Coordinate; 2]; 4] =
    [[Translation, Angle], [Angle, Angle], [Cyclic, Translation], [Cyclic, Cyclic]];

const INPUTS: [Input; 3] = [Input::Translation, Input::Angle, Input::WrappedAngle];
const PAIRS: [Option<PairInput>; 4] =
    [None, Some(PairInput::Concat), Some(PairInput::Difference), Some(PairInput::Distance)];
const TREES: [&[TreeElement]; 5] = [
    &[TreeElement { kind: 0, parent: None }, TreeElement { kind: 0, parent: Some(0) }],
    &[TreeElement { kind: 1, parent: None }, TreeElement { kind: 0, parent: Some(0) }],
    &[TreeElement { kind: 2, parent: None }, TreeElement { kind: 1, parent: Some(0) }],
    &[TreeElement { kind: 2, parent: None }, TreeElement { kind: 2, parent: None }],
    &[TreeElement { kind: 0, parent: None }, TreeElement { kind: 0, parent: None }],
];

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn inertia_network_never_panics(
        (q, v, u, damping) in (pair(), pair(), pair(), pair()),
        h in extreme(),
        activation in prop::sample::select(&Activation::ALL[..]),
        coordinates in prop::sample::select(&KINDS[..]),
        diagonal in any::<bool>(),
        scale in prop::sample::select(&[1.0_f32, 1e-40, 1e20, 3e38][..]),
    ) {
        let inertia = if diagonal { Inertia::Diagonal } else { Inertia::Cholesky { epsilon: 0.0 } };
        let model = Model::new(coordinates, &[9, 3], activation, inertia, 5);
        let weights: Vec<f32> = model.weights.iter().map(|w| *w as f32 * scale).collect();
        let inertia_network = model.over(&weights);
        everything(inertia_network, damping, h, q, v, u);
    }

    #[test]
    fn modular_never_panics(
        (q, v, u, damping) in (pair(), pair(), pair(), pair()),
        h in extreme(),
        activation in prop::sample::select(&Activation::ALL[..]),
        input in prop::sample::select(&INPUTS[..]),
        pair in prop::sample::select(&PAIRS[..]),
        nodes in prop::sample::select(&TREES[..]),
        own_velocity in any::<bool>(),
        scale in prop::sample::select(&[1.0_f32, 1e-40, 1e20, 3e38][..]),
    ) {
        let mut shape = trees::chain(input, own_velocity.then_some(2), pair);
        shape.networks.iter_mut().for_each(|network| network.activation = activation);
        let tree = Tree::<2>::new(shape, nodes, 5);
        let weights: Vec<f32> = tree.single().into_iter().map(|w| w * scale).collect();
        let modular = tree.over(&weights);
        everything(modular, damping, h, q, v, u);
    }

    #[test]
    fn trigonometric_never_panics(
        (q, v, u, damping) in (pair(), pair(), pair(), pair()), h in extreme(),
    ) {
        everything(CARTPOLE, damping, h, q, v, u);
    }

    #[test]
    fn scalars_never_panic(x in any::<f32>(), y in any::<f32>()) {
        let (sin, cos) = Scalar::sin_cos(x);
        let _ = (Scalar::tanh(x), Scalar::exp(x), Scalar::ln_1p(x), Scalar::sqrt(x), Scalar::max(x, y));
        let _ = (max_abs(&[sin, cos, y]), Compensated::new(x).plus(y));
        let _ = Activation::ALL.map(|a| a.curve(x));
    }
}
