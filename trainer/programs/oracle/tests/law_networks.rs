//! Comparison of laws with networks, which are read from a weight block, with core in f64.

mod common;

use common::{Numbers, random_weights};
use leastaction_core::discrete::{self, Control, Galerkin, Midpoint, Path, State};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia, InertiaNetwork, InertiaNetworkShape};
use leastaction_core::forces::{Dissipation, Forces, PotentialCorrection, System as CoreSystem, Viscous};
use leastaction_core::lagrangian::{Energies as CoreEnergies, Gradient, Hessian, Lagrangian};
use leastaction_core::linear::add_scaled_matrix;
use leastaction_core::model::{Law, LawNetwork as Header};
use leastaction_core::network::Activation;
use leastaction_programs::dynamics::{Del, Newton, Order};
use leastaction_programs::energies::{
    Energies, GroupForce, InertiaNetworkEnergies, LawNetwork, WithGroupLaw, WithNetworks,
};
use leastaction_programs::{Row, System, WIDTH};

const N: usize = 3;
const KINDS: [Coordinate; N] = [Coordinate::Angle, Coordinate::Translation, Coordinate::Angle];
const INERTIA: Inertia = Inertia::Cholesky { epsilon: 1e-2 };
const VISCOUS: [f64; N] = [0.3, 0.05, 0.2];

type Model = WithNetworks<WithGroupLaw<InertiaNetworkEnergies>>;
type Networks<'w> = (Dissipation<'w, f64, N, 6, 2>, PotentialCorrection<'w, f64, N, 6, 2>);

/// Laws on two of three coordinates, one of which enters only by its velocity; on one other coordinate; and on two.
const CASES: [[Option<Header<'static>>; 2]; 4] = {
    const fn header(coordinates: &'static str, activation: Activation) -> Option<Header<'static>> {
        Some(Header { coordinates, widths: [6, 5, 0, 0], activation })
    }
    [
        [header("c-a", Activation::Tanh), header("-ta", Activation::Softplus)],
        [header("ata", Activation::Isru), None],
        [header("-t", Activation::Squareplus), None],
        [None, header("a", Activation::Tanh)],
    ]
};

fn network(header: &Header) -> LawNetwork {
    let kind = |letter| if letter == '-' { None } else { Coordinate::from_letter(letter) };
    LawNetwork {
        coordinates: header.coordinates.chars().map(kind).collect(),
        widths: vec![6, 5],
        activation: header.activation,
    }
}

fn inertia_network() -> InertiaNetworkEnergies {
    InertiaNetworkEnergies::new(KINDS.to_vec(), (&[4], Activation::Tanh), INERTIA, false)
}

fn model([dissipation, potential]: [Option<Header>; 2]) -> Model {
    let damped = WithGroupLaw::new(inertia_network(), GroupForce::Viscous, N, vec![0, 1, 2]).unwrap();
    let [dissipation, potential] = [dissipation, potential].map(|law| law.as_ref().map(network));
    WithNetworks::new(damped, dissipation.as_ref(), potential.as_ref()).unwrap()
}

/// Random weights; damping and scales are positive.
fn weights(case: [Option<Header>; 2], seed: u64) -> Vec<f64> {
    let (mut weights, start) =
        (random_weights(model(case).parameters(), seed), inertia_network().parameters());
    weights[start..start + N].copy_from_slice(&VISCOUS);
    let scales = case[0].map_or(0, |header| header.count());
    (0..scales).for_each(|k| weights[start + N + k] = 0.6 + 0.5 * k as f64);
    weights
}

fn networks<'w>([dissipation, potential]: [Option<Header>; 2], weights: &'w [f64]) -> Networks<'w> {
    let mut block = &weights[inertia_network().parameters() + N..];
    let dissipation = dissipation.map_or(Dissipation::none(), |header| {
        let shape = header.network(Law::Dissipation).unwrap();
        Dissipation::take(&mut block, header.seen().unwrap(), &shape).unwrap().unwrap()
    });
    let potential = potential.map_or(PotentialCorrection::none(), |header| {
        let shape = header.network(Law::Potential).unwrap();
        PotentialCorrection::take(&mut block, header.seen().unwrap(), &shape).unwrap().unwrap()
    });
    assert!(block.is_empty(), "{} numbers left", block.len());
    (dissipation, potential)
}

fn lagrangian(weights: &[f64]) -> InertiaNetwork<'_, f64, N, 4, 1> {
    let shape = InertiaNetworkShape::new(KINDS, &[4], Activation::Tanh, INERTIA).unwrap();
    InertiaNetwork::take(&mut &*weights, &shape).unwrap()
}

/// Core's L including the potential of the law, as the host treats it.
struct Within<'w>(InertiaNetwork<'w, f64, N, 4, 1>, PotentialCorrection<'w, f64, N, 6, 2>);

impl Lagrangian<f64, N> for Within<'_> {
    fn energies(&self, q: &[f64; N], v: &[f64; N]) -> CoreEnergies<f64> {
        CoreSystem { lagrangian: &self.0, forces: self.1 }.energies(q, v)
    }

    fn gradient(&self, q: &[f64; N], v: &[f64; N]) -> Gradient<f64, N> {
        self.hessian(q, v).into_gradient()
    }

    fn hessian(&self, q: &[f64; N], v: &[f64; N]) -> Hessian<f64, N> {
        let (h, force) = (self.0.hessian(q, v), self.1.force(q, v, v));
        let (in_q, _) = self.1.derivatives(q, v, v);
        let l_q = std::array::from_fn(|i| h.l_q[i] + force[i]);
        Hessian { l_q, l_qq: add_scaled_matrix(&h.l_qq, 1.0, &in_q), ..h }
    }
}

