//! Measures of a model's quality. This module has those of SyMo, evaluated on equal terms for all models; [`states`]
//! has the same for models that are stepped from states, [`prediction`] has those of ModLaNet, and [`rollouts`] those
//! of LGNN.

#[cfg(test)]
mod forces_tests;
pub mod horizons;
#[cfg(test)]
mod horizons_tests;
pub mod prediction;
pub mod rollouts;
mod starts;
pub mod states;
mod successive;

use crate::data::{Dataset, Trajectory};
use crate::training::{Samples, Solved};
use leastaction_core::continuous::energy;
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Newton, Path, StepError};
use leastaction_core::energy::trigonometric::Trigonometric;
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::{Exact, Mechanism};
use leastaction_models::rollout::{lagging_commands, logged_command};
use leastaction_models::{Model, parallel};

/// Number of steps in the early part of a long integration.
const EARLY: usize = 100;

/// Positions along every trajectory, as from [`Model::rollout`], for any system of core's types, exact or learned.
pub fn rollout_system<L, F, const N: usize>(system: &System<L, F>, order: u8, data: &Dataset) -> Vec<Vec<f64>>
where
    L: Lagrangian<f64, N> + Sync,
    F: Forces<f64, N> + Sync,
{
    parallel::map(data.trajectories.len(), &|k| match order {
        4 => free_run::<Galerkin, _, _, N>(system, data, &data.trajectories[k]),
        _ => free_run::<Midpoint, _, _, N>(system, data, &data.trajectories[k]),
    })
}

fn free_run<P: Path, L, F, const N: usize>(
    system: &System<L, F>,
    data: &Dataset,
    trajectory: &Trajectory,
) -> Vec<f64>
where
    L: Lagrangian<f64, N>,
    F: Forces<f64, N>,
{
    let del = Del::<f64, P>::with_newton(data.h, Newton { max_iterations: 50, stop: 1e-14, accept: 1e-8 });
    let mut positions: Vec<f64> = trajectory.q.iter().take(2).flatten().copied().collect();
    let _stopped_early = extend_run(&del, system, (data, trajectory), &mut positions);
    positions.resize(trajectory.samples() * N, f64::NAN);
    positions
}

fn extend_run<P: Path, L, F, const N: usize>(
    del: &Del<f64, P>,
    system: &System<L, F>,
    (data, trajectory): (&Dataset, &Trajectory),
    positions: &mut Vec<f64>,
) -> Result<(), StepError<f64>>
where
    L: Lagrangian<f64, N>,
    F: Forces<f64, N>,
{
    let q = |k: usize| -> [f64; N] { std::array::from_fn(|i| trajectory.q[k][i]) };
    let u =
        |k: usize| -> [f64; N] { std::array::from_fn(|i| trajectory.u.as_ref().map_or(0.0, |u| u[k][i])) };
    let between = |k: usize| Control { start: u(k), end: u(data.control_end(k)) };
    let mut state = del.start(system, &q(0), &q(1), &between(0))?;
    for k in 1..trajectory.samples() - 1 {
        del.step(system, &mut state, &between(k))?;
        positions.extend(state.q());
    }
    Ok(())
}

/// Position errors of long free motions, without the first two positions.
#[derive(Clone, Debug, PartialEq)]
pub struct IntegrationErrors {
    /// Mean squared position error.
    pub mean: f64,
    /// Median over trajectories of their mean squared error.
    pub median: f64,
    /// The mean over the first 100 steps.
    pub first_100: f64,
}

/// The rollouts that reach the end, with the corresponding exact motions.
pub fn finished(predicted: &[Vec<f64>], data: &Dataset) -> (Vec<Vec<f64>>, Dataset) {
    let pairs = predicted.iter().zip(&data.trajectories);
    let finished = pairs.filter(|(positions, _)| positions.iter().all(|q| q.is_finite()));
    let (predicted, trajectories) =
        finished.map(|(positions, trajectory)| (positions.clone(), trajectory.clone())).unzip();
    (predicted, Dataset { n: data.n, h: data.h, control: data.control, trajectories })
}

