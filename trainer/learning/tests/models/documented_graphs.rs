//! The examples of docs/book/src/graphs.md, as they stand there, on exact motion.

use crate::page::{self, Strict};
use leastaction_ground_truth::{Horizon, LgnnSettings, LgnnSystem, Start, Truss, lgnn_set, logged};
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::Config;
use leastaction_learning::data::{self, Dataset};
use leastaction_learning::evaluate::acceleration_mse;
use leastaction_learning::run::{Plan, Run};
use leastaction_models::GraphArchitecture;
use leastaction_models::Model;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const PAGE: &str = include_str!("../../../../docs/book/src/graphs.md");

/// The example of the page that begins with this file name.
fn example(name: &str) -> &'static str {
    page::example(PAGE, name)
}

/// Trains an example; fails on any notice.
fn train(name: &str, log: &Dataset) -> Trained {
    let folder = tempfile::tempdir().unwrap();
    let config = Config::parse(example(name), Path::new(name)).unwrap();
    data::write(folder.path().join(&config.data.file.0[0]), log).unwrap();
    let plan = Plan::new(config, log).unwrap();
    assert_eq!(plan.notices(), []);
    let run = folder.path().join("run");
    Run::begin(plan, &run, true).unwrap().train(&mut Strict, &AtomicBool::new(false)).unwrap();
    Trained::read(&run).unwrap()
}

fn log(system: LgnnSystem, drag: f64) -> Dataset {
    let settings = LgnnSettings { trajectories: 10, samples: 12, drag, ..LgnnSettings::published(system, 3) };
    lgnn_set(&LgnnSettings { h: 5.0 * settings.h, ..settings }).unwrap()
}

/// The error of the accelerations of a graph, relative to their mean square.
fn relative(trained: &Trained, graph: &str, log: &Dataset) -> f64 {
    let architecture = trained.architecture.with_part_named(graph).unwrap();
    let (error, square) = acceleration_mse(&Model { architecture, ..trained.model() }, log).unwrap().unwrap();
    println!("{graph}: {:.1e}", error.or_infinite() / square);
    error.or_infinite() / square
}

/// The numbers after the networks.
fn numbers(trained: &Trained) -> &[f64] {
    let graph: &GraphArchitecture = trained.architecture.family.graph().unwrap();
    let weights = &trained.best.weights;
    &weights[weights.len() - graph.shape.all_numbers()..]
}

#[test]
fn pendulums_on_rods() {
    let [two, three] = [2, 3].map(|count| log(LgnnSystem::Pendulum(count), 0.0));
    let trained = train("pendulums.toml", &two);
    let errors = [relative(&trained, "two", &two), relative(&trained, "three", &three)];
    assert!(errors[0] < 1e-12 && errors[1] < 1e-10, "{errors:?}");
}

#[test]
fn a_ring_of_springs() {
    let [three, five] = [3, 5].map(|count| log(LgnnSystem::Spring(count), 0.0));
    let trained = train("springs.toml", &three);
    let errors = [relative(&trained, "three", &three), relative(&trained, "five", &five)];
    assert!(errors[0] < 1e-12 && errors[1] < 1e-8, "{errors:?}");
}

#[test]
fn drag() {
    let two = log(LgnnSystem::Pendulum(2), 0.3);
    let trained = train("drag.toml", &two);
    let error = relative(&trained, "two", &two);
    let [_, _, gx, gy] = numbers(&trained) else { panic!("one node type") };
    assert!(error < 1e-8, "{error:e}");
    assert!(gx.abs() < 1e-3 && (gy - 10.0).abs() < 1e-3, "{gx} {gy}");
}

/// Light nodes of 1 kg about a heavy one of 3 kg, with the pair potential (r² − 1)² between all nodes.
#[test]
fn known_and_unknown_parts() {
    let molecule =
        Truss { masses: vec![1.0, 3.0, 1.0], springs: vec![[0, 1], [1, 2], [2, 0]], ..Truss::free(3) };
    let wave = |k: usize, i: usize| 0.3 * (1.7 * k as f64 + 2.3 * i as f64).sin();
    let rest = [0.0, 0.0, 1.0, 0.0, 0.5, 0.8];
    let start = |k: usize| Start {
        q: rest.iter().enumerate().map(|(i, x)| x + wave(k, i)).collect(),
        v: (0..6).map(|i| wave(k, i + 7)).collect(),
    };
    let starts: Vec<Start> = (0..8).map(start).collect();
    let log = logged(&molecule, &starts, Horizon { h: 0.02, samples: 12 }, 0.0, 0).unwrap();
    let trained = train("molecule.toml", &log);
    let [.., mass, _, _, _, c1, c2, _, _] = numbers(&trained) else { panic!("two of each") };
    println!("mass {mass}, law {c1} {c2}");
    assert!(
        (mass - 3.0).abs() < 1e-3 && (c1 + 2.0).abs() < 1e-3 && (c2 - 1.0).abs() < 1e-3,
        "{mass} {c1} {c2}"
    );
    assert!(relative(&trained, "molecule", &log) < 1e-6);
}
