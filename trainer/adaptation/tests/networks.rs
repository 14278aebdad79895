//! A cable that stiffens and a damping that grows, followed by the networks of a model.

mod common;

use common::{AS_LEARNED, H, N, model, model_with};
use leastaction_adaptation::{Choice, Followed, Patched, Request};
use leastaction_core::adapt::Number;
use leastaction_core::forces::{Dissipation, Forces, PotentialCorrection};
use leastaction_core::lagrangian::Column;
use leastaction_core::linear::{Matrix, solve};
use leastaction_core::model::{Law, LawNetwork, Laws};
use leastaction_core::network::Activation;
use leastaction_data::Dataset;
use leastaction_models::Model;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

/// Units of the potential's network.
const UNITS: usize = 24;
const POTENTIAL: LawNetwork =
    LawNetwork { coordinates: "-aa", widths: [UNITS as u16, 0, 0, 0], activation: Activation::Tanh };
const DISSIPATION: LawNetwork =
    LawNetwork { coordinates: "-aa", widths: [5, 0, 0, 0], activation: Activation::Tanh };

/// A cable over the last two joints: V = ½ k (q₁ + ½ q₂ − ¼)².
#[derive(Clone, Copy)]
struct Cable {
    stiffness: f64,
}

/// Change of the cable's length with every coordinate, m.
const STRETCH: [f64; N] = [0.0, 1.0, 0.5];

impl Forces<f64, N> for Cable {
    fn force(&self, q: &[f64; N], _: &[f64; N], _: &[f64; N]) -> [f64; N] {
        let length: f64 = STRETCH.iter().zip(q).map(|(s, q)| s * q).sum();
        STRETCH.map(|s| -self.stiffness * s * (length - 0.25))
    }

    fn derivatives(&self, _: &[f64; N], _: &[f64; N], _: &[f64; N]) -> (Matrix<f64, N>, Matrix<f64, N>) {
        (STRETCH.map(|a| STRETCH.map(|b| -self.stiffness * a * b)), [[0.0; N]; N])
    }

    fn load_derivative(&self, _: &[f64; N], _: &[f64; N], _: &[f64; N]) -> Matrix<f64, N> {
        [[0.0; N]; N]
    }
}

/// Stiffness of the cable as it was learned, N m.
const STIFFNESS: f64 = 12.0;

fn normal(random: &mut Pcg64, deviation: f64) -> f64 {
    deviation * random.sample::<f64, _>(StandardNormal)
}

/// Scales of the velocities and weights of the dissipation's network, whose output layer is `factor` times what it was.
fn damping(factor: f64) -> Vec<f64> {
    let mut random = Pcg64::seed_from_u64(3);
    let shape = DISSIPATION.network(Law::Dissipation).expect("a shape");
    let count = shape.parameters().expect("a size");
    let last = count - 3 * (shape.last_inputs() + 1);
    let weights = (0..count).map(|k| normal(&mut random, if k < last { 0.4 } else { 0.8 * factor }));
    [2.0, 2.0].into_iter().chain(weights).collect()
}

fn dissipation(block: &[f64]) -> Dissipation<'_, f64, N, 5, 1> {
    let (seen, shape) = (DISSIPATION.seen().expect("letters"), DISSIPATION.network(Law::Dissipation));
    let taken = Dissipation::take(&mut &block[..], seen, &shape.expect("a shape"));
    taken.expect("a size").expect("numbers")
}

fn potential(block: &[f64]) -> PotentialCorrection<'_, f64, N, UNITS, 1> {
    let (seen, shape) = (POTENTIAL.seen().expect("letters"), POTENTIAL.network(Law::Potential));
    let taken = PotentialCorrection::take(&mut &block[..], seen, &shape.expect("a shape"));
    taken.expect("a size").expect("numbers")
}

/// Weights of a potential that was learned along a log: units at random, and the output layer by least squares on the forces of the cable.
fn learned(log: &Dataset) -> Vec<f64> {
    let mut random = Pcg64::seed_from_u64(1);
    let count = POTENTIAL.network(Law::Potential).expect("a shape").parameters().expect("a size");
    let mut weights: Vec<f64> = (0..count).map(|_| normal(&mut random, 0.8)).collect();
    let last = count - 1 - UNITS;
    weights[last..].fill(0.0);
    let numbers: [Number; UNITS] = core::array::from_fn(|j| Number::Potential(j as u8));
    let (mut matrix, mut right) = ([[0.0; UNITS]; UNITS], [0.0; UNITS]);
    (0..UNITS).for_each(|j| matrix[j][j] = 1e-2);
    let cable = Cable { stiffness: STIFFNESS };
    for q in log.trajectories[0].q.iter().step_by(5) {
        let q = q.try_into().expect("positions");
        let mut columns = [Column::zero(); UNITS];
        potential(&weights).network_columns(&q, &[0.0; N], &numbers, &mut columns);
        let force = cable.force(&q, &q, &q);
        let dot = |a: &[f64; N], b: &[f64; N]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for (j, of) in columns.iter().enumerate() {
            right[j] += dot(&of.force, &force);
            columns.iter().enumerate().for_each(|(k, other)| matrix[j][k] += dot(&of.force, &other.force));
        }
    }
    let output = solve(matrix, right).expect("a positive definite matrix");
    weights[last..][..UNITS].copy_from_slice(&output);
    weights
}

fn learned_model(log: &Dataset) -> Model {
    let laws = Laws::FRICTION.with_dissipation(DISSIPATION).with_potential(POTENTIAL);
    model_with(laws, &[damping(1.0), learned(log)].concat())
}

