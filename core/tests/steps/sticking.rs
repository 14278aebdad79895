//! Friction that sticks: rest to the last bit, energy, instants of sticking and release, order, and arms that stop joint by joint.

use crate::common::{Random, log_log_slope};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Path, State};
use leastaction_core::energy::trigonometric::ACROBOT;
use leastaction_core::forces::{Sticking, StickingFriction, System};
use leastaction_core::lagrangian::{Energies, Gradient, Hessian, Lagrangian};
use leastaction_core::linear::{add_scaled, dot, multiply};
use leastaction_core::scalar::{Real, Scalar};

/// Masses coupled by inertia and springs under a constant force: L = ½vᵀMv − ½qᵀKq + fᵀq.
#[derive(Clone, Copy, Debug)]
pub struct Masses<const N: usize> {
    pub mass: [[f64; N]; N],
    pub springs: [[f64; N]; N],
    pub force: [f64; N],
}

impl<const N: usize> Masses<N> {
    fn matrix<S: Scalar>(rows: &[[f64; N]; N]) -> [[S; N]; N] {
        rows.map(|row| row.map(S::constant))
    }
}

impl<S: Scalar, const N: usize> Lagrangian<S, N> for Masses<N> {
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        let half = |x: &[S; N], rows| dot(x, &multiply(&Self::matrix(rows), x)).half();
        let constant = dot(&self.force.map(S::constant), q);
        Energies { kinetic: half(v, &self.mass), potential: half(q, &self.springs) - constant }
    }

    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        let pull = multiply(&Self::matrix(&self.springs), q);
        let l_q = add_scaled(&self.force.map(S::constant), -S::one(), &pull);
        Gradient { l_q, l_v: multiply(&Self::matrix(&self.mass), v) }
    }

    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        let Gradient { l_q, l_v } = self.gradient(q, v);
        let l_qq = Self::matrix(&self.springs.map(|row| row.map(|k| -k)));
        Hessian { l_q, l_v, l_qq, l_vq: [[S::zero(); N]; N], l_vv: Self::matrix(&self.mass) }
    }
}

pub fn friction<R: Real>(forward: f64, backward: f64) -> StickingFriction<R> {
    let mean = (forward + backward) / 2.0;
    let asymmetry = R::constant(if mean > 0.0 { (forward - mean) / mean } else { 0.0 });
    let (constant, width) = (R::constant(mean), R::constant(0.01));
    StickingFriction { constant, asymmetry, width, ..StickingFriction::none() }
}

fn masses<R: Real, const N: usize>(
    lagrangian: Masses<N>,
    levels: [[f64; 2]; N],
) -> System<Masses<N>, Sticking<R, N>> {
    let coordinates = levels.map(|[forward, backward]| friction(forward, backward));
    System { lagrangian, forces: Sticking { coordinates } }
}

/// A block that slides onto a slope stops, and stays to the last bit for a million steps, whatever the slope's remaining force.
#[test]
fn a_block_on_a_slope_stays() {
    fn check<R: Real, P: Path>() {
        let block = Masses { mass: [[1.7]], springs: [[0.0]], force: [-3.1] };
        let system = masses::<R, 1>(block, [[2.9, 3.3]]);
        let del = Del::<R, P>::new(R::constant(1e-3));
        let mut state = State::new(&block, [R::constant(0.3)], [R::constant(0.2)]).unwrap();
        let none = Control::held([R::zero()]);
        for _ in 0..200 {
            del.step(&system, &mut state, &none).unwrap();
        }
        let stopped = state;
        assert!(stopped.p() == [R::zero()] && stopped.q()[0] > R::constant(0.3), "{stopped:?}");
        for _ in 0..1_000_000 {
            del.step(&system, &mut state, &none).unwrap();
        }
        assert_eq!(state, stopped);
        // One part in a thousand more than friction holds, and it goes down.
        let push = Control::held([R::constant(-0.2 * 1.001 - 0.0002)]);
        del.step(&system, &mut state, &push).unwrap();
        assert!(state.p()[0] < R::zero());
    }
    check::<f32, Midpoint>();
    check::<f64, Midpoint>();
    check::<f32, Galerkin>();
    check::<f64, Galerkin>();
}

