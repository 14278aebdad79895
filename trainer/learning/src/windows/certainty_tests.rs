use super::{
    Calibration, Certainty, Integrator, LearnedNumber, Shown, WindowLogs, WindowLoss, WindowModel,
    WindowSettings, certainty,
};
use crate::data::{Dataset, Rows, Trajectory};
use crate::training::Levenberg;
use leastaction_core::energy::bodies::{BodyParameters, Joint, TreeBody};
use leastaction_core::forces::ControlKind;
use leastaction_models::parallel;
use leastaction_models::{Architecture, BodiesArchitecture, GroupLaws, Number};
use leastaction_programs::steps::{ExplicitSteps, RungeKutta, Steps};
use leastaction_programs::{Row, System};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use std::sync::Arc;

const H: f64 = 0.02;
const STEPS: usize = 40;
const LOGS: usize = 12;
const NOISE: f64 = 0.002;

/// A pendulum with an inertia of 0.05 kg m², a weight moment of 0.4 N m and friction of 0.03 N m s/rad, some of it learned.
fn pendulum(mass: bool) -> Architecture {
    let [zero, learned] = [Number::known(0.0), Number::learned(0.05)];
    let known = |value| if mass { Number::learned(value) } else { Number::known(value) };
    let own = BodyParameters {
        place: [zero; 2],
        angle: zero,
        mass: known(0.2),
        centre: [Number::known(0.0), known(-0.2)],
        inertia: learned,
        rotor: zero,
        gear: Number::known(1.0),
    };
    let gravity = [zero, Number::known(-9.81)];
    let body = TreeBody { joint: Joint::Revolute, parent: None };
    let friction = GroupLaws::of_friction(vec![Number::learned(0.03)], Vec::new());
    Architecture { group_laws: friction, ..BodiesArchitecture::new(gravity, [(body, own)]).unwrap().into() }
}

/// Logs of the pendulum, with noise of this seed.
fn logs(architecture: &Architecture, seed: u64) -> Dataset {
    let (weights, system) =
        (architecture.initial_weights(0), System::new(&*architecture.energies().unwrap()));
    let mut stream = rand_pcg::Pcg64::seed_from_u64(seed);
    let noise = Normal::new(0.0, NOISE).unwrap();
    let mut steps = ExplicitSteps::new(&system, H, RungeKutta::of_order(4));
    let mut trajectory = |log: usize| {
        let mut state = vec![Row::splat(0.1 * log as f64 - 0.5), Row::splat(0.3)];
        let (mut q, mut u) = (Vec::new(), Vec::new());
        for k in 0..=STEPS {
            q.push(state[0].0[0] + noise.sample(&mut stream));
            u.push(0.3 * (0.2 * k as f64 + log as f64).sin());
            let tau = [Row::splat(u[k])];
            let _ = steps.step(&weights, &mut state, [&tau, &tau], None);
        }
        let rows = |x| Rows::from_flat(1, x).unwrap();
        Trajectory { id: log as i64, t0: 0.0, q: rows(q), v: None, a: None, u: Some(rows(u)) }
    };
    let trajectories = (0..LOGS).map(&mut trajectory).collect();
    Dataset { n: 1, h: H, control: Some(ControlKind::Held), trajectories }
}

/// Learns from logs; returns the numbers with their certainty.
fn learned(architecture: &Architecture, data: &Dataset, zero: bool) -> Certainty {
    let calibration = Calibration { zero, ..Calibration::default() };
    let integrator = Integrator::RungeKutta;
    let settings =
        WindowSettings { steps: STEPS, stride: STEPS, integrator, longest_step: H, order: 4, calibration };
    let logs = Arc::new(WindowLogs::new(data));
    let model = WindowModel::new(architecture).unwrap();
    let loss = WindowLoss::new(model, &logs, 0..data.trajectories.len(), settings).unwrap();
    let end = Levenberg::new(&loss, architecture.initial_weights(0)).run(&loss, 8, |_, _| {});
    certainty(&loss, &end.weights, &architecture.ranges()).unwrap()
}

