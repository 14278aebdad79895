//! Tests of laws of force with networks: formulas, all derivatives, dissipation, potentials, equal bits.

use super::forces::{check_derivatives, check_inverse_under};
use crate::common::dual::Dual;
use crate::common::forces::dry;
use crate::common::network_laws::NetworkLaws;
use crate::common::{Random, assert_close, assert_vectors_close};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Path, State};
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE};
use leastaction_core::forces::{Dissipation, Forces, PotentialCorrection, Seen, System};
use leastaction_core::lagrangian::{Energies, Gradient, Hessian, Lagrangian};
use leastaction_core::linear::{add_scaled_matrix, dot, solve};
use leastaction_core::network::Activation;
use leastaction_core::scalar::{Real, WeightFormat};

#[test]
fn forces_are_the_formulas() {
    fn check<const N: usize>(seed: u64) {
        let laws = NetworkLaws::of(N, seed);
        let (dissipation, potential) = laws.in_f64::<N>();
        let mut random = Random(seed);
        for _ in 0..50 {
            let [q, v, tau] = [random.array(2.0), random.array(2.0), random.array(2.0)];
            let expected: [f64; N] = laws.naive_force(&q, &v).try_into().unwrap();
            assert_vectors_close("−Dv", &dissipation.force(&q, &v, &tau), &expected, 1e-13);
            assert_close("V_c", potential.potential(&q), laws.naive_potential(&q), 1e-13);
            assert_eq!(dissipation.potential(&q), 0.0);
            let both = (&dissipation, potential);
            assert_eq!(both.potential(&q), potential.potential(&q));
            let slope = |i: usize| {
                let moved = |step: f64| core::array::from_fn::<_, N, _>(|k| q[k] + step * f64::from(k == i));
                (laws.naive_potential(&moved(1e-5)) - laws.naive_potential(&moved(-1e-5))) / 2e-5
            };
            let expected = core::array::from_fn(|i| -slope(i));
            assert_vectors_close("−∂V_c/∂q", &potential.force(&q, &v, &tau), &expected, 1e-8);
        }
    }
    check::<1>(1);
    check::<2>(2);
    check::<3>(3);
    check::<4>(4);
}

#[test]
fn derivatives_are_those_of_dual_numbers() {
    fn check<const N: usize>(seed: u64) {
        let laws = NetworkLaws::of(N, seed);
        let numbers = laws.numbers(Dual::constant);
        let numbers = numbers.each_ref().map(Vec::as_slice);
        let (dissipation, potential) = laws.in_f64::<N>();
        let (dual_dissipation, dual_potential) = laws.over::<Dual, N>(numbers);
        check_derivatives("dissipation", dissipation, &dual_dissipation, seed);
        check_derivatives("potential", potential, &dual_potential, seed);
        check_derivatives("both", (dissipation, potential), &(dual_dissipation, dual_potential), seed);
    }
    check::<1>(1);
    check::<2>(2);
    check::<3>(3);
    check::<4>(4);
}

/// The power of the dissipation is not positive, whatever the weights of the network, except for the rounding of
/// terms that cancel. With a single coordinate, not even rounding makes it positive.
#[test]
fn power_is_never_positive() {
    fn check<R: Real<Weight = R> + WeightFormat<Wide = R>, const N: usize>() {
        let number = R::constant;
        let mut random = Random(7);
        for seed in 0..300 {
            let laws = NetworkLaws::of(N, seed);
            let size = 10_f64.powf(random.symmetric(3.0));
            let weights = laws.numbers(|x| number(x * size));
            let scales: Vec<R> = (0..N).map(|k| number(0.1 + k as f64)).collect();
            let seen = laws.dissipation.count();
            let numbers = [&scales[..seen], &weights[0][seen..]].concat();
            let (dissipation, _) = laws.over::<R, N>([&numbers, &weights[1]]);
            for _ in 0..30 {
                let [q, v] = [0; 2].map(|_| random.array::<N>(4.0).map(R::constant));
                let force = dissipation.force(&q, &v, &q);
                let (power, terms) = (dot(&force, &v), dot(&force.map(R::abs), &v.map(R::abs)));
                let rounding = if seen == 1 { 0.0 } else { 50.0 * R::EPSILON.to_f64() };
                assert!(power <= number(rounding) * terms, "{power:?} of {terms:?}");
            }
            let still = dissipation.force(&[number(0.3); N], &[number(0.0); N], &[number(1.0); N]);
            assert!(still.iter().all(|force| *force == number(0.0)), "{still:?} at rest");
        }
    }
    check::<f32, 1>();
    check::<f32, 2>();
    check::<f32, 4>();
    check::<f64, 1>();
    check::<f64, 3>();
}

#[test]
fn without_a_network_there_is_no_force() {
    let none = (Dissipation::<f64, 2, 1, 1>::none(), PotentialCorrection::<f64, 2, 1, 1>::none());
    let (q, v) = ([0.3, 0.4], [0.5, 0.6]);
    assert_eq!(none.force(&q, &v, &v), [0.0; 2]);
    assert_eq!(none.derivatives(&q, &v, &v), ([[0.0; 2]; 2], [[0.0; 2]; 2]));
    assert_eq!(none.potential(&q), 0.0);
}

#[test]
fn inverse_dynamics_inverts_acceleration() {
    let laws = NetworkLaws::of(2, 5);
    let (dissipation, potential) = laws.in_f64::<2>();
    check_inverse_under(&CARTPOLE, (dissipation, potential));
    check_inverse_under(&ACROBOT, (dry::<f64, 2>(), (dissipation, potential)));
}

