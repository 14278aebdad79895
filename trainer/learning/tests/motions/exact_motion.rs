//! Chains and attracting bodies against Lagrangians written down in Cartesian coordinates, textbook formulas and conserved quantities.

use leastaction_ground_truth::{BadMechanism, Bodies, Chain, ExactMotion, Extrapolation, Link, second_order};
use proptest::prelude::*;

const G: f64 = 9.8;

/// T and V of rigid links under a cart (of any mass, 0 when there is none) from the places of their centres of mass.
fn chain_energies(links: &[Link], cart: Option<f64>, q: &[f64], v: &[f64]) -> (f64, f64) {
    let first = usize::from(cart.is_some());
    let (mut pivot, mut speed) = ([0.0, 0.0], [0.0, 0.0]);
    let (mut kinetic, mut potential) = (0.0, 0.0);
    if let Some(mass) = cart {
        (pivot[0], speed[0]) = (q[0], v[0]);
        kinetic += 0.5 * mass * v[0] * v[0];
    }
    for (link, (q, v)) in links.iter().zip(q[first..].iter().zip(&v[first..])) {
        let at = |r: f64| [pivot[0] + r * q.sin(), pivot[1] - r * q.cos()];
        let moving = |r: f64| [speed[0] + r * q.cos() * v, speed[1] + r * q.sin() * v];
        let [vx, vy] = moving(link.centre);
        kinetic += 0.5 * link.mass * (vx * vx + vy * vy) + 0.5 * link.inertia * v * v;
        potential += link.mass * G * at(link.centre)[1];
        (pivot, speed) = (at(link.length), moving(link.length));
    }
    (kinetic, potential)
}

fn body_energies(masses: &[f64], k: f64, q: &[f64], v: &[f64]) -> (f64, f64) {
    let (mut kinetic, mut potential) = (0.0, 0.0);
    for i in 0..masses.len() {
        kinetic += 0.5 * masses[i] * (v[2 * i] * v[2 * i] + v[2 * i + 1] * v[2 * i + 1]);
        for j in 0..i {
            let r = (q[2 * i] - q[2 * j]).hypot(q[2 * i + 1] - q[2 * j + 1]);
            potential -= k * masses[i] * masses[j] / r;
        }
    }
    (kinetic, potential)
}

/// The largest |d/dt ∂L/∂v − ∂L/∂q| along the acceleration, by central differences; exact in v, where L is quadratic.
fn euler_lagrange_residual(l: &dyn Fn(&[f64], &[f64]) -> f64, q: &[f64], v: &[f64], a: &[f64]) -> f64 {
    let n = q.len();
    let moved = |x: &[f64], i: usize, d: f64| {
        let mut x = x.to_vec();
        x[i] += d;
        x
    };
    let momentum =
        |q: &[f64], v: &[f64], i: usize| (l(q, &moved(v, i, 1.0)) - l(q, &moved(v, i, -1.0))) / 2.0;
    let e = 1e-5;
    let state = |t: f64| -> (Vec<f64>, Vec<f64>) {
        let q = (0..n).map(|i| q[i] + t * v[i] + 0.5 * t * t * a[i]).collect();
        (q, (0..n).map(|i| v[i] + t * a[i]).collect())
    };
    let ((q_after, v_after), (q_before, v_before)) = (state(e), state(-e));
    let residual = |i: usize| {
        let rate = (momentum(&q_after, &v_after, i) - momentum(&q_before, &v_before, i)) / (2.0 * e);
        rate - (l(&moved(q, i, e), v) - l(&moved(q, i, -e), v)) / (2.0 * e)
    };
    (0..n).map(|i| residual(i).abs()).fold(0.0, f64::max)
}

fn acceleration(motion: &dyn ExactMotion, q: &[f64], v: &[f64]) -> Vec<f64> {
    let mut a = vec![f64::NAN; q.len()];
    motion.acceleration(q, v, &mut a).unwrap();
    a
}

/// The state after `t` seconds.
fn after(motion: &dyn ExactMotion, q: &[f64], v: &[f64], t: f64) -> (Vec<f64>, Vec<f64>) {
    let mut state = [q, v].concat();
    let rate = second_order(|q: &[f64], v: &[f64], a: &mut [f64]| motion.acceleration(q, v, a));
    Extrapolation::new(state.len(), 1e-13).advance(rate, &mut state, t).unwrap();
    let v = state.split_off(q.len());
    (state, v)
}

