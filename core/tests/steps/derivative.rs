//! Derivatives of a step against dual numbers that pass the whole step, Newton's method included.

use crate::common::dual::Dual;
use crate::common::network_laws::NetworkLaws;
use crate::common::{Random, arms, bodies, forces, log_log_slope, oracle::Learned, shapes, trees};
use leastaction_core::discrete::{
    Control, Del, EndDerivative, Galerkin, Midpoint, Newton, Path, State, StepDerivative,
};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE};
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::{Matrix, add_scaled, product, transpose};
use leastaction_core::scalar::Real;

/// Step at which Newton's method reaches rounding for all these models, s; random trees are stiffer.
const H: f64 = 0.01;
const STIFF_H: f64 = 0.002;
/// Largest error relative to the largest derivative.
const TOLERANCE: f64 = 1e-12;

/// Start of a step and the control at both of its ends: q₀, p₀, τ₀, τ₁.
type Start<R, const N: usize> = [[R; N]; 4];

/// Solves every step to rounding.
fn del<R: Real, P: Path>(h: f64) -> Del<R, P> {
    let newton = Newton { max_iterations: 40, stop: R::zero(), accept: R::EPSILON.sqrt() };
    Del::with_newton(R::constant(h), newton)
}

fn state<R: Real, const N: usize>([q, p, ..]: Start<R, N>, w: [f64; N]) -> State<R, N> {
    State::with_momentum(q, p, w.map(R::constant)).unwrap()
}

fn control<R: Real, const N: usize>([_, _, start, end]: Start<R, N>) -> Control<R, N> {
    Control { start, end }
}

/// A step in both number types.
struct Case<'a, L, D, F, G, const N: usize> {
    system: &'a System<L, F>,
    dual: &'a System<D, G>,
    start: Start<f64, N>,
    v: [f64; N],
    h: f64,
}

impl<L, D, F, G, const N: usize> Case<'_, L, D, F, G, N>
where
    L: Lagrangian<f64, N>,
    D: Lagrangian<Dual, N>,
    F: Forces<f64, N>,
    G: Forces<Dual, N>,
{
    fn found<P: Path>(&self) -> StepDerivative<f64, N> {
        let mut state = state(self.start, self.v);
        del::<f64, P>(self.h).step_with_derivative(self.system, &mut state, &control(self.start)).unwrap()
    }

    /// Column `j` of the derivative with respect to one of the four inputs, from dual numbers.
    fn expected<P: Path>(&self, input: usize, j: usize) -> [[f64; N]; 2] {
        let mut moving = self.start.map(|x| x.map(Dual::constant));
        moving[input][j] = Dual::moving(self.start[input][j], [1.0, 0.0]);
        let mut state = state(moving, self.v);
        del::<Dual, P>(self.h).step(self.dual, &mut state, &control(moving)).unwrap();
        [state.q(), state.p()].map(|x| x.map(|x| x.0.eps1))
    }

    fn check<P: Path>(&self) {
        let found = self.found::<P>();
        let by = [found.by_q, found.by_p, found.by_start, found.by_end];
        let size = by.iter().flat_map(|by| [by.q, by.p]).map(|m| largest(&m)).fold(0.0, f64::max);
        for (input, by) in by.iter().enumerate() {
            for j in 0..N {
                for (matrix, expected) in [by.q, by.p].iter().zip(self.expected::<P>(input, j)) {
                    let error = (0..N).map(|i| (matrix[i][j] - expected[i]).abs()).fold(0.0, f64::max);
                    assert!(error <= TOLERANCE * size, "input {input}, column {j}: {error:e} of {size:e}");
                }
            }
        }
    }
}

fn largest<const N: usize>(matrix: &Matrix<f64, N>) -> f64 {
    matrix.as_flattened().iter().fold(0.0, |most, x| x.abs().max(most))
}

/// Compares both orders at a few random states, without forces and with all of them.
fn check<const N: usize>(h: f64, energies: impl Lagrangian<f64, N>, dual: impl Lagrangian<Dual, N>) {
    let networks = NetworkLaws::of(N, 5).scaled(0.3);
    let numbers = networks.numbers(Dual::constant);
    let [dissipation, potential] = &numbers;
    let forced = (forces::all(), (forces::coulomb(), networks.in_f64()));
    let dual_forced = (forces::all(), (forces::coulomb(), networks.over([dissipation, potential])));
    let (system, dual_system) =
        (System { lagrangian: &energies, forces: forced }, System { lagrangian: &dual, forces: dual_forced });
    let mut random = Random(17);
    for _ in 0..3 {
        let (q, v) = (random.array(2.0), random.array(1.5));
        let p = energies.gradient(&q, &v).l_v;
        let start = [q, p, random.array(2.0), random.array(2.0)];
        let free = Case {
            system: &System::conservative(&energies),
            dual: &System::conservative(&dual),
            start,
            v,
            h,
        };
        free.check::<Midpoint>();
        free.check::<Galerkin>();
        let forced = Case { system: &system, dual: &dual_system, start, v, h };
        forced.check::<Midpoint>();
        forced.check::<Galerkin>();
    }
}

fn duals(weights: &[f64]) -> Vec<Dual> {
    weights.iter().map(|w| Dual::constant(*w)).collect()
}

fn check_learned<M: Learned<N>, const N: usize>(h: f64, models: &[M]) {
    for model in models {
        let weights = duals(model.weights());
        check(h, model.energies_in_f64(), model.energies_over::<Dual>(&weights));
    }
}