/// A random positive definite matrix.
pub fn definite<const N: usize>(random: &mut Random) -> [[f64; N]; N] {
    let factor: [[f64; N]; N] = core::array::from_fn(|_| random.array(1.0));
    core::array::from_fn(|i| {
        core::array::from_fn(|j| dot(&factor[i], &factor[j]) + if i == j { 0.05 } else { 0.0 })
    })
}

/// T(p) = ½pᵀM⁻¹p in double precision.
pub fn kinetic<R: Real, const N: usize>(system: &Masses<N>, p: [R; N]) -> f64 {
    let p = p.map(|p| p.to_f64());
    let v = leastaction_core::linear::solve(system.mass, p).unwrap();
    dot(&p, &v) / 2.0
}

/// Without a potential and a drive, no step of coupled coordinates gains energy, and every motion ends.
#[test]
fn energy_never_grows() {
    fn check<R: Real, P: Path>(machines: usize) {
        let mut random = Random(5);
        let (mut steps, mut stopped) = (0, 0);
        for _ in 0..machines {
            let lagrangian =
                Masses::<3> { mass: definite(&mut random), springs: [[0.0; 3]; 3], force: [0.0; 3] };
            let levels = core::array::from_fn(|_| random.array::<2>(0.5).map(|x| 0.5 + x));
            let system = masses::<R, 3>(lagrangian, levels);
            let h = 10_f64.powf(-2.0 + random.symmetric(1.0));
            let del = Del::<R, P>::new(R::constant(h));
            let [q, v] = [random.array(1.0), random.array(2.0)].map(|x: [f64; 3]| x.map(R::constant));
            let mut state = State::new(&lagrangian, q, v).unwrap();
            let mut before = kinetic(&lagrangian, state.p());
            for _ in 0..100 {
                del.step(&system, &mut state, &Control::held([R::zero(); 3])).unwrap();
                let after = kinetic(&lagrangian, state.p());
                let rounding = 100.0 * R::EPSILON.to_f64() * before;
                assert!(after <= before + rounding, "{before:e} grew to {after:e} with {levels:?}, h = {h}");
                before = after;
                steps += 1;
            }
            stopped += usize::from(state.p() == [R::zero(); 3]);
        }
        assert!(stopped * 10 > machines, "{stopped} of {machines} came to rest in {steps} steps");
    }
    check::<f32, Midpoint>(3_000);
    check::<f64, Midpoint>(3_000);
    check::<f32, Galerkin>(2_000);
    check::<f64, Galerkin>(2_000);
}

/// Den Hartog's oscillator, m ẍ + kx = F cos ωt − c sign ẋ, in closed form between events.
struct DenHartog {
    m: f64,
    k: f64,
    c: f64,
    amplitude: f64,
    omega: f64,
}

impl DenHartog {
    fn drive(&self, t: f64) -> f64 {
        self.amplitude * (self.omega * t).cos()
    }

    /// Position and velocity at t of a motion in direction `sign` that starts at rest at (t0, x0).
    fn sliding(&self, (t0, x0): (f64, f64), sign: f64, t: f64) -> [f64; 2] {
        let (rate, centre) = ((self.k / self.m).sqrt(), -sign * self.c / self.k);
        let response = self.amplitude / (self.k - self.m * self.omega * self.omega);
        let forced = |t: f64| {
            let (sin, cos) = (self.omega * t).sin_cos();
            [response * cos + centre, -response * self.omega * sin]
        };
        let [x, v] = forced(t0);
        let ((sin, cos), [offset, speed]) = ((rate * (t - t0)).sin_cos(), [x0 - x, -v]);
        let [x, v] = forced(t);
        [x + offset * cos + speed / rate * sin, v - offset * rate * sin + speed * cos]
    }

    /// Instants of release and of sticking in turn, until `end`, from rest at 0. A motion that reverses at once does not stop.
    fn events(&self, end: f64) -> Vec<f64> {
        let (mut events, mut at) = (Vec::new(), (0.0, 0.0));
        loop {
            let excess = |t: f64| (self.drive(t) - self.k * at.1).abs() - self.c;
            let release = crossing(at.0, end, excess);
            let Some(release) = release else { return events };
            let sign = (self.drive(release) - self.k * at.1).signum();
            let still = crossing(release + 1e-6, end, |t| -sign * self.sliding((release, at.1), sign, t)[1]);
            let Some(still) = still else { return events };
            if events.last().is_some_and(|stop| release - stop < 1e-6) {
                events.pop();
                events.push(still);
            } else {
                events.extend([release, still]);
            }
            at = (still, self.sliding((release, at.1), sign, still)[0]);
        }
    }
}

