//! Errors of exact physics stepped by the DEL equation, which all models here use: the floor set by the discretisation.
//! A learned Lagrangian may go below this floor, because it learns the modified Lagrangian.

use leastaction_core::forces::{System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_ground_truth::{Exact, Mechanism};
use leastaction_learning::data::symo::SymoSet;
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::evaluate::{energy_mse, integration_errors, rollout_system};

/// Measures as in [`super::Outcome::measures`] for the exact mechanism; NaN for the inertia matrix.
pub(super) fn floor(mechanism: Mechanism, order: u8, set: &SymoSet) -> [f64; 6] {
    match mechanism.exact() {
        Exact::One(exact) => of(&undamped(exact), mechanism, order, set),
        Exact::Two(exact) => of(&undamped(exact), mechanism, order, set),
    }
}

fn undamped<L, const N: usize>(lagrangian: L) -> System<L, Viscous<f64, N>> {
    System { lagrangian, forces: Viscous { coefficients: [0.0; N] } }
}

fn of<L: Lagrangian<f64, N> + Sync, const N: usize>(
    system: &System<L, Viscous<f64, N>>,
    mechanism: Mechanism,
    order: u8,
    set: &SymoSet,
) -> [f64; 6] {
    let triples = triples(&set.test);
    let test = integration_errors(&rollout_system(system, order, &triples), &triples).mean;
    let runs = rollout_system(system, order, &set.integration);
    let errors = integration_errors(&runs, &set.integration);
    let energy = energy_mse(mechanism, &runs, &set.integration);
    [test, errors.mean, errors.median, errors.first_100, energy, f64::NAN]
}

/// Returns every three consecutive states as a separate motion.
fn triples(data: &Dataset) -> Dataset {
    let cut = |rows: &Rows, k: usize| rows.select(&[k, k + 1, k + 2]);
    let of_trajectory = |trajectory: &Trajectory| -> Vec<Trajectory> {
        let count = trajectory.samples().saturating_sub(2);
        let one = |k: usize| Trajectory {
            id: k as i64,
            t0: 0.0,
            q: cut(&trajectory.q, k),
            v: None,
            a: None,
            u: trajectory.u.as_ref().map(|u| cut(u, k)),
        };
        (0..count).map(one).collect()
    };
    let trajectories = data.trajectories.iter().flat_map(of_trajectory).collect();
    Dataset { n: data.n, h: data.h, control: data.control, trajectories }
}
