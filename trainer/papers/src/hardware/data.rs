//! Logs of a machine, and parameters that others identified from them.

use super::error::HardwareError;
use super::identified::Identified;
use super::log::{Log, read_logs};
use super::machine::Machine;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Data shared by the tasks of a machine.
#[derive(Clone, Debug)]
pub struct MachineData {
    /// The machine.
    pub machine: Machine,
    /// Folder of its logs.
    pub folder: PathBuf,
    /// Logs in order of name.
    pub logs: Arc<[Log]>,
    /// Parameters that others identified.
    pub baseline: Option<Arc<Identified>>,
    /// File of these parameters.
    file: Option<PathBuf>,
}

/// File of identified parameters that is looked for beside the logs.
const BASELINE: &str = "model_parameters.yml";

impl MachineData {
    /// Reads `data`/machine. For the double pendulum it also reads the baseline, from the given file or else from
    /// `model_parameters.yml` beside the logs, if there is one.
    ///
    /// # Errors
    /// [`HardwareError`].
    pub fn read(data: &Path, machine: Machine, baseline: Option<&Path>) -> Result<Self, HardwareError> {
        let (folder, logs) = (data.join(machine.name()), read_logs(data, machine)?.into());
        let beside = Some(folder.join(BASELINE)).filter(|file| file.exists());
        let file = baseline.map(Path::to_owned).or(beside).filter(|_| machine == Machine::DoublePendulum);
        let baseline = file.as_deref().map(Identified::read).transpose()?.map(Arc::new);
        Ok(Self { machine, folder, logs, baseline, file })
    }

    /// Name of the file of the baseline.
    pub(super) fn baseline_name(&self) -> String {
        self.file.as_ref().map_or(String::new(), |file| file.display().to_string())
    }
}
