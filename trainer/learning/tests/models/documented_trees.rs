//! The examples of docs/book/src/trees.md, as they stand there, on exact motion.

use crate::page::{self, Strict};
use leastaction_core::continuous::acceleration;
use leastaction_core::forces::Viscous;
use leastaction_core::model::Laws;
use leastaction_ground_truth::{Bodies, Chain, ExactMotion, Horizon, Link, Start, follow};
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::Config;
use leastaction_learning::data::{self, Dataset, Rows, Trajectory};
use leastaction_learning::evaluate::acceleration_mse;
use leastaction_learning::run::{Plan, Run};
use leastaction_models::Architecture;
use leastaction_models::Model;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const PAGE: &str = include_str!("../../../../docs/book/src/trees.md");

/// The example of the page that begins with this file name.
fn example(name: &str) -> &'static str {
    page::example(PAGE, name)
}

/// Motions from widely spread starts.
fn log(motion: &dyn ExactMotion, spread: f64) -> Dataset {
    let trajectories = (0..12).map(|id| trajectory(motion, spread, id)).collect();
    Dataset { n: motion.coordinates(), h: 0.05, control: None, trajectories }
}

fn trajectory(motion: &dyn ExactMotion, spread: f64, id: i64) -> Trajectory {
    let n = motion.coordinates();
    let wave = |i: usize, phase: f64| spread * (1.7 * id as f64 + 2.3 * i as f64 + phase).sin();
    // Bodies are 3 m apart.
    let place =
        |i: usize| if motion.is_angle(i) { 0.0 } else { 1.5 * f64::from(i as u32 / 2 * (1 + i as u32 % 2)) };
    let q = (0..n).map(|i| place(i) + wave(i, 0.3)).collect();
    let start = Start { q, v: (0..n).map(|i| wave(i, 1.1)).collect() };
    let (mut q, mut v, mut a) = (Vec::new(), Vec::new(), Vec::new());
    let exact = |q: &[f64], v: &[f64], a: &mut [f64]| motion.acceleration(q, v, a);
    let keep = |state: &[f64]| {
        let mut out = vec![0.0; n];
        motion.acceleration(&state[..n], &state[n..], &mut out).unwrap();
        q.extend_from_slice(&state[..n]);
        v.extend_from_slice(&state[n..]);
        a.extend(out);
    };
    follow(exact, |_| Some(()), &start, Horizon { h: 0.05, samples: 20 }, 1e-10, keep).unwrap();
    let rows = |values| Rows::from_flat(n, values).unwrap();
    Trajectory { id, t0: 0.0, q: rows(q), v: Some(rows(v)), a: Some(rows(a)), u: None }
}

/// Trains an example in a folder and returns the result.
fn train(folder: &Path, name: &str, motion: &dyn ExactMotion, spread: f64) -> Trained {
    let text = example(name);
    std::fs::write(folder.join(name), text).unwrap();
    let config = Config::read(&folder.join(name)).unwrap();
    data::write(&config.data.file.0[0], &log(motion, spread)).unwrap();
    let plan = Plan::new(config, &log(motion, spread)).unwrap();
    let run = folder.join("run");
    Run::begin(plan, &run, true).unwrap().train(&mut Strict, &AtomicBool::new(false)).unwrap();
    Trained::read(&run).unwrap()
}

/// The error of the accelerations, relative to their mean square.
fn relative(architecture: &Architecture, weights: &[f64], motion: &dyn ExactMotion, spread: f64) -> f64 {
    let model = Model::new(architecture.clone(), weights.to_vec());
    let (error, square) = acceleration_mse(&model, &log(motion, spread)).unwrap().unwrap();
    error.or_infinite() / square
}

/// Trains the example, checks its error against the limit, and returns the model.
fn learned(name: &str, motion: &dyn ExactMotion, spread: f64, limit: f64) -> Trained {
    let folder = tempfile::tempdir().unwrap();
    let trained = train(folder.path(), name, motion, spread);
    let error = relative(&trained.architecture, &trained.best.weights, motion, spread);
    println!("{name}: {error:.1e}");
    assert!(error < limit, "{name}: {error:e}");
    trained
}

