//! Graphs of particles: learned on a small graph, used in larger ones.

use crate::support::Bench;
use leastaction_learning::data;
use leastaction_models::config::ModelConfig;

const RODS: &str = "[[model.node_types]]\nname = \"bob\"\nfield = { learn = [0, 0] }\n\
    [model.graphs.two]\nnodes = [\"bob\", \"bob\"]\n\
    rods = [{ from = \"origin\", to = 0, length = 1 }, { from = 0, to = 1, length = 1 }]\n\
    [model.graphs.four]\nnodes = [\"bob\", \"bob\", \"bob\", \"bob\"]\n\
    rods = [{ from = \"origin\", to = 0, length = 1 }, { from = 0, to = 1, length = 1 }, \
    { from = 1, to = 2, length = 1 }, { from = 2, to = 3, length = 1 }]\n";
const SPRINGS: &str = "[[model.node_types]]\nname = \"node\"\n\
    [[model.edge_types]]\nname = \"spring\"\nsees = \"squared\"\nlaw = { learn = [0, 0] }\npotential = [2]\n\
    [model.graphs.three]\nnodes = [\"node\", \"node\", \"node\"]\nedges = [[0, 1], [1, 2], [2, 0]]\n";

fn config(bench: &Bench, data: &str, model: &str, training: &str) {
    let text = format!(
        "[data]\nfile = \"{data}\"\nvalidation = 0.2\n[model]\nfamily = \"graph\"\n{model}[training]\n{training}\n"
    );
    bench.write("c.toml", &text);
}

fn generate(bench: &Bench, words: &str) {
    bench.run(&format!("generate {words} --trajectories 6 --samples 9")).good();
}