/// Compares rollouts with the exact motions. The error of a rollout that broke off counts as infinite.
pub fn integration_errors(predicted: &[Vec<f64>], data: &Dataset) -> IntegrationErrors {
    let errors = |steps: usize| -> Vec<f64> {
        let pairs = predicted.iter().zip(&data.trajectories);
        pairs.map(|(p, t)| mean_square(p, t.q.as_flat(), 2 * data.n..(2 + steps) * data.n)).collect()
    };
    let all = errors(usize::MAX / (2 * data.n) - 2);
    IntegrationErrors { mean: mean(&all), median: median(&all), first_100: mean(&errors(EARLY)) }
}

fn mean_square(a: &[f64], b: &[f64], range: std::ops::Range<usize>) -> f64 {
    let range = range.start..range.end.min(a.len());
    let errors: Vec<f64> = a[range.clone()].iter().zip(&b[range]).map(|(a, b)| a - b).collect();
    mean_square_or_infinite(&errors)
}

/// Mean square; infinite if an error is not finite.
fn mean_square_or_infinite(errors: &[f64]) -> f64 {
    let mean = mean(&errors.iter().map(|e| e * e).collect::<Vec<_>>());
    if mean.is_finite() { mean } else { f64::INFINITY }
}

/// The median: for an even number of values the mean of the middle two, for none NaN.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.get(middle.saturating_sub(1)..=middle) {
        Some([low, high]) if sorted.len().is_multiple_of(2) => (low + high) / 2.0,
        _ => sorted.get(middle).copied().unwrap_or(f64::NAN),
    }
}

