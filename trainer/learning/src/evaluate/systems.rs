//! Learned systems of any size: accelerations and steps of states, side by side or one by one.

use crate::architecture::Architecture;
use crate::data::{Dataset, Trajectory};
use crate::parallel::{self, Pool};
use crate::training::order_of;
use leastaction_core::model::ModelError;
use leastaction_programs::dynamics::{Accelerations, Del, DelState, Newton};
use leastaction_programs::{Row, System, WIDTH};

/// Bounds of the steps of rollouts.
pub const NEWTON: Newton = Newton { max_iterations: 50, stop: 1e-14, accept: 1e-8 };

/// The accelerations of a system without constraints, for any thread.
pub struct FreeAccelerations<'w> {
    weights: &'w [f64],
    n: usize,
    pool: Pool<Accelerations>,
}

impl<'w> FreeAccelerations<'w> {
    /// Those of a model over its weight block.
    ///
    /// # Errors
    /// Where the shape does not fit in itself, or the block to the shape.
    pub fn new(architecture: &Architecture, weights: &'w [f64]) -> Result<Self, ModelError> {
        let system = system(architecture, weights)?;
        Ok(Self { weights, n: system.n(), pool: Pool::new(move || Accelerations::new(&system)) })
    }

    /// Writes v̇(q, v, u), u = 0 where it is empty; `None` where it does not exist or a slice does not fit.
    pub fn write(&self, q: &[f64], v: &[f64], u: &[f64], out: &mut [f64]) -> Option<()> {
        let n = self.n;
        let fits = q.len() >= n && v.len() >= n && (u.is_empty() || u.len() >= n) && out.len() >= n;
        fits.then_some(())?;
        let rows = |x: &[f64]| -> Vec<Row> {
            (0..n).map(|i| Row::splat(x.get(i).copied().unwrap_or(0.0))).collect()
        };
        let (q, v, u) = (rows(q), rows(v), rows(u));
        let mut a = vec![Row::default(); n];
        let failures =
            self.pool.with(|accelerations| accelerations.evaluate(self.weights, [&q, &v, &u], &mut a, None));
        out.iter_mut().zip(&a).for_each(|(out, a)| *out = a.0[0]);
        (!failures.any(1)).then_some(())
    }
}

/// The system of a model that a weight block fits.
pub(super) fn system(architecture: &Architecture, weights: &[f64]) -> Result<System, ModelError> {
    let system = System::new(&*architecture.energies()?);
    if system.parameters() == weights.len() {
        Ok(system)
    } else {
        Err(ModelError::WeightCount { found: weights.len(), needed: system.parameters() })
    }
}

/// What a rollout begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beginning {
    /// The first two positions.
    Positions,
    /// The second position with the velocity that was logged there; the first two positions where there are no velocities.
    Velocity,
}

/// Positions that free or forced steps from the beginning of each trajectory give, after the first two as logged, all
/// \[samples\]\[n\], flat. The control is held between samples, or linear, as the data has it.
///
/// Where a step fails the rest of the trajectory is NaN.
///
/// # Errors
/// As [`FreeAccelerations::new`].
pub fn rollout(
    architecture: &Architecture,
    weights: &[f64],
    order: u8,
    (data, beginning): (&Dataset, Beginning),
) -> Result<Vec<Vec<f64>>, ModelError> {
    let system = system(architecture, weights)?;
    let (h, order) = (data.h, order_of(order));
    let pool = Pool::new(move || Del::new(&system, h, order, NEWTON));
    let blocks: Vec<&[Trajectory]> = data.trajectories.chunks(WIDTH).collect();
    let runs =
        parallel::map(blocks.len(), &|k| pool.with(|del| run(del, weights, data, (blocks[k], beginning))));
    Ok(runs.into_iter().flatten().collect())
}

