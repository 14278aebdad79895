//! The firmware along a log knows gain, offset and delay of the model file.

use crate::support::Bench;
use leastaction_core::discrete::Order;
use leastaction_core::forces::ControlKind;
use leastaction_core::model::TrainedStep;
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_models::file::{Precision, decode, encode_in};
use leastaction_models::laws::Actuator;
use leastaction_models::{Beginning, Model};
use std::fmt::Write as _;
use std::path::Path;

/// The step, exact in single precision, as the file has it.
const H: f64 = 1.0 / 128.0;
const SAMPLES: usize = 60;
const FILES: [&str; 5] = ["cartpole", "cartpole-dry", "acrobot", "double", "arm"];

/// Gains and offsets, assigned to coordinates in turn, and delays of zero, of a partial step, and of whole steps plus a part.
const ACTUATORS: [(&[f64], &[f64], f64); 3] = [
    (&[1.0, 0.75], &[0.25, -0.5], 0.0),
    (&[1.5, -0.5, 1.0], &[0.0, 0.125, 0.5], 0.003),
    (&[0.75, 2.0], &[0.5, -0.25], 0.02),
];

fn model(name: &str, (gain, offset, delay): (&[f64], &[f64], f64)) -> Model {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../firmware-sim/chip/models");
    let mut model = decode(&std::fs::read(folder.join(format!("{name}.postcard"))).unwrap()).unwrap();
    let of = |numbers: &[f64]| numbers.iter().copied().cycle().take(model.architecture.n()).collect();
    let actuator = Actuator { gain: of(gain), offset: of(offset), delay, lag: 0.0 };
    let order = model.facts.trained_step.map_or(Order::Four, |step| step.order);
    let step = TrainedStep { order, h: H as f32, control: ControlKind::Held };
    (model.facts.actuator, model.facts.trained_step) = (actuator, Some(step));
    model
}

fn save(bench: &Bench, name: &str, model: &Model) {
    let file = encode_in(Precision::Single, &model.architecture, &model.weights, &model.facts).unwrap();
    std::fs::write(bench.at(name), file).unwrap();
}

/// Motion in double precision under smooth commands that begin far from 0, as CSV text.
fn log(model: &Model) -> String {
    let n = model.architecture.n();
    let rows = |of: &dyn Fn(usize, usize) -> f64| {
        Rows::from_flat(n, (0..SAMPLES).flat_map(|k| (0..n).map(move |i| of(k, i))).collect()).unwrap()
    };
    let command = |k: usize, i: usize| 0.5 * (9.0 * H * k as f64 + 1.0 + i as f64).sin();
    let (q, u) = (rows(&|_, i| 0.25 - 0.125 * i as f64), rows(&command));
    let trajectory = Trajectory { id: 0, t0: 0.0, q, v: None, a: None, u: Some(u) };
    let data = Dataset { n, h: H, control: Some(ControlKind::Held), trajectories: vec![trajectory] };
    let order = model.facts.trained_step.unwrap().order.number();
    let path = model.rollout(order, (&data, Beginning::Positions)).unwrap().remove(0);
    let list = |name: &str| (0..n).map(|i| format!(",{name}{i}")).collect::<String>();
    let mut text = format!("t{}{}\n", list("q"), list("u"));
    for (k, q) in path.chunks_exact(n).enumerate() {
        let numbers = q.iter().copied().chain((0..n).map(|i| command(k, i)));
        let numbers: String = numbers.map(|x| format!(",{x}")).collect();
        writeln!(text, "{}{numbers}", H * k as f64).unwrap();
    }
    text
}

/// The largest innovation, rad or m, of the firmware with a model file along the log.
fn innovation(bench: &Bench, file: &str) -> f64 {
    let report = bench.run(&format!("simulate {file} --replay log.csv --json -o out")).good().json();
    let all = report["innovation_max"].as_array().unwrap();
    all.iter().map(|x| x.as_f64().unwrap()).fold(0.0, f64::max)
}

#[test]
fn a_replayed_motion_of_the_model_leaves_nothing_but_rounding() {
    for name in FILES {
        for (index, actuator) in ACTUATORS.into_iter().enumerate() {
            let (bench, own) = (Bench::new(), model(name, actuator));
            bench.write("log.csv", &log(&own));
            save(&bench, "own.postcard", &own);
            save(&bench, "ideal.postcard", &model(name, (&[1.0], &[0.0], 0.0)));
            let [found, forgotten] = ["own.postcard", "ideal.postcard"].map(|file| innovation(&bench, file));
            assert!(
                found < 2e-5 && forgotten > 20.0 * found,
                "{name}, actuator {index}: {found:e}, {forgotten:e}"
            );
        }
    }
}

/// A lag of the drives is shown, and an observer that knows it follows a log of its own model, which one that takes it for nothing does not.
#[test]
fn a_lag_is_shown_and_followed() {
    let (bench, mut own) = (Bench::new(), model("cartpole", ACTUATORS[0]));
    let without = own.clone();
    own.facts.actuator.lag = 0.03;
    bench.write("log.csv", &log(&own));
    save(&bench, "own.postcard", &own);
    save(&bench, "without.postcard", &without);
    let said = bench.run("inspect own.postcard").good().stdout;
    assert!(said.contains("delay 0.00000 s, lag 0.03000 s"), "{said}");
    let report = bench.run("inspect own.postcard --json").good().json();
    assert!((report["actuator"]["lag"].as_f64().unwrap() - 0.03).abs() < 1e-9, "{report}");
    let [found, forgotten] = ["own.postcard", "without.postcard"].map(|file| innovation(&bench, file));
    assert!(found < 2e-5 && forgotten > 20.0 * found, "{found:e}, {forgotten:e}");
}
