//! Holonomic constraints: their derivatives, and the constrained acceleration against dense and angle coordinates.

use crate::common::particles::{Exact, Spring, hanging, rods, solve_dense};
use crate::common::{Random, assert_close, assert_vectors_close};
use leastaction_core::constraints::{Constrained, ConstraintError, Constraints, Holonomic, Positions};
use leastaction_core::continuous::{
    Baumgarte, Drive, constrained_acceleration, constrained_inverse_dynamics, constrained_workspace,
};
use leastaction_core::linear::{SolveError, dot, multiply, solve_definite};
use leastaction_core::particles::Particles;
use proptest::prelude::*;

type List<const D: usize> = [Holonomic<f64, D>];

/// The acceleration and the multipliers (v̇, λ).
type Accelerations<const D: usize> = (Vec<[f64; D]>, Vec<f64>);

/// (v̇, λ) of a mechanism.
fn accelerate<const D: usize>(
    mechanism: &Constrained<f64, Exact<f64, D>, List<D>, D>,
    q: &[[f64; D]],
    v: &[[f64; D]],
    drive: &Drive<f64, D>,
) -> Result<Accelerations<D>, ConstraintError<f64>> {
    let mut workspace = vec![0.0; constrained_workspace(mechanism)];
    let (mut a, mut lambda) = (vec![[0.0; D]; q.len()], vec![0.0; mechanism.equations()]);
    constrained_acceleration(mechanism, (q, v), drive, &mut workspace, (&mut a, &mut lambda))?;
    Ok((a, lambda))
}

/// A rod, an anchor and a node held at a point, in space.
fn one_of_each() -> Vec<Holonomic<f64, 3>> {
    let rod = Holonomic::Rod { nodes: [2, 0], length: 1.3 };
    let anchor = Holonomic::Anchor { node: 1, to: [0.4, -0.2, 0.7], length: 0.6 };
    [rod, anchor].into_iter().chain(Holonomic::held(3, [0.3, 2.0, -1.0])).collect()
}

fn vectors<const D: usize>(random: &mut Random, nodes: usize, radius: f64) -> Vec<[f64; D]> {
    (0..nodes).map(|_| random.array(radius)).collect()
}

fn moved<const D: usize>(q: &[[f64; D]], c: f64, v: &[[f64; D]]) -> Vec<[f64; D]> {
    q.iter().zip(v).map(|(q, v)| core::array::from_fn(|i| q[i] + c * v[i])).collect()
}

/// φ is quadratic in q, so central differences over any step are exact.
#[test]
fn derivatives_are_those_of_the_value() {
    let (list, mut random) = (one_of_each(), Random(3));
    let constraints = &list[..];
    let q = vectors::<3>(&mut random, 4, 2.0);
    let v = vectors::<3>(&mut random, 4, 2.0);
    for k in 0..constraints.equations() {
        let phi = |q: &[[f64; 3]]| constraints.value(k, Positions::new(q));
        let curvature = phi(&moved(&q, 1.0, &v)) - 2.0 * phi(&q) + phi(&moved(&q, -1.0, &v));
        assert_close(
            &format!("curvature {k}"),
            constraints.curvature(k, Positions::new(&q), &v),
            curvature,
            1e-13,
        );
        for node in 0..4 {
            let slot = constraints.nodes(k).iter().position(|n| *n == node);
            let found = slot.map_or([0.0; 3], |slot| constraints.gradient(k, slot, Positions::new(&q)));
            let slope = core::array::from_fn(|axis| {
                let mut along = vec![[0.0; 3]; 4];
                along[node][axis] = 0.5;
                phi(&moved(&q, 1.0, &along)) - phi(&moved(&q, -1.0, &along))
            });
            assert_vectors_close(&format!("gradient {k} of {node}"), &found, &slope, 1e-13);
        }
    }
}

#[test]
fn the_value_is_the_stretch_of_a_rod() {
    let constraints = &one_of_each()[..];
    let mut q = vec![[0.0; 3]; 4];
    q[2] = [1.3 + 1e-7, 0.0, 0.0];
    q[1] = [0.4, -0.2 - 0.6 - 2e-7, 0.7];
    q[3] = [0.3, 2.0 + 3e-7, -1.0];
    let found: Vec<f64> = (0..5).map(|k| constraints.value(k, Positions::new(&q))).collect();
    for (found, expected) in found.iter().zip([1e-7, 2e-7, 0.0, 3e-7, 0.0]) {
        assert_close("stretch", *found, expected, 1e-13);
    }
}

