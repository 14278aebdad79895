//! Models of the pendulum that controllers believe in.

use super::plant::DoublePendulum;
use super::policy::{ControlError, TORQUE_LIMIT};
use leastaction_models::Model as Bodies;
use leastaction_planning::Machine;
use leastaction_replica::{ModelFile, Replica};

/// A model of the pendulum.
pub struct Model {
    /// Name in results.
    pub name: &'static str,
    /// Numbers of the pendulum.
    pendulum: DoublePendulum,
    /// The pendulum as rigid bodies.
    bodies: Bodies,
    /// Model file of the bodies.
    file: ModelFile,
}

/// Model in which a controller believes.
#[derive(Clone, Copy)]
pub struct Believed<'m> {
    /// Numbers of the pendulum.
    pub pendulum: DoublePendulum,
    /// The pendulum as rigid bodies.
    pub bodies: &'m Bodies,
    /// The bodies in the chip's arithmetic.
    pub replica: &'m Replica<'m>,
}

impl Model {
    /// The pendulum that is simulated.
    ///
    /// # Errors
    /// See [`Model::of`].
    pub fn exact() -> Result<Self, ControlError> {
        Self::of("exact", DoublePendulum::competition())
    }

    /// A pendulum with known numbers.
    ///
    /// # Errors
    /// [`ControlError::Policy`] if the numbers are those of no bodies, or of rotors or friction, which a description has not.
    pub fn of(name: &'static str, pendulum: DoublePendulum) -> Result<Self, ControlError> {
        let machine = Machine::of_text(&description(&pendulum)).map_err(failed)?;
        let file = machine.model.to_bytes().map_err(failed)?;
        let file = ModelFile::new(&file).map_err(failed)?;
        Ok(Self { name, pendulum, bodies: machine.model, file })
    }

    /// The bodies in the chip's arithmetic.
    ///
    /// # Errors
    /// [`ControlError::Policy`].
    pub fn replica(&self) -> Result<Replica<'_>, ControlError> {
        self.file.replica(None).map_err(failed)
    }

    /// The model for a controller.
    pub fn believed<'m>(&'m self, replica: &'m Replica<'m>) -> Believed<'m> {
        Believed { pendulum: self.pendulum, bodies: &self.bodies, replica }
    }
}

/// An error of a model or of a policy.
pub(super) fn failed(error: impl ToString) -> ControlError {
    ControlError::Policy(error.to_string())
}

/// Robot description (URDF) of a pendulum without rotors and friction; q = 0 hangs.
fn description(of: &DoublePendulum) -> String {
    let link = |k: usize| {
        let (mass, centre) = (of.mass[k], of.centre[k]);
        // About the centre of mass; the description has inertias there.
        let about = of.inertia[k] - mass * centre * centre;
        format!(
            "<link name=\"link{k}\"><inertial><origin xyz=\"0 0 {}\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\"{about}\" iyy=\"{about}\" izz=\"{about}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>",
            -centre
        )
    };
    let joint = |k: usize, parent: &str, below: f64| {
        format!(
            "<joint name=\"joint{k}\" type=\"continuous\"><parent link=\"{parent}\"/><child link=\"link{k}\"/>\
             <origin xyz=\"0 0 {}\"/><axis xyz=\"0 1 0\"/><limit effort=\"{TORQUE_LIMIT}\"/></joint>",
            -below
        )
    };
    let links = [link(0), link(1), joint(0, "base", 0.0), joint(1, "link0", of.length[0])].concat();
    format!("<robot name=\"double_pendulum\"><link name=\"base\"/>{links}</robot>")
}