/// Quantile at `part` (0 to 1) by linear interpolation; NaN if there are no values.
pub fn percentile(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = part * sorted.len().saturating_sub(1) as f64;
    let value = |k: f64| sorted.get(k as usize).copied().unwrap_or(f64::NAN);
    let (low, high) = (value(at.floor()), value(at.ceil()));
    // Both may be infinite.
    if low == high { low } else { low + (at - at.floor()) * (high - low) }
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

/// Mean squared deviation of the true energy along the rollouts from the true energy at the start (or at the first
/// midpoint if the data has no velocities). The energy is taken at the midpoint states ((a + b)/2, (b − a)/h). Even
/// exact positions do not give zero, because the midpoint state itself is an approximation.
pub fn energy_mse(mechanism: Mechanism, predicted: &[Vec<f64>], data: &Dataset) -> f64 {
    match mechanism.exact() {
        Exact::One(exact) => exact_energy_mse(&exact, predicted, data),
        Exact::Two(exact) => exact_energy_mse(&exact, predicted, data),
    }
}

fn exact_energy_mse<const N: usize>(exact: &Trigonometric<N>, predicted: &[Vec<f64>], data: &Dataset) -> f64 {
    let mut errors = Vec::new();
    for (positions, trajectory) in predicted.iter().zip(&data.trajectories) {
        let (rows, _) = positions.as_chunks::<N>();
        let start = start_energy(exact, trajectory, data.h);
        let pairs = rows.windows(2).skip(1);
        errors.extend(pairs.map(|pair| midpoint_energy(exact, &pair[0], &pair[1], data.h) - start));
    }
    mean_square_or_infinite(&errors)
}

/// Energy of the first state, or of the first midpoint if there are no velocities.
fn start_energy<const N: usize>(exact: &Trigonometric<N>, trajectory: &Trajectory, h: f64) -> f64 {
    let row = |x: &[f64]| -> [f64; N] { std::array::from_fn(|i| x[i]) };
    let q = &trajectory.q;
    match &trajectory.v {
        Some(v) => energy(exact, &row(&q[0]), &row(&v[0])),
        None => midpoint_energy(exact, &row(&q[0]), &row(&q[1]), h),
    }
}

fn midpoint_energy<const N: usize>(exact: &Trigonometric<N>, a: &[f64; N], b: &[f64; N], h: f64) -> f64 {
    let q = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
    let v = std::array::from_fn(|i| (b[i] - a[i]) / h);
    energy(exact, &q, &v)
}

/// Mean squared difference between the entries of the learned and the true inertia matrix, at all positions of the
/// data.
///
/// # Errors
/// [`ModelError`] if the shape is inconsistent or does not fit the data.
pub fn inertia_mse(model: &Model, mechanism: Mechanism, data: &Dataset) -> Result<f64, ModelError> {
    let positions: Vec<&[f64]> = data.trajectories.iter().flat_map(|t| t.q.iter()).collect();
    let pairs = model.at_rest(&positions)?.into_iter().zip(positions);
    let squares = pairs.flat_map(|(learned, q)| {
        let exact = exact_mass(mechanism, q);
        learned.mass.into_iter().zip(exact).map(|(a, b)| (a - b) * (a - b))
    });
    Ok(mean(&squares.collect::<Vec<_>>()))
}

fn exact_mass(mechanism: Mechanism, q: &[f64]) -> Vec<f64> {
    match mechanism.exact() {
        Exact::One(exact) => exact.mass_matrix(&[q[0]]).as_flattened().to_vec(),
        Exact::Two(exact) => exact.mass_matrix(&[q[0], q[1]]).as_flattened().to_vec(),
    }
}

/// Squared error of the acceleration at logged states, summed over samples and coordinates, and the mean squared
/// acceleration. The forces are those that the actuator produces from the logged commands. `None` if the data lacks
/// velocities or accelerations.
///
/// # Errors
/// [`ModelError`] if the shape is inconsistent or does not fit the data.
pub fn acceleration_mse(model: &Model, data: &Dataset) -> Result<Option<(Solved, f64)>, ModelError> {
    let Ok(samples) = Samples::accelerations(data) else { return Ok(None) };
    let (n, square) = (samples.n.max(1), samples.mean_square());
    let forces = forces(model, data);
    let [q, v, a] = samples.states.each_ref().map(|x| x.chunks_exact(n));
    let rows: Vec<_> = q.zip(v).zip(forces.chunks_exact(n)).zip(a).collect();
    let squares: Vec<Option<f64>> = model.with_forced(|forced| {
        parallel::map(rows.len(), &|k| {
            let (((q, v), tau), a) = rows[k];
            let mut out = vec![0.0; n];
            forced(q, v, tau, &mut out)?;
            let square = out.iter().zip(a).map(|(ours, a)| (ours - a) * (ours - a)).sum::<f64>();
            Some(square / n as f64).filter(|square| square.is_finite())
        })
    })?;
    Ok(Some((Solved::of(&squares), square)))
}

/// τ at every sample, \[samples\]\[n\].
fn forces(model: &Model, data: &Dataset) -> Vec<f64> {
    let (step, actuator) = ((data.h, data.control_kind()), &model.facts.actuator);
    let mut forces = Vec::with_capacity(data.samples() * data.n);
    for trajectory in &data.trajectories {
        let lagging = lagging_commands(actuator, data, trajectory);
        for (k, i) in (0..trajectory.samples()).flat_map(|k| (0..data.n).map(move |i| (k, i))) {
            let command = |k: isize| logged_command(trajectory, k, i);
            forces.push(actuator.at_sample(step, (k, i), &lagging, command));
        }
    }
    forces
}

/// Squared error of the position one step ahead, predicted from the two before, over samples and coordinates.
///
/// # Errors
/// [`ModelError`] if the shape is inconsistent or does not fit the data.
pub fn one_step_mse(model: &Model, order: u8, data: &Dataset) -> Result<Solved, ModelError> {
    Ok(Solved::of(&model.one_steps(order, data)?))
}

#[cfg(test)]
mod tests {
    use super::median;

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!((median(&[3.0]), median(&[3.0, 1.0]), median(&[9.0, 1.0, 2.0])), (3.0, 2.0, 2.0));
        assert_eq!(median(&[4.0, f64::INFINITY, 1.0, 2.0]), 3.0);
        assert!(median(&[]).is_nan());
    }
}
