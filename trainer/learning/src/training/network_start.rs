//! Where training of a rigid network begins that starts from another model: at the energies of that model, over the range of the logs.

use super::blocks::Blocks;
use super::{Levenberg, Progress, Samples};
use crate::architecture::Architecture;
use leastaction_core::model::ModelError;
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
pub(crate) struct Covered<'a> {
    /// Positions, \[samples\]\[n\], flat.
    pub q: &'a [f64],
    /// Root mean squares of velocities and accelerations of every coordinate.
    pub sizes: [Vec<f64>; 2],
}

/// Weights of a rigid network, from `initial` on, whose inertia and potential are those of a model of the same coordinates.
///
/// At positions of the logs, and random velocities and accelerations of the size that the logs have, both models without their forces are
/// to take the same torque, M v̇ + L_vq v − L_q: first torques are fitted, to which any weights lead, then the accelerations that these
/// torques give, which count light coordinates as much as heavy ones. What follows the network in the weight block stays.
///
/// # Errors
/// Where a shape does not fit in itself.
pub(crate) fn network_start(
    (architecture, initial): (&Architecture, Vec<f64>),
    (model, weights): (&Architecture, &[f64]),
    covered: &Covered,
) -> Result<Vec<f64>, ModelError> {
    let Some(rigid) = architecture.rigid() else { return Ok(initial) };
    let (own, parameters) = (rigid.header().parameters()?, architecture.parameters()?);
    let [system, model] = [architecture, model].map(|of| of.energies().map(|of| System::new(&*of)));
    let (system, model) = (system?.conservative(), model?.conservative());
    let n = architecture.n();
    let states = (EQUATIONS * own).div_ceil(n).clamp(STATES[0], STATES[1]);
    let samples = states_like(covered, n, states);
    let samples = with_torques(samples, (&mut TorqueLoss::new(&model), weights));
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

/// The same with the torques that a model takes there.
fn with_torques(mut samples: Samples, (loss, weights): (&mut dyn Loss, &[f64])) -> Samples {
    let (n, count) = (samples.n, samples.states[0].len() / samples.n);
    let mut torques = vec![0.0; count * n];
    for start in (0..count).step_by(WIDTH) {
        let range = start..(start + WIDTH).min(count);
        let mut residual = vec![Row::default(); n];
        let _failures =
            loss.evaluate(weights, &samples.block(start, &range), &mut residual, Derivatives::None);
        for (k, torque) in torques[n * range.start..n * range.end].iter_mut().enumerate() {
            *torque = residual[k % n].0[k / n];
        }
    }
    samples.controls[0] = torques;
    samples
}