/// The positions of trajectories that are stepped side by side.
fn run(
    del: &mut Del,
    weights: &[f64],
    data: &Dataset,
    (trajectories, beginning): (&[Trajectory], Beginning),
) -> Vec<Vec<f64>> {
    let n = data.n;
    let longest = trajectories.iter().map(Trajectory::samples).max().unwrap_or(0);
    let row = |of: &dyn Fn(&Trajectory) -> f64| {
        Row(std::array::from_fn(|lane| trajectories.get(lane).or(trajectories.last()).map_or(0.0, of)))
    };
    let logged =
        |k: usize| -> Vec<Row> { (0..n).map(|i| row(&|t| t.q.get(k).map_or(f64::NAN, |q| q[i]))).collect() };
    let tau = |k: usize| -> Vec<Row> {
        let u = |t: &Trajectory, i: usize| t.u.as_ref().and_then(|u| u.get(k)).map_or(0.0, |u| u[i]);
        (0..n).map(|i| row(&|t| u(t, i))).collect()
    };
    let mut positions: Vec<Vec<f64>> =
        trajectories.iter().map(|t| t.q.iter().take(2).flatten().copied().collect()).collect();
    let ends = |k: usize| [tau(k), tau(data.control_end(k))];
    let has_velocities = trajectories.iter().all(|t| t.v.is_some());
    let mut state: DelState = if beginning == Beginning::Velocity && has_velocities {
        let at = |t: &Trajectory, i: usize| t.v.as_ref().and_then(|v| v.get(1)).map_or(f64::NAN, |v| v[i]);
        del.start_at(weights, &logged(1), &(0..n).map(|i| row(&|t| at(t, i))).collect::<Vec<_>>())
    } else {
        del.start(weights, [&logged(0), &logged(1)], ends(0).each_ref().map(Vec::as_slice))
    };
    for k in 1..longest.saturating_sub(1) {
        del.step(weights, &mut state, ends(k).each_ref().map(Vec::as_slice));
        for (lane, (positions, trajectory)) in positions.iter_mut().zip(trajectories).enumerate() {
            if k + 1 < trajectory.samples() {
                positions.extend(state.q.iter().map(|q| q.0[lane]));
            }
        }
    }
    positions
}

/// M(q) at rest at every position of the data, row by row.
///
/// # Errors
/// As [`FreeAccelerations::new`].
pub(super) fn masses(
    architecture: &Architecture,
    weights: &[f64],
    data: &Dataset,
) -> Result<Vec<Vec<f64>>, ModelError> {
    let positions: Vec<&[f64]> = data.trajectories.iter().flat_map(|t| t.q.iter()).collect();
    masses_at(architecture, weights, &positions)
}

/// M(q) at rest at these positions, row by row.
///
/// # Errors
/// As [`FreeAccelerations::new`].
pub fn masses_at(
    architecture: &Architecture,
    weights: &[f64],
    positions: &[&[f64]],
) -> Result<Vec<Vec<f64>>, ModelError> {
    let system = system(architecture, weights)?;
    let n = system.n();
    let (mut accelerations, zero) = (Accelerations::new(&system), vec![Row::default(); n]);
    let mut masses = Vec::new();
    for block in positions.chunks(WIDTH) {
        let at = |lane: usize, i: usize| block.get(lane).or(block.last()).map_or(0.0, |q| q[i]);
        let q: Vec<Row> = (0..n).map(|i| Row(std::array::from_fn(|lane| at(lane, i)))).collect();
        let _mass_alone = accelerations.evaluate(weights, [&q, &zero, &zero], &mut zero.clone(), None);
        let entry = |lane: usize, k: usize| accelerations.mass(k / n, k % n).0[lane];
        masses.extend((0..block.len()).map(|lane| (0..n * n).map(|k| entry(lane, k)).collect()));
    }
    Ok(masses)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::architecture::RigidArchitecture;
    use crate::data::Rows;
    use leastaction_core::energy::rigid::Coordinate;

    const H: f64 = 1e-3;

    /// A straight motion of 8 samples, v its velocities.
    fn motion(v: Option<f64>) -> Dataset {
        let rows = |x: &dyn Fn(usize) -> f64| Rows::from_flat(1, (0..8).map(x).collect()).unwrap();
        let q = rows(&|k| 0.3 + 0.7 * H * k as f64);
        let v = v.map(|v| rows(&|_| v));
        let trajectories = vec![Trajectory { id: 0, t0: 0.0, q, v, a: None, u: None }];
        Dataset { n: 1, h: H, control: None, trajectories }
    }

    #[test]
    fn rollouts_begin_with_the_velocity_that_was_logged() {
        let architecture = Architecture::from(RigidArchitecture::new(&[Coordinate::Angle], 5));
        let weights = architecture.initial_weights(3);
        let end = |v: Option<f64>, beginning| {
            let runs = rollout(&architecture, &weights, 4, (&motion(v), beginning)).unwrap();
            assert_eq!(runs[0].len(), 8);
            runs[0][7] - runs[0][1]
        };
        let straight = end(None, Beginning::Positions);
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 0.02;
        assert!(close(straight, 0.7 * 6.0 * H), "{straight}");
        assert_eq!(end(None, Beginning::Velocity), straight);
        assert_eq!(end(Some(-2.0), Beginning::Positions), straight);
        assert!(close(end(Some(-2.0), Beginning::Velocity), -2.0 * 6.0 * H));
        assert!(close(end(Some(0.7), Beginning::Velocity), straight));
    }
}