/// φ in f32 is right to 1e-13 m if it is computed from positions with their carries. Computed from positions alone,
/// it would be 1e-7 m off.
#[test]
fn the_value_is_twice_as_precise_as_its_scalar() {
    let mut random = Random(17);
    for _ in 0..200 {
        let angle = random.symmetric(3.0);
        let far = random.array::<2>(4.0);
        let near = [far[0] + angle.sin(), far[1] + angle.cos()];
        let q = [far, near].map(|x| x.map(|x| x as f32));
        let carry: [[f32; 2]; 2] = core::array::from_fn(|i| {
            core::array::from_fn(|j| ([far, near][i][j] - f64::from(q[i][j])) as f32)
        });
        let whole: [[f64; 2]; 2] =
            core::array::from_fn(|i| core::array::from_fn(|j| f64::from(q[i][j]) + f64::from(carry[i][j])));
        for (single, double) in [
            (
                Holonomic::Rod { nodes: [0, 1], length: 1.0_f32 },
                Holonomic::Rod { nodes: [0, 1], length: 1.0 },
            ),
            (
                Holonomic::Anchor { node: 1, to: q[0], length: 1.0 },
                Holonomic::Anchor { node: 1, to: q[0].map(f64::from), length: 1.0 },
            ),
        ] {
            let found = f64::from([single][..].value(0, Positions::with_carry(&q, &carry)));
            let expected = [double][..].value(0, Positions::new(&whole));
            let error = (found - expected).abs();
            assert!(error < 2e-13 + 2e-7 * expected.abs(), "{found:e} instead of {expected:e}");
        }
    }
}

/// The whole system [M −Aᵀ; A 0](v̇, λ) = (r, −Ȧv − feedback), row by row.
fn dense<const D: usize>(
    system: &Exact<f64, D>,
    constraints: &List<D>,
    q: &[[f64; D]],
    v: &[[f64; D]],
    drive: &Drive<f64, D>,
) -> Vec<f64> {
    let (n, m) = (q.len() * D, constraints.len());
    let (mut a, mut b) = (vec![vec![0.0; n + m]; n + m], vec![0.0; n + m]);
    let mut l_q = vec![[0.0; D]; q.len()];
    system.l_q(q, &mut [], &mut l_q);
    for node in 0..q.len() {
        let (mass, drag) = (system.mass(node, &v[node]), system.drag(node, &v[node]));
        for i in 0..D {
            a[node * D + i][node * D..(node + 1) * D].copy_from_slice(&mass[i]);
            b[node * D + i] = l_q[node][i] + drag[i] + drive.force.map_or(0.0, |f| f[node][i]);
        }
    }
    let (Baumgarte { omega, zeta }, x) = (drive.baumgarte, Positions::new(q));
    for k in 0..m {
        b[n + k] = -constraints.curvature(k, x, v) - omega * omega * constraints.value(k, x);
        for (slot, node) in constraints.nodes(k).iter().enumerate() {
            let gradient = constraints.gradient(k, slot, x);
            b[n + k] -= 2.0 * zeta * omega * dot(&gradient, &v[*node]);
            for i in 0..D {
                a[n + k][node * D + i] += gradient[i];
                a[node * D + i][n + k] -= gradient[i];
            }
        }
    }
    solve_dense(a, b)
}

fn assert_dense<const D: usize>(
    system: &Exact<f64, D>,
    constraints: &List<D>,
    (q, v): (&[[f64; D]], &[[f64; D]]),
    drive: &Drive<f64, D>,
    tolerance: f64,
) {
    let mechanism = Constrained::new(system, constraints).unwrap();
    let (a, lambda) = accelerate(&mechanism, q, v, drive).unwrap();
    let expected = dense(system, constraints, q, v, drive);
    let size = expected.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
    for (found, expected) in a.as_flattened().iter().chain(&lambda).zip(&expected) {
        assert!((found - expected).abs() < tolerance * size, "{found} instead of {expected} of {size}");
    }
}

