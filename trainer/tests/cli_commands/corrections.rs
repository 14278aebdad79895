//! A dissipation network, from a configuration to firmware: the page's own example.

use crate::support::Bench;
use leastaction_core::continuous::{ContinuousState, rk4_step};
use leastaction_core::energy::trigonometric::PENDULUM;
use leastaction_core::forces::ControlKind;
use leastaction_core::forces::{Forces, System};
use leastaction_core::linear::Matrix;
use leastaction_learning::data::{self, Dataset, Rows, Trajectory};
use serde_json::Value;

const H: f64 = 0.01;
/// Steps of the truth per step of the log.
const FINE: usize = 5;

/// Friction that falls before it rises, and differs along a turn.
struct Stribeck;

impl Forces<f64, 1> for Stribeck {
    fn force(&self, [q]: &[f64; 1], [v]: &[f64; 1], _: &[f64; 1]) -> [f64; 1] {
        let level = 0.15 + 0.25 * (-(v / 0.4).powi(2)).exp();
        [-(0.03 * v + level * (1.0 + 0.4 * q.cos()) * (v / 0.15).tanh())]
    }

    fn derivatives(&self, _: &[f64; 1], _: &[f64; 1], _: &[f64; 1]) -> (Matrix<f64, 1>, Matrix<f64, 1>) {
        unreachable!("explicit steps need no derivative")
    }

    fn load_derivative(&self, _: &[f64; 1], _: &[f64; 1], _: &[f64; 1]) -> Matrix<f64, 1> {
        unreachable!("explicit steps need no derivative")
    }
}

/// A motion of a pendulum that is pushed to and fro.
fn motion(id: i64) -> Trajectory {
    let system = System { lagrangian: PENDULUM, forces: Stribeck };
    let own = id as f64;
    let torque = |k: usize| {
        let t = H * k as f64;
        2.5 * ((2.1 + 0.3 * own) * t + own).sin() + 1.5 * ((7.3 - 0.4 * own) * t).sin()
    };
    let mut state = ContinuousState { q: [1.3 * own], v: [0.5] };
    let (mut q, mut u) = (Vec::new(), Vec::new());
    for k in 0..150 {
        q.push(state.q[0]);
        u.push(torque(k));
        for _ in 0..FINE {
            state = rk4_step(&system, &state, &[torque(k)], H / FINE as f64).unwrap();
        }
    }
    let rows = |values| Rows::from_flat(1, values).unwrap();
    Trajectory { id, t0: 0.0, q: rows(q), v: None, a: None, u: Some(rows(u)) }
}

fn log(ids: std::ops::Range<i64>) -> Dataset {
    Dataset { n: 1, h: H, control: Some(ControlKind::Held), trajectories: ids.map(motion).collect() }
}

/// The configuration of the page.
fn configuration() -> &'static str {
    const PAGE: &str = include_str!("../../../docs/book/src/friction.md");
    PAGE.split("```toml\n").nth(2).and_then(|rest| rest.split("```").next()).unwrap()
}

/// The median error over whole logs, and the error of one step.
fn errors(report: &Value) -> [f64; 2] {
    ["rollout_median", "one_step_mse"]
        .map(|key| report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report}")))
}

#[test]
fn a_network_learns_what_friction_lacks_and_runs_on_the_chip() {
    let bench = Bench::new();
    data::write(bench.at("stribeck.npz"), &log(0..5)).unwrap();
    data::write(bench.at("test.npz"), &log(20..23)).unwrap();
    bench.write("with.toml", configuration());
    let without = configuration().replace("[model.dissipation]\nhidden = [8]\n", "");
    bench.write(
        "without.toml",
        &without.lines().filter(|line| !line.starts_with("scale")).collect::<Vec<_>>().join("\n"),
    );
    let errors = ["with", "without"].map(|name| {
        bench.run(&format!("train {name}.toml -o {name} -q")).good();
        bench.run(&format!("export {name} -o {name}.postcard --rust {name}.rs")).good();
        let report = bench.run(&format!("evaluate {name}.postcard --data test.npz --json")).good().json();
        (errors(&report), report["chip"]["one_step_mse"].as_f64().unwrap())
    });
    let own = bench.text("with/report.html");
    assert!(own.contains("<th>without networks, rad</th>") && own.contains("Friction of q0"));
    assert!(!bench.text("without/report.html").contains("without networks"));
    let beside = "evaluate with.postcard --data test.npz --beside without";
    bench.run(&format!("{beside} -o page.html")).good();
    assert!(bench.text("page.html").contains("<th>without, rad</th>"));
    bench.run(beside).bad(2, &["--output"]);
    let [([with, one_step], chips), ([without, _], _)] = errors;
    println!("over 1.5 s, squared error in rad²: with {with:.2e}, without {without:.2e}");
    assert!(with < without / 10.0 && chips < one_step + 1e-9, "{errors:?}");

    assert!(bench.text("with.rs").contains("BodiesModel<'static, N, f32, Forces<N>>"));
    let report = bench.run("inspect with.postcard --json").good().json();
    assert_eq!(report["dissipation"]["hidden"][0].as_u64(), Some(8));
    assert_eq!(report["dissipation"]["coordinates"], report["dissipation"]["positions"]);
    let text = bench.run("inspect with.postcard").good().stdout;
    assert!(
        text.contains("sees q0 and the velocity of q0 over [0.3") && !text.contains("potential beside"),
        "{text}"
    );
    bench
        .run("inspect with.postcard --target cortex-m4f")
        .bad(2, &["laws with networks it was not measured"]);
    let words = "simulate with.postcard --plant with.postcard --scenario predict --seconds 0.5 --json -o out";
    assert_eq!(bench.run(words).good().json()["success"].as_bool(), Some(true));
}
