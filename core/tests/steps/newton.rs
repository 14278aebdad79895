//! Newton's method of a step: few iterations, and no silent failure.

use crate::common::{Random, shapes, trees};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Newton, Path, Report, State, StepError};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM, Trigonometric};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::lagrangian::{Energies, Gradient, Hessian, Lagrangian};
use leastaction_core::scalar::{Real, WeightFormat};

/// Steps that took 0, 1, 2, … updates.
type Histogram = [usize; 51];

/// Runs 4 s from several starts, the last of them at rest, with SyMo's range of controls on coordinate `driven`.
/// Every step must end with a residual of a few rounding units.
fn iterations<R: Real, P: Path, const N: usize>(
    lagrangian: impl Lagrangian<R, N>,
    driven: usize,
    h: f64,
) -> Histogram {
    let system = System::conservative(lagrangian);
    let del = Del::<R, P>::new(R::constant(h));
    let mut random = Random(4);
    let mut histogram = [0; 51];
    for speed in [3.0, 1.5, 0.5, 0.0] {
        let (q, v) = (random.array::<N>(3.1), random.array::<N>(speed));
        let mut state = State::new(&system.lagrangian, q.map(R::constant), v.map(R::constant)).unwrap();
        for k in 0..(4.0 / h) as usize {
            let mut u = [R::zero(); N];
            u[driven] = R::constant(2.0 * (3.0 * k as f64 * h).sin());
            let u = Control::held(u);
            let report = del.step(&system, &mut state, &u).unwrap();
            assert!(report.residual <= R::constant(16.0) * R::EPSILON, "{report:?} at {state:?}");
            histogram[usize::from(report.iterations)] += 1;
        }
    }
    histogram
}

#[track_caller]
fn assert_iterations(name: &str, most: usize, histogram: Histogram) {
    println!("{name}: {histogram:?}");
    assert_eq!(histogram[most + 1..].iter().sum::<usize>(), 0, "more than {most}, {name}: {histogram:?}");
    assert_eq!(histogram[0], 0, "a step without an update, {name}");
}

fn check_iterations<R: Real, P: Path>(scalar: &str, most: [usize; 3]) {
    for (h, most) in [0.001, 0.01, 0.05].into_iter().zip(most) {
        let name = |system: &str| format!("{scalar}, order {}, h = {h}, {system}", P::ORDER);
        assert_iterations(&name("pendulum"), most, iterations::<R, P, 1>(PENDULUM, 0, h));
        assert_iterations(&name("cart-pole"), most, iterations::<R, P, 2>(CARTPOLE, 0, h));
        assert_iterations(&name("acrobot"), most, iterations::<R, P, 2>(ACROBOT, 1, h));
    }
}

#[test]
fn few_iterations_up_to_50_ms() {
    check_iterations::<f32, Midpoint>("f32", [2, 3, 4]);
    check_iterations::<f32, Galerkin>("f32", [2, 3, 4]);
    check_iterations::<f64, Midpoint>("f64", [3, 5, 9]);
    check_iterations::<f64, Galerkin>("f64", [3, 5, 9]);
}

/// A double pendulum of 1 m that falls from upright turns by half a radian in 50 ms, so a few steps take more
/// updates.
fn check_tree_iterations<R: Real<Weight = R> + WeightFormat<Wide = R>, P: Path>(
    scalar: &str,
    most: [usize; 4],
) {
    for (links, learned) in [("rods", false), ("learned links", true)] {
        let tree = trees::double_pendulum(learned);
        let weights: Vec<R> = tree.weights.iter().map(|w| R::constant(*w)).collect();
        for (h, most) in [0.001, 0.01, 0.02, 0.05].into_iter().zip(most) {
            let name = format!("{scalar}, order {}, h = {h}, two {links}", P::ORDER);
            assert_iterations(&name, most, iterations::<R, P, 2>(tree.over(&weights), 1, h));
        }
    }
}

#[test]
fn a_tree_takes_few_iterations() {
    check_tree_iterations::<f32, Midpoint>("f32", [2, 3, 4, 9]);
    check_tree_iterations::<f32, Galerkin>("f32", [2, 3, 4, 6]);
    check_tree_iterations::<f64, Midpoint>("f64", [4, 7, 10, 24]);
    check_tree_iterations::<f64, Galerkin>("f64", [4, 6, 9, 13]);
}