fn three_links() -> Vec<Link> {
    vec![
        Link::point(1.3, 0.7),
        Link { mass: 0.6, length: 1.1, centre: 0.4, inertia: 0.09 },
        Link::rod(2.1, 0.9),
    ]
}

fn states(n: usize) -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    (prop::collection::vec(-4.0..4.0_f64, n), prop::collection::vec(-3.0..3.0_f64, n))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn chains_obey_the_euler_lagrange_equation((q, v) in states(4), cart in prop::option::of(0.2..3.0_f64)) {
        let n = if cart.is_some() { 4 } else { 3 };
        let (q, v, links) = (&q[..n], &v[..n], three_links());
        let chain = Chain::new(links.clone(), cart).unwrap();
        prop_assert_eq!(chain.coordinates(), n);
        let lagrangian = |q: &[f64], v: &[f64]| {
            let (kinetic, potential) = chain_energies(&links, cart, q, v);
            kinetic - potential
        };
        let residual = euler_lagrange_residual(&lagrangian, q, v, &acceleration(&chain, q, v));
        prop_assert!(residual < 1e-6, "{}", residual);
        let (kinetic, potential) = chain_energies(&links, cart, q, v);
        prop_assert!((chain.kinetic_energy(q, v) - kinetic).abs() < 1e-12 * (1.0 + kinetic));
        prop_assert!((chain.potential_energy(q) - potential).abs() < 1e-12 * (1.0 + potential.abs()));
    }

    #[test]
    fn bodies_obey_the_euler_lagrange_equation(turn in -3.0..3.0_f64, (_, v) in states(6), k in 0.3..2.0_f64) {
        let masses = [0.7, 1.9, 1.2];
        let bodies = Bodies::new(masses.to_vec(), k).unwrap();
        let q: Vec<f64> = (0..3).flat_map(|i| { let (s, c) = (turn + 1.7 * f64::from(i)).sin_cos(); [2.0 * c, 1.5 * s] }).collect();
        let lagrangian = |q: &[f64], v: &[f64]| {
            let (kinetic, potential) = body_energies(&masses, k, q, v);
            kinetic - potential
        };
        let residual = euler_lagrange_residual(&lagrangian, &q, &v, &acceleration(&bodies, &q, &v));
        prop_assert!(residual < 1e-7, "{}", residual);
        let (kinetic, potential) = body_energies(&masses, k, &q, &v);
        prop_assert!((bodies.kinetic_energy(&q, &v) - kinetic).abs() < 1e-12 * (1.0 + kinetic));
        prop_assert!((bodies.potential_energy(&q) - potential).abs() < 1e-12 * (1.0 + potential.abs()));
    }
}

#[test]
fn the_double_pendulum_of_the_textbook() {
    // The formula as in most textbooks, e.g. Stachowiak and Okada, Chaos, Solitons & Fractals 29 (2006) 417.
    let (m1, m2, l1, l2) = (1.4, 0.8, 0.6, 1.3);
    let (a, b, u, w): (f64, f64, f64, f64) = (2.1, -0.7, 1.9, -2.6);
    let d = a - b;
    let below = 2.0 * m1 + m2 - m2 * (2.0 * d).cos();
    let first = (-G * (2.0 * m1 + m2) * a.sin()
        - m2 * G * (a - 2.0 * b).sin()
        - 2.0 * d.sin() * m2 * (w * w * l2 + u * u * l1 * d.cos()))
        / (l1 * below);
    let second =
        2.0 * d.sin() * (u * u * l1 * (m1 + m2) + G * (m1 + m2) * a.cos() + w * w * l2 * m2 * d.cos())
            / (l2 * below);
    let chain = Chain::of_points(&[m1, m2], &[l1, l2]).unwrap();
    let found = acceleration(&chain, &[a, b], &[u, w]);
    assert!((found[0] - first).abs() < 1e-12 && (found[1] - second).abs() < 1e-12, "{found:?}");
}

#[test]
fn a_swinging_rod_has_the_reduced_length_of_two_thirds() {
    let rod = Chain::new(vec![Link::rod(3.0, 1.2)], None).unwrap();
    let found = acceleration(&rod, &[0.4], &[5.0]);
    assert!((found[0] + G * 0.4_f64.sin() / (2.0 / 3.0 * 1.2)).abs() < 1e-12, "{found:?}");
}

