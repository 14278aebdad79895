use super::super::{Case, Options, run};
use super::*;
use crate::training::Ending;
use leastaction_ground_truth::{ModlanetSettings, modlanet_set_of};
use std::time::Duration;

/// A data set with 101 rows to learn from and 101 to test with.
fn set(system: ManyBody) -> ModlanetSet {
    let settings = ModlanetSettings { trajectories: 2, ..ModlanetSettings::published(system, 5) };
    modlanet_set_of(&settings).unwrap()
}

fn rows(case: Case, system: ManyBody, limits: Limits) -> Vec<Outcome> {
    let options = Options { iterations: Some(1), starts: 0, steps: 0, ..Options::new(0) };
    let set = set(system);
    let bounds = Bounds { limits, interrupted: None };
    let one =
        |baseline| run((case, Some((baseline, bounds))), &options, Some(&set), &|_| ()).unwrap().remove(0);
    Baseline::ALL.map(one).to_vec()
}

#[test]
fn every_baseline_has_its_row_beside_ours() {
    let limits = Limits { epochs: Some(1), time: None };
    for (case, system) in
        [(Case::DoublePendulum, ManyBody::Pendulum(2)), (Case::ThreeBody, ManyBody::Bodies(3))]
    {
        let rows = rows(case, system, limits);
        assert_eq!(rows.iter().map(|row| row.kind).collect::<Vec<_>>(), Baseline::ALL.map(Baseline::name));
        for row in &rows {
            // The network is about as large as the authors' model; they differ in the inputs of angles and in the
            // output.
            let theirs = row.published.parameters.unwrap() as f64;
            assert!((row.parameters as f64 / theirs - 1.0).abs() < 0.12, "{row:?}");
            assert!(row.epochs == Some(1) || row.ending == Ending::Diverged { epoch: 1 }, "{row:?}");
        }
    }
}

#[test]
fn without_time_a_row_says_so() {
    let limits = Limits { epochs: None, time: Some(Duration::ZERO) };
    let rows = rows(Case::DoublePendulum, ManyBody::Pendulum(2), limits);
    for row in &rows {
        assert_eq!((row.epochs, row.ending), (Some(0), Ending::OutOfTime { epoch: 0 }));
        assert_eq!(row.ending.words().unwrap(), "out of time at epoch 0");
    }
}

#[test]
fn divergence_ends_with_the_last_weights_that_had_a_loss() {
    let system = ManyBody::Pendulum(2);
    let model = Baseline::LightHnn.model(system, "aa").unwrap();
    let recipe = Baseline::LightHnn.recipe(system);
    let recipe = Recipe { adam: AdamSettings { learning_rate: 1e200, ..recipe.adam }, epochs: 9 };
    let samples = Samples::modlanet(&set(system).train);
    let trained = recipe.train(&*model, samples.clone(), (0, Bounds::default()), &|_| ()).unwrap();
    let Ending::Diverged { epoch } = trained.ending else { panic!("{:?}", trained.ending) };
    assert_eq!(trained.epochs, epoch - 1);
    assert!(model.training(samples).unwrap().loss(&trained.weights).is_finite());
}

#[test]
fn recipes_are_the_authors() {
    let recipe = Baseline::Hnn.recipe(ManyBody::Pendulum(2));
    assert_eq!((recipe.epochs, recipe.adam.learning_rate, recipe.adam.decay), (10_000, 1e-2, 1e-4));
    assert!(matches!(recipe.adam.schedule, Schedule::Steps { epochs: [3_000, 9_000, _], .. }));
    let lnn = Baseline::LightLnn.recipe(ManyBody::Pendulum(2));
    assert_eq!((lnn.epochs, lnn.adam.learning_rate, lnn.adam.schedule), (10_000, 1e-3, Schedule::Constant));
    let bodies = Baseline::Mlp.recipe(ManyBody::Bodies(3));
    assert_eq!((bodies.epochs, bodies.adam.learning_rate), (3_000, 1e-3));
}