#[test]
fn a_stop_of_zero_takes_a_constant_number_of_iterations() {
    for max_iterations in [1, 2, 5] {
        let newton = Newton { max_iterations, stop: 0.0, ..Newton::<f32>::default() };
        let del = Del::<f32, Galerkin>::with_newton(0.01, newton);
        let mut state = State::new(&CARTPOLE, [0.0, 3.0], [0.0, 0.0]).unwrap();
        for _ in 0..200 {
            let report = del.step(&System::conservative(CARTPOLE), &mut state, &Control::none()).unwrap();
            assert_eq!(report.iterations, max_iterations);
        }
    }
}

/// The matrix leaves out L_qq, a part of relative size (hω)²/4: an update multiplies the residual by about that.
#[test]
fn an_update_divides_the_residual_by_the_square_of_the_step() {
    fn residual<P: Path>(h: f64, max_iterations: u8) -> f64 {
        let newton = Newton { max_iterations, stop: 0.0, accept: 1.0 };
        let (del, tree) = (Del::<f64, P>::with_newton(h, newton), trees::double_pendulum(true));
        let system = System::conservative(tree.over(&tree.weights));
        let mut state = State::new(&system.lagrangian, [2.5, -1.0], [3.0, -4.0]).unwrap();
        let step = |_| del.step(&system, &mut state, &Control::none()).unwrap().residual;
        (0..(3.0 / h) as usize).map(step).fold(0.0, f64::max)
    }
    fn check<P: Path>() {
        for (h, ratio) in [(0.01, 0.05), (0.001, 5e-4)] {
            let [once, twice, thrice] = [1, 2, 3].map(|updates| residual::<P>(h, updates));
            println!("order {}, h = {h}: {once:.1e}, {twice:.1e}, {thrice:.1e}", P::ORDER);
            assert!(twice < ratio * once && (thrice < ratio * twice || thrice < 1e-14), "order {}", P::ORDER);
        }
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

#[test]
fn without_iterations_the_guess_is_judged() {
    let newton = Newton { max_iterations: 0, ..Newton::<f64>::default() };
    let del = Del::<f64, Midpoint>::with_newton(0.01, newton);
    let system = System::conservative(CARTPOLE);
    let mut state = State::new(&CARTPOLE, [0.0, 0.5], [0.0, 0.0]).unwrap();
    assert!(matches!(del.step(&system, &mut state, &Control::none()), Err(StepError::NotConverged(_))));
    let mut at_rest = State::new(&CARTPOLE, [0.0, 0.0], [0.0, 0.0]).unwrap();
    assert_eq!(del.step(&system, &mut at_rest, &Control::none()).unwrap().iterations, 0);
}

/// Without momentum, force and motion, the terms of a residual cancel. A residual relative to their sum would never
/// be small.
#[test]
fn systems_at_rest_step_too() {
    fn check<P: Path>() {
        for q in [[0.0, 0.0], [0.0, 1e-3], [5.0, core::f32::consts::PI], [0.0, 2.0], [-300.0, 100.0]] {
            let mut state = State::<f32, 2>::new(&CARTPOLE, q, [0.0, 0.0]).unwrap();
            for k in 0..2_000 {
                let result = Del::<f32, P>::new(0.005).step(
                    &System::conservative(CARTPOLE),
                    &mut state,
                    &Control::none(),
                );
                assert!(result.is_ok_and(|r| r.iterations <= 3), "step {k} from {q:?}: {result:?}");
            }
        }
        // The control balances gravity, so only rounding is left of the force.
        let mut held = State::<f32, 1>::new(&PENDULUM, [0.8], [0.0]).unwrap();
        for _ in 0..2_000 {
            let [force] = PENDULUM.gradient(&held.q(), &[0.0]).l_q;
            let control = Control::held([-force]);
            Del::<f32, P>::new(0.001).step(&System::conservative(PENDULUM), &mut held, &control).unwrap();
        }
        assert!((held.q()[0] - 0.8).abs() < 1e-4);
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

#[test]
fn a_learned_system_at_rest_steps_in_f32() {
    for model in shapes::of_two() {
        let weights: Vec<f32> = model.weights.iter().map(|w| *w as f32).collect();
        let inertia_network = model.over(&weights);
        let system = System { lagrangian: inertia_network, forces: Viscous { coefficients: [0.4, 0.4] } };
        let mut state = State::new(&inertia_network, [0.3, -0.2], [0.0, 0.0]).unwrap();
        // The control balances gravity at every step, so forces and momenta are rounding errors.
        for k in 0..2_000 {
            let l_q = inertia_network.gradient(&state.q(), &[0.0, 0.0]).l_q;
            let u = Control::held(l_q.map(|x| -x));
            let result = Del::<f32, Galerkin>::new(0.002).step(&system, &mut state, &u);
            assert!(result.is_ok(), "step {k}: {result:?}");
        }
    }
}

const NO_MASS: Trigonometric<'static, 1> = Trigonometric { inertia: &[], potential: &[] };

/// Runs one step that must fail, and checks that it left the state as it was, bit for bit.
#[track_caller]
fn failing<L, P: Path, const N: usize>(
    lagrangian: L,
    h: f32,
    mut state: State<f32, N>,
    u: [f32; N],
) -> StepError<f32>
where
    L: Lagrangian<f32, N>,
{
    let before = state;
    let error = Del::<f32, P>::new(h).step(&System::conservative(lagrangian), &mut state, &Control::held(u));
    assert_eq!(state, before, "the state was touched");
    error.expect_err("the step must fail")
}

#[test]
fn errors_leave_the_state_alone() {
    fn check<P: Path>() {
        let at = |q, v| State::<f32, 2>::new(&CARTPOLE, q, v).unwrap();
        let swinging = at([0.0, 1.0], [0.5, 2.0]);
        let not_a_number = failing::<_, P, 2>(CARTPOLE, 0.01, swinging, [f32::NAN, 0.0]);
        assert_eq!(not_a_number, StepError::NotFinite);
        assert_eq!(failing::<_, P, 2>(CARTPOLE, 0.01, swinging, [0.0, f32::INFINITY]), StepError::NotFinite);
        assert_eq!(failing::<_, P, 2>(CARTPOLE, 0.01, swinging, [f32::MAX, f32::MAX]), StepError::NotFinite);
        assert_eq!(failing::<_, P, 2>(CARTPOLE, f32::NAN, swinging, [0.0, 0.0]), StepError::NotFinite);
        let lost = State::with_momentum([0.0, 7e4], [0.0, 0.0], [0.0, 0.0]).unwrap();
        assert_eq!(failing::<_, P, 2>(CARTPOLE, 0.01, lost, [0.0, 0.0]), StepError::NotFinite);
        let still = State::with_momentum([0.0], [1.0], [0.0]).unwrap();
        assert!(matches!(failing::<_, P, 1>(NO_MASS, 0.01, still, [0.0]), StepError::Singular { .. }));
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

#[test]
fn a_step_far_too_long_is_never_taken_for_converged() {
    fn check<P: Path>() {
        let mut random = Random(17);
        let (mut failures, accept) = (0, Newton::<f32>::default().accept);
        for _ in 0..100 {
            let del = Del::<f32, P>::new(random.symmetric(20.0).abs() as f32 + 1.0);
            let [q, v] = [random.array::<2>(3.0), random.array::<2>(40.0)].map(|x| x.map(|x| x as f32));
            let mut state = State::new(&ACROBOT, q, v).unwrap();
            let before = state;
            match del.step(&System::conservative(ACROBOT), &mut state, &Control::none()) {
                Ok(report) => assert!(report.residual <= accept),
                Err(StepError::NotConverged(report)) => {
                    assert!(
                        report.residual > accept
                            && report.iterations == Newton::<f32>::default().max_iterations,
                        "{report:?}"
                    );
                    assert_eq!(state, before, "the state was touched");
                    failures += 1;
                }
                Err(_) => assert_eq!(state, before, "the state was touched"),
            }
        }
        assert!(failures > 10, "only {failures} steps failed: the test does not test");
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

#[test]
fn a_state_is_finite_or_refused() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(State::new(&PENDULUM, [bad], [0.0]), Err(StepError::NotFinite));
        assert_eq!(State::new(&PENDULUM, [0.0], [bad]), Err(StepError::NotFinite));
        assert_eq!(State::with_momentum([0.0_f32], [bad], [0.0]), Err(StepError::NotFinite));
        assert_eq!(State::with_momentum([0.0_f32], [0.0], [bad]), Err(StepError::NotFinite));
        let del = Del::<f32, Galerkin>::new(0.01);
        let start = del.start(&System::conservative(PENDULUM), &[0.0], &[bad], &Control::none());
        assert_eq!(start, Err(StepError::NotFinite));
    }
}

/// A system in coordinates q′ = cq: in other units.
#[derive(Clone, Copy)]
struct Rescaled<L, const N: usize> {
    lagrangian: L,
    c: [f32; N],
}

impl<L: Lagrangian<f32, N>, const N: usize> Rescaled<L, N> {
    fn divided(&self, x: &[f32; N]) -> [f32; N] {
        core::array::from_fn(|i| x[i] / self.c[i])
    }

    fn matrix(&self, x: &[[f32; N]; N]) -> [[f32; N]; N] {
        core::array::from_fn(|i| self.divided(&x[i]).map(|x| x / self.c[i]))
    }
}

impl<L: Lagrangian<f32, N>, const N: usize> Lagrangian<f32, N> for Rescaled<L, N> {
    fn energies(&self, q: &[f32; N], v: &[f32; N]) -> Energies<f32> {
        self.lagrangian.energies(&self.divided(q), &self.divided(v))
    }

    fn gradient(&self, q: &[f32; N], v: &[f32; N]) -> Gradient<f32, N> {
        let Gradient { l_q, l_v } = self.lagrangian.gradient(&self.divided(q), &self.divided(v));
        Gradient { l_q: self.divided(&l_q), l_v: self.divided(&l_v) }
    }

    fn hessian(&self, q: &[f32; N], v: &[f32; N]) -> Hessian<f32, N> {
        let Hessian { l_q, l_v, l_qq, l_vq, l_vv } =
            self.lagrangian.hessian(&self.divided(q), &self.divided(v));
        let [l_qq, l_vq, l_vv] = [l_qq, l_vq, l_vv].map(|x| self.matrix(&x));
        Hessian { l_q: self.divided(&l_q), l_v: self.divided(&l_v), l_qq, l_vq, l_vv }
    }
}

/// Coordinates in metres or about millimetres, radians or about degrees: the updates and residuals are equal, bit for
/// bit if the factors are powers of two.
#[test]
fn units_of_coordinates_do_not_matter() {
    fn check<P: Path>(c: [f32; 2]) {
        let del = Del::<f32, P>::new(0.02);
        let plain = System::conservative(CARTPOLE);
        let rescaled = System::conservative(Rescaled { lagrangian: CARTPOLE, c });
        for (q, v) in [([0.3, 2.0], [0.5, -1.0]), ([1e-3, 1e-2], [0.0, 0.0]), ([0.0, 3.0], [0.0, 0.0])] {
            let scaled = |x: [f32; 2]| [x[0] * c[0], x[1] * c[1]];
            let mut state = State::new(&plain.lagrangian, q, v).unwrap();
            let mut other = State::new(&rescaled.lagrangian, scaled(q), scaled(v)).unwrap();
            for k in 0..500 {
                let u = [0.3 * (0.1 * k as f32).sin(), 0.0];
                let report = del.step(&plain, &mut state, &Control::held(u)).unwrap();
                let u = [u[0] / c[0], u[1] / c[1]];
                assert_eq!(del.step(&rescaled, &mut other, &Control::held(u)), Ok(report), "{c:?}, step {k}");
                assert_eq!(other.q(), scaled(state.q()), "{c:?}, step {k}");
            }
        }
    }
    // Elimination takes the same row first for all of them.
    for c in [[1024.0, 1024.0], [0.0009765625, 1.0], [0.0078125, 64.0], [0.125, 0.0625]] {
        check::<Midpoint>(c);
        check::<Galerkin>(c);
    }
}

#[test]
fn errors_say_what_is_wrong() {
    let slow: StepError<f32> = StepError::NotConverged(Report { iterations: 3, residual: 0.25 });
    assert_eq!(
        slow.to_string(),
        "Newton's method did not converge: 3 updates left a relative residual of 0.25"
    );
    let singular: &dyn std::error::Error = &StepError::<f32>::Singular { column: 1 };
    assert_eq!(singular.to_string(), "the matrix is singular: column 1 has no pivot but 0");
}