trait IntoGradient {
    fn into_gradient(self) -> Gradient<f64, N>;
}

impl IntoGradient for Hessian<f64, N> {
    fn into_gradient(self) -> Gradient<f64, N> {
        Gradient { l_q: self.l_q, l_v: self.l_v }
    }
}

#[test]
fn values_and_derivatives_are_cores() {
    for (seed, case) in (1..).zip(CASES) {
        let weights = weights(case, seed);
        let (dissipation, potential) = networks(case, &weights);
        let forces = (Viscous { coefficients: VISCOUS }, dissipation);
        let core = CoreSystem { lagrangian: Within(lagrangian(&weights), potential), forces };
        let numbers = Numbers::<N>::new(weights.clone(), 1.5, seed);
        common::check_values(&System::new(&model(case)), &core, &numbers, 10.0);
    }
}

/// Checks ∂(y·(L_q + Q))/∂w for every number against central differences of core's forces.
#[test]
fn gradients_are_the_differences_of_cores_force() {
    const STEP: f64 = 1e-5;
    for (seed, case) in (1..).zip(CASES) {
        let weights = weights(case, seed);
        let own = Numbers::<N>::new(weights.clone(), 1.5, seed);
        // Vectors 4 and 3 are y and v̇.
        let (_, rows) = own.run(&System::new(&model(case)).residual(1), &[0, 1, 2, 3, 4]);
        for place in inertia_network().parameters() + N..weights.len() {
            let moved = |step: f64| {
                let mut moved = weights.clone();
                moved[place] += step;
                moved
            };
            let (forth, back) = (moved(STEP), moved(-STEP));
            for sample in (0..WIDTH).step_by(3) {
                let [q, v, tau, y] = [0, 1, 2, 4].map(|vector| own.of(vector, sample));
                let work = |weights: &[f64]| -> f64 {
                    networks(case, weights).force(&q, &v, &tau).iter().zip(&y).map(|(f, y)| f * y).sum()
                };
                let expected = (work(&forth) - work(&back)) / (2.0 * STEP);
                let found = rows[0][place].0[sample];
                assert!((found - expected).abs() < 1e-7, "number {place}: {found} {expected}");
            }
        }
    }
}

/// Refused are coordinates that the model does not have, a network without inputs, and a potential without a position
/// among its inputs.
#[test]
fn networks_must_fit() {
    let law = |coordinates: Vec<Option<Coordinate>>| LawNetwork {
        coordinates,
        widths: vec![2],
        activation: Activation::Tanh,
    };
    let too_many = law(vec![Some(Coordinate::Angle); 4]);
    let (none, speed) = (law(vec![None; 2]), law(vec![Some(Coordinate::Cyclic)]));
    for wrong in [&too_many, &none] {
        assert!(WithNetworks::new(inertia_network(), Some(wrong), None).is_none());
        assert!(WithNetworks::new(inertia_network(), None, Some(wrong)).is_none());
    }
    assert!(WithNetworks::new(inertia_network(), None, Some(&speed)).is_none());
    assert_eq!(
        WithNetworks::new(inertia_network(), Some(&speed), None).unwrap().parameters(),
        inertia_network().parameters() + 1 + 2 * 2 + 3
    );
    let plain = WithNetworks::new(inertia_network(), None, None).unwrap();
    assert_eq!((plain.parameters(), plain.n()), (inertia_network().parameters(), N));
}

/// Checks that steps under a force that pushes back and forth equal core's, where the potential acts as a force.
fn check_steps<P: Path>(order: Order) {
    let case = CASES[0];
    let weights = weights(case, 9);
    let forces = (Viscous { coefficients: VISCOUS }, networks(case, &weights));
    let (core, system, h) =
        (CoreSystem { lagrangian: lagrangian(&weights), forces }, System::new(&model(case)), 0.01);
    let newton = Newton { max_iterations: 50, stop: 1e-13, accept: 1e-9 };
    let mut del = Del::new(&system, h, order, newton);
    let (q, v) = ([0.3, -0.2, 0.5], [0.8, -0.4, 0.3]);
    let rows = |x: [f64; N]| x.map(Row::splat);
    let mut found = del.start_at(&weights, &rows(q), &rows(v));
    let mut expected = State::new(&core.lagrangian, q, v).unwrap();
    for k in 0..200 {
        let tau = [2.0, -1.5, 1.0].map(|push| if k / 50 % 2 == 0 { push } else { -push });
        discrete::Del::<f64, P>::new(h).step(&core, &mut expected, &Control::held(tau)).unwrap();
        del.step(&weights, &mut found, [&rows(tau), &rows(tau)]);
        for (found, expected) in found.q.iter().zip(&expected.q()) {
            assert!((found.0[0] - expected).abs() < 1e-9, "step {k}: {} {expected}", found.0[0]);
        }
    }
}

#[test]
fn steps_are_cores() {
    check_steps::<Midpoint>(Order::Two);
    check_steps::<Galerkin>(Order::Four);
}