/// Springs, rods, an anchor and a held node; a kinetic energy that is not quadratic, drag and a force; positions that
/// violate the constraints.
#[test]
fn acceleration_solves_the_dense_system() {
    let mut random = Random(8);
    let mut system = Exact::<f64, 3>::under_gravity(&[1.0, 0.7, 2.0, 1.3, 0.4], 9.8).hard();
    system.springs = vec![
        Spring { nodes: [4, 0], stiffness: 5.0, rest: 0.9 },
        Spring { nodes: [1, 4], stiffness: 3.0, rest: 1.1 },
    ];
    let list = one_of_each();
    let (q, v) = (vectors::<3>(&mut random, 5, 2.0), vectors::<3>(&mut random, 5, 2.0));
    let force = vectors::<3>(&mut random, 5, 4.0);
    assert_dense(&system, &list, (&q, &v), &Drive::none(), 1e-12);
    let baumgarte = Baumgarte { omega: 3.0, zeta: 0.7 };
    assert_dense(&system, &list, (&q, &v), &Drive { force: Some(&force), baumgarte }, 1e-12);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    /// Chains whose rods are listed in any order, so that the band varies.
    #[test]
    fn acceleration_of_chains_solves_the_dense_system(
        links in prop::collection::vec((0.3..2.0, -3.0..3.0, -4.0..4.0, 0.3..3.0), 1..8),
        anchored: bool,
        turn in 0..7usize,
    ) {
        let column = |f: fn(&(f64, f64, f64, f64)) -> f64| links.iter().map(f).collect::<Vec<f64>>();
        let (lengths, angles, rates) = (column(|l| l.0), column(|l| l.1), column(|l| l.2));
        let (mut q, mut v) = hanging(&lengths, &angles, &rates);
        let mut masses = column(|l| l.3);
        if !anchored {
            q.insert(0, [0.0; 2]);
            v.insert(0, [0.0; 2]);
            masses.push(0.8);
        }
        let mut list = rods::<f64, 2>(&lengths, anchored);
        let count = list.len();
        list.rotate_left(turn % count);
        let system = Exact::under_gravity(&masses, 10.0).hard();
        assert_dense(&system, &list, (&q, &v), &Drive::none(), 1e-10);
    }
}

/// Σ_j m_max(i,j) ℓ_i ℓ_j (θ̈_j cos(θ_i − θ_j) + θ̇_j² sin(θ_i − θ_j)) = −m_i g ℓ_i sin θ_i, m the mass from a link on.
#[test]
fn acceleration_of_a_chain_is_that_of_its_angles() {
    let (lengths, masses, g) = ([1.0, 0.7, 1.4, 0.9], [0.5, 1.2, 0.8, 2.0], 9.8);
    let (angles, rates) = ([0.6_f64, -1.1, 2.2, 0.3], [1.5, -0.4, 2.0, -3.0]);
    let below = |i: usize| masses[i..].iter().sum::<f64>();
    let inertia = |i: usize, j: usize| below(i.max(j)) * lengths[i] * lengths[j];
    let matrix = (0..4).map(|i| (0..4).map(|j| inertia(i, j) * (angles[i] - angles[j]).cos()).collect());
    let right = (0..4).map(|i| {
        let centrifugal =
            (0..4).map(|j| inertia(i, j) * (angles[i] - angles[j]).sin() * rates[j] * rates[j]).sum::<f64>();
        -centrifugal - below(i) * g * lengths[i] * angles[i].sin()
    });
    let expected = solve_dense(matrix.collect(), right.collect());

    let (system, list) = (Exact::<f64, 2>::under_gravity(&masses, g), rods(&lengths, true));
    let mechanism = Constrained::new(&system, &list[..]).unwrap();
    assert_eq!(mechanism.band(), 1);
    let (q, v) = hanging(&lengths, &angles, &rates);
    let (a, _) = accelerate(&mechanism, &q, &v, &Drive::none()).unwrap();
    let mut end = [0.0; 2];
    for i in 0..4 {
        let (sin, cos) = angles[i].sin_cos();
        let (along, turning) = (lengths[i] * rates[i] * rates[i], lengths[i] * expected[i]);
        end = [end[0] + turning * cos - along * sin, end[1] + turning * sin + along * cos];
        assert_vectors_close(&format!("node {i}"), &a[i], &end, 1e-12);
    }
}

