//! The file of a plan, as it is shipped.

use crate::plan::PlanNode;
use crate::{Machine, Plan, PlanError};
use leastaction_core::model::fingerprint;
use leastaction_core::plan::{PlanFile, PlanHeader, write};

impl Plan {
    /// The plan as a file for the controller of this machine.
    ///
    /// # Errors
    /// [`PlanError::Motion`] if a number does not fit single precision or the format.
    pub fn to_bytes(&self, machine: &Machine) -> Result<Vec<u8>, PlanError> {
        let model = fingerprint(&machine.shipped()?).map_err(|error| unwritten(&error))?;
        let driven: Vec<usize> = (0..self.task.n()).filter(|i| self.task.limits.is_driven(*i)).collect();
        self.file_of(model, &driven)
    }

    /// The plan with a command for every coordinate, held at 0 for those that are not driven.
    pub(crate) fn all_driven(&self) -> Result<Vec<u8>, PlanError> {
        self.file_of(0, &(0..self.task.n()).collect::<Vec<_>>())
    }

    /// The plan with the commands of these coordinates, for a model with this fingerprint.
    fn file_of(&self, model: u32, driven: &[usize]) -> Result<Vec<u8>, PlanError> {
        let coordinates: Vec<u8> = driven.iter().filter_map(|i| u8::try_from(*i).ok()).collect();
        let limits: Vec<[f32; 2]> = driven.iter().map(|i| self.task.limits.u[*i].map(|u| u as f32)).collect();
        let angles: Vec<u8> =
            self.task.goal.turns.iter().take(self.task.n()).map(|turns| u8::from(*turns)).collect();
        let header = PlanHeader {
            model,
            driven: &coordinates,
            angles: &angles,
            h: self.task.tick as f32,
            ticks_per_node: self.task.ticks_per_node.into(),
            nodes: u32::try_from(self.nodes.len()).map_err(|error| unwritten(&error))?,
            limits: &limits,
        };
        let records: Vec<f32> =
            self.nodes.iter().chain([&self.end]).flat_map(|node| numbers(node, driven)).collect();
        let mut words = vec![0_u32; WORDS + 2 * limits.len() + records.len()];
        let memory = bytemuck::cast_slice_mut(&mut words);
        let file = write(&header, &records, memory).map_err(|error| unwritten(&error))?;
        PlanFile::parse(file).map_err(|error| unwritten(&error))?;
        Ok(file.to_vec())
    }
}

fn unwritten(error: &dyn std::fmt::Display) -> PlanError {
    PlanError::Motion(format!("the plan cannot be written: {error}"))
}

/// Room for everything but the numbers, in words of four bytes: the lists of the header have at most 64 entries each.
const WORDS: usize = 64;

/// Numbers of a record: q, v, u and the gains of the driven coordinates.
fn numbers(node: &PlanNode, driven: &[usize]) -> Vec<f32> {
    let commands = driven.iter().map(|i| node.u[*i]);
    let gains = driven.iter().flat_map(|i| &node.gain[*i]).copied();
    node.x.iter().copied().chain(commands).chain(gains).map(|x| x as f32).collect()
}