fn error(of: &LearnedNumber) -> f64 {
    match of.shown {
        Shown::Within(error) => error,
        Shown::Together | Shown::AtBound => panic!("{of:?}"),
    }
}

/// Over many logs with different noise, the estimates scatter as much as their standard errors say.
#[test]
fn standard_errors_are_those_of_repeated_logs() {
    const SEEDS: usize = 36;
    let architecture = pendulum(false);
    let all: Vec<Certainty> =
        parallel::map(SEEDS, &|seed| learned(&architecture, &logs(&architecture, seed as u64), true));
    let first = &all[0];
    assert_eq!((first.hidden, first.clusters, first.whole_logs), (0, LOGS, true));
    assert_eq!(first.numbers.len(), 2 + LOGS);
    for k in 0..first.numbers.len() {
        let values: Vec<f64> = all.iter().map(|of| of.numbers[k].value).collect();
        let mean = values.iter().sum::<f64>() / SEEDS as f64;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let deviation = (squares / (SEEDS - 1) as f64).sqrt();
        let said = all.iter().map(|of| error(&of.numbers[k]).powi(2)).sum::<f64>() / SEEDS as f64;
        let ratio = said.sqrt() / deviation;
        // A standard deviation estimated from 36 values has an error of about an eighth.
        assert!((0.65..1.5).contains(&ratio), "{k}: {ratio}");
    }
}

#[test]
fn what_is_only_shown_in_combination_is_said_to_be() {
    let architecture = pendulum(true);
    let certainty = learned(&architecture, &logs(&pendulum(false), 1), false);
    // The logs determine only m c and I + m c², not m, c and I.
    assert_eq!(certainty.hidden, 1);
    let shown: Vec<Shown> = certainty.numbers.iter().map(|of| of.shown).collect();
    assert_eq!(shown[..3], [Shown::Together; 3]);
    assert!(certainty.numbers[..3].iter().all(|of| of.strongest.is_none()));
    assert!(error(&certainty.numbers[3]) < 0.01 && certainty.numbers[3].strongest.is_none());
}

/// Free motion of a pendulum of known mass shows neither its centre nor its inertia, and friction only in their scale.
#[test]
fn friction_in_a_scale_that_nothing_shows_has_no_error() {
    let mut architecture = pendulum(true);
    let mut data = logs(&pendulum(false), 2);
    data.trajectories.iter_mut().for_each(|trajectory| trajectory.u = None);
    let of = |architecture: &Architecture| learned(architecture, &data, false);
    let all = of(&architecture);
    assert_eq!((all.hidden, all.combinations.len()), (2, 2));
    assert!(all.numbers.iter().all(|of| of.shown == Shown::Together), "{:?}", all.numbers);
    // With friction known, the scale is shown.
    architecture.group_laws = GroupLaws::of_friction(vec![Number::known(0.03)], Vec::new());
    assert_eq!(of(&architecture).hidden, 1);
}

#[test]
fn few_logs_are_cut_into_parts() {
    let architecture = pendulum(false);
    let mut data = logs(&architecture, 3);
    data.trajectories.truncate(2);
    let certainty = learned(&architecture, &data, false);
    assert_eq!((certainty.clusters, certainty.whole_logs), (2, false));
}

#[test]
fn intervals_of_few_logs_are_wider() {
    let of = |clusters| {
        let (numbers, combinations) = (Vec::new(), Vec::new());
        Certainty { numbers, hidden: 0, combinations, clusters, whole_logs: true }.interval()
    };
    for (clusters, percentile) in [(5, 2.776), (10, 2.262), (26, 2.060), (64, 1.998)] {
        assert!((of(clusters) / percentile - 1.0).abs() < 3e-3, "{clusters}: {}", of(clusters));
    }
}