/// The first t after `from` at which f rises above 0.
fn crossing(from: f64, end: f64, f: impl Fn(f64) -> f64) -> Option<f64> {
    let step = 1e-4;
    let after = (1..).map(|i| from + step * f64::from(i)).take_while(|t| *t < end).find(|t| f(*t) > 0.0)?;
    let (mut low, mut high) = (after - step, after);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if f(middle) > 0.0 { high = middle } else { low = middle }
    }
    Some(high)
}

/// Instants of sticking and of release lie within a thousandth of the period of those in closed form.
#[test]
fn an_oscillator_stops_and_goes_when_it_should() {
    fn check<R: Real, P: Path>() {
        let oscillator = DenHartog { m: 1.0, k: 16.0, c: 1.0, amplitude: 1.6, omega: 2.0 };
        let (h, end) = (1e-3, 20.0);
        let expected = oscillator.events(end);
        let period = std::f64::consts::TAU / oscillator.omega;
        let stops = expected
            .iter()
            .skip(1)
            .step_by(2)
            .filter(|t| (end - 5.0 * period..end - 2.0 * period).contains(*t));
        assert_eq!(stops.count(), 6, "two stops a period: {expected:?}");
        let lagrangian = Masses { mass: [[oscillator.m]], springs: [[oscillator.k]], force: [0.0] };
        let system = masses::<R, 1>(lagrangian, [[oscillator.c; 2]]);
        let mut state = State::new(&lagrangian, [R::zero()], [R::zero()]).unwrap();
        let (mut found, mut moving) = (Vec::new(), false);
        for step in 0..(end / h) as usize {
            let t = step as f64 * h;
            let [start, stop] = [t, t + h].map(|t| [R::constant(oscillator.drive(t))]);
            Del::<R, P>::new(R::constant(h))
                .step(&system, &mut state, &Control { start, end: stop })
                .unwrap();
            let moves = state.last_increment()[0] != R::zero();
            if moves != moving {
                found.push(t + h / 2.0);
                moving = moves;
            }
        }
        // The last release may have no stop before the end.
        assert!([0, 1].contains(&(found.len() - expected.len())), "{found:?} instead of {expected:?}");
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-3 * period, "{found} instead of {expected}");
        }
    }
    check::<f32, Midpoint>();
    check::<f64, Midpoint>();
    check::<f64, Galerkin>();
}

/// A system whose first coordinate is fixed.
#[derive(Clone, Copy, Debug)]
struct Fixed<L> {
    whole: L,
    at: f64,
}

impl<S: Scalar, L: Lagrangian<S, 2>> Lagrangian<S, 1> for Fixed<L> {
    fn energies(&self, [q]: &[S; 1], [v]: &[S; 1]) -> Energies<S> {
        self.whole.energies(&[S::constant(self.at), *q], &[S::zero(), *v])
    }

    fn gradient(&self, [q]: &[S; 1], [v]: &[S; 1]) -> Gradient<S, 1> {
        let Gradient { l_q, l_v } = self.whole.gradient(&[S::constant(self.at), *q], &[S::zero(), *v]);
        Gradient { l_q: [l_q[1]], l_v: [l_v[1]] }
    }

    fn hessian(&self, [q]: &[S; 1], [v]: &[S; 1]) -> Hessian<S, 1> {
        let Hessian { l_q, l_v, l_qq, l_vq, l_vv } =
            self.whole.hessian(&[S::constant(self.at), *q], &[S::zero(), *v]);
        let [l_qq, l_vq, l_vv] = [l_qq, l_vq, l_vv].map(|rows| [[rows[1][1]]]);
        Hessian { l_q: [l_q[1]], l_v: [l_v[1]], l_qq, l_vq, l_vv }
    }
}

