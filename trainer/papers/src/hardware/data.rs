//! A machine's logs and what others identified from them.

use super::error::HardwareError;
use super::identified::Identified;
use super::log::{Log, read_logs};
use super::machine::Machine;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What the tasks of a machine share.
#[derive(Clone, Debug)]
pub struct MachineData {
    /// Which.
    pub machine: Machine,
    /// Where its logs are.
    pub folder: PathBuf,
    /// In order of name.
    pub logs: Arc<[Log]>,
    /// The parameters that others identified.
    pub baseline: Option<Arc<Identified>>,
    /// Their file.
    file: Option<PathBuf>,
}

/// The file of identified parameters that is looked for beside the logs.
const BASELINE: &str = "model_parameters.yml";

impl MachineData {
    /// Reads `data`/machine; of the double pendulum also the baseline, from its own file or from `model_parameters.yml` beside the
    /// logs, where there is one.
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

    /// The file of the baseline, in words.
    pub(super) fn baseline_name(&self) -> String {
        self.file.as_ref().map_or(String::new(), |file| file.display().to_string())
    }
}