#[test]
fn definite_matrices_are_solved_without_pivoting() {
    let mut random = Random(12);
    for _ in 0..50 {
        let root: [[f64; 3]; 3] = core::array::from_fn(|_| random.array(1.0));
        let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
        let a: [[f64; 3]; 3] =
            core::array::from_fn(|i| core::array::from_fn(|j| dot(&root[i], &root[j]) + 0.2 * unit(i, j)));
        let x = [random.array(2.0), random.array(2.0)];
        for sign in [1.0, -1.0] {
            let a = a.map(|row| row.map(|a| sign * a));
            let found = solve_definite(a, x.map(|x| multiply(&a, &x))).unwrap();
            for (found, x) in found.iter().zip(&x) {
                assert_vectors_close("x", found, x, 1e-12);
            }
        }
    }
    let singular = [[1.0, 2.0], [2.0, 4.0]];
    assert_eq!(solve_definite(singular, [[1.0, 1.0]]), Err(SolveError::Singular { column: 1 }));
    assert_eq!(solve_definite([[f64::NAN]], [[1.0]]), Err(SolveError::NotFinite));
}

#[test]
fn errors_say_which_constraint() {
    let system = Exact::<f64, 2>::under_gravity(&[1.0; 4], 9.8);
    let rod = |a, b, length| Holonomic::Rod { nodes: [a, b], length };
    let new = |list: &List<2>| Constrained::new(&system, list).map(|_| ());
    let node = ConstraintError::Node { constraint: 1, node: 4, nodes: 4 };
    assert_eq!(new(&[rod(0, 1, 1.0), rod(2, 4, 1.0)]), Err(node));
    for length in [0.0, -1.0, f64::INFINITY] {
        let refused = ConstraintError::Length { constraint: 1, length };
        assert_eq!(new(&[rod(0, 1, 1.0), rod(1, 2, length)]), Err(refused));
    }
    assert!(matches!(new(&[rod(0, 1, f64::NAN)]), Err(ConstraintError::Length { constraint: 0, .. })));

    let (q, v) = ([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.1]], [[0.3, -0.2]; 4]);
    let run = |list: &List<2>, q: &[[f64; 2]]| {
        accelerate(&Constrained::new(&system, list).unwrap(), q, &v, &Drive::none()).map(|_| ())
    };
    let square =
        [rod(0, 1, 1.0), rod(1, 2, 1.0), rod(2, 3, 1.0), rod(3, 0, 1.1), rod(0, 2, 1.4), rod(1, 3, 1.5)];
    assert_eq!(run(&square[..5], &q), Ok(()));
    assert_eq!(
        run(&square, &q),
        Err(ConstraintError::Redundant { constraint: 5 }),
        "six rods of five degrees"
    );
    let contradictory = [rod(0, 1, 1.0), rod(2, 3, 1.0), rod(1, 0, 2.0)];
    assert_eq!(run(&contradictory, &q), Err(ConstraintError::Redundant { constraint: 2 }));
    let off_axis = [Holonomic::Held { node: 1, axis: 2, at: 0.0 }];
    assert_eq!(new(&off_axis), Err(ConstraintError::Length { constraint: 0, length: 0.0 }));
    assert_eq!(run(&square[..5], &[[f64::NAN, 0.0]; 4]), Err(ConstraintError::NotFinite));
    assert_eq!(run(&square[..5], &q[..3]), Err(ConstraintError::Shape { expected: 4, given: 3 }));
}

