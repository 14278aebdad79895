//! Nodes on rods and springs: the exact motion compared with the motion in angles, and its conserved quantities.

use leastaction_ground_truth::{
    Chain, ExactMotion, Horizon, LgnnSettings, LgnnSystem, Link, Rod, Start, Truss, follow, lgnn_set,
    lgnn_starts,
};
use proptest::prelude::*;

/// Gravity of [`Chain`], m/s².
const CHAIN_GRAVITY: f64 = 9.8;

fn settings(system: LgnnSystem) -> LgnnSettings {
    LgnnSettings { trajectories: 3, ..LgnnSettings::published(system, 5) }
}

fn states(motion: &dyn ExactMotion, start: &Start, horizon: Horizon) -> Vec<Vec<f64>> {
    let mut states = Vec::new();
    let exact = |q: &[f64], v: &[f64], a: &mut [f64]| motion.acceleration(q, v, a);
    let project = |state: &mut [f64]| motion.project(state);
    follow(exact, project, start, horizon, 1e-12, |state| states.push(state.to_vec()))
        .expect("can be followed");
    states
}

/// Bobs of these masses (kg) on rods of these lengths (m), with the gravity of [`Chain`].
fn hanging(masses: &[f64], lengths: &[f64]) -> Truss {
    let rods =
        (0..).zip(lengths).map(|(to, length)| Rod { from: usize::checked_sub(to, 1), to, length: *length });
    let truss =
        Truss { masses: masses.to_vec(), gravity: CHAIN_GRAVITY, rods: rods.collect(), ..Truss::free(0) };
    truss.checked().expect("a chain")
}

/// Positions and velocities of the ends of rods with these angles and angular velocities.
fn cartesian(lengths: &[f64], angles: &[f64], rates: &[f64]) -> Start {
    let (mut x, mut u) = ([0.0; 2], [0.0; 2]);
    let mut start = Start { q: Vec::new(), v: Vec::new() };
    for ((length, angle), rate) in lengths.iter().zip(angles).zip(rates) {
        let (sin, cos) = angle.sin_cos();
        x = [x[0] + length * sin, x[1] - length * cos];
        u = [u[0] + length * cos * rate, u[1] + length * sin * rate];
        start.q.extend(x);
        start.v.extend(u);
    }
    start
}

fn assert_near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
    }
}

#[test]
fn moves_as_the_chain_in_angles_does() {
    let (masses, lengths) = ([1.0, 0.4, 2.5], [0.7, 1.3, 0.5]);
    let links = masses.iter().zip(&lengths).map(|(m, l)| Link::point(*m, *l)).collect();
    let chain = Chain::new(links, None).expect("a chain");
    let angles = Start { q: vec![1.2, -0.4, 2.9], v: vec![0.3, -1.0, 0.8] };
    let truss = hanging(&masses, &lengths);
    let horizon = Horizon { h: 0.05, samples: 21 };
    let found = states(&truss, &cartesian(&lengths, &angles.q, &angles.v), horizon);
    for (found, expected) in found.iter().zip(states(&chain, &angles, horizon)) {
        let (q, v) = expected.split_at(3);
        let Start { q: x, v: u } = cartesian(&lengths, q, v);
        assert_near(found, &[x, u].concat(), 1e-9);
        let energy = truss.energy(&found[..6], &found[6..]);
        assert!((energy - chain.energy(q, v)).abs() < 1e-9);
    }
}

#[test]
fn rods_keep_their_length_and_energy_stays() {
    for system in [LgnnSystem::Pendulum(5), LgnnSystem::Hybrid, LgnnSystem::Spring(4)] {
        let settings = settings(system);
        let truss = settings.truss().expect("exists");
        let n = truss.coordinates();
        for start in lgnn_starts(&settings) {
            let energy = truss.energy(&start.q, &start.v);
            for state in states(&truss, &start, Horizon { h: 0.1, samples: 31 }) {
                let (q, v) = state.split_at(n);
                assert!((truss.energy(q, v) - energy).abs() < 1e-9 * (1.0 + energy.abs()), "{system:?}");
                for Rod { from, to, length } in &truss.rods {
                    let at = |node: usize, i: usize| q[2 * node + i];
                    let d = [0, 1].map(|i| at(*to, i) - from.map_or(0.0, |from| at(from, i)));
                    assert!((d[0].hypot(d[1]) - length).abs() < 1e-14);
                }
            }
        }
    }
}

