//! Motions along logs by the discrete Euler–Lagrange equation, many side by side, under the forces that the actuator makes of the commands.

use crate::parallel::{self, Pool};
use crate::{Actuator, LaggingCommands, Model};
use leastaction_core::model::ModelError;
use leastaction_data::{Dataset, Trajectory};
use leastaction_programs::dynamics::{Del, DelState, Newton, Order};
use leastaction_programs::{Row, WIDTH};

/// Limits of the Newton iteration in the steps of rollouts.
pub const NEWTON: Newton = Newton { max_iterations: 50, stop: 1e-14, accept: 1e-8 };

/// Initial condition of a rollout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beginning {
    /// The first two positions.
    Positions,
    /// The second position with the velocity logged there; the first two positions if there are no velocities.
    Velocity,
}

/// Converts an order given as a number: 4 is order 4, any other number order 2.
pub fn order_of(order: u8) -> Order {
    if order == 4 { Order::Four } else { Order::Two }
}

/// Places in logs that are stepped side by side: a trajectory, and the sample at which the motion begins.
type Places<'d> = [(&'d Driven<'d>, usize)];

/// A trajectory, and the lagging commands along it.
struct Driven<'d> {
    trajectory: &'d Trajectory,
    lagging: LaggingCommands,
}

/// Lagging commands of an actuator along a trajectory of a data set.
pub fn lagging_commands(actuator: &Actuator, data: &Dataset, trajectory: &Trajectory) -> LaggingCommands {
    let (step, sizes) = ((data.h, data.control_kind()), (trajectory.samples(), data.n));
    actuator.lagging(step, sizes, |k, i| logged_command(trajectory, k, i))
}

/// Command u_i at a sample; the first or last command beyond the ends of a log, 0 without control.
pub fn logged_command(trajectory: &Trajectory, sample: isize, i: usize) -> f64 {
    let Some(u) = &trajectory.u else { return 0.0 };
    let sample = usize::try_from(sample).unwrap_or(0).min(u.len().saturating_sub(1));
    u.get(sample).and_then(|u| u.get(i)).copied().unwrap_or(0.0)
}

/// The model and the log of a rollout.
struct Logged<'a> {
    model: &'a Model,
    data: &'a Dataset,
}

impl Model {
    /// Returns the positions reached by stepping from the beginning of each trajectory, \[samples\]\[n\], flat; the
    /// first two are as logged. The commands of the log are held between samples or linear; the force is what the
    /// actuator produces from them.
    ///
    /// If a step fails, the rest of the trajectory is NaN.
    ///
    /// # Errors
    /// See [`Model::system`].
    pub fn rollout(
        &self,
        order: u8,
        (data, beginning): (&Dataset, Beginning),
    ) -> Result<Vec<Vec<f64>>, ModelError> {
        let logged = Logged { model: self, data };
        let driven = logged.driven();
        let places: Vec<_> = driven.iter().map(|driven| (driven, 0)).collect();
        let pool = self.stepper(order, data.h)?;
        let blocks: Vec<&Places> = places.chunks(WIDTH).collect();
        let runs = parallel::map(blocks.len(), &|k| pool.with(|del| logged.run(del, blocks[k], beginning)));
        Ok(runs.into_iter().flatten().collect())
    }

    /// Returns mean squared errors of positions, each predicted from the two positions before it, for every position of
    /// every trajectory except the first two, in the order of the log; `None` if the step cannot be solved.
    ///
    /// # Errors
    /// See [`Model::system`].
    pub fn one_steps(&self, order: u8, data: &Dataset) -> Result<Vec<Option<f64>>, ModelError> {
        let logged = Logged { model: self, data };
        let driven = logged.driven();
        let starts = |of: &Driven| 0..of.trajectory.samples().saturating_sub(2);
        let places: Vec<_> = driven.iter().flat_map(|of| starts(of).map(move |first| (of, first))).collect();
        let pool = self.stepper(order, data.h)?;
        let blocks: Vec<&Places> = places.chunks(WIDTH).collect();
        let errors = parallel::map(blocks.len(), &|k| pool.with(|del| logged.one_step(del, blocks[k])));
        Ok(errors.into_iter().flatten().collect())
    }

    fn stepper(&self, order: u8, h: f64) -> Result<Pool<Del>, ModelError> {
        let system = self.system()?;
        Ok(Pool::new(move || Del::new(&system, h, order_of(order), NEWTON)))
    }
}