/// Readings of the machine with a cable and a damping.
fn log(stiffness: f64, damping: &[f64], seconds: f64, seed: u64) -> Dataset {
    let friction = AS_LEARNED.forces();
    AS_LEARNED.under(seconds, seed, |_| (&friction, (dissipation(damping), Cable { stiffness })))
}

/// Root mean square error of a model's torques along a log, N m, against those of the machine.
fn torque_error(of: &Model, (stiffness, damping): (f64, &[f64]), log: &Dataset) -> f64 {
    /// Samples from the middle of a difference to its ends.
    const APART: usize = 5;
    let (bodies, positions) = (model(), &log.trajectories[0].q);
    let (mut squares, mut count) = (0.0, 0);
    for k in (APART..positions.len() - APART).step_by(APART) {
        let [before, q, after] =
            [k - APART, k, k + APART].map(|k| <[f64; N]>::try_from(&positions[k]).expect("positions"));
        let step = APART as f64 * H;
        let v: [f64; N] = core::array::from_fn(|i| (after[i] - before[i]) / (2.0 * step));
        let a: [f64; N] = core::array::from_fn(|i| (after[i] - 2.0 * q[i] + before[i]) / (step * step));
        let torques = |of: &Model| of.inverse_dynamics([&q, &v, &a]).expect("torques");
        let beside = (dissipation(damping), Cable { stiffness }).force(&q, &v, &q);
        let errors = torques(of).into_iter().zip(torques(&bodies)).zip(beside);
        squares += errors.map(|((model, bodies), beside)| (model - (bodies - beside)).powi(2)).sum::<f64>();
        count += N;
    }
    (squares / count as f64).sqrt()
}

fn with_networks() -> Request {
    Request { networks: true, ..Request::default() }
}

/// Times at which the error is measured, s.
const TIMES: [f64; 4] = [1.0, 2.0, 4.0, 10.0];

#[test]
fn a_cable_that_stiffens_and_a_damping_that_grows_are_followed() {
    let training = log(STIFFNESS, &damping(1.0), 20.0, 1);
    let model = learned_model(&training);
    let changed = (1.2 * STIFFNESS, &damping(1.5_f64.sqrt())[..]);
    let later = log(changed.0, changed.1, TIMES[3], 2);
    let error = |of: &Model| torque_error(of, changed, &later);
    let learned = torque_error(&model, (STIFFNESS, &damping(1.0)), &training);
    let follow =
        |request: &Request| Followed::new(&model, &later, Some(&training), request).expect("numbers");
    let [without, with] = [Request::default(), with_networks()].map(|request| follow(&request));
    let Followed { choice, course, .. } = &with;
    let errors = TIMES.map(|time| {
        let entry = course.entries.iter().rev().find(|entry| entry.t <= time).expect("a window");
        error(&choice.adapted(&model, &entry.applied).expect("a model"))
    });
    let (before, friction) = (error(&model), error(&without.model));
    println!(
        "root mean square error of the torques, N m: {learned:.3} as learned, {before:.3} after the change; {friction:.3} by bodies and \
         friction; with networks after {TIMES:?} s {errors:.3?}"
    );
    let last = course.entries.last().expect("windows");
    let strengths = &last.applied[choice.settings.numbers.len() - 2..];
    let mass = course.mass(choice).expect("bodies");
    println!("strengths of dissipation {strengths:.2?}, half of it more in truth; attached {mass:?}");
    assert!(errors[3] < 0.2 * before && errors[1] < 0.6 * before, "{errors:?} of {before}");
    assert!(friction > 0.7 * before, "{friction} of {before}");
    assert!(strengths.iter().all(|strength| (strength - 0.5).abs() < 0.15), "{strengths:?}");
    assert!(!course.unlike() && course.announced.is_none(), "{mass:?}");
    check_saved(&model, &with);
}

/// Checks that the adapted model is what is saved, and that settings name the numbers.
fn check_saved(model: &Model, followed: &Followed) {
    let patch = followed.patch(7).expect("a patch");
    let patched = Patched::read((model, 7), &patch).expect("the patch");
    assert_eq!(patched.model.weights, followed.model.weights);
    let names: Vec<String> = patched.numbers.iter().map(|number| number.label.name()).collect();
    assert_eq!(names[16..18], ["w of potential unit 0", "w of potential unit 1"]);
    assert_eq!(names[16 + UNITS..], ["s of dissipation column 0", "s of dissipation column 1"]);
    assert_eq!(patched.numbers[16].label.unit, "J");
    assert_eq!(patched.numbers[16 + UNITS].model, Some(1.0));
    let weights = model.weights_f32();
    assert_eq!(patched.numbers[16 + 3].model, Some(weights[weights.len() - 1 - UNITS + 3]));
    let source = followed.choice.source(N);
    assert!(source.contains("Number::Potential(3),") && source.contains("Number::Dissipation(1),"));
}

#[test]
fn networks_follow_where_there_are_some() {
    let choices = [Request::default(), with_networks()].map(|request| Choice::new(&model(), H, &request));
    assert_eq!(choices[0], choices[1]);
    let damped = model_with(Laws::FRICTION.with_dissipation(DISSIPATION), &damping(1.0));
    let numbers = Choice::new(&damped, H, &with_networks()).expect("a choice").settings.numbers;
    assert_eq!(numbers.len(), 16 + 2);
    assert_eq!((numbers[16].model, numbers[16].prior, numbers[16].limits), (1.0, 0.3, [-1.0, 3.0]));
    assert_eq!(Choice::new(&damped, H, &Request::default()).expect("a choice").settings.numbers.len(), 16);
}