#[test]
fn double_and_triple() {
    let folder = tempfile::tempdir().unwrap();
    let (two, three) = (Chain::uniform(2).unwrap(), Chain::uniform(3).unwrap());
    let double = train(folder.path(), "double.toml", &two, 2.0);
    let triple = train(folder.path(), "triple.toml", &three, 2.0);
    let errors = [
        relative(&double.architecture, &double.best.weights, &two, 2.0),
        relative(&triple.architecture, &triple.best.weights, &three, 2.0),
    ];
    println!("double and triple: {errors:?}");
    assert_eq!(double.best.weights, triple.best.weights);
    assert!(errors[0] < 1e-6 && errors[1] < 1e-3, "{errors:?}");
}

#[test]
fn a_cart_that_carries_a_chain() {
    let chain = Chain::new(vec![Link::point(0.7, 0.6); 2], Some(3.0)).unwrap();
    let trained = learned("cart.toml", &chain, 2.0, 1e-10);
    let modular = trained.architecture.family.modular().unwrap().clone().with_numbers(&trained.best.weights);
    assert!((modular.types[1].numbers[0].value - 0.7).abs() < 1e-3, "{:?}", modular.types[1]);
}

#[test]
fn two_kinds_of_bobs() {
    let chain = |count| {
        let kinds = [Link::point(1.0, 1.0), Link::point(2.0, 0.5)];
        Chain::new(kinds.into_iter().cycle().take(count).collect(), None).unwrap()
    };
    let trained = learned("ab.toml", &chain(2), 2.0, 1e-9);
    let four = trained.architecture.family.modular().unwrap().with_tree_named("chain").unwrap().into();
    let error = relative(&four, &trained.best.weights, &chain(4), 2.0);
    assert!(error < 1e-8, "{error:e}");
}

#[test]
fn rigid_links() {
    let link = Link { mass: 1.5, length: 0.8, centre: 0.4, inertia: 0.08 };
    let trained = learned("links.toml", &Chain::new(vec![link; 2], None).unwrap(), 2.0, 1e-10);
    let modular = trained.architecture.family.modular().unwrap().clone().with_numbers(&trained.best.weights);
    let [_, inertia, centre, ..] = modular.types[0].numbers;
    assert!(
        (inertia.value - 0.08).abs() < 1e-4 && (centre.value - 0.5).abs() < 1e-4,
        "{inertia:?} {centre:?}"
    );
}

#[test]
fn bodies() {
    learned("bodies.toml", &Bodies::uniform(3).unwrap(), 0.5, 1e-4);
}

/// Two pendulums on the end of another: coupled through it alone.
#[test]
fn a_fork() {
    let config = Config::parse(example("fork.toml"), Path::new("fork.toml")).unwrap();
    let (architecture, mut weights) = config.beginning().unwrap();
    let modular = architecture.family.modular().unwrap();
    // Gravity: U = g y.
    weights[..3].copy_from_slice(&[0.0, 9.8, 0.0]);
    let header = modular.header();
    let tree = modular.tree_header();
    let system =
        header.system::<_, f64, Viscous<f64, 3>, 3, 1, 0, 0>(&tree, Laws::VISCOUS, &weights).unwrap();
    let (q, v) = ([0.4, -0.9, 0.7], [0.3, 1.1, -0.6]);
    let found = acceleration(&system, &q, &v, &[0.0; 3]).unwrap();
    // A_jk as in a chain, except that the second and the third link carry nothing and do not couple.
    let a = [[3.0, 1.0, 1.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]];
    let b = [3.0, 1.0, 1.0];
    for j in 0..3 {
        let coupling: f64 = (0..3)
            .map(|k| a[j][k] * ((q[j] - q[k]).cos() * found[k] + (q[j] - q[k]).sin() * v[k] * v[k]))
            .sum();
        let residual = coupling + 9.8 * b[j] * q[j].sin();
        assert!(residual.abs() < 1e-12, "{j}: {residual:e}");
    }
}
