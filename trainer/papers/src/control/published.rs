//! Published rows of the competition, RealAIGym at ICRA 2025, one run each.

use super::policy::Robot::{self, Acrobot, Pendubot};

/// Scores of policies.
pub const POLICY: [(Robot, &str, f64); 8] = [
    (Acrobot, "AR-EAPO", 0.658),
    (Acrobot, "VIMPPI", 0.648),
    (Acrobot, "acados MPC", 0.630),
    (Acrobot, "MC-PILCO", 0.307),
    (Pendubot, "VIMPPI", 0.799),
    (Pendubot, "AR-EAPO", 0.759),
    (Pendubot, "acados MPC", 0.726),
    (Pendubot, "MC-PILCO", 0.509),
];

/// Scores of the best single swing-ups, and their time if it is known, s.
pub const SINGLE: [(Robot, &str, f64, Option<f64>); 2] =
    [(Acrobot, "History SAC", 0.655, Some(1.0)), (Pendubot, "History SAC", 0.682, None)];

/// Shares of variations survived, in the order of [`Column::ALL`](super::robustness::Column::ALL). TVLQR is the best that is not learned.
pub const ROBUSTNESS: [(Robot, &str, [f64; 6]); 3] = [
    (Acrobot, "TVLQR", [0.48, 0.19, 1.0, 0.95, 0.24, 0.78]),
    (Acrobot, "best of each column", [0.676, 0.286, 1.0, 1.0, 0.905, 0.78]),
    (Pendubot, "best of each column", [0.876, 0.905, 1.0, 1.0, 1.0, 0.98]),
];
