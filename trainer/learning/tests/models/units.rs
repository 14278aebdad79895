//! One log in two units gives one model in these units.

use leastaction_core::energy::bodies::GRAVITY_PARAMETERS;
use leastaction_core::forces::ControlKind;
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::Config;
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::run::Plan;
use std::path::Path;

/// Interval of the log, s, and steps of the simulation in it.
const H: f64 = 0.005;
const FINE: usize = 100;
const SAMPLES: usize = 1600;
/// Inertia (kg), damping (N s/m), dry friction (N) and its width (m/s) of a heavy axis.
const TRUTH: [f64; 4] = [95.0, 200.0, 20.0, 0.004];

/// Force in a sample, N: two waves, which turn the axis around many times.
fn force(k: usize) -> f64 {
    let t = H * k as f64;
    70.0 * (4.4 * t).sin() + 50.0 * (11.9 * t + 1.0).cos()
}

/// A log of the axis, in a unit of which a metre (or a radian) has `unit`; a grid of 10⁻⁶ m is the noise.
fn log(unit: f64) -> Dataset {
    let [mass, damping, dry, width] = TRUTH;
    let (mut q, mut v) = (0.0, 0.0_f64);
    let rows: Vec<f64> = (0..SAMPLES)
        .map(|k| {
            let sample: f64 = q;
            let h = H / FINE as f64;
            for _ in 0..FINE {
                v += h * (force(k) - damping * v - dry * (v / width).tanh()) / mass;
                q += h * v;
            }
            unit * (sample * 1e6).round() / 1e6
        })
        .collect();
    let u = Rows::from_flat(1, (0..SAMPLES).map(force).collect());
    let q = Rows::from_flat(1, rows).unwrap();
    let trajectory = Trajectory { id: 0, t0: 0.0, q, v: None, a: None, u };
    Dataset { n: 1, h: H, control: Some(ControlKind::Held), trajectories: vec![trajectory] }
}

const SLIDE: &str = "joint = \"prismatic\"\nangle = 1.5707963267948966\ncentre = [0.0, 0.0]\ninertia = 1.0\n";
const TURN: &str = "centre = [0.0, 0.0]\nmass = 1.0\n";

fn learned(body: &str, unit: f64) -> Trained {
    let text = format!(
        "[data]\nfile = \"a.npz\"\nvalidation = 0\n[model]\nfamily = \"bodies\"\nfriction = \"learned\"\n\
         [[model.bodies]]\n{body}[training]\nloss = \"windows\"\nwindow = 0.5\niterations = 60\n"
    );
    let config = Config::parse(&text, Path::new("c.toml")).unwrap();
    Plan::new(config, &log(unit)).unwrap().train().unwrap()
}

/// Inertia, damping, dry friction and width of a model, in the units of [`TRUTH`]; `place` is that of the inertia in a body.
fn numbers(trained: &Trained, place: usize, unit: f64) -> [f64; 4] {
    let weights = &trained.best.weights;
    let friction = trained.architecture.friction_of_coordinates(weights)[0];
    let dry = friction.dry.unwrap();
    let inertia = weights[GRAVITY_PARAMETERS + place];
    [inertia * unit, friction.viscous * unit, dry.constant, dry.width / unit]
}

fn check(body: &str, place: usize, unit: f64) {
    let [si, other] = [1.0, unit].map(|unit| numbers(&learned(body, unit), place, unit));
    for ((si, other), truth) in si.iter().zip(other).zip(TRUTH) {
        assert!((si / other - 1.0).abs() < 2e-3, "{si} {other}");
        assert!((si / truth - 1.0).abs() < 0.05, "{si} {truth}");
    }
}

#[test]
fn an_axis_in_metres_and_in_millimetres() {
    check(SLIDE, 3, 1e3);
}

#[test]
fn a_joint_in_radians_and_in_degrees() {
    check(TURN, 6, 180.0 / std::f64::consts::PI);
}
