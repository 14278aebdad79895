//! The pendulums of Finzi et al.: data from positions and velocities alone, and the models learned from it.

use leastaction_ground_truth::{ExactMotion, Horizon, logged};
use leastaction_learning::training::Samples;
use leastaction_papers::chnn::{Options, STEP, chain, run, starts, training_set};

/// Mean squared error of accelerations from states `h` apart, of a chain of three.
fn interpolation_error(h: f64) -> f64 {
    let truss = chain(3, 1).unwrap();
    let data = logged(&truss, &starts(&truss, 4, 7), Horizon { h, samples: 9 }, 0.0, 0).unwrap();
    let (found, exact) = (Samples::interpolated(&data).unwrap(), Samples::accelerations(&data).unwrap());
    // Every trajectory has 9 states, of which the middle 5 have two neighbours on both sides.
    let of_trajectory = |k: usize| exact.range(9 * k + 2..9 * k + 7);
    let kept: Vec<Samples> = (0..4).map(of_trajectory).collect();
    for i in 0..2 {
        assert_eq!(found.states[i], kept.iter().flat_map(|s| s.states[i].clone()).collect::<Vec<_>>());
    }
    let exact: Vec<f64> = kept.iter().flat_map(|s| s.states[2].clone()).collect();
    assert_eq!(found.states[2].len(), exact.len());
    found.states[2].iter().zip(&exact).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / exact.len() as f64
}

#[test]
fn accelerations_between_states_are_of_order_eight() {
    let [coarse, fine] = [0.08, 0.04].map(|h| interpolation_error(h).sqrt());
    let order = (coarse / fine).log2();
    assert!((7.0..9.5).contains(&order), "{order}: {coarse} {fine}");
    assert!(interpolation_error(STEP).sqrt() < 1e-6);
}

#[test]
fn starts_and_trajectories_lie_on_the_rods() {
    let truss = chain(5, 3).unwrap();
    let data = training_set(&truss, 3, 3).unwrap();
    assert!(data.trajectories.iter().all(|trajectory| trajectory.samples() == 5 && trajectory.a.is_none()));
    for start in starts(&truss, 20, 4) {
        let mut state = [start.q, start.v].concat();
        let before = state.clone();
        truss.project(&mut state).unwrap();
        let moved = state.iter().zip(&before).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(moved < 1e-12, "{moved}");
    }
}

#[test]
fn a_chain_is_learned_from_few_trajectories() {
    let options = Options { iterations: 30, trajectories: 60, starts: 3, ..Options::new(0) };
    let outcome = run(2, &options, &|_| ()).unwrap();
    let rolled = outcome.rolled_out;
    assert!(rolled.rollout_error < 1e-6 && rolled.failed == 0 && outcome.mass_error < 1e-6, "{outcome:?}");
    let again = run(2, &options, &|_| ()).unwrap().rolled_out;
    assert_eq!(again.rollout_error.to_bits(), rolled.rollout_error.to_bits());
}