impl Logged<'_> {
    /// The trajectories of the data.
    fn driven(&self) -> Vec<Driven<'_>> {
        let actuator = &self.model.facts.actuator;
        let of =
            |trajectory| Driven { trajectory, lagging: lagging_commands(actuator, self.data, trajectory) };
        self.data.trajectories.iter().map(of).collect()
    }

    /// One number per place; lanes beyond the last place repeat it.
    fn row(places: &Places, of: impl Fn(&Trajectory, usize) -> f64) -> Row {
        Row(std::array::from_fn(|lane| {
            places
                .get(lane)
                .or(places.last())
                .map_or(f64::NAN, |(driven, first)| of(driven.trajectory, *first))
        }))
    }

    /// Positions k samples after every beginning.
    fn positions(&self, places: &Places, k: usize) -> Vec<Row> {
        let at = |i: usize| {
            Self::row(places, |trajectory, first| trajectory.q.get(first + k).map_or(f64::NAN, |q| q[i]))
        };
        (0..self.data.n).map(at).collect()
    }

    /// Forces at the start and the end of the step k samples after every beginning.
    fn forces(&self, places: &Places, k: usize) -> [Vec<Row>; 2] {
        let step = (self.data.h, self.data.control_kind());
        let mut ends = [(); 2].map(|()| vec![Row::default(); self.data.n]);
        for (lane, i) in (0..WIDTH).flat_map(|lane| (0..self.data.n).map(move |i| (lane, i))) {
            let Some((Driven { trajectory, lagging }, first)) = places.get(lane).or(places.last()) else {
                continue;
            };
            let command = |k: isize| logged_command(trajectory, k, i);
            let own = self.model.facts.actuator.over_step(step, (first + k, i), lagging, command);
            ends.iter_mut().zip(own).for_each(|(end, tau)| end[i].0[lane] = tau);
        }
        ends
    }

    /// Returns the motion one sample after every beginning.
    fn begin(&self, del: &mut Del, places: &Places, beginning: Beginning) -> DelState {
        let weights = &self.model.weights;
        let has_velocities = places.iter().all(|(driven, _)| driven.trajectory.v.is_some());
        if beginning == Beginning::Velocity && has_velocities {
            let velocity = |trajectory: &Trajectory, first: usize, i: usize| {
                trajectory.v.as_ref().and_then(|v| v.get(first + 1)).map_or(f64::NAN, |v| v[i])
            };
            let v: Vec<Row> = (0..self.data.n)
                .map(|i| Self::row(places, |trajectory, first| velocity(trajectory, first, i)))
                .collect();
            return del.start_at(weights, &self.positions(places, 1), &v);
        }
        let [q0, q1] = [0, 1].map(|k| self.positions(places, k));
        del.start(weights, [&q0, &q1], self.forces(places, 0).each_ref().map(Vec::as_slice))
    }

    fn step(&self, del: &mut Del, state: &mut DelState, (places, k): (&Places, usize)) {
        // After a failure, everything is NaN, so the failures need no handling.
        del.step(&self.model.weights, state, self.forces(places, k).each_ref().map(Vec::as_slice));
    }

    /// Returns the positions of trajectories that are stepped side by side.
    fn run(&self, del: &mut Del, places: &Places, beginning: Beginning) -> Vec<Vec<f64>> {
        let longest = places.iter().map(|(driven, _)| driven.trajectory.samples()).max().unwrap_or(0);
        let first_two = |t: &Trajectory| t.q.iter().take(2).flatten().copied().collect();
        let mut runs: Vec<Vec<f64>> = places.iter().map(|(driven, _)| first_two(driven.trajectory)).collect();
        let mut state = self.begin(del, places, beginning);
        for k in 1..longest.saturating_sub(1) {
            self.step(del, &mut state, (places, k));
            for (lane, (run, (Driven { trajectory, .. }, _))) in runs.iter_mut().zip(places).enumerate() {
                if k + 1 < trajectory.samples() {
                    run.extend(state.q.iter().map(|q| q.0[lane]));
                }
            }
        }
        runs
    }

    /// Squared errors of the positions two samples after every beginning.
    fn one_step(&self, del: &mut Del, places: &Places) -> Vec<Option<f64>> {
        let mut state = self.begin(del, places, Beginning::Positions);
        self.step(del, &mut state, (places, 1));
        let logged = self.positions(places, 2);
        let error = |lane: usize| {
            let squares = state.q.iter().zip(&logged).map(|(q, logged)| (q.0[lane] - logged.0[lane]).powi(2));
            Some(squares.sum::<f64>() / self.data.n as f64).filter(|error| error.is_finite())
        };
        (0..places.len()).map(error).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Architecture, InertiaNetworkArchitecture};
    use leastaction_core::energy::inertia_network::Coordinate;
    use leastaction_data::Rows;

    const H: f64 = 1e-3;

    /// A uniform motion of 8 samples; `v` gives the logged velocity.
    fn motion(v: Option<f64>) -> Dataset {
        let rows = |x: &dyn Fn(usize) -> f64| Rows::from_flat(1, (0..8).map(x).collect()).unwrap();
        let q = rows(&|k| 0.3 + 0.7 * H * k as f64);
        let v = v.map(|v| rows(&|_| v));
        let trajectories = vec![Trajectory { id: 0, t0: 0.0, q, v, a: None, u: None }];
        Dataset { n: 1, h: H, control: None, trajectories }
    }

    #[test]
    fn rollouts_begin_with_the_velocity_that_was_logged() {
        let architecture = Architecture::from(InertiaNetworkArchitecture::new(&[Coordinate::Angle], 5));
        let weights = architecture.initial_weights(3);
        let model = Model::new(architecture, weights);
        let end = |v: Option<f64>, beginning| {
            let runs = model.rollout(4, (&motion(v), beginning)).unwrap();
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
