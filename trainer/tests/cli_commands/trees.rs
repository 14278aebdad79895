//! Trees of elements: learned on a small tree, used in larger ones.

use crate::support::Bench;
use leastaction_ground_truth::{Chain, ExactMotion, Horizon, Link, Start, follow};
use leastaction_learning::data::{self, Dataset, Rows, Trajectory};

/// Motions of a chain of pendulums of two kinds, one after the other.
fn log(bench: &Bench, name: &str, count: usize) {
    let kinds = [Link::point(1.0, 1.0), Link::point(2.0, 0.5)];
    let links: Vec<_> = kinds.into_iter().cycle().take(count).collect();
    let chain = Chain::new(links, None).unwrap();
    let trajectories = (0..5).map(|id| trajectory(&chain, id)).collect();
    data::write(bench.at(name), &Dataset { n: count, h: 0.05, control: None, trajectories }).unwrap();
}

fn trajectory(chain: &Chain, id: i64) -> Trajectory {
    let n = chain.coordinates();
    let spread = |i: usize, phase: f64| 3.0 * (1.7 * (id as f64) + 2.3 * i as f64 + phase).sin();
    let start =
        Start { q: (0..n).map(|i| spread(i, 0.3)).collect(), v: (0..n).map(|i| spread(i, 1.1)).collect() };
    let (mut q, mut v, mut a) = (Vec::new(), Vec::new(), Vec::new());
    let exact = |q: &[f64], v: &[f64], a: &mut [f64]| chain.acceleration(q, v, a);
    follow(
        exact,
        |_| Some(()),
        &start,
        Horizon { h: 0.05, samples: 30 },
        1e-10,
        |state| {
            let mut out = vec![0.0; n];
            chain.acceleration(&state[..n], &state[n..], &mut out).unwrap();
            q.extend_from_slice(&state[..n]);
            v.extend_from_slice(&state[n..]);
            a.extend(out);
        },
    )
    .unwrap();
    let rows = |values| Rows::from_flat(n, values).unwrap();
    Trajectory { id, t0: 0.0, q: rows(q), v: Some(rows(v)), a: Some(rows(a)), u: None }
}

const TRAINING: &str = "[training]\nloss = \"acceleration\"\niterations = 60\n";
/// A rod needs only functions linear in (cos q, sin q), and gravity only a linear potential.
const BOB: &str = "[[model.types]]\nname = \"bob\"\ntransform = \"angle\"\nposition = []\npotential = []\n";

fn config(bench: &Bench, name: &str, data: &str, model: &str, training: &str) {
    bench.write(name, &format!("[data]\nfile = \"{data}\"\nvalidation = 0.2\n[model]\n{model}\n{training}"));
}

/// The relative error of the accelerations of a tree.
fn relative(bench: &Bench, options: &str) -> f64 {
    let report = bench.run(&format!("evaluate {options} --json")).good().json();
    report["acceleration_relative"].as_f64().unwrap()
}

/// A trained double pendulum in the folder `run`.
fn trained() -> Bench {
    let bench = Bench::new();
    bench.run("generate n-pendulum -o two.npz --trajectories 5 --samples 30 --h 0.02 --speed 4").good();
    bench
        .run("generate n-pendulum --count 3 -o three.npz --trajectories 5 --samples 30 --h 0.02 --speed 4")
        .good();
    config(
        &bench,
        "two.toml",
        "two.npz",
        &format!("family = \"modular\"\n{BOB}[model.trees]\ndouble = [\"bob\", \"bob\"]"),
        TRAINING,
    );
    bench.run("train two.toml -o run -q").good();
    bench
}

#[test]
fn two_kinds_trained_in_a_pair_serve_in_a_chain_of_four() {
    let bench = Bench::new();
    log(&bench, "ab.npz", 2);
    log(&bench, "abab.npz", 4);
    let light = BOB.replace("bob", "a");
    let heavy = format!("{}mass = {{ learn = 1.0 }}\n", BOB.replace("bob", "b"));
    let trees = "[model.trees]\npair = [\"a\", \"b\"]\nchain = [\"a\", \"b\", \"a\", \"b\"]";
    let model = format!("family = \"modular\"\ntree = \"pair\"\n{light}{heavy}{trees}");
    config(&bench, "ab.toml", "ab.npz", &model, TRAINING);
    bench.run("train ab.toml -o run -q").good();
    bench.model("run");
    let (pair, chain) = (
        relative(&bench, "run.postcard --data ab.npz"),
        relative(&bench, "run.postcard --data abab.npz --tree chain"),
    );
    assert!(pair < 1e-9 && chain < 1e-8, "{pair:e} {chain:e}");
    let types = bench.run("inspect run.postcard --json").good().json()["types"].clone();
    assert!((types[1]["mass"].as_f64().unwrap() - 2.0).abs() < 1e-3, "{types}");
}

