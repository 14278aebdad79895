//! Recursive dynamics compared with a Lagrangian of homogeneous transforms, differentiated by dual numbers.

use crate::common::tree;
use leastaction_learning::torque::linear::BaseParameters;
use leastaction_models::tree::{Joint, Tree};
use nalgebra::{Matrix3, Matrix4, Vector3};
use num_dual::{Dual64, DualNum, HyperDual64, second_partial_derivative};
use proptest::prelude::*;

/// Rodrigues' formula, or a shift along the axis, as a homogeneous matrix.
fn moved<D: DualNum<Primitive = f64> + Copy>(joint: &Joint, q: D) -> [[D; 4]; 4] {
    let mut m = [[D::from(0.0); 4]; 4];
    let (axis, turn, slide) = match joint {
        Joint::Revolute(axis) => (axis, q, D::from(0.0)),
        Joint::Prismatic(axis) => (axis, D::from(0.0), q),
    };
    let cross = axis.cross_matrix();
    let (one, sin, cos) = (Matrix3::<f64>::identity(), turn.sin(), turn.cos());
    let square = cross * cross;
    for i in 0..3 {
        for j in 0..3 {
            m[i][j] = sin * cross[(i, j)] + (-cos + 1.0) * square[(i, j)] + one[(i, j)];
        }
        m[i][3] = slide * axis[i];
    }
    m[3][3] = D::from(1.0);
    m
}

fn times<D: DualNum<Primitive = f64> + Copy>(a: &[[D; 4]; 4], b: &[[D; 4]; 4]) -> [[D; 4]; 4] {
    let entry = |i: usize, j: usize| (0..4).fold(D::from(0.0), |sum, k| sum + a[i][k] * b[k][j]);
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// The pose of every body in the base.
fn poses<D: DualNum<Primitive = f64> + Copy>(tree: &Tree, q: &[D]) -> Vec<[[D; 4]; 4]> {
    let mut all: Vec<[[D; 4]; 4]> = Vec::new();
    for body in tree.bodies() {
        let at = |i: usize, j: usize| match (i, j) {
            (3, j) => f64::from(u8::from(j == 3)),
            (i, 3) => body.pose.translation[i],
            (i, j) => body.pose.rotation[(i, j)],
        };
        let fixed = std::array::from_fn(|i| std::array::from_fn(|j| D::from(at(i, j))));
        let own = times(&fixed, &moved(&body.joint, q[body.coordinate] * body.ratio + body.offset));
        all.push(body.parent.map_or(own, |parent| times(&all[parent], &own)));
    }
    all
}

/// T − V: T = ½ Σ tr(Ẋ P Ẋᵀ) with the pseudo-inertia P, Ẋ by a dual number of dual numbers along v.
fn lagrangian<D: DualNum<Primitive = f64> + Copy>(tree: &Tree, q: &[D], v: &[D]) -> D {
    // Ẋ by hand: the derivative along v is Σ v_k ∂X/∂q_k, taken by a dual over D.
    let along: Vec<num_dual::Dual<D>> = q.iter().zip(v).map(|(q, v)| num_dual::Dual::new(*q, *v)).collect();
    let mut sum = D::from(0.0);
    for (body, pose) in tree.bodies().iter().zip(poses(tree, &along)) {
        let pseudo: Matrix4<f64> = body.inertia.pseudo();
        for (row, gravity) in pose.iter().zip(tree.gravity.iter()) {
            for (j, x) in row.iter().enumerate() {
                for (k, y) in row.iter().enumerate() {
                    sum += x.eps * y.eps * (0.5 * pseudo[(j, k)]);
                }
                sum += x.re * (gravity * pseudo[(j, 3)]);
            }
        }
    }
    for (rotor, v) in tree.rotors.iter().zip(v) {
        sum += *v * *v * (0.5 * rotor);
    }
    sum
}

/// d/dt L_v − L_q at q, v, a.
fn by_lagrange(tree: &Tree, q: &[f64], v: &[f64], a: &[f64]) -> Vec<f64> {
    let n = q.len();
    let at = |x: &[f64]| -> Vec<HyperDual64> { x.iter().map(|x| HyperDual64::from(*x)).collect() };
    (0..n)
        .map(|i| {
            // The duals vary along (v, a) in time, and along e_i in velocity.
            let rate: f64 = (0..2 * n)
                .map(|k| {
                    let of = |(x, y): (HyperDual64, HyperDual64)| {
                        let (mut q, mut v) = (at(q), at(v));
                        v[i] += y;
                        if k < n {
                            q[k] += x
                        } else {
                            v[k - n] += x
                        }
                        lagrangian(tree, &q, &v)
                    };
                    let (_, _, _, mixed) = second_partial_derivative(of, (0.0, 0.0));
                    mixed * if k < n { v[k] } else { a[k - n] }
                })
                .sum();
            let slope = |x: f64| {
                let mut q: Vec<Dual64> = q.iter().map(|q| Dual64::from(*q)).collect();
                q[i] += Dual64::new(x, 1.0);
                let v: Vec<Dual64> = v.iter().map(|v| Dual64::from(*v)).collect();
                lagrangian(tree, &q, &v).eps
            };
            rate - slope(0.0)
        })
        .collect()
}

fn near(a: &[f64], b: &[f64], within: f64) -> bool {
    let size = a.iter().chain(b).fold(1.0_f64, |size, x| size.max(x.abs()));
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= within * size)
}