#[test]
fn derivatives_of_inertia_networks_are_those_of_dual_numbers() {
    check_learned(H, &shapes::of_one());
    check_learned(H, &shapes::of_two());
    check_learned(H, &shapes::of_three());
}

#[test]
fn derivatives_of_modular_trees_are_those_of_dual_numbers() {
    check_learned(STIFF_H, &trees::of_three());
}

#[test]
fn derivatives_of_bodies_in_the_plane_are_those_of_dual_numbers() {
    for bodies in bodies::of_one() {
        check(H, bodies.in_f64(), bodies.over(&duals(&bodies.weights)));
    }
    for bodies in bodies::of_two() {
        check(H, bodies.in_f64(), bodies.over(&duals(&bodies.weights)));
    }
}

#[test]
fn derivatives_of_arms_are_those_of_dual_numbers() {
    for arm in arms::of_one() {
        check(H, arm.in_f64(), arm.over(&duals(&arm.weights)));
    }
    for arm in arms::of_three() {
        check(H, arm.in_f64(), arm.over(&duals(&arm.weights)));
    }
}

#[test]
fn derivatives_of_exact_mechanisms_are_those_of_dual_numbers() {
    check(H, CARTPOLE, CARTPOLE);
    check(H, ACROBOT, ACROBOT);
}

/// AᵀJA = J without dissipation, whatever control is held; J = [[0, 1], [−1, 0]].
fn check_symplectic<P: Path, const N: usize>(energies: &impl Lagrangian<f64, N>) {
    let mut random = Random(3);
    let (q, v, u) = (random.array(2.0), random.array(1.5), random.array(2.0));
    let start = [q, energies.gradient(&q, &v).l_v, u, u];
    let (system, mut state) = (System::conservative(energies), state(start, v));
    let found = del::<f64, P>(H).step_with_derivative(&system, &mut state, &Control::held(u)).unwrap();
    let StepDerivative { by_q, by_p, .. } = found;
    // The blocks of AᵀJA in the blocks of A: XᵀY′ − Y′ᵀX for two columns (X, X′) and (Y, Y′).
    let form = |x: &EndDerivative<f64, N>, y: &EndDerivative<f64, N>| {
        let [a, b] = [product(&transpose(&x.q), &y.p), product(&transpose(&x.p), &y.q)];
        (a, b)
    };
    for (x, y, expected) in [(&by_q, &by_q, 0.0), (&by_q, &by_p, 1.0), (&by_p, &by_p, 0.0)] {
        let (a, b) = form(x, y);
        let size = 1.0 + largest(&a) + largest(&b);
        for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
            let error = a[i][j] - b[i][j] - if i == j { expected } else { 0.0 };
            assert!(error.abs() < 1e-13 * size, "{error:e} of {size:e}");
        }
    }
}

#[test]
fn steps_without_dissipation_are_symplectic() {
    fn both<const N: usize>(energies: impl Lagrangian<f64, N>) {
        check_symplectic::<Midpoint, N>(&energies);
        check_symplectic::<Galerkin, N>(&energies);
    }
    shapes::of_two().iter().for_each(|model| both(model.in_f64()));
    shapes::of_three().iter().for_each(|model| both(model.in_f64()));
    trees::of_three().iter().for_each(|tree| both(tree.energies_in_f64()));
    bodies::of_five().iter().for_each(|bodies| both(bodies.in_f64()));
    both(arms::chain_of_seven().in_f64());
    both(ACROBOT);
}

/// The error of a linear prediction falls with the square of the distance from the step about which it was made.
#[test]
fn the_error_of_linear_predictions_has_slope_2() {
    fn slope<P: Path>() -> f64 {
        let system = System { lagrangian: CARTPOLE, forces: forces::all() };
        let (start, v): (Start<f64, 2>, _) = ([[0.2, 2.0], [0.5, -0.1], [1.0, 0.0], [0.4, 0.1]], [0.3, -1.0]);
        let along: Start<f64, 2> = [[0.3, -0.8], [0.2, 0.1], [0.9, -0.3], [-0.7, 0.5]];
        let end = |start: Start<f64, 2>| {
            let mut state = state(start, v);
            let found = del::<f64, P>(H).step_with_derivative(&system, &mut state, &control(start)).unwrap();
            ([state.q(), state.p()], found)
        };
        let (there, by) = end(start);
        let error = |size: f64| {
            let moved = core::array::from_fn(|k| add_scaled(&start[k], size, &along[k]));
            let predicted = |component: fn(&EndDerivative<f64, 2>) -> &Matrix<f64, 2>, from: [f64; 2]| {
                [by.by_q, by.by_p, by.by_start, by.by_end].iter().zip(along).fold(from, |sum, (by, along)| {
                    let change = leastaction_core::linear::multiply(component(by), &along);
                    add_scaled(&sum, size, &change)
                })
            };
            let [q, p] = end(moved).0;
            let (dq, dp) = (predicted(|by| &by.q, there[0]), predicted(|by| &by.p, there[1]));
            (0..2).map(|i| (q[i] - dq[i]).abs().max((p[i] - dp[i]).abs())).fold(0.0, f64::max)
        };
        log_log_slope(&[0.1, 0.03, 0.01, 0.003].map(|size| (size, error(size))))
    }
    for slope in [slope::<Midpoint>(), slope::<Galerkin>()] {
        assert!((slope - 2.0).abs() < 0.1, "{slope}");
    }
}