#[test]
fn a_trained_pair_grows_by_a_few_lines() {
    let bench = trained();
    let triple = "from = \"run\"\n[model.trees]\ntriple = [\"bob\", \"bob\", \"bob\"]";
    config(
        &bench,
        "three.toml",
        "three.npz",
        triple,
        "[training]\nloss = \"acceleration\"\niterations = 0\n",
    );
    let built = bench.run("train three.toml -o three --json -q").good().json();
    assert_eq!((built["iterations"].as_u64(), built["ending"].as_str()), (Some(0), Some("iterations")));
    assert_eq!((built["parameters"].as_u64(), built["learned_parameters"].as_u64()), (Some(16), Some(9)));
    bench.model("three");
    // The trees of the pair are still there.
    let triple = relative(&bench, "three.postcard --data three.npz");
    let double = relative(&bench, "three.postcard --data two.npz --tree double");
    assert!(triple < 1e-9 && double < 1e-9, "{triple:e} {double:e}");
    bench
        .run("evaluate three.postcard --data two.npz")
        .bad(2, &["two.npz", "2 coordinates, tree \"triple\" 3", "--tree"]);
    bench.run("evaluate three.postcard --data two.npz --tree duble").bad(2, &["\"duble\"", "triple, double"]);
    let text = bench.run("inspect three.postcard").good().stdout;
    assert!(text.contains("triple (3 coordinates): 0 bob, 1 bob on 0, 2 bob on 1"), "{text}");
    let double = bench.run("inspect three.postcard --tree double --json").good().json();
    assert_eq!(double["coordinates"].as_array().unwrap().len(), 2);
    // The model file, trained further on position losses, never gets worse.
    let again = "from = \"three.postcard\"\ntree = \"triple\"";
    for (loss, iterations) in [("acceleration", 3), ("next-position", 2)] {
        let loss = |iterations| format!("[training]\nloss = \"{loss}\"\niterations = {iterations}\n");
        let validation = |iterations: u64| {
            config(&bench, "again.toml", "three.npz", again, &loss(iterations));
            let report = bench.run("train again.toml -o again --force --json -q").good().json();
            assert!(report["iterations"].as_u64().unwrap() <= iterations, "no warm-up: {report}");
            report["validation_loss"].as_f64().unwrap()
        };
        let (before, after) = (validation(0), validation(iterations));
        assert!(after <= before, "{after:e} {before:e}");
    }
}

#[test]
fn long_predictions_are_beside_the_floor_of_single_precision() {
    let bench = trained();
    bench.model("run");
    let words = "evaluate run.postcard --data two.npz --system n-pendulum --starts 3 --seconds 2";
    let report = bench.run(&format!("{words} -o out --json")).good().json();
    let prediction = &report["prediction"];
    let (learned, floor) = (&prediction["learned"], &prediction["single_precision"]);
    for measure in ["position", "energy"] {
        let (learned, floor) = (learned[measure].as_f64().unwrap(), floor[measure].as_f64().unwrap());
        assert!(0.0 < floor && floor < 1e-3 && learned < 1e-2, "{measure}: {learned:e} {floor:e}");
    }
    assert_eq!((prediction["count"].as_u64(), learned["failed"].as_u64()), (Some(2), Some(0)));
    let curves = bench.text("out/prediction.csv");
    assert_eq!(curves.lines().count(), 1 + 41, "{curves}");
    assert!(bench.text("out/prediction.svg").contains("single precision"));
    let text = bench.run(words).good().stdout;
    assert!(text.contains("valid for, median (s)") && text.contains("relative to its mean square"), "{text}");
    bench.run("evaluate run.postcard --data two.npz --system n-body").bad(2, &["n-body", "two translations"]);
    bench.run("evaluate run.postcard --data two.npz --system acrobot --starts 3").bad(2, &["--starts"]);
}

