//! Where training of an inertia network begins that starts from another model: at the energies of that model, over the range of the logs.

use super::blocks::Blocks;
use super::{Levenberg, Progress, Samples};
use leastaction_core::model::ModelError;
use leastaction_models::Architecture;
use leastaction_programs::losses::{AccelerationLoss, Derivatives, Loss, TorqueLoss};
use leastaction_programs::{Row, System, WIDTH};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Equations for each weight that the network is fitted to.
const EQUATIONS: usize = 4;
/// States at least and at most.
const STATES: [usize; 2] = [512, 4096];
/// Iterations on torques, and then on accelerations.
const ITERATIONS: [usize; 2] = [40, 60];
/// A mean square error of this part of the mean square is small enough: windows go on from there.
const GOOD: f64 = 1e-7;

/// What the motion of logs covers.
pub struct Covered<'a> {
    /// Positions, \[samples\]\[n\], flat.
    pub q: &'a [f64],
    /// Root mean squares of velocities and accelerations of every coordinate.
    pub sizes: [Vec<f64>; 2],
}

/// Weights of an inertia network, from `initial` on, whose inertia and potential are those of a model of the same coordinates.
///
/// At positions of the logs, and random velocities and accelerations of the size that the logs have, both models without their forces are
/// to take the same torque, M v̇ + L_vq v − L_q: first torques are fitted, to which any weights lead, then the accelerations that these
/// torques give, which count light coordinates as much as heavy ones. What follows the network in the weight block stays.
///
/// # Errors
/// Where a shape does not fit in itself.
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

/// Weights after so many iterations, or where what is left is small beside the whole.
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

/// So many states: positions in turn from all over the logs.
fn states_like(Covered { q, sizes }: &Covered, n: usize, count: usize) -> Samples {
    let (mut stream, rows) = (Pcg64::seed_from_u64(0), q.len() / n);
    // Multiples of the golden ratio: every part of the logs has its turn.
    let row = |k: usize| (k as f64 * 0.618_033_988_749_895).fract() * rows as f64;
    let positions = (0..count).flat_map(|k| &q[n * (row(k) as usize).min(rows - 1)..][..n]).copied();
    let mut states = [positions.collect::<Vec<_>>(), Vec::new(), Vec::new()];
    for (all, size) in states[1..].iter_mut().zip(sizes) {
        // Uniform, of this root mean square.
        let most = |i: usize| 3_f64.sqrt() * if size[i] > 0.0 { size[i] } else { 1.0 };
        all.extend((0..count * n).map(|k| stream.random_range(-1.0..1.0) * most(k % n)));
    }
    Samples { n, states, controls: [vec![0.0; count * n], Vec::new(), Vec::new()], ..Samples::default() }
}

/// Passes at most until friction that grows with the torque is that of the torque itself: each leaves less than the largest c_load of the error.
const PASSES: usize = 200;
/// What is left then, beside 1 N m or N and the torque.
const SETTLED: f64 = 1e-12;

/// The torques that a model takes at states (q, v, v̇) of samples, \[samples\]\[n\], flat: τ = M v̇ + L_vq v − L_q − Q(q, v, τ). What the samples
/// have as controls is not read.
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
