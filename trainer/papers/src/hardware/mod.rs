//! Real machines: logs recorded on robots, models that learn from some of them, and their errors on the others.
//!
//! **Window error.** The grid of a log is t₀ + 10k ms; positions are interpolated linearly, torques averaged over each
//! step. Logs are counted from 0 in order of name. A window starts at grid sample s = 0, 25, 50, … while s + 104
//! samples exist, and counts if max |v| over it is at least 0.2 rad/s. The start state, at sample s + 3, is that of a
//! quadratic through the positions s … s + 6. The motion is predicted under the logged torque. The error to a horizon
//! is the root mean square over all joints and all samples from s + 3 to s + 3 + 10, 50 or 100. A row has the median
//! over windows that start at 2 s or later, and the 90th percentile.
//!
//! Without calibration ("as is"), only the start states of a tested log are used. With calibration, the zero offsets of its
//! encoders are estimated from its first 2 s.
//!
//! An arm of many joints is judged by its torques instead (`arm`) or by the currents of its drives (`currents`), free
//! swings by their own windows (`multi_arm`), an axis with friction by its position along a whole log (`axis`).
//!
//! Data flows one way: files → [`Log`] → windows → [`Predictor`] → summaries. The table is a list of entries.

mod arm;
mod axis;
mod calibration;
pub(crate) mod configured;
mod currents;
mod data;
mod entries;
mod error;
mod figures;
mod grid;
mod identified;
mod log;
mod machine;
mod multi_arm;
mod parameters;
mod polynomial;
mod predictor;
mod rivals;
mod rollout;
mod split;
mod states;
mod task;
mod window;

pub use arm::{ArmData, arm_tasks};
pub use axis::{Axis, AxisData, AxisOutcome, axis_tasks};
pub use calibration::zero_offsets;
pub use currents::{CurrentData, CurrentOutcome, current_tasks};
pub use data::MachineData;
pub use error::HardwareError;
pub(super) use figures::overview;
pub use identified::Identified;
pub use log::Log;
pub use machine::Machine;
pub use multi_arm::{Swings, read_swings, swing_tasks};
pub use predictor::Predictor;
pub use split::Split;

use entries::entries;

use super::task::Task;
use task::Experiment;

/// Creates the tasks of all models on a machine's logs with these splits; tasks that depend on a seed are repeated for
/// each of `seeds`. `arguments` are the command-line options other than machine, tested logs and seed.
pub fn tasks(
    data: &MachineData,
    splits: &[Split],
    seeds: &[u64],
    (quick, arguments): (bool, &str),
) -> Vec<Task> {
    let mut tasks = Vec::new();
    for split in splits {
        for entry in entries(data.baseline.is_some()) {
            let seeds = &seeds[..if entry.is_seeded { seeds.len() } else { seeds.len().min(1) }];
            tasks.extend(seeds.iter().map(|seed| {
                let (data, split, arguments) = (data.clone(), split.clone(), arguments.to_owned());
                Task::from(Experiment { entry, data, split, seed: *seed, quick, arguments })
            }));
        }
    }
    tasks
}
