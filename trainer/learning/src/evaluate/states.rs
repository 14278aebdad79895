//! Models that are stepped from states by an explicit Runge–Kutta method, in SyMo's measures on equal terms.

use super::{mean_square_or_infinite, start_energy};
use crate::data::{Dataset, Trajectory};
use crate::runge_kutta::{self, RungeKutta, State};
use leastaction_core::continuous::energy;
use leastaction_core::energy::trigonometric::Trigonometric;
use leastaction_models::parallel;

/// A learned acceleration v̇(q, v, u), m/s² or rad/s², with its integration method. Each stage uses the control at its time.
pub struct Stepper<A> {
    /// Runge–Kutta method.
    pub method: RungeKutta,
    /// The acceleration; `None` if it does not exist at a state.
    pub acceleration: A,
}

impl<A> Stepper<A> {
    /// The state after a step; `None` if an acceleration does not exist.
    fn step<const N: usize>(
        &self,
        h: f64,
        state: &State<N>,
        [first, last]: &[[f64; N]; 2],
    ) -> Option<State<N>>
    where
        A: Fn(&[f64; N], &[f64; N], &[f64; N]) -> Option<[f64; N]>,
    {
        let mut times = self.method.times();
        let acceleration = |q: &[f64; N], v: &[f64; N]| {
            let c = times.next().ok_or(())?;
            let u = std::array::from_fn(|i| first[i] + c * (last[i] - first[i]));
            (self.acceleration)(q, v, &u).ok_or(())
        };
        runge_kutta::step(self.method, h, state, acceleration).ok()
    }

    /// States (q, v) along every trajectory. The first two are as logged. The rest are steps, free or forced, from the
    /// second state, so that there are as many as from a model that starts from two positions.
    ///
    /// If a step fails, or the log has no velocities, the rest of the trajectory is NaN.
    pub fn rollout<const N: usize>(&self, data: &Dataset) -> Vec<Vec<State<N>>>
    where
        A: Fn(&[f64; N], &[f64; N], &[f64; N]) -> Option<[f64; N]> + Sync,
    {
        parallel::map(data.trajectories.len(), &|k| self.run(data, &data.trajectories[k]))
    }

    fn run<const N: usize>(&self, data: &Dataset, trajectory: &Trajectory) -> Vec<State<N>>
    where
        A: Fn(&[f64; N], &[f64; N], &[f64; N]) -> Option<[f64; N]>,
    {
        let lost = [[f64::NAN; N]; 2];
        let mut states: Vec<_> = (0..2).map(|k| logged(trajectory, k).unwrap_or(lost)).collect();
        for k in 1..trajectory.samples() - 1 {
            let u = control(data, trajectory, k);
            states.push(self.step(data.h, &states[k], &u).unwrap_or(lost));
        }
        states
    }

    /// Mean squared error of the position one step ahead of a logged state, from the second state of each trajectory
    /// on. The predicted positions are the same as for a model that starts from two positions.
    pub fn one_step_mse<const N: usize>(&self, data: &Dataset) -> f64
    where
        A: Fn(&[f64; N], &[f64; N], &[f64; N]) -> Option<[f64; N]>,
    {
        let steps = data.trajectories.iter().flat_map(|t| (1..t.samples() - 1).map(move |k| (t, k)));
        let errors = steps.flat_map(|(trajectory, k)| {
            let u = control(data, trajectory, k);
            let next = logged(trajectory, k).and_then(|state| self.step::<N>(data.h, &state, &u));
            let [q, _] = next.unwrap_or([[f64::NAN; N]; 2]);
            let exact: [f64; N] = row(&trajectory.q[k + 1]);
            std::array::from_fn::<f64, N, _>(|i| q[i] - exact[i])
        });
        mean_square_or_infinite(&errors.collect::<Vec<_>>())
    }
}

fn row<const N: usize>(x: &[f64]) -> [f64; N] {
    std::array::from_fn(|i| x[i])
}