#[test]
fn chains_keep_their_energy_and_a_cart_its_momentum() {
    let (q, v) = ([0.2, 2.5, -1.0, 3.0], [0.3, 1.0, -4.0, 2.0]);
    let chain = Chain::new(three_links(), Some(0.9)).unwrap();
    let (q_end, v_end) = after(&chain, &q, &v, 4.0);
    let (start, end) = (chain.energy(&q, &v), chain.energy(&q_end, &v_end));
    assert!((end - start).abs() < 1e-9 * start.abs(), "{start} {end}");
    // ∂T/∂ẋ, exactly, for T is quadratic in ẋ.
    let momentum = |q: &[f64], v: &[f64]| {
        let shifted = |d: f64| chain.kinetic_energy(q, &[v[0] + d, v[1], v[2], v[3]]);
        (shifted(1.0) - shifted(-1.0)) / 2.0
    };
    let (start, end) = (momentum(&q, &v), momentum(&q_end, &v_end));
    assert!((end - start).abs() < 1e-9, "{start} {end}");
}

#[test]
fn bodies_keep_energy_and_momenta() {
    let masses = [0.7, 1.9, 1.2, 0.5];
    let bodies = Bodies::new(masses.to_vec(), 1.3).unwrap();
    let q = [2.0, 0.1, -0.3, 1.8, -1.9, -0.4, 0.2, -2.2];
    let v = [0.1, 0.9, -0.8, 0.2, 0.0, -0.7, 1.1, 0.3];
    let (q_end, v_end) = after(&bodies, &q, &v, 6.0);
    let invariants = |q: &[f64], v: &[f64]| {
        let linear = |axis: usize| (0..4).map(|i| masses[i] * v[2 * i + axis]).sum::<f64>();
        let angular = (0..4).map(|i| masses[i] * (q[2 * i] * v[2 * i + 1] - q[2 * i + 1] * v[2 * i]));
        [bodies.energy(q, v), linear(0), linear(1), angular.sum()]
    };
    let (start, end) = (invariants(&q, &v), invariants(&q_end, &v_end));
    assert!(start.iter().zip(&end).all(|(a, b)| (a - b).abs() < 1e-10), "{start:?} {end:?}");
    assert!(q.iter().zip(&q_end).any(|(a, b)| (a - b).abs() > 0.5), "they moved");
}

#[test]
fn renumbered_bodies_move_alike() {
    let q = [2.0, 0.1, -0.3, 1.8, -1.9, -0.4];
    let bodies = Bodies::new(vec![0.7, 1.9, 1.2], 1.0).unwrap();
    let turned = Bodies::new(vec![1.9, 1.2, 0.7], 1.0).unwrap();
    let a = acceleration(&bodies, &q, &[0.0; 6]);
    let b = acceleration(&turned, &[q[2], q[3], q[4], q[5], q[0], q[1]], &[0.0; 6]);
    let back = [b[4], b[5], b[0], b[1], b[2], b[3]];
    assert!(a.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-15), "{a:?} {back:?}");
}

#[test]
fn a_collision_and_short_slices_have_no_acceleration() {
    let bodies = Bodies::uniform(2).unwrap();
    let mut out = [0.0; 4];
    assert_eq!(bodies.acceleration(&[1.0, 2.0, 1.0, 2.0], &[0.0; 4], &mut out), None);
    assert_eq!(bodies.acceleration(&[1.0, 2.0], &[0.0; 4], &mut out), None);
    assert_eq!(Chain::uniform(3).unwrap().acceleration(&[1.0, 2.0], &[0.0; 3], &mut out), None);
}

#[test]
fn mechanisms_that_cannot_be_are_refused() {
    assert_eq!(Bodies::uniform(0), Err(BadMechanism::Empty));
    assert_eq!(Chain::uniform(0), Err(BadMechanism::Empty));
    let unpaired = Chain::of_points(&[1.0, 2.0], &[1.0]).unwrap_err();
    assert_eq!(unpaired.to_string(), "2 masses and 1 lengths; give as many of one as of the other");
    let negative = Chain::of_points(&[1.0, -2.0], &[1.0, 1.0]).unwrap_err();
    assert_eq!(negative.to_string(), "element 1 has a mass of -2; it must be finite and above 0");
    assert!(Bodies::new(vec![1.0, f64::NAN], 1.0).is_err());
    assert!(Bodies::new(vec![1.0], f64::INFINITY).is_err());
    assert!(Chain::new(vec![Link::point(1.0, 1.0)], Some(0.0)).is_err());
    let in_pivot = Link { mass: 1.0, length: 1.0, centre: 0.0, inertia: 0.0 };
    assert!(Chain::new(vec![in_pivot], None).is_err());
    assert!(Chain::new(vec![Link { inertia: 0.1, ..in_pivot }], None).is_ok());
}