#[test]
fn every_loss_trains_a_tree_and_a_run_goes_on_bit_for_bit() {
    let bench = trained();
    let from = "from = \"run\"\ntree = \"double\"";
    config(&bench, "c.toml", "two.npz", from, "[training]\nloss = \"next-position\"\niterations = 2\n");
    bench.run("train c.toml -o parts -q").good();
    bench.write("c.toml", &bench.text("c.toml").replace("iterations = 2", "iterations = 4"));
    bench.run("train c.toml -o parts -q --resume").good();
    bench.run("train c.toml -o straight -q").good();
    assert_eq!(bench.model("parts"), bench.model("straight"));
    // Bodies with a known mass determine the scale of L: the residual may be trained on free motion.
    bench.run("generate n-body --count 2 -o bodies.npz --trajectories 4 --samples 12").good();
    let body = "family = \"modular\"\n[[model.types]]\nname = \"body\"\ntransform = \"free\"\n[model.pair]\nhidden = [6]\n\
                [model.trees]\nbodies = [\"body\", \"body\"]";
    for loss in ["del-residual", "next-position", "acceleration"] {
        config(
            &bench,
            "b.toml",
            "bodies.npz",
            body,
            &format!("[training]\nloss = \"{loss}\"\niterations = 3\nwarm_up = 2\n"),
        );
        let done = bench.run("train b.toml -o bodies --force -q").good();
        assert!(!done.stderr.contains("note:"), "{}", done.stderr);
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let bench = trained();
    let tree = format!("family = \"modular\"\n{BOB}[model.trees]\ndouble = [\"bob\", \"bob\"]");
    config(&bench, "c.toml", "three.npz", &tree, TRAINING);
    bench
        .run("train c.toml -o new")
        .bad(2, &["tree = \"double\" has 2 coordinates", "bob, bob", "the data has 3"]);
    let learned = tree.replace("potential = []", "mass = { learn = 1.0 }");
    config(&bench, "c.toml", "two.npz", &learned, TRAINING);
    bench.run("train c.toml -o new").bad(2, &["every mass", "mass = 1.0"]);
    config(&bench, "c.toml", "two.npz", &tree, "[training]\nloss = \"del-residual\"\n");
    bench.run("train c.toml -o new").bad(2, &["no sample is forced", "L = 0"]);
    config(
        &bench,
        "c.toml",
        "two.npz",
        "from = \"run\"\n[[model.types]]\nname = \"bob\"\npotential = [4]",
        TRAINING,
    );
    bench.run("train c.toml -o new").bad(2, &["c.toml:8", "`potential` of \"bob\" cannot be changed"]);
    config(&bench, "c.toml", "two.npz", "from = \"none.postcard\"", TRAINING);
    bench.run("train c.toml -o new").bad(2, &["c.toml:5", "none.postcard"]);
    bench.log("");
    bench.config("iterations = 1");
    bench.run("train c.toml -o inertia_network -q").good();
    config(&bench, "c.toml", "two.npz", "from = \"inertia_network\"", TRAINING);
    bench.run("train c.toml -o new").bad(2, &["c.toml:5", "inertia-network", "no element types"]);
    assert!(!bench.at("new").exists());
}

#[test]
fn a_new_type_joins_a_trained_one() {
    let bench = trained();
    let model = "from = \"run\"\n[[model.types]]\nname = \"cart\"\ntransform = \"slide\"\nmass = 3.0\n\
                 [[model.types]]\nname = \"bob\"\ndamping = 0.5\n[model.trees]\ncart = [\"cart\", \"bob\", \"bob\"]";
    config(&bench, "c.toml", "three.npz", model, "[training]\nloss = \"acceleration\"\niterations = 0\n");
    bench.run("train c.toml -o cart -q").good();
    let (old, new) = (bench.model("run"), bench.model("cart"));
    let report = bench.run("inspect cart.postcard --json").good().json();
    assert_eq!(
        (report["types"][1]["mass"].as_f64(), report["types"][0]["damping"].as_f64()),
        (Some(3.0), Some(0.5))
    );
    let weights = |bytes: &[u8]| leastaction_models::file::decode(bytes).unwrap().weights;
    // The weights of the position and potential networks of "bob" equal those of the model in `run`, bit for bit.
    assert_eq!(weights(&old)[..9], weights(&new)[..9]);
}
