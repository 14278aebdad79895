//! Results of the authors' program, measured with it on its own data and its own integrator.

use super::Baseline;
use leastaction_ground_truth::LgnnSystem;

/// Geometric means of rollout error and energy violation; `None` if unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Published {
    /// Rollout error.
    pub rollout_error: Option<f64>,
    /// Energy violation.
    pub energy_violation: Option<f64>,
    /// Number of weights.
    pub parameters: Option<usize>,
}

/// Numbers of weights of the authors' networks, without and with drag.
const PARAMETERS: [usize; 2] = [694, 740];

/// Results of the network trained on 3 pendulums or 5 springs (with drag if the system has it), run on this system.
pub fn rolled_out(system: LgnnSystem, drag: bool) -> Published {
    let row = |rollout_error, energy_violation| {
        row(rollout_error, energy_violation, Some(PARAMETERS[usize::from(drag)]))
    };
    match (system, drag) {
        (LgnnSystem::Pendulum(3), false) => row(2.6e-4, 2.9e-6),
        (LgnnSystem::Pendulum(4), false) => row(1.4e-3, 2.3e-5),
        (LgnnSystem::Pendulum(5), false) => row(5.9e-4, 6.3e-6),
        (LgnnSystem::Pendulum(3), true) => row(2.2e-3, 3.6e-4),
        (LgnnSystem::Pendulum(4), true) => row(5.3e-3, 6.6e-4),
        (LgnnSystem::Pendulum(5), true) => row(1.2e-2, 1.0e-3),
        (LgnnSystem::Spring(3), false) => row(3.0e-2, 2.6e-3),
        (LgnnSystem::Spring(4), false) => row(7.0e-2, 1.7e-3),
        (LgnnSystem::Spring(5), false) => row(8.4e-2, 1.9e-3),
        (LgnnSystem::Spring(50), false) => row(0.133, 4.7e-4),
        (LgnnSystem::Spring(500), false) => row(0.138, 4.0e-4),
        (LgnnSystem::Spring(3), true) => row(1.8e-2, 5.6e-3),
        (LgnnSystem::Spring(5), true) => row(6.3e-2, 7.4e-3),
        (LgnnSystem::Spring(50), true) => row(0.12, 2.8e-3),
        (LgnnSystem::Spring(500), true) => row(0.13, 1.4e-3),
        _ => Published::default(),
    }
}

/// Results of the union of both networks on the hybrid, free or pulled by 10 N.
pub fn hybrid(pulled: bool) -> Published {
    let parameters = Some(PARAMETERS[0]);
    if pulled { row(1.8e-3, 3.2e-4, parameters) } else { row(1.3e-3, 1.1e-4, parameters) }
}

/// Results of a model that the paper compares with, run on this system. LGN diverged when we ran it.
pub fn baseline(baseline: Baseline, system: LgnnSystem) -> Published {
    let row = |rollout_error, energy_violation| {
        row(rollout_error, energy_violation, baseline.published_parameters())
    };
    match (baseline, system) {
        (Baseline::Gns, LgnnSystem::Spring(5)) => row(0.24, 8.4e-3),
        (Baseline::Gns, LgnnSystem::Spring(50)) => row(0.24, 5.6e-3),
        (Baseline::Gns, LgnnSystem::Spring(500)) => row(0.25, 7.7e-3),
        (Baseline::Lnn, LgnnSystem::Pendulum(3)) => row(2.9e-2, 1.7e-4),
        _ => Published { parameters: baseline.published_parameters(), ..Published::default() },
    }
}

fn row(rollout_error: f64, energy_violation: f64, parameters: Option<usize>) -> Published {
    Published { rollout_error: Some(rollout_error), energy_violation: Some(energy_violation), parameters }
}
