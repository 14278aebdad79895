//! From a machine's own logs to a controller, by the page's commands.

use crate::support::Bench;
use serde_json::Value;

const PAGE: &str = include_str!("../../../docs/book/src/swing-up.md");
const MODELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../firmware-sim/chip/models");
/// Configuration with which `make.sh` learns the image's model.
const CONFIGURATION: &str = include_str!("../../../firmware-sim/chip/models/cartpole-dry.toml");
const MAKE: &str = include_str!("../../../firmware-sim/chip/models/make.sh");

/// The page's command with this beginning, without its name.
fn command(beginning: &str) -> String {
    let words = PAGE.replace("\\\n", " ");
    let mut lines = words.lines().filter_map(|line| line.trim().strip_prefix("leastaction "));
    let line = lines.find(|line| line.starts_with(beginning)).unwrap();
    line.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The first `logs` of the page's twelve logs, and its configuration with another end.
fn logged(logs: u32, end: &str) -> Bench {
    let bench = Bench::new();
    bench.write("cartpole-dry.toml", &format!("{CONFIGURATION}{end}"));
    bench.run(&command("generate").replace("--trajectories 12", &format!("--trajectories {logs}"))).good();
    bench
}

/// Inspects and runs the model as the page does.
fn check(bench: &Bench) {
    let learned = bench.run(&format!("{} --json", command("inspect"))).good().json();
    let close = |found: &Value, expected: f64| {
        let found = found.as_f64().unwrap_or_else(|| panic!("{learned}"));
        assert!((found / expected - 1.0).abs() < 0.02, "{found} for {expected}");
    };
    close(&learned["actuator"]["gain"][0], 0.9);
    close(&learned["actuator"]["delay"], 0.008);
    close(&learned["dry_friction"][0]["coulomb"], 0.5);
    close(&learned["bodies"][1]["centre"][0], 0.5);
    let simulate = command("simulate");
    assert!(simulate.contains("swing-up"), "{simulate}");
    let report = bench.run(&format!("{simulate} --json")).good().json();
    assert_eq!((report["success"].as_bool(), report["model_errors"].as_u64()), (Some(true), Some(0)));
    let most = report["max_force"][0].as_f64().unwrap();
    assert!((most - 9.0).abs() < 1e-6, "a command of 10 N is a force of {most} N");
    bench.run(&simulate.replace("--gain 0.9,1", "--gain 0")).bad(2, &["actuator gain", "not 0"]);
}

#[test]
fn the_page_is_how_the_image_s_model_was_made() {
    let toml = PAGE.split("```toml\n# cartpole-dry.toml\n").nth(1).and_then(|rest| rest.split("```").next());
    assert_eq!(toml, Some(CONFIGURATION));
    let generate = command("generate");
    let made = MAKE.replace("\\\n", " ").split_whitespace().collect::<Vec<_>>().join(" ");
    let (_, options) = generate.split_once("--robot logs ").unwrap();
    assert!(made.contains(options), "make.sh generates other logs: {generate}");
}

#[test]
fn the_image_s_model_does_what_the_page_says() {
    let bench = logged(2, "warm_up = 1\niterations = 1\n");
    bench.run(&format!("{} -q", command("train"))).good();
    bench.run(&command("export")).good();
    std::fs::copy(format!("{MODELS}/cartpole-dry.postcard"), bench.at("cartpole-dry.postcard")).unwrap();
    check(&bench);
}

#[test]
#[ignore = "half a minute without optimisation"]
fn a_machine_swings_up_by_what_its_own_logs_told() {
    let bench = logged(12, "");
    bench.run(&format!("{} -q", command("train"))).good();
    bench.run(&command("export")).good();
    check(&bench);
}
