//! Results of the authors' program, measured with it on its own data and its own integrator.

use crate::published::{self, Row, UNKNOWN};
use leastaction_ground_truth::LgnnSystem::{self, Hybrid, Pendulum, Spring};

/// Geometric means of rollout error and energy violation.
pub type Published = published::Published<2>;

/// Results for a model, a system, and whether the system has drag or (if it is a hybrid) is pulled by 10 N. `ours`
/// stands for the authors' own network, trained on 3 pendulums or 5 springs (with drag if the system has drag); for the
/// hybrid it is the union of both. LGN diverged when we ran it.
const TABLE: [Row<(&str, LgnnSystem, bool), 2>; 24] = [
    (("ours", Pendulum(3), false), Some(694), [2.6e-4, 2.9e-6]),
    (("ours", Pendulum(4), false), Some(694), [1.4e-3, 2.3e-5]),
    (("ours", Pendulum(5), false), Some(694), [5.9e-4, 6.3e-6]),
    (("ours", Pendulum(3), true), Some(740), [2.2e-3, 3.6e-4]),
    (("ours", Pendulum(4), true), Some(740), [5.3e-3, 6.6e-4]),
    (("ours", Pendulum(5), true), Some(740), [1.2e-2, 1.0e-3]),
    (("ours", Spring(3), false), Some(694), [3.0e-2, 2.6e-3]),
    (("ours", Spring(4), false), Some(694), [7.0e-2, 1.7e-3]),
    (("ours", Spring(5), false), Some(694), [8.4e-2, 1.9e-3]),
    (("ours", Spring(50), false), Some(694), [0.133, 4.7e-4]),
    (("ours", Spring(500), false), Some(694), [0.138, 4.0e-4]),
    (("ours", Spring(3), true), Some(740), [1.8e-2, 5.6e-3]),
    (("ours", Spring(5), true), Some(740), [6.3e-2, 7.4e-3]),
    (("ours", Spring(50), true), Some(740), [0.12, 2.8e-3]),
    (("ours", Spring(500), true), Some(740), [0.13, 1.4e-3]),
    (("ours", Hybrid, false), Some(694), [1.3e-3, 1.1e-4]),
    (("ours", Hybrid, true), Some(694), [1.8e-3, 3.2e-4]),
    (("GNS", Spring(5), false), Some(2_130), [0.24, 8.4e-3]),
    (("GNS", Spring(50), false), Some(2_130), [0.24, 5.6e-3]),
    (("GNS", Spring(500), false), Some(2_130), [0.25, 7.7e-3]),
    (("LGN", Pendulum(3), false), Some(2_113), [UNKNOWN; 2]),
    (("LGN", Spring(5), false), Some(2_113), [UNKNOWN; 2]),
    (("LGN", Spring(50), false), Some(2_113), [UNKNOWN; 2]),
    (("LNN", Pendulum(3), false), None, [2.9e-2, 1.7e-4]),
];

/// Returns the results for a model on a system; `is_forced` says whether the system has drag or is pulled.
pub(super) fn published(model: &str, system: LgnnSystem, is_forced: bool) -> Published {
    Published::find(&TABLE, &(model, system, is_forced))
}
