//! Friction from a configuration to firmware: the page's own example.

use crate::support::Bench;
use leastaction_core::discrete::{Control, Del, Galerkin, State};
use leastaction_core::energy::trigonometric::PENDULUM;
use leastaction_core::forces::{ControlKind, Coulomb, DryFriction, System, Viscous};
use leastaction_learning::data::{self, Dataset, Rows, Trajectory};
use serde_json::Value;

const H: f64 = 0.05;
const TRUE: DryFriction<f64> = DryFriction { constant: 0.3, load: 0.2, smoothing: 0.1, width: 0.15 };

/// A motion of a pendulum with friction, pushed to and fro.
fn motion(id: i64) -> Trajectory {
    let forces = (Viscous { coefficients: [0.05] }, Coulomb { coordinates: [TRUE] });
    let (system, del) = (System { lagrangian: PENDULUM, forces }, Del::<f64, Galerkin>::new(H));
    let at = |k: usize| H * k as f64;
    let torque = |k: usize| {
        let own = id as f64;
        2.5 * ((2.1 + 0.3 * own) * at(k) + own).sin() + 1.5 * ((7.3 - 0.4 * own) * at(k)).sin()
    };
    let mut state = State::new(&system.lagrangian, [1.3 * id as f64], [0.5]).unwrap();
    let (mut q, mut u) = (Vec::new(), Vec::new());
    for k in 0..40 {
        q.push(state.q()[0]);
        u.push(torque(k));
        del.step(&system, &mut state, &Control::held([torque(k)])).unwrap();
    }
    let rows = |values| Rows::from_flat(1, values).unwrap();
    Trajectory { id, t0: 0.0, q: rows(q), v: None, a: None, u: Some(rows(u)) }
}

/// The configuration of the page.
fn configuration() -> &'static str {
    const PAGE: &str = include_str!("../../../docs/book/src/friction.md");
    PAGE.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap()
}

fn number(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report}"))
}

#[test]
fn friction_is_learned_exported_inspected_stepped_on_the_chip_and_a_plant() {
    let bench = Bench::new();
    let trajectories = (0..10).map(motion).collect();
    let log = Dataset { n: 1, h: H, control: Some(ControlKind::Held), trajectories };
    data::write(bench.at("robot.npz"), &log).unwrap();
    bench.write("robot.toml", configuration());
    bench.run("train robot.toml -o run -q").good();
    bench.run("export run -o m.postcard --rust m.rs").good();
    assert!(bench.text("m.rs").contains("InertiaNetworkModel<'static, N, H, L, f32, Friction<N>>"));

    let report = bench.run("inspect m.postcard --json").good().json();
    let dry = &report["dry_friction"][0];
    let close = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 0.05, "{report}");
    close(report["damping"][0].as_f64().unwrap(), 0.05);
    close(number(dry, "coulomb"), TRUE.constant);
    close(number(dry, "load"), TRUE.load);
    close(number(dry, "width"), TRUE.width);
    close(number(dry, "smoothing"), TRUE.smoothing);
    let text = bench.run("inspect m.postcard").good().stdout;
    assert!(text.contains("dry friction") && text.contains("of the load beyond 0.1000"), "{text}");
    let predicted = bench.run("inspect m.postcard --target cortex-m4f --json").good().json();
    let step = &predicted["target"]["step_order_2"];
    assert!(number(step, "instructions") > 1000.0 && number(step, "stack_bytes") > 500.0, "{predicted}");

    let report = bench.run("evaluate m.postcard --data robot.npz --json").good().json();
    let (ours, chips) = (number(&report, "one_step_mse"), number(&report["chip"], "one_step_mse"));
    assert!(ours < 1e-8 && chips < ours + 1e-9, "{report}");
    let words = "simulate m.postcard --plant m.postcard --scenario predict --seconds 0.5 --json -o out";
    assert_eq!(bench.run(words).good().json()["success"].as_bool(), Some(true));
}