/// Sizes that do not fit are refused with their numbers, and networks with the wrong numbers of inputs or outputs are
/// not taken.
#[test]
fn what_does_not_fit_is_refused() {
    use Coordinate::{Angle, Translation};
    let seen = Seen::<2>::new([None, Some(Angle)]).unwrap();
    assert_eq!((seen.count(), seen.features(), seen.iter().next()), (1, 2, Some(1)));
    let error = Seen::<1>::new([None, Some(Translation)]).unwrap_err();
    assert_eq!((error.found, error.compiled), (2, 1));
    let shape = |inputs, outputs| NetworkShape::new(inputs, &[3], outputs, Activation::Tanh).unwrap();
    let block = [0.5; 64];
    let taken = |length: usize, inputs, outputs| {
        let mut block = &block[..length];
        Dissipation::<f64, 2, 3, 1>::take(&mut block, seen, &shape(inputs, outputs))
            .unwrap()
            .map(|_| block.len())
    };
    assert_eq!(taken(40, 3, 1), Some(40 - 1 - 12 - 4));
    assert!(taken(16, 3, 1).is_none() && taken(40, 4, 1).is_none() && taken(40, 3, 2).is_none());
    let mut rest = &block[..];
    let error = Dissipation::<f64, 2, 2, 1>::take(&mut rest, seen, &shape(3, 1)).unwrap_err();
    assert_eq!((error.found, error.compiled), (3, 2));
    assert!(PotentialCorrection::<f64, 2, 3, 1>::take(&mut rest, seen, &shape(3, 1)).unwrap().is_none());
    assert!(PotentialCorrection::<f64, 2, 3, 1>::take(&mut rest, seen, &shape(2, 1)).unwrap().is_some());
}

/// L − V_c: the potential of the law moved into the Lagrangian.
struct Within<L, F>(System<L, F>);

impl<L: Lagrangian<f64, N>, F: Forces<f64, N>, const N: usize> Lagrangian<f64, N> for Within<L, F> {
    fn energies(&self, q: &[f64; N], v: &[f64; N]) -> Energies<f64> {
        self.0.energies(q, v)
    }

    fn gradient(&self, q: &[f64; N], v: &[f64; N]) -> Gradient<f64, N> {
        let Gradient { l_q, l_v } = self.0.lagrangian.gradient(q, v);
        let force = self.0.forces.force(q, v, &[0.0; N]);
        Gradient { l_q: core::array::from_fn(|i| l_q[i] + force[i]), l_v }
    }

    fn hessian(&self, q: &[f64; N], v: &[f64; N]) -> Hessian<f64, N> {
        let h = self.0.lagrangian.hessian(q, v);
        let (in_q, _) = self.0.forces.derivatives(q, v, &[0.0; N]);
        let l_q = Lagrangian::gradient(self, q, v).l_q;
        Hessian { l_q, l_qq: add_scaled_matrix(&h.l_qq, 1.0, &in_q), ..h }
    }
}

/// The step of L with the law is the variational step of L − V_c at both orders: it conserves the energy that
/// includes V_c.
#[test]
fn a_potential_beside_the_lagrangian_is_one_within() {
    fn check<P: Path>(oscillation: f64) {
        let laws = NetworkLaws::of(2, 6);
        let (_, potential) = laws.in_f64::<2>();
        let beside = System { lagrangian: ACROBOT, forces: potential };
        let within = System::conservative(Within(System { lagrangian: ACROBOT, forces: potential }));
        let del = Del::<f64, P>::new(0.02);
        let (q, v) = ([0.4, -0.7], [0.3, 0.5]);
        let mut states = [State::new(&ACROBOT, q, v).unwrap(); 2];
        let energy = |q: &[f64; 2], v: &[f64; 2]| {
            let Energies { kinetic, potential } = beside.energies::<f64, 2>(q, v);
            kinetic + potential
        };
        let start = energy(&q, &v);
        let (mut moved, mut worst) = (0.0_f64, 0.0_f64);
        for _ in 0..500 {
            let [a, b] = &mut states;
            del.step(&beside, a, &Control::none()).unwrap();
            del.step(&within, b, &Control::none()).unwrap();
            assert_vectors_close("q", &a.q(), &b.q(), 1e-9);
            let v = solve(ACROBOT.mass_matrix(&a.q()), a.p()).unwrap();
            worst = worst.max((energy(&a.q(), &v) - start).abs());
            moved = moved.max((potential.potential(&a.q()) - potential.potential(&q)).abs());
        }
        assert!(worst < oscillation && moved > 0.1, "energy off by {worst}, V_c moved by {moved}");
    }
    check::<Midpoint>(5e-4);
    check::<Galerkin>(1e-7);
}

/// Equal bits on every target.
#[test]
fn the_forces_have_these_bits() {
    let laws = NetworkLaws::of(3, 8);
    let numbers = laws.numbers(|x| x as f32);
    let (dissipation, potential) = laws.over::<f32, 3>([&numbers[0], &numbers[1]]);
    let (q, v) = ([0.25_f32, -0.5, 1.0], [0.5_f32, -2.0, 8.0]);
    let bits = [dissipation.force(&q, &v, &v), potential.force(&q, &v, &v)].map(|q| q.map(f32::to_bits));
    let golden = [[0xc0cf_7826, 0, 0xc259_5da4], [0x8000_0000, 0x3f16_fbcb, 0x3fa9_61d8]];
    assert_eq!(bits, golden, "{bits:#010x?}");
}
