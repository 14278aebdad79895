//! Steps under dry friction: Newton's method through the change of sign, dissipation, ringing, orders of accuracy, and bits.

use crate::common::{Random, forces::dry, trees};
use leastaction_core::continuous::energy;
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Newton, Path, State, StepError};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM, Trigonometric, Wave};
use leastaction_core::forces::{Coulomb, DryFriction, Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::{Matrix, solve};
use leastaction_core::scalar::{Real, Scalar};

/// Friction of the given levels, N or N m, with widths that make steps of h seconds as stiff as `a` in every coordinate.
fn as_stiff<R: Real, L: Lagrangian<f64, N>, const N: usize>(
    lagrangian: &L,
    c: [f64; N],
    h: f64,
    a: f64,
) -> Coulomb<R, N> {
    let unit = |i: usize| DryFriction { constant: c[i], load: 0.1, smoothing: 0.1, width: 1.0 };
    let unit = Coulomb { coordinates: core::array::from_fn(unit) };
    let mass = lagrangian.hessian(&[0.0; N], &[0.0; N]).l_vv;
    let stiffness = unit.stiffness(h, mass, &[0.0; N]).unwrap();
    Coulomb {
        coordinates: core::array::from_fn(|i| DryFriction {
            constant: R::constant(c[i]),
            load: R::constant(0.1),
            smoothing: R::constant(0.1),
            width: R::constant(stiffness[i] / a),
        }),
    }
}

/// Friction that lets Newton's method take every change of velocity in full.
struct Trusting<S, const N: usize>(Coulomb<S, N>);

impl<S: Scalar, const N: usize> Forces<S, N> for Trusting<S, N> {
    fn force(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        self.0.force(q, v, tau)
    }

    fn derivatives(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        self.0.derivatives(q, v, tau)
    }

    fn load_derivative(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> Matrix<S, N> {
        self.0.load_derivative(q, v, tau)
    }
}

/// Updates of steps: the sum, the number of steps, and the maximum.
#[derive(Clone, Copy, Default)]
struct Updates {
    sum: usize,
    steps: usize,
    most: u8,
}

impl Updates {
    fn add(&mut self, updates: u8) {
        *self = Self {
            sum: self.sum + usize::from(updates),
            steps: self.steps + 1,
            most: self.most.max(updates),
        };
    }

    fn text(&self) -> String {
        format!("{:.1}, {}", self.sum as f64 / self.steps.max(1) as f64, self.most)
    }
}

/// Runs 4 s from six starts, with coordinate 0 driven to and fro. Returns the updates of the steps in which a
/// velocity changes its sign, those of all steps, and the number of trajectories that ended in an error.
fn follow<R: Real, P: Path, L: Lagrangian<R, N>, F: Forces<R, N>, const N: usize>(
    system: &System<L, F>,
    h: f64,
) -> (Updates, Updates, usize) {
    let (del, mut random) = (Del::<R, P>::new(R::constant(h)), Random(4));
    let (mut turning, mut all, mut failures) = (Updates::default(), Updates::default(), 0);
    for speed in [3.0, 1.5, 0.5, 0.0, 2.0, 1.0] {
        let (q, v) = (random.array::<N>(3.1), random.array::<N>(speed));
        let mut state = State::new(&system.lagrangian, q.map(R::constant), v.map(R::constant)).unwrap();
        for k in 0..(4.0 / h) as usize {
            let mut u = [R::zero(); N];
            u[0] = R::constant(2.0 * (3.0 * k as f64 * h).sin());
            let before = state.last_increment();
            let Ok(report) = del.step(system, &mut state, &Control::held(u)) else {
                failures += 1;
                break;
            };
            all.add(report.iterations);
            let turned = |(a, b): (&R, &R)| (*a > R::zero()) != (*b > R::zero());
            if before.iter().zip(&state.last_increment()).any(turned) {
                turning.add(report.iterations);
            }
        }
    }
    (turning, all, failures)
}

/// Checks the number of updates of one system, and returns how many trajectories fail if every change is taken in
/// full.
fn check_system<R, P, L, const N: usize>(name: &str, lagrangian: L, c: [f64; N], most: [u8; 3]) -> usize
where
    R: Real,
    P: Path,
    L: Lagrangian<f64, N> + Lagrangian<R, N> + Copy,
{
    let mut trusting_failures = 0;
    for (h, most) in [0.001, 0.01, 0.05].into_iter().zip(most) {
        for a in [0.1, 0.5, 1.0, 2.0, 5.0, 50.0] {
            let forces = as_stiff::<R, L, N>(&lagrangian, c, h, a);
            let (turning, all, failures) = follow::<R, P, _, _, N>(&System { lagrangian, forces }, h);
            let name = format!("{name}, order {}, h = {h}, a = {a}", P::ORDER);
            println!("{name}: through the change of sign {}; all {}", turning.text(), all.text());
            assert_eq!(failures, 0, "{name}");
            assert!(turning.steps > 10 && all.most <= most, "{name}: {} updates", all.most);
            let forces = Trusting(forces);
            trusting_failures += follow::<R, P, _, _, N>(&System { lagrangian, forces }, h).2;
        }
    }
    trusting_failures
}

/// Newton's method converges through the change of sign, however stiff friction is; without [`Forces::trusted_part`] it does not.
fn check_newton<R: Real, P: Path>(scalar: &str, most: [u8; 3]) {
    let name = |system: &str| format!("{scalar}, {system}");
    let failures = check_system::<R, P, _, 1>(&name("pendulum"), PENDULUM, [0.5], most)
        + check_system::<R, P, _, 2>(&name("cart-pole"), CARTPOLE, [0.3, 0.02], most)
        + check_system::<R, P, _, 2>(&name("acrobot"), ACROBOT, [0.8, 0.3], most);
    assert!(failures > 3, "only {failures} trajectories failed where every change was trusted");
}

#[test]
fn newtons_method_converges_through_the_change_of_sign() {
    check_newton::<f32, Midpoint>("f32", [7, 7, 8]);
    check_newton::<f32, Galerkin>("f32", [7, 7, 8]);
    check_newton::<f64, Midpoint>("f64", [9, 9, 12]);
    check_newton::<f64, Galerkin>("f64", [9, 9, 12]);
}

/// Three coordinates that change direction at different times, learned and not. One of these systems has a step that
/// fails; with friction, no step fails that does not also fail without friction.
#[test]
fn a_tree_converges_too() {
    fn check<P: Path>(tree: &trees::Tree<3>) {
        let lagrangian = &tree.in_f64();
        let forces = Coulomb::<f64, 3>::none();
        let (_, _, without) = follow::<f64, P, _, _, 3>(&System { lagrangian, forces }, 0.01);
        for a in [0.5, 5.0] {
            let forces = as_stiff::<f64, _, 3>(&lagrangian, [0.5, 0.2, 0.1], 0.01, a);
            let (_, all, failures) = follow::<f64, P, _, _, 3>(&System { lagrangian, forces }, 0.01);
            assert_eq!(failures, without, "order {}, a = {a}", P::ORDER);
            assert!(all.most <= 8, "order {}, a = {a}: {} updates", P::ORDER, all.most);
        }
    }
    for tree in &trees::of_three() {
        check::<Midpoint>(tree);
        check::<Galerkin>(tree);
    }
}

/// A fixed number of updates stays fixed: a step that these updates do not solve is an error, and leaves the state
/// unchanged.
#[test]
fn the_bound_on_updates_stays() {
    let newton = Newton { max_iterations: 2, stop: 0.0, ..Newton::<f32>::default() };
    let del = Del::<f32, Midpoint>::with_newton(0.01, newton);
    let system = System { lagrangian: PENDULUM, forces: as_stiff::<f32, _, 1>(&PENDULUM, [0.5], 0.01, 20.0) };
    let mut state = State::new(&PENDULUM, [2.9], [0.3]).unwrap();
    let error = (0..1_000).find_map(|_| {
        let before = state;
        let result = del.step(&system, &mut state, &Control::none());
        assert!(result.is_ok_and(|report| report.iterations == 2) || state == before);
        result.err()
    });
    let Some(StepError::NotConverged(report)) = error else { panic!("{error:?}") };
    assert_eq!(report.iterations, 2);
}

/// A mass without a potential.
const FREE: Trigonometric<'static, 1> =
    Trigonometric { inertia: &[(0, 0, Wave { amplitude: 0.5, wave: [0.0] })], potential: &[] };

/// Near rest a midpoint step turns v into v(1 − a)/(1 + a), a step of order 4 into v(1 − a + a²/3)/(1 + a + a²/3), and energy is lost at
/// every step for any a.
#[test]
fn a_stiff_step_rings_and_loses_energy() {
    check_ringing::<Midpoint>(|a| (1.0 - a) / (1.0 + a));
    check_ringing::<Galerkin>(|a| (1.0 - a + a * a / 3.0) / (1.0 + a + a * a / 3.0));
}

fn check_ringing<P: Path>(factor: impl Fn(f64) -> f64) {
    for a in [0.3, 0.9, 1.1, 3.0, 20.0] {
        let system = System { lagrangian: FREE, forces: as_stiff::<f64, _, 1>(&FREE, [0.4], 0.02, a) };
        let width = system.forces.coordinates[0].width;
        let del = Del::<f64, P>::new(0.02);
        let mut state = State::new(&FREE, [0.0], [1e-4 * width]).unwrap();
        for _ in 0..20 {
            let before = state.p()[0];
            del.step(&system, &mut state, &Control::none()).unwrap();
            let ratio = state.p()[0] / before;
            assert!((ratio - factor(a)).abs() < 1e-6, "order {}, a = {a}: {ratio}", P::ORDER);
        }
        let mut moving = State::new(&FREE, [0.0], [3.0 * width + 0.2]).unwrap();
        for _ in 0..100 {
            let before = moving.p()[0].abs();
            del.step(&system, &mut moving, &Control::none()).unwrap();
            assert!(moving.p()[0].abs() < before, "a = {a}: no energy is lost");
        }
    }
}

/// The energy falls from second to second, at both orders.
#[test]
fn energy_is_lost() {
    fn check<P: Path>(h: f64, tolerance: f64) {
        let system = System { lagrangian: CARTPOLE, forces: dry::<f64, 2>() };
        let del = Del::<f64, P>::new(h);
        let mut state = State::new(&CARTPOLE, [0.0, 2.0], [1.5, 0.0]).unwrap();
        let total = |state: &State<f64, 2>| {
            let mass = CARTPOLE.mass_matrix(&state.q());
            let v = solve(mass, state.p()).unwrap();
            energy(&CARTPOLE, &state.q(), &v)
        };
        let start = total(&state);
        let mut last = start;
        for second in 1..=8 {
            (0..(1.0 / h) as usize).for_each(|_| {
                del.step(&system, &mut state, &Control::none()).unwrap();
            });
            let now = total(&state);
            assert!(now <= last + tolerance, "{second} s: {now} J after {last} J");
            last = now;
        }
        assert!(last < start - 0.5, "from {start} J to {last} J");
    }
    check::<Midpoint>(0.01, 1e-4);
    check::<Galerkin>(0.01, 1e-8);
}

/// Equal bits on every target: position and momentum after 5 s in which the cart is pushed to and fro.
#[test]
fn steps_have_these_bits() {
    fn follow<P: Path>() -> [u32; 4] {
        let system = System { lagrangian: CARTPOLE, forces: dry::<f32, 2>() };
        let del = Del::<f32, P>::new(0.01);
        let mut state = State::new(&CARTPOLE, [0.0, 2.5], [0.5, 0.0]).unwrap();
        for k in 0..500 {
            let u = Control::held([if k % 100 < 50 { 2.0 } else { -2.0 }, 0.0]);
            del.step(&system, &mut state, &u).unwrap();
        }
        let ([x, angle], [p_x, p_angle]) = (state.q(), state.p());
        [x, angle, p_x, p_angle].map(f32::to_bits)
    }
    let bits = [follow::<Midpoint>(), follow::<Galerkin>()];
    let golden = [
        [0x3f81_17a6, 0x4042_7a81, 0xbef6_5827, 0x3cae_9c9b],
        [0x3f81_1890, 0x4042_7a80, 0xbef6_574c, 0x3cae_9bd4],
    ];
    assert_eq!(bits, golden, "{bits:#010x?}");
}