fn logged<const N: usize>(trajectory: &Trajectory, k: usize) -> Option<State<N>> {
    Some([row(&trajectory.q[k]), row(&trajectory.v.as_ref()?[k])])
}

/// Control at the start and at the end of the step from sample `k`; linear in between.
fn control<const N: usize>(data: &Dataset, trajectory: &Trajectory, k: usize) -> [[f64; N]; 2] {
    [k, data.control_end(k)].map(|k| trajectory.u.as_ref().map_or([0.0; N], |u| row(&u[k])))
}

/// Positions of rollouts, \[samples\]\[n\], flat.
pub fn positions<const N: usize>(runs: &[Vec<State<N>>]) -> Vec<Vec<f64>> {
    runs.iter().map(|run| run.iter().flat_map(|[q, _]| *q).collect()).collect()
}

/// Mean squared deviation of the true energy along rollouts, without their first two states, from the true energy at the start.
pub fn state_energy_mse<const N: usize>(
    exact: &Trigonometric<N>,
    runs: &[Vec<State<N>>],
    data: &Dataset,
) -> f64 {
    let pairs = runs.iter().zip(&data.trajectories);
    let errors = pairs.flat_map(|(run, trajectory)| {
        let start = start_energy(exact, trajectory, data.h);
        run.iter().skip(2).map(move |[q, v]| energy(exact, q, v) - start)
    });
    mean_square_or_infinite(&errors.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::integration_errors;
    use leastaction_core::continuous::acceleration;
    use leastaction_core::energy::trigonometric::CARTPOLE;
    use leastaction_core::forces::System;
    use leastaction_ground_truth::{Drive, Mechanism, Settings, generate};

    type Two = [f64; 2];

    fn stepper(method: RungeKutta) -> Stepper<impl Fn(&Two, &Two, &Two) -> Option<Two> + Sync> {
        let exact = |q: &Two, v: &Two, u: &Two| acceleration(&System::conservative(CARTPOLE), q, v, u).ok();
        Stepper { method, acceleration: exact }
    }

    #[test]
    fn exact_accelerations_are_off_by_the_method_alone() {
        let mut data = generate(&Settings::symo(Mechanism::Cartpole, 8, 3)).unwrap();
        let [fine, coarse] = [RungeKutta::ThreeEighths, RungeKutta::Midpoint].map(|method| {
            let stepper = stepper(method);
            let runs = stepper.rollout::<2>(&data);
            let integration = integration_errors(&positions(&runs), &data).mean;
            [stepper.one_step_mse(&data), integration, state_energy_mse(&CARTPOLE, &runs, &data)]
        });
        assert!(fine[0] < 1e-10 && fine[1] < 1e-6, "{fine:?}");
        assert!(coarse[0] > 100.0 * fine[0] && coarse[1] > 100.0 * fine[1], "{fine:?} {coarse:?}");
        // The control does work on the cart: a constant energy would be wrong.
        assert!(fine[2] > 1e-3 && fine[2].is_finite());
        let free = Settings { drive: Drive::Free, ..Settings::symo(Mechanism::Cartpole, 8, 3) };
        data = generate(&free).unwrap();
        let runs = stepper(RungeKutta::ThreeEighths).rollout::<2>(&data);
        assert!(state_energy_mse(&CARTPOLE, &runs, &data) < 1e-6);
    }

    #[test]
    fn what_cannot_be_stepped_is_infinitely_wrong() {
        let mut data = generate(&Settings::symo(Mechanism::Cartpole, 2, 3)).unwrap();
        data.trajectories[1].v = None;
        let stepper = stepper(RungeKutta::Midpoint);
        let runs = stepper.rollout::<2>(&data);
        let finite = |run: &Vec<State<2>>| run.as_flattened().as_flattened().iter().all(|x| x.is_finite());
        assert_eq!(runs.iter().map(finite).collect::<Vec<_>>(), [true, false]);
        assert_eq!(stepper.one_step_mse::<2>(&data), f64::INFINITY);
    }
}
