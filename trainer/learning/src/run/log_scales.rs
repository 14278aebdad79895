//! Scales of a log, which defaults and bounds of learned numbers follow.

use super::ringing;
use crate::data::{Dataset, Rows, Trajectory};
use leastaction_core::model::{Law, ModelError};
use leastaction_models::{Architecture, Model, Scales};

/// Part of the samples whose amounts a scale covers: few enough are left out that the scale is near the largest amount, and enough that
/// outliers do not count.
const COVERED: f64 = 0.95;
/// Time over which positions are differenced, s: over a shorter time noise hides velocities.
const APART: f64 = 0.03;

/// Logs and their step, s.
type Logs<'l> = (&'l [Trajectory], f64);

/// Lets the numbers of laws that were not given follow the scales of the first `training` logs.
///
/// # Errors
/// An error if the shape is inconsistent or the weights do not fit it.
pub(super) fn follow(
    architecture: &mut Architecture,
    initial: &mut [f64],
    (data, training): (&Dataset, usize),
) -> Result<(), ModelError> {
    // The fit of an arm to torques solves for these numbers, and their starts do not matter to it, except for the width at rest.
    let is_fitted_to_torques = architecture.family.arm().is_some()
        && !architecture.group_laws.has_servos()
        && !architecture.group_laws.has(Law::Sticking);
    if architecture.follows_scales() && !is_fitted_to_torques {
        let logs = data.trajectories.get(..training).unwrap_or(&data.trajectories);
        let scales = of((logs, data.h), (architecture, initial))?;
        architecture.follow(&scales, initial);
    }
    Ok(())
}

/// Scales of every coordinate in these training logs. A coordinate without a logged force gets that of the inertia and the potential at the
/// weights with which training begins, in the proportion in which logged forces of other coordinates stand to theirs.
///
/// # Errors
/// An error if the shape is inconsistent or the weights do not fit it.
fn of(logs: Logs, (architecture, initial): (&Architecture, &[f64])) -> Result<Vec<Scales>, ModelError> {
    let n = architecture.n();
    let are_positions = architecture.group_laws.has_servos();
    let mut scales: Vec<Scales> = (0..n).map(|i| of_coordinate(logs, i, are_positions)).collect();
    if scales.iter().all(|own| own.force > 0.0) {
        return Ok(scales);
    }
    let inner = inner_forces(logs, (architecture, initial), &scales)?;
    let mut factors: Vec<f64> =
        scales.iter().zip(&inner).map(|(own, inner)| own.force / inner).filter(|x| *x > 0.0).collect();
    let factor = covered(&mut factors, 0.5).filter(|factor| factor.is_finite()).unwrap_or(1.0);
    let missing = scales.iter_mut().zip(inner).filter(|(own, _)| own.force == 0.0);
    missing.for_each(|(own, inner)| own.force = factor * inner);
    Ok(scales)
}

/// Scales that the rows of a coordinate show; commands are forces or positions.
fn of_coordinate((logs, h): Logs, i: usize, are_positions: bool) -> Scales {
    let amounts = |of: &dyn Fn(&Trajectory) -> Vec<f64>| {
        let mut all: Vec<f64> = logs.iter().flat_map(of).map(f64::abs).collect();
        all.retain(|x| x.is_finite());
        covered(&mut all, COVERED).unwrap_or(0.0)
    };
    let commands = |log: &Trajectory| log.u.as_ref().map_or(Vec::new(), |u| column(u, i));
    let deflections = |log: &Trajectory| -> Vec<f64> {
        commands(log).iter().zip(column(&log.q, i)).map(|(u, q)| u - q).collect()
    };
    let rates = |log: &Trajectory| differences(&column(&log.q, i), h);
    Scales {
        speed: amounts(&|log| rates(log)[0].clone()),
        acceleration: amounts(&|log| rates(log)[1].clone()),
        force: if are_positions { 0.0 } else { amounts(&commands) },
        deflection: if are_positions { amounts(&deflections) } else { 0.0 },
    }
}

/// Number i of every row.
fn column(rows: &Rows, i: usize) -> Vec<f64> {
    rows.iter().filter_map(|row| row.get(i)).copied().collect()
}

/// Velocities and accelerations of positions with this step, as differences over [`APART`], or over less in a short log.
fn differences(q: &[f64], h: f64) -> [Vec<f64>; 2] {
    let apart = ((APART / h).round() as usize).min(q.len().saturating_sub(1) / 2).max(1);
    let (later, time) = (q.iter().skip(apart), apart as f64 * h);
    let velocities: Vec<f64> = q.iter().zip(later).map(|(now, later)| (later - now) / time).collect();
    let later = velocities.iter().skip(apart);
    let accelerations = velocities.iter().zip(later).map(|(now, later)| (later - now) / time).collect();
    [velocities, accelerations]
}

