//! Results of the paper and of its authors' program.

use super::Baseline;
use leastaction_ground_truth::ManyBody;

/// Errors as printed: of accelerations, and of predictions in the authors' measures. `None` if not printed or failed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Published {
    /// Number of weights in the authors' program.
    pub parameters: Option<usize>,
    /// Mean squared error of accelerations on the test set.
    pub test_mse: Option<f64>,
    /// Position error A_q.
    pub position: Option<f64>,
    /// Energy error A_E.
    pub energy: Option<f64>,
}

/// Results of ModLaNet trained on this system itself (Table 2).
pub fn trained(system: ManyBody) -> Published {
    match system {
        ManyBody::Pendulum(2) => row(6_275, 3.47e-2, 1.28, 4.6e-2),
        ManyBody::Bodies(3) => row(6_307, 1.56e-5, 3.96e-2, 1.1e-3),
        _ => Published::default(),
    }
}

/// Results of ModLaNet extended to this system (section 5.3; predictions of the pendulums by the authors' program over 100 and 40 starts).
pub fn extended(system: ManyBody, fine_tuned: bool) -> Published {
    match (system, fine_tuned) {
        (ManyBody::Pendulum(3), false) => row(6_275, 7.15, 1.88, 1.01),
        (ManyBody::Pendulum(3), true) => row(6_275, 4.6e-2, 1.21, 0.077),
        (ManyBody::Pendulum(4), false) => row(6_275, 22.7, 2.48, 2.99),
        (ManyBody::Pendulum(4), true) => row(6_275, 0.196, 1.93, 0.034),
        (ManyBody::Bodies(4), false) => row(6_307, 7.2e-5, 0.0127, 0.0013),
        (ManyBody::Bodies(4), true) => row(6_307, 8.6e-5, 0.0093, 0.0008),
        (ManyBody::Bodies(5), false) => row(6_307, 2.4e-3, 0.028, 0.0024),
        (ManyBody::Bodies(5), true) => row(6_307, 9.4e-5, 0.019, 0.0022),
        (ManyBody::Bodies(6), false) => row(6_307, 1.52, 0.059, 0.0058),
        (ManyBody::Bodies(6), true) => row(6_307, 1.2e-2, 0.055, 0.0068),
        _ => Published::default(),
    }
}

/// Results for the double pendulum by the number of samples (Table 4): 100K and 1M fail.
pub fn by_samples(samples: usize) -> Published {
    let test_mse = match samples {
        10_000 => Some(3.47e-2),
        20_000 => Some(3.02e-2),
        40_000 => Some(7.82e-2),
        _ => None,
    };
    Published { parameters: Some(6_275), test_mse, ..Published::default() }
}

/// Results of a model that the paper compares with (Table 2); those of the light MLP are by the authors' program, whose losses of HNN and
/// MLP are those of ṗ alone. Predictions that are left out fail.
pub fn baseline(system: ManyBody, baseline: Baseline) -> Published {
    let failing = |parameters, test_mse| Published {
        parameters: Some(parameters),
        test_mse: Some(test_mse),
        ..Published::default()
    };
    match (system, baseline) {
        (ManyBody::Pendulum(2), Baseline::Hnn) => row(41_600, 9.8e3, 4.91, 12.4),
        (ManyBody::Pendulum(2), Baseline::LightHnn) => failing(6_225, 5.0e2),
        (ManyBody::Pendulum(2), Baseline::Lnn) => failing(364_200, 7.1e2),
        (ManyBody::Pendulum(2), Baseline::LightLnn) => failing(6_150, 4.3e3),
        (ManyBody::Pendulum(2), Baseline::Mlp) => row(42_000, 6.5e2, 3.42, 673.0),
        (ManyBody::Pendulum(2), Baseline::LightMlp) => failing(6_375, 3.57),
        (ManyBody::Bodies(3), Baseline::Hnn) => row(43_200, 2.9e-4, 9.6e-2, 4.7e-3),
        (ManyBody::Bodies(3), Baseline::LightHnn) => row(6_020, 3.6e-4, 0.112, 5.3e-3),
        (ManyBody::Bodies(3), Baseline::Lnn) => failing(369_000, 2.2e-5),
        (ManyBody::Bodies(3), Baseline::LightLnn) => failing(5_950, 7.8e-4),
        (ManyBody::Bodies(3), Baseline::Mlp) => row(45_200, 1.45e-4, 0.264, 2.1e-2),
        (ManyBody::Bodies(3), Baseline::LightMlp) => failing(6_720, 2.11e-3),
        _ => Published::default(),
    }
}

fn row(parameters: usize, test_mse: f64, position: f64, energy: f64) -> Published {
    Published {
        parameters: Some(parameters),
        test_mse: Some(test_mse),
        position: Some(position),
        energy: Some(energy),
    }
}