#[test]
fn systems_are_logged_in_cartesian_coordinates() {
    let bench = Bench::new();
    let report = bench
        .run("generate rod-pendulum --count 2 -o a.npz --trajectories 2 --samples 5 --drag 0.1 --json")
        .good()
        .json();
    assert_eq!((report["system"].as_str(), report["h"].as_f64()), (Some("rod-pendulum"), Some(0.01)));
    let (log, notes) = data::read(bench.at("a.npz")).unwrap();
    assert!(
        notes.is_empty() && log.n == 4 && log.trajectories.iter().all(|t| t.a.is_some() && t.u.is_none())
    );
    generate(&bench, "hybrid -o b.csv --pull 10");
    let (log, _) = data::read(bench.at("b.csv")).unwrap();
    let u = log.trajectories[5].u.as_ref().unwrap();
    assert!(u.iter().all(|u| *u == [0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
    generate(&bench, "n-spring -o c.npz");
    let (log, _) = data::read(bench.at("c.npz")).unwrap();
    assert_eq!((log.n, log.h), (10, 0.1));
}

#[test]
fn options_that_mean_nothing_are_refused() {
    let bench = Bench::new();
    for (system, option) in [
        ("hybrid", "--count 3"),
        ("n-spring", "--speed 1"),
        ("rod-pendulum", "--no-control"),
        ("n-spring", "--symo-layout"),
        ("hybrid", "--modlanet-layout"),
        ("pendulum", "--pull 1"),
        ("n-body", "--pull 1"),
    ] {
        let name = option.split(' ').next().unwrap();
        bench.run(&format!("generate {system} -o a.npz {option}")).bad(2, &[name, system]);
    }
    bench.run("generate n-spring --count 2 -o a.npz").bad(2, &["nodes in a ring", "at least 3"]);
    bench.run("generate rod-pendulum --count 1 --pull 1 -o a.npz").bad(2, &["a pull"]);
    assert_eq!(std::fs::read_dir(bench.folder.path()).unwrap().count(), 0);
}

#[test]
fn bobs_on_two_rods_serve_on_four() {
    let bench = Bench::new();
    generate(&bench, "rod-pendulum --count 2 -o two.npz --h 0.05");
    generate(&bench, "rod-pendulum --count 4 -o four.npz --h 0.05");
    config(&bench, "two.npz", &format!("graph = \"two\"\n{RODS}"), "loss = \"acceleration\"\niterations = 9");
    let report = bench.run("train c.toml -o run -q --json").good().json();
    assert_eq!((report["parameters"].as_u64(), report["learned_parameters"].as_u64()), (Some(4), Some(2)));
    bench.run("export run -o run.postcard --rust run.rs").good();
    let words = "--system rod-pendulum --starts 2 --seconds 1";
    for (graph, count) in [("two", 2), ("four", 4)] {
        let done = bench
            .run(&format!("evaluate run.postcard --data {graph}.npz --graph {graph} {words} --json"))
            .good();
        let report = done.json();
        assert!(report["acceleration_relative"].as_f64().unwrap() < 1e-9, "{report}");
        assert_eq!((report["graph"].as_str(), report.get("one_step_mse")), (Some(graph), None));
        let chip = &report["chip"];
        assert!(chip["one_step_mse"].as_f64() < Some(1e-6) && chip["rollouts_broken_off"] == 0, "{report}");
        let (learned, floor) = (&report["prediction"]["learned"], &report["prediction"]["single_precision"]);
        assert_eq!(report["prediction"]["count"].as_u64(), Some(count));
        let position = |of: &serde_json::Value| of["position"].as_f64().unwrap();
        assert!(position(floor) > 0.0 && position(learned) < 1e-4, "{report}");
        assert!(done.stderr.contains("rods"), "{}", done.stderr);
    }
    let text = bench.run("inspect run.postcard --graph four").good().stdout;
    assert!(text.contains("two: nodes 2, edges 0, rods 2") && text.contains("graph four, of 8"), "{text}");
    bench
        .run("evaluate run.postcard --data four.npz")
        .bad(2, &["four.npz", "8 coordinates, graph \"two\" 4", "--graph"]);
    bench.run("inspect run.postcard --tree three").bad(2, &["no graph", "\"three\"", "two, four"]);
    bench.run("evaluate run.postcard --data two.npz --system n-body").good();
    bench.run("evaluate run.postcard --data two.npz --system hybrid").bad(2, &["hybrid", "4 nodes"]);
    bench.run("evaluate run.postcard --data two.npz --system n-pendulum").bad(2, &["one angle"]);
    bench.run("simulate run.postcard --scenario predict -o out").bad(2, &["run.postcard"]);
}

#[test]
fn positions_alone_train_rods() {
    let bench = Bench::new();
    generate(&bench, "rod-pendulum --count 2 -o two.npz");
    for (loss, order, bar) in [
        ("del-residual", 2, 1e-4),
        ("del-residual", 4, 1e-6),
        ("next-position", 2, 1e-4),
        ("next-position", 4, 1e-6),
    ] {
        let training = format!("loss = \"{loss}\"\norder = {order}\niterations = 9\nwarm_up = 3");
        config(&bench, "two.npz", &format!("graph = \"two\"\n{RODS}"), &training);
        bench.run("train c.toml -o run -q --force").good();
        bench.model("run");
        let report = bench.run("evaluate run.postcard --data two.npz --json").good().json();
        assert!(report["acceleration_relative"].as_f64().unwrap() < bar, "{loss} {order}: {report}");
    }
}

#[test]
fn every_loss_trains_springs_and_a_run_goes_on_bit_for_bit() {
    let bench = Bench::new();
    generate(&bench, "n-spring --count 3 -o three.npz --h 0.05");
    for loss in ["del-residual", "next-position", "acceleration"] {
        let training = |iterations| format!("loss = \"{loss}\"\niterations = {iterations}\nwarm_up = 2\n");
        config(&bench, "three.npz", SPRINGS, &training(2));
        let done = bench.run("train c.toml -o parts --force -q").good();
        assert_eq!(done.stderr, "");
        config(&bench, "three.npz", SPRINGS, &training(3));
        bench.run("train c.toml -o parts -q --resume").good();
        let history = bench.text("parts/history.csv");
        assert!(history.contains("warm-up") && history.contains("training"), "{history}");
        if loss == "acceleration" {
            bench.run("train c.toml -o straight -q").good();
            assert_eq!(bench.model("parts"), bench.model("straight"));
        }
    }
    let report = bench.run("evaluate straight.postcard --data three.npz --json").good().json();
    assert!(report["acceleration_relative"].as_f64().unwrap() < 1e-3, "{report}");
    assert!(report["one_step_mse"].as_f64().unwrap() < 1e-6, "{report}");
}

#[test]
fn what_does_not_fit_is_refused() {
    let bench = Bench::new();
    generate(&bench, "rod-pendulum --count 2 -o two.npz");
    generate(&bench, "n-spring --count 4 -o ring.npz");
    let two = format!("graph = \"two\"\n{RODS}");
    config(&bench, "ring.npz", &two, "loss = \"acceleration\"");
    bench
        .run("train c.toml -o new")
        .bad(2, &["graph = \"two\" has 4 coordinates", "2 of each", "the data has 8"]);
    let learned = two.replace("field", "mass = { learn = 1 }\nfield");
    config(&bench, "two.npz", &learned, "loss = \"acceleration\"");
    bench.run("train c.toml -o new").bad(2, &["[[model.node_types]]", "every mass", "mass = 1.0"]);
    config(&bench, "two.npz", &two.replace("\"origin\"", "7"), "loss = \"acceleration\"");
    bench.run("train c.toml -o new").bad(2, &["c.toml:15", "no node 7"]);
    assert!(!bench.at("new").exists());
    let printed = bench.run("train --print-defaults graph").good().stdout;
    assert_eq!(printed, ModelConfig::defaults("graph").unwrap());
}
