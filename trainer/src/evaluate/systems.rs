//! Learned systems of any size: accelerations and steps of states, side by side or one by one.

use crate::architecture::Architecture;
use crate::data::{Dataset, Trajectory};
use crate::parallel::{self, Pool};
use crate::training::order_of;
use leastaction_core::model::ModelError;
use leastaction_programs::dynamics::{Accelerations, Del, DelState, Newton};
use leastaction_programs::{Row, System, WIDTH};

/// Bounds of the steps of rollouts.
const NEWTON: Newton = Newton { max_iterations: 50, stop: 1e-14, accept: 1e-8 };

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
fn system(architecture: &Architecture, weights: &[f64]) -> Result<System, ModelError> {
    let system = System::new(&*architecture.energies()?);
    if system.parameters() == weights.len() {
        Ok(system)
    } else {
        Err(ModelError::WeightCount { found: weights.len(), needed: system.parameters() })
    }
}

/// Positions that free or forced steps from the first two of each trajectory give, all \[samples\]\[n\], flat. The control is held
/// between samples, or linear, as the data has it.
///
/// Where a step fails the rest of the trajectory is NaN.
///
/// # Errors
/// As [`FreeAccelerations::new`].
pub fn rollout(
    architecture: &Architecture,
    weights: &[f64],
    order: u8,
    data: &Dataset,
) -> Result<Vec<Vec<f64>>, ModelError> {
    let system = system(architecture, weights)?;
    let (h, order) = (data.h, order_of(order));
    let pool = Pool::new(move || Del::new(&system, h, order, NEWTON));
    let blocks: Vec<&[Trajectory]> = data.trajectories.chunks(WIDTH).collect();
    let runs = parallel::map(blocks.len(), &|k| pool.with(|del| run(del, weights, data, blocks[k])));
    Ok(runs.into_iter().flatten().collect())
}

/// The positions of trajectories that are stepped side by side.
fn run(del: &mut Del, weights: &[f64], data: &Dataset, trajectories: &[Trajectory]) -> Vec<Vec<f64>> {
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
    let acting = ends(0);
    let mut state: DelState =
        del.start(weights, [&logged(0), &logged(1)], acting.each_ref().map(Vec::as_slice));
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
    let system = system(architecture, weights)?;
    let n = system.n();
    let (mut accelerations, zero) = (Accelerations::new(&system), vec![Row::default(); n]);
    let positions: Vec<&[f64]> = data.trajectories.iter().flat_map(|t| t.q.iter()).collect();
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
