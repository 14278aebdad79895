//! Starting weights of an inertia network that reproduces the energies of another model, over the range of the logs.

use super::blocks::Blocks;
use super::{Levenberg, Progress, Samples};
use leastaction_core::model::ModelError;
use leastaction_models::Architecture;
use leastaction_programs::losses::{AccelerationLoss, Derivatives, Loss, TorqueLoss};
use leastaction_programs::{Row, System, WIDTH};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Equations per network weight.
const EQUATIONS: usize = 4;
/// Least and largest number of states.
const STATES: [usize; 2] = [512, 4096];
/// Iterations on torques, then on accelerations.
const ITERATIONS: [usize; 2] = [40, 60];
/// Ratio of mean squared error to mean square at which the fit is good enough: training over windows continues from
/// there.
const GOOD: f64 = 1e-7;

/// Range of the logged motion.
pub struct Covered<'a> {
    /// Positions, \[samples\]\[n\], flat.
    pub q: &'a [f64],
    /// Root mean squares of velocity and acceleration of every coordinate.
    pub sizes: [Vec<f64>; 2],
}

/// Weights of an inertia network whose inertia and potential match those of a model with the same coordinates; the fit
/// starts from `initial`.
///
/// The states are positions of the logs with random velocities and accelerations of the logs' size. At these states
/// both models, without friction and other forces, should need the same torque, M v̇ + L_vq v − L_q. First the torques
/// are fitted, which works from any weights. Then the accelerations under these torques are fitted, which gives light
/// coordinates the same weight as heavy ones. Numbers after the network in the weight block are kept.
///
/// # Errors
/// [`ModelError`] if a shape is inconsistent.
pub fn network_start(
    (architecture, initial): (&Architecture, Vec<f64>),
    (model, weights): (&Architecture, &[f64]),
    covered: &Covered,
) -> Result<Vec<f64>, ModelError> {
    let Some(inertia_network) = architecture.family.inertia_network() else { return Ok(initial) };
    let (own, parameters) = (inertia_network.header().parameters()?, architecture.parameters()?);
    let [system, model] = [architecture, model].map(|of| of.energies().map(|of| System::new(&*of)));
    let (system, model) = (system?.conservative(), model?.conservative());
    let n = architecture.n();
    let states = (EQUATIONS * own).div_ceil(n).clamp(STATES[0], STATES[1]);
    let mut samples = states_like(covered, n, states);
    samples.controls[0] = inverse_dynamics(&model, weights, &samples);
    let fixed: Vec<usize> = (own..parameters).collect();
    let objective = |make: fn(&System) -> Box<dyn Loss>| {
        let (system, fixed) = (system.clone(), fixed.clone());
        Blocks::new(move || make(&system), (parameters, fixed), samples.clone(), Box::new(|_: &mut [f64]| ()))
    };
    let torques = objective(|system| Box::new(TorqueLoss::new(system)));
    let accelerations = objective(|system| Box::new(AccelerationLoss::new(system)));
    let weights = fitted(&torques, (initial, mean_square(&samples.controls[0])), ITERATIONS[0]);
    Ok(fitted(&accelerations, (weights, mean_square(&samples.states[2])), ITERATIONS[1]))
}

/// Weights after at most `iterations` iterations; stops early once the residual is small relative to `whole`.
fn fitted(objective: &Blocks, (weights, whole): (Vec<f64>, f64), iterations: usize) -> Vec<f64> {
    let mut state = Levenberg::new(objective, weights);
    for _ in 0..iterations {
        if state.loss <= GOOD * whole || state.iterate(objective) != Progress::Lower {
            break;
        }
    }
    state.weights
}

fn mean_square(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>() / x.len().max(1) as f64
}

/// `count` states at positions taken in turn from throughout the logs.
fn states_like(Covered { q, sizes }: &Covered, n: usize, count: usize) -> Samples {
    let (mut stream, rows) = (Pcg64::seed_from_u64(0), q.len() / n);
    // Multiples of the golden ratio visit every part of the logs.
    let row = |k: usize| (k as f64 * 0.618_033_988_749_895).fract() * rows as f64;
    let positions = (0..count).flat_map(|k| &q[n * (row(k) as usize).min(rows - 1)..][..n]).copied();
    let mut states = [positions.collect::<Vec<_>>(), Vec::new(), Vec::new()];
    for (all, size) in states[1..].iter_mut().zip(sizes) {
        // A uniform distribution over this range has the wanted root mean square.
        let most = |i: usize| 3_f64.sqrt() * if size[i] > 0.0 { size[i] } else { 1.0 };
        all.extend((0..count * n).map(|k| stream.random_range(-1.0..1.0) * most(k % n)));
    }
    Samples { n, states, controls: [vec![0.0; count * n], Vec::new(), Vec::new()], ..Samples::default() }
}

/// Largest number of passes until friction that grows with the torque is consistent with the torque. Each pass reduces
/// the error at least by the factor of the largest c_load.
const PASSES: usize = 200;
/// Tolerance on the change of a torque, relative to 1 N m or N plus its size.
const SETTLED: f64 = 1e-12;

/// Inverse dynamics: torques of a model at states (q, v, v̇) of samples, \[samples\]\[n\], flat. τ = M v̇ + L_vq v −
/// L_q − Q(q, v, τ). The controls of the samples are not used.
pub fn inverse_dynamics(model: &System, weights: &[f64], samples: &Samples) -> Vec<f64> {
    let (n, count) = (model.n(), samples.len());
    let (mut loss, mut torques) = (TorqueLoss::new(model), Vec::with_capacity(count * n));
    for start in (0..count).step_by(WIDTH) {
        let mut block = samples.block(start, &(start..count));
        block.controls[0] = vec![Row::default(); n];
        let mut residual = vec![Row::default(); n];
        for _ in 0..PASSES {
            let _not_finite = loss.evaluate(weights, &block, &mut residual, Derivatives::None);
            for (torque, more) in block.controls[0].iter_mut().zip(&residual) {
                torque.add_scaled(1.0, more);
            }
            if block.controls[0].iter().zip(&residual).all(|(torque, more)| is_settled(torque, more)) {
                break;
            }
        }
        let samples = 0..WIDTH.min(count - start);
        torques.extend(samples.flat_map(|k| block.controls[0].iter().map(move |row| row.0[k])));
    }
    torques
}

fn is_settled(torque: &Row, change: &Row) -> bool {
    torque.0.iter().zip(&change.0).all(|(torque, change)| change.abs() <= SETTLED * (1.0 + torque.abs()))
}
