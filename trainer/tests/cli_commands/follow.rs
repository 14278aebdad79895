//! `simulate --scenario follow`: plans of `plan`, followed by the firmware.

use crate::support::Bench;
use serde_json::Value;
use std::fs;

const PROBLEMS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/peers/control");

/// A folder with the plan of a problem and with its model.
fn planned(problem: &str) -> Bench {
    let bench = Bench::new();
    plan(&bench, problem);
    bench
}

fn plan(bench: &Bench, problem: &str) {
    bench.run(&format!("plan {PROBLEMS}/{problem}.toml -o {problem} -q")).good();
}

/// The command to follow the plan of a problem on its own plant.
fn words(problem: &str, options: &str) -> String {
    format!(
        "simulate {problem}/model.postcard --scenario follow --plan {problem}/plan.postcard \
         --plant {problem}/model.postcard --limit 20 -o out {options}"
    )
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

#[test]
fn a_plan_is_followed_and_its_end_held() {
    let bench = planned("pendulum");
    let report = bench.run(&words("pendulum", "--json")).good().json();
    let followed = &report["planned"];
    assert_eq!((report["success"].as_bool(), followed["reached"].as_bool()), (Some(true), Some(true)));
    assert_eq!((followed["seconds"].as_f64(), followed["rests"].as_bool()), (Some(4.0), Some(true)));
    let [deviation, held] = ["deviation", "held_error"].map(|name| numbers(&followed[name])[0]);
    assert!(deviation < 0.2 && held < 0.05, "{followed}");
    // The law stays within the plan's limits, although the drive is stronger.
    assert!((0.5..=1.001).contains(&numbers(&followed["limit_share"])[0]), "{followed}");
    assert!(numbers(&report["max_force"])[0] < 1.501);
    assert_eq!(bench.text("out/trace.csv").lines().count() as u64, 1 + report["ticks"].as_u64().unwrap());
    assert!(bench.text("out/run.svg").contains("</svg>"));
    let said = bench.run(&words("pendulum", "")).good().stdout;
    for line in
        ["follow of the pendulum/model.postcard, seed 0: goal reached", "for 4.00 s", "reached, error"]
    {
        assert!(said.contains(line), "{line:?} is not in {said}");
    }
}

#[test]
fn a_start_beside_the_plan_is_said() {
    let bench = planned("cartpole");
    let report = bench.run(&words("cartpole", "--at 0.05,3.0 --spread 0 --seed 2 --json")).good().json();
    let off = numbers(&report["planned"]["off_start"][0]);
    assert!((off[0] - 0.05).abs() < 1e-3 && (off[1] + 0.1416).abs() < 1e-3, "{off:?}");
    let hash = |options: &str| bench.run(&words("cartpole", options)).good().json()["trace_hash"].clone();
    assert_eq!(hash("--seed 3 --json"), hash("--seed 3 --json"));
    assert_ne!(hash("--seed 3 --json"), hash("--seed 4 --json"));
    // A drive half as strong as planned does not bring the pole up.
    let weak = bench.run(&words("cartpole", "--json").replace("--limit 20", "--limit 3"));
    assert_eq!((weak.code, weak.json()["success"].as_bool()), (Some(1), Some(false)), "{}", weak.stderr);
}

#[test]
fn a_run_that_ends_before_the_plan_does_not_reach_it() {
    let bench = planned("pendulum");
    let short = bench.run(&words("pendulum", "--seconds 0.5 --json"));
    let report = short.json();
    assert_eq!((short.code, report["success"].as_bool()), (Some(1), Some(false)));
    assert!(report["planned"]["end_error"].is_null(), "{report}");
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let bench = planned("pendulum");
    plan(&bench, "cartpole");
    let model = "simulate pendulum/model.postcard --plant pendulum/model.postcard";
    bench.run(&format!("{model} --scenario follow")).bad(2, &["follow needs a plan", "--plan"]);
    let track = format!("{model} --scenario gravity --limit 9 --plan pendulum/plan.postcard");
    bench.run(&track).bad(2, &["--plan, --spread and --tolerance are of --scenario follow"]);
    let follow = |plan: &str| bench.run(&format!("{model} --scenario follow --plan {plan}"));
    follow("none.postcard").bad(2, &["none.postcard"]);
    follow("cartpole/plan.postcard").bad(2, &["cartpole/plan.postcard", "made for the model", "plan anew"]);
    follow("pendulum/model.postcard").bad(2, &["pendulum/model.postcard", "not a plan"]);
    let whole = bench.read("pendulum/plan.postcard");
    fs::write(bench.at("cut.postcard"), &whole[..whole.len() / 2]).unwrap();
    follow("cut.postcard").bad(2, &["cut.postcard", "damaged: checksum"]);
    fs::write(bench.at("cut.postcard"), &whole[..3]).unwrap();
    follow("cut.postcard").bad(2, &["cut.postcard", "only 3 bytes"]);
    bench.run(&words("pendulum", "--tick 0.02")).bad(2, &["ticks of 0.01 s, the program of 0.02 s"]);
    bench.run(&words("pendulum", "--drag 1")).bad(2, &["--push and --drag are of gravity"]);
    bench.run(&words("pendulum", "--spread 1,2")).bad(2, &["--spread has 2 values"]);
}

#[test]
#[ignore = "a quarter of a minute"]
fn the_demo_ends_with_an_acrobot_that_was_learned_and_swung_up() {
    let bench = Bench::new();
    let report = bench.run("demo -q --out demo --json").good().json();
    let acrobot = &report["acrobot"];
    assert_eq!(acrobot["swing_up"]["planned"]["reached"].as_bool(), Some(true), "{acrobot}");
    assert!(
        numbers(&acrobot["swing_up"]["planned"]["held_error"]).iter().all(|error| *error < 0.1),
        "{acrobot}"
    );
    let world = "--coulomb 0.1,0.07 --width 0.05 --delay 6 --json";
    let follow = "simulate demo/acrobot/model.postcard --scenario follow --plan demo/acrobot/plan.postcard";
    // Seed 0 is the demo's own run.
    let again = bench.run(&format!("{follow} {world}")).good().json();
    assert_eq!(again["trace_hash"], acrobot["swing_up"]["trace_hash"]);
    for seed in 1..20 {
        bench.run(&format!("{follow} --seed {seed} {world}")).good();
    }
    assert!(bench.text("demo/acrobot/plan.html").contains("</html>"));
}