#[test]
fn a_short_room_and_a_massless_node_are_refused() {
    let (q, v) = ([[0.0, -1.0], [0.0, -2.0]], [[0.0; 2]; 2]);
    let list = rods::<f64, 2>(&[1.0, 1.0], true);
    let mut system = Exact::<f64, 2>::under_gravity(&[1.0; 2], 9.8);
    let mechanism = Constrained::new(&system, &list[..]).unwrap();
    let needed = constrained_workspace(&mechanism);
    let mut workspace = vec![0.0; needed - 1];
    let (mut a, mut lambda) = ([[0.0; 2]; 2], [0.0; 3]);
    let mut run = |workspace: &mut [f64], multipliers: usize| {
        let out = (&mut a[..], &mut lambda[..multipliers]);
        constrained_acceleration(&mechanism, (&q, &v), &Drive::none(), workspace, out)
    };
    assert_eq!(run(&mut workspace, 2), Err(ConstraintError::Workspace { needed, given: needed - 1 }));
    assert_eq!(run(&mut workspace, 3), Err(ConstraintError::Shape { expected: 2, given: 3 }));
    system.masses[1] = 0.0;
    let mechanism = Constrained::new(&system, &list[..]).unwrap();
    assert_eq!(accelerate(&mechanism, &q, &v, &Drive::none()), Err(ConstraintError::Mass { node: 1 }));
}

/// A workspace that suffices for a chain: rod k of 2,000 couples to its neighbours only.
#[test]
fn a_long_chain_takes_room_in_proportion() {
    let workspace = |links: usize| {
        let system = Exact::<f64, 2>::under_gravity(&vec![1.0; links], 9.8);
        let list = rods::<f64, 2>(&vec![1.0; links], true);
        let mechanism = Constrained::new(&system, &list[..]).unwrap();
        let (q, v) = hanging(&vec![1.0; links], &vec![0.0; links], &vec![0.0; links]);
        let (a, lambda) = accelerate(&mechanism, &q, &v, &Drive::none()).unwrap();
        // At rest: every rod carries what hangs below it.
        for (k, lambda) in lambda.iter().enumerate() {
            assert_close("tension", -lambda, 9.8 * (links - k) as f64, 1e-9);
        }
        assert!(a.as_flattened().iter().all(|a| a.abs() < 1e-9));
        constrained_workspace(&mechanism)
    };
    assert_eq!(workspace(2_000), 2 * workspace(1_000));
}

/// The force that inverse dynamics finds gives the original acceleration without load on the constraints.
#[test]
fn inverse_dynamics_unloads_the_constraints() {
    let lengths = [1.0, 0.7, 1.3];
    let system = Exact::under_gravity(&[1.0, 0.6, 1.7], 10.0).hard();
    let constraints: Vec<Holonomic<f64, 2>> = rods(&lengths, true);
    let mechanism = Constrained::new(&system, &constraints[..]).unwrap();
    let (q, v) = hanging(&lengths, &[0.4, 2.0, -0.9], &[2.0, -1.5, 0.8]);
    let push = [[1.0, -2.0], [0.5, 0.3], [-4.0, 1.0]];
    let under = |force: &[[f64; 2]]| {
        accelerate(&mechanism, &q, &v, &Drive { force: Some(force), ..Drive::none() }).unwrap()
    };
    let (a, loaded) = under(&push);
    assert!(loaded.iter().all(|lambda| lambda.abs() > 0.1), "{loaded:?}");
    let (mut work, mut force) = (vec![0.0; constrained_workspace(&mechanism)], [[0.0; 2]; 3]);
    constrained_inverse_dynamics(&mechanism, [&q, &v, &a], &mut work, &mut force).unwrap();
    let (found, unloaded) = under(&force);
    for (found, a) in found.iter().zip(&a) {
        assert_vectors_close("acceleration", found, a, 1e-13);
    }
    assert!(unloaded.iter().all(|lambda| lambda.abs() < 1e-12), "{unloaded:?}");
    let refused = |a: &[[f64; 2]], work: &mut [f64]| {
        constrained_inverse_dynamics(&mechanism, [&q, &v, a], work, &mut [[0.0; 2]; 3])
    };
    assert_eq!(refused(&a[1..], &mut work), Err(ConstraintError::Shape { expected: 3, given: 2 }));
    assert_eq!(refused(&[[f64::NAN; 2]; 3], &mut work), Err(ConstraintError::NotFinite));
    let (needed, given) = (work.len(), work.len() - 1);
    assert_eq!(refused(&a, &mut work[1..]), Err(ConstraintError::Workspace { needed, given }));
}
