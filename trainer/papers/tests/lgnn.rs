//! LGNN's experiments: training of laws and networks, and rollouts on other graphs.

use leastaction_ground_truth::{LgnnSettings, LgnnSystem, lgnn_set, lgnn_shape};
use leastaction_learning::training::Samples;
use leastaction_models::{Family as _, GraphArchitecture};
use leastaction_papers::lgnn::{Case, Options, run, train};

fn samples(system: LgnnSystem, drag: f64, trajectories: usize) -> Samples {
    let published = LgnnSettings::published(system, 3);
    let settings = LgnnSettings { drag, trajectories, samples: 20, ..published };
    Samples::accelerations(&lgnn_set(&settings).expect("data")).expect("accelerations")
}

fn shape(system: LgnnSystem, drag: bool, networks_alone: bool) -> GraphArchitecture {
    lgnn_shape(system, drag, networks_alone).expect("a shape")
}

#[test]
fn laws_are_learned_to_rounding() {
    for (system, drag) in [(LgnnSystem::Pendulum(2), 0.1), (LgnnSystem::Spring(3), 0.0)] {
        let (_, [train_mse, validation_mse]) =
            train(shape(system, drag > 0.0, false), &samples(system, drag, 5), 20, 0, |_, _| ())
                .expect("learns");
        assert!(train_mse < 1e-20 && validation_mse < 1e-20, "{system:?}: {train_mse} {validation_mse}");
    }
}

#[test]
fn networks_learn_what_they_are_not_told() {
    let system = LgnnSystem::Spring(3);
    let alone = shape(system, false, true);
    let samples = samples(system, 0.0, 10);
    let (model, [train_mse, _]) = train(alone, &samples, 40, 0, |_, _| ()).expect("learns");
    assert!(train_mse < 1e-4 * samples.mean_square(), "{train_mse}");
    let fixed = model.architecture.fixed_positions();
    let learned = fixed.iter().map(|k| model.weights[*k]).filter(|number| *number != 0.0 && *number != 1.0);
    assert_eq!(learned.count(), 0, "known numbers stay");
}

#[test]
fn a_model_runs_on_graphs_that_it_was_not_trained_on() {
    let options = Options { iterations: 20, starts: 2, ..Options::new(1) };
    for case in [Case::Pendulum, Case::Hybrid, Case::HybridForce] {
        let rows = run((case, None), &options, &|_| ()).expect("runs");
        for row in rows {
            let rolled_out = row.rolled_out.expect("rolled out");
            assert_eq!(rolled_out.failed, 0);
            assert!(rolled_out.rollout_error < 1e-5, "{case:?} {}: {rolled_out:?}", row.count);
            assert!(rolled_out.energy_violation < 1e-8, "{case:?} {}: {rolled_out:?}", row.count);
            let pulls = row.insight.rods.iter().flatten();
            assert!(pulls.clone().count() > 0);
            for [_, learned, exact] in pulls {
                assert!((learned - exact).abs() < 1e-6 * (1.0 + exact.abs()), "{learned} {exact}");
            }
        }
    }
}