/// The amount that this part of the amounts does not exceed; the largest if that is 0, as of a force that acts seldom; `None` of none.
fn covered(amounts: &mut [f64], part: f64) -> Option<f64> {
    let last = amounts.len().checked_sub(1)?;
    let (_, found, rest) = amounts.select_nth_unstable_by((part * last as f64) as usize, f64::total_cmp);
    Some(if *found > 0.0 { *found } else { rest.iter().copied().fold(0.0, f64::max) })
}

/// Force of the inertia at the log's accelerations or of the potential at its positions, whichever is larger, N or N m.
fn inner_forces(
    (logs, _): Logs,
    (architecture, initial): (&Architecture, &[f64]),
    scales: &[Scales],
) -> Result<Vec<f64>, ModelError> {
    let positions = ringing::positions(logs);
    let positions: Vec<&[f64]> = positions.iter().map(Vec::as_slice).collect();
    let own = initial.get(..architecture.parameters()?).unwrap_or_default().to_vec();
    let at_rest = Model::new(architecture.clone(), own).at_rest(&positions)?;
    let n = scales.len();
    let force = |i: usize| {
        let mut inertias: Vec<f64> = at_rest.iter().map(|at| at.mass[i * n + i].abs()).collect();
        let mut slopes: Vec<f64> = at_rest.iter().map(|at| at.slope[i].abs()).collect();
        let [inertia, slope] = [&mut inertias, &mut slopes].map(|all| covered(all, COVERED).unwrap_or(0.0));
        (inertia * scales[i].acceleration).max(slope)
    };
    Ok((0..n).map(force).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_core::energy::inertia_network::Coordinate;
    use leastaction_models::InertiaNetworkArchitecture;

    /// A swing of amplitude 2 at 3 rad/s, whose force acts in a tenth of the samples.
    fn log(unit: f64, h: f64) -> Dataset {
        let samples = (12.0 / h) as usize;
        let q = (0..samples).map(|k| unit * 2.0 * (3.0 * h * k as f64).sin());
        let q = Rows::from_flat(1, q.collect()).unwrap();
        let u = Rows::from_flat(1, (0..samples).map(|k| if k % 10 == 0 { 5.0 } else { 0.0 }).collect());
        Dataset {
            n: 1,
            h,
            control: None,
            trajectories: vec![Trajectory { id: 0, t0: 0.0, q, v: None, a: None, u }],
        }
    }

    fn logs(data: &Dataset) -> Logs<'_> {
        (&data.trajectories, data.h)
    }

    #[test]
    fn differences_show_speed_and_acceleration() {
        for h in [0.001, 0.01, 0.1] {
            let scales = of_coordinate(logs(&log(1.0, h)), 0, false);
            assert!((scales.speed / 6.0 - 1.0).abs() < 0.03, "{scales:?}");
            assert!((scales.acceleration / 18.0 - 1.0).abs() < 0.03, "{scales:?}");
            assert_eq!((scales.force, scales.deflection), (5.0, 0.0));
            assert!(
                (of_coordinate(logs(&log(1e3, h)), 0, false).speed / scales.speed / 1e3 - 1.0).abs() < 1e-9
            );
        }
        let mut short = log(1.0, 0.1);
        short.trajectories[0] = short.trajectories[0].part(0..1, 0.1);
        assert_eq!(of_coordinate(logs(&short), 0, false).speed, 0.0, "a single position");
    }

    #[test]
    fn outliers_do_not_count_and_seldom_forces_do() {
        let mut amounts: Vec<f64> = (0..=100).map(f64::from).collect();
        amounts[3] = 1e9;
        assert_eq!(covered(&mut amounts, COVERED), Some(96.0));
        assert_eq!(covered(&mut [0.0, 0.0, 0.0, 7.0, 0.0], 0.5), Some(7.0));
        assert_eq!(covered(&mut [], COVERED), None);
    }

    /// Free motion has the force of the inertia at the initial weights.
    #[test]
    fn without_a_force_the_inertia_gives_one() {
        let architecture = Architecture::from(InertiaNetworkArchitecture::new(&[Coordinate::Angle], 4));
        let weights = architecture.initial_weights(0);
        let mut free = log(1.0, 0.01);
        free.trajectories[0].u = None;
        let scales = of(logs(&free), (&architecture, &weights)).unwrap()[0];
        assert!(scales.force > 0.0 && scales.force.is_finite(), "{scales:?}");
        let forced = of(logs(&log(1.0, 0.01)), (&architecture, &weights)).unwrap()[0];
        assert_eq!((forced.force, forced.speed), (5.0, scales.speed));
    }
}
