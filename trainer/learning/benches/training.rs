//! Benchmark of second-order training: the time of one Levenberg–Marquardt iteration, and Levenberg–Marquardt against Adam alone on the
//! same cart-pole data, network and loss.
//!
//! `cargo bench -p leastaction-learning --bench training`

use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_ground_truth::{Mechanism, symo_set};
use leastaction_learning::training::{
    Adam, AdamSettings, Levenberg, LossKind, Objective, Samples, objective,
};
use leastaction_models::{Architecture, InertiaNetworkArchitecture};
use nalgebra::DMatrix;
use std::time::{Duration, Instant};

/// Number of training trajectories.
const TRAJECTORIES: usize = 32;
/// Seed of the initial weights and of the data.
const SEED: u64 = 0;
/// Levenberg–Marquardt iterations.
const ITERATIONS: usize = 60;
/// Largest multiple of Levenberg–Marquardt's time that Adam may take to reach the same loss.
const PATIENCE: u32 = 10;

/// A loss and the time it took.
struct Reached {
    loss: f64,
    time: Duration,
}

fn main() {
    let set = symo_set(Mechanism::Cartpole, SEED, 0.0).expect("the motion can be followed");
    let coordinates = [Coordinate::Cyclic, Coordinate::Angle];
    let architecture: Architecture =
        InertiaNetworkArchitecture { widths: vec![100], ..InertiaNetworkArchitecture::new(&coordinates, 0) }
            .into();
    let samples = Samples::triples(&set.train.truncated(TRAJECTORIES)).shuffled(SEED);
    let build =
        |kind, order| objective(&architecture, samples.clone(), kind, order).expect("the shape is compiled");
    let (residual, loss) = (build(LossKind::DelResidual, 2), build(LossKind::NextPosition, 4));
    let weights = architecture.initial_weights(SEED);
    let (p, rows) = (weights.len(), loss.samples() * 2);
    println!("cart-pole, order 4, next position: {p} weights, {rows} residuals");

    let ours = levenberg(&*residual, &*loss, weights.clone());
    let each = ours.time / (ITERATIONS as u32 + 20);
    // The lower triangle of JᵀJ and the Cholesky factor dominate.
    let multiply_adds = rows * p * (p + 1) / 2 + p * p * p / 6;
    let (rate, peak) = (per_nanosecond(multiply_adds, each), peak());
    println!(
        "Levenberg-Marquardt: one iteration {each:?}, {:.2} G multiply-adds, {rate:.1} G/s: {:.0}% of the {peak:.1} G/s \
         of a plain product of matrices in f64",
        multiply_adds as f64 * 1e-9,
        100.0 * rate / peak
    );
    let settings = AdamSettings::symo(TRAJECTORIES, SEED);
    let equal = adam(&*loss, weights.clone(), settings, |reached| reached.time >= ours.time);
    let longer = adam(&*loss, weights, settings, |reached| {
        reached.loss <= ours.loss || reached.time >= PATIENCE * ours.time
    });
    println!("{:<42} {:>10} {:>10}", "", "seconds", "mean sq.");
    row("Levenberg-Marquardt", &ours);
    row("Adam, equal time", &equal);
    row("Adam, to the same error or 10 x the time", &longer);
    println!("Adam at equal time: {:.0} times the error", equal.loss / ours.loss);
    println!(
        "Adam after {:.1} times the time: {:.0} times the error",
        ratio(&longer, &ours),
        longer.loss / ours.loss
    );
}

/// Attainable rate of this machine: multiply-adds per nanosecond in the product of two large f64 matrices, times the number of threads.
fn peak() -> f64 {
    const SIZE: usize = 1024;
    let a = DMatrix::from_fn(SIZE, SIZE, |i, j| ((i * 7 + j * 3) % 11) as f64);
    let mut product = DMatrix::zeros(SIZE, SIZE);
    let mut once = || {
        let clock = Instant::now();
        product.gemm(1.0, &a, &a, 0.0);
        per_nanosecond(SIZE * SIZE * SIZE, clock.elapsed())
    };
    (0..5).map(|_| once()).fold(0.0, f64::max) * rayon::current_num_threads() as f64
}

fn levenberg(residual: &dyn Objective, loss: &dyn Objective, weights: Vec<f64>) -> Reached {
    let clock = Instant::now();
    let mut warm_up = Levenberg::new(residual, weights);
    for _ in 0..20 {
        warm_up.iterate(residual);
    }
    let mut levenberg = Levenberg::new(loss, warm_up.weights);
    for _ in 0..ITERATIONS {
        levenberg.iterate(loss);
    }
    Reached { loss: levenberg.loss, time: clock.elapsed() }
}

/// Returns the lowest loss that Adam reaches before `done` holds.
fn adam(
    loss: &dyn Objective,
    weights: Vec<f64>,
    settings: AdamSettings,
    done: impl Fn(&Reached) -> bool,
) -> Reached {
    let clock = Instant::now();
    let mut adam = Adam::new(loss, weights, settings);
    let mut reached = Reached { loss: f64::INFINITY, time: Duration::ZERO };
    while !done(&reached) {
        adam.iterate(loss);
        reached = Reached { loss: reached.loss.min(adam.loss), time: clock.elapsed() };
    }
    reached
}

fn per_nanosecond(operations: usize, time: Duration) -> f64 {
    operations as f64 / time.as_nanos() as f64
}

fn ratio(a: &Reached, b: &Reached) -> f64 {
    a.time.as_secs_f64() / b.time.as_secs_f64()
}

fn row(name: &str, reached: &Reached) {
    println!("{name:<42} {:>10.1} {:>10.2e}", reached.time.as_secs_f64(), reached.loss);
}