fn state() -> impl Strategy<Value = [Vec<f64>; 3]> {
    let of = || proptest::collection::vec(-3.0..3.0, 4);
    (of(), of(), of()).prop_map(|(q, v, a)| [q, v, a])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn inverse_dynamics_are_lagranges_equations(seed in 0u64..1000, [q, v, a] in state()) {
        let tree = tree(seed);
        let (found, expected) = (tree.inverse_dynamics(&q, &v, &a), by_lagrange(&tree, &q, &v, &a));
        prop_assert!(near(&found, &expected, 1e-12), "{found:?} {expected:?}");
    }

    #[test]
    fn energies_are_the_lagrangian(seed in 0u64..1000, [q, v, _] in state()) {
        let tree = tree(seed);
        let [kinetic, potential] = tree.energies(&q, &v);
        prop_assert!(near(&[kinetic - potential], &[lagrangian(&tree, &q, &v)], 1e-12));
        prop_assert!(kinetic >= 0.0);
    }

    #[test]
    fn the_regressor_times_the_parameters_is_the_torque(seed in 0u64..1000, [q, v, a] in state()) {
        let tree = tree(seed);
        let parameters = tree.parameters();
        let found: Vec<f64> = tree.regressor(&q, &v, &a).iter()
            .map(|row| row.iter().zip(&parameters).map(|(y, x)| y * x).sum()).collect();
        prop_assert!(near(&found, &tree.inverse_dynamics(&q, &v, &a), 1e-12));
    }

    #[test]
    fn the_mass_matrix_is_that_of_kinetic_energy(seed in 0u64..1000, [q, v, _] in state()) {
        let tree = tree(seed);
        let matrix = tree.mass_matrix(&q);
        let momentum: Vec<f64> = matrix.iter().map(|row| row.iter().zip(&v).map(|(m, v)| m * v).sum()).collect();
        let twice: f64 = momentum.iter().zip(&v).map(|(p, v)| p * v).sum();
        prop_assert!(near(&[twice / 2.0], &[tree.energies(&q, &v)[0]], 1e-12));
        for i in 0..4 {
            let column: Vec<f64> = matrix.iter().map(|row| row[i]).collect();
            prop_assert!(near(&column, &matrix[i], 1e-12));
        }
    }

    #[test]
    fn base_parameters_carry_all_that_torques_show(seed in 0u64..1000, [q, v, a] in state()) {
        let tree = tree(seed);
        let base = BaseParameters::of(&tree);
        prop_assert!(base.count() < tree.parameter_count());
        let mut reduced = vec![0.0; tree.parameter_count()];
        let values = base.values(&tree.parameters());
        base.independent.iter().zip(&values).for_each(|(k, x)| reduced[*k] = *x);
        let found = tree.with_parameters(&reduced).inverse_dynamics(&q, &v, &a);
        prop_assert!(near(&found, &tree.inverse_dynamics(&q, &v, &a), 1e-9));
    }
}

#[test]
fn a_pendulum_has_the_torque_of_the_book() {
    let text = "<robot name='p'><link name='base'/><link name='rod'><inertial><origin xyz='0 0 -0.7'/><mass value='2'/>\
        <inertia ixx='0.1' ixy='0' ixz='0' iyy='0.2' iyz='0' izz='0.15'/></inertial></link><joint name='j' type='revolute'>\
        <parent link='base'/><child link='rod'/><axis xyz='0 1 0'/></joint></robot>";
    let tree = leastaction_models::urdf::parse(text, leastaction_models::urdf::Inertias::Required).unwrap();
    assert_eq!(tree.bodies()[0].inertia.moment(), Vector3::new(0.0, 0.0, -1.4));
    let [found] = tree.inverse_dynamics(&[0.4], &[5.0], &[3.0])[..] else { panic!() };
    let expected = (0.2 + 2.0 * 0.49) * 3.0 + 2.0 * 9.81 * 0.7 * 0.4_f64.sin();
    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
}