#[test]
fn accelerations_are_the_second_differences_of_the_motion() {
    for system in [LgnnSystem::Pendulum(3), LgnnSystem::Hybrid, LgnnSystem::Spring(5)] {
        let settings = LgnnSettings { drag: 0.3, pull: 7.0, ..settings(system) };
        let truss = settings.truss().expect("exists");
        let (n, h) = (truss.coordinates(), 1e-3);
        let start = &lgnn_starts(&settings)[0];
        let path = states(&truss, start, Horizon { h, samples: 5 });
        let mut a = vec![0.0; n];
        truss.acceleration(&path[2][..n], &path[2][n..], &mut a).expect("exists");
        for (i, a) in a.iter().enumerate() {
            let v = |k: usize| path[k][n + i];
            let difference = (8.0 * (v(3) - v(1)) - (v(4) - v(0))) / (12.0 * h);
            assert!((a - difference).abs() < 1e-7 * (1.0 + a.abs()), "{system:?}: {a} {difference}");
        }
    }
}

#[test]
fn drag_takes_the_energy_that_it_must() {
    let settings = LgnnSettings { drag: 0.1, ..settings(LgnnSystem::Pendulum(2)) };
    let truss = settings.truss().expect("exists");
    let (n, h) = (truss.coordinates(), 1e-3);
    let path = states(&truss, &lgnn_starts(&settings)[1], Horizon { h, samples: 1001 });
    let power = |state: &[f64]| 0.1 * state[n..].iter().map(|v| v * v).sum::<f64>();
    let ends = 0.5 * h * (power(&path[0]) + power(&path[1000]));
    let lost = h * path.iter().map(|state| power(state)).sum::<f64>() - ends;
    let energy = |state: &[f64]| truss.energy(&state[..n], &state[n..]);
    assert!((energy(&path[0]) - energy(&path[1000]) - lost).abs() < 1e-5, "{lost}");
}

#[test]
fn a_hanging_bob_pulls_with_its_weight() {
    let truss = hanging(&[2.0, 0.5], &[1.0, 0.25]);
    let start = cartesian(&[1.0, 0.25], &[0.0; 2], &[0.0; 2]);
    let tensions = truss.tensions(&start.q, &start.v).expect("exists");
    assert_near(&tensions, &[2.5 * CHAIN_GRAVITY, 0.5 * CHAIN_GRAVITY], 1e-12);
}

#[test]
fn published_sets_have_the_authors_sizes() {
    for (system, h, nodes) in [(LgnnSystem::Pendulum(3), 0.01, 3), (LgnnSystem::Spring(5), 0.1, 5)] {
        let settings = LgnnSettings { trajectories: 2, ..LgnnSettings::published(system, 0) };
        let data = lgnn_set(&settings).expect("exists");
        assert_eq!((data.n, data.h, data.samples()), (2 * nodes, h, 200));
        assert_eq!(data, lgnn_set(&settings).expect("the same again"));
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let ring = LgnnSettings::published(LgnnSystem::Spring(2), 0);
    assert!(ring.truss().expect_err("no ring").to_string().contains("at least 3"));
    let rod = |from, to, length| Truss { rods: vec![Rod { from, to, length }], ..Truss::free(2) }.checked();
    assert!(rod(Some(0), 1, 1.0).is_ok());
    for bad in [rod(Some(0), 0, 1.0), rod(None, 2, 1.0), rod(Some(2), 1, 1.0), rod(None, 0, 0.0)] {
        assert!(bad.is_err());
    }
    assert!(Truss::free(0).checked().is_err());
}

proptest! {
    #[test]
    fn a_ring_keeps_its_momentum(nodes in 3usize..7, seed in 0u64..100) {
        let settings = LgnnSettings { seed, ..settings(LgnnSystem::Spring(nodes)) };
        let truss = settings.truss().expect("exists");
        let start = &lgnn_starts(&settings)[0];
        let mut a = vec![0.0; truss.coordinates()];
        truss.acceleration(&start.q, &start.v, &mut a).expect("exists");
        let force = a.as_chunks::<2>().0;
        let x = start.q.as_chunks::<2>().0;
        let sum = |of: &dyn Fn(usize) -> f64| (0..nodes).map(of).sum::<f64>();
        prop_assert!(sum(&|i| force[i][0]).abs() < 1e-10 && sum(&|i| force[i][1]).abs() < 1e-10);
        prop_assert!(sum(&|i| x[i][0] * force[i][1] - x[i][1] * force[i][0]).abs() < 1e-10);
    }
}