/// Beside a coordinate that sticks, the other one moves as if the first were fixed; the momentum is that of the whole motion.
#[test]
fn a_coordinate_that_sticks_is_fixed() {
    fn check<P: Path>() {
        let (at, h) = (0.4, 5e-3);
        let system = masses_of(ACROBOT, [[1e4; 2], [0.0; 2]]);
        let alone = System::conservative(Fixed { whole: ACROBOT, at });
        let del = Del::<f64, P>::new(h);
        let mut state = State::new(&system.lagrangian, [at, 1.9], [0.0, 0.0]).unwrap();
        let mut other = State::new(&alone.lagrangian, [1.9], [0.0]).unwrap();
        for _ in 0..1_000 {
            del.step(&system, &mut state, &Control::held([3.0, 0.2])).unwrap();
            del.step(&alone, &mut other, &Control::held([0.2])).unwrap();
            assert_eq!(state.q()[0], at);
            assert!((state.q()[1] - other.q()[0]).abs() < 1e-9, "{:?} instead of {:?}", state.q(), other.q());
            let v = other.velocity(&alone.lagrangian).unwrap();
            let p = ACROBOT.gradient(&state.q(), &[0.0, v[0]]).l_v;
            assert!((0..2).all(|i| (state.p()[i] - p[i]).abs() < 1e-8), "{:?} instead of {p:?}", state.p());
        }
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

fn masses_of<L>(lagrangian: L, levels: [[f64; 2]; 2]) -> System<L, Sticking<f64, 2>> {
    let coordinates = levels.map(|[forward, backward]| friction(forward, backward));
    System { lagrangian, forces: Sticking { coordinates } }
}

/// While both coordinates slide, and only then, the error falls with the square of the step at either order.
#[test]
fn sliding_is_of_order_2() {
    fn end<P: Path>(steps: usize) -> [f64; 4] {
        let system = masses_of(ACROBOT, [[0.3, 0.5], [0.4, 0.2]]);
        let del = Del::<f64, P>::new(0.3 / steps as f64);
        let mut state = State::new(&system.lagrangian, [0.2, -0.7], [3.0, -2.5]).unwrap();
        for _ in 0..steps {
            del.step(&system, &mut state, &Control::held([1.0, -2.0])).unwrap();
            let w = state.last_increment();
            assert!(w[0] > 0.1 && w[1] < -0.1, "{w:?}");
        }
        let ([a, b], [c, d]) = (state.q(), state.p());
        [a, b, c, d]
    }
    fn check<P: Path>(least: f64) {
        let exact = end::<Galerkin>(20_000);
        let errors = [30, 60, 120].map(|steps| {
            let found = end::<P>(steps);
            let error = found.iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            (1.0 / steps as f64, error)
        });
        let slope = log_log_slope(&errors);
        assert!(slope > least, "slope {slope}: {errors:?}");
    }
    check::<Midpoint>(1.95);
    check::<Galerkin>(3.9);
}

/// The state at the second of two positions is that of a step that arrives there, sliding or at rest.
#[test]
fn a_motion_starts_from_two_positions() {
    fn check<P: Path>() {
        let system = masses_of(ACROBOT, [[0.5, 0.6], [0.3, 0.2]]);
        let del = Del::<f64, P>::new(4e-3);
        for (v, u) in [([1.0, -2.0], [0.5, 0.0]), ([0.0, 2.0], [0.1, 0.0]), ([0.0; 2], [0.0; 2])] {
            let mut state = State::new(&system.lagrangian, [0.0, 0.0], v).unwrap();
            let before = state.q();
            del.step(&system, &mut state, &Control::held(u)).unwrap();
            let started = del.start(&system, &before, &state.q(), &Control::held(u)).unwrap();
            let near = |a: [f64; 2], b: [f64; 2]| (0..2).all(|i| (a[i] - b[i]).abs() < 1e-9);
            assert!(near(started.p(), state.p()), "{:?} instead of {:?} from {v:?}", started.p(), state.p());
        }
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

/// A value that is not a number is refused, also where everything sticks, and leaves the state as it was.
#[test]
fn numbers_that_are_none_are_refused() {
    let system = masses_of(ACROBOT, [[5.0; 2]; 2]);
    let mut state = State::new(&system.lagrangian, [0.1, 0.2], [0.0, 0.0]).unwrap();
    let before = state;
    for u in [f64::NAN, f64::INFINITY] {
        let step = Del::<f64, Midpoint>::new(1e-3).step(&system, &mut state, &Control::held([0.0, u]));
        assert!(step.is_err(), "{step:?}");
        assert_eq!(state, before);
    }
}
