//! Models of the pendulum that controllers believe in.

use super::learned;
use super::plant::DoublePendulum;
use super::policy::{ControlError, Robot, TORQUE_LIMIT};
use leastaction_models::Model as Bodies;
use leastaction_planning::Machine;
use leastaction_replica::{ModelFile, Replica};
use std::f64::consts::FRAC_PI_2;

/// Way in which a model is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Known {
    /// The pendulum that is simulated.
    Exact,
    /// Learned from ten simulated logs of 10 s of the robot, with encoders of 12 bits, jitter and a noisy torque.
    Learned,
}

impl Known {
    /// The model of a robot.
    ///
    /// # Errors
    /// [`ControlError::Policy`].
    pub fn model(self, robot: Robot, note: &(dyn Fn(&str) + Sync)) -> Result<Model, ControlError> {
        match self {
            Self::Exact => Model::exact(),
            Self::Learned => learned::learned(robot, note),
        }
    }
}

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
        Self::new(name, pendulum, machine.model)
    }

    /// A model that was learned, without friction.
    ///
    /// # Errors
    /// [`ControlError::Policy`] for a model that cannot be evaluated.
    pub fn of_bodies(name: &'static str, bodies: Bodies) -> Result<Self, ControlError> {
        Self::new(name, pendulum_of(&bodies)?, bodies)
    }

    fn new(name: &'static str, pendulum: DoublePendulum, bodies: Bodies) -> Result<Self, ControlError> {
        let file = ModelFile::new(&bodies.to_bytes().map_err(failed)?).map_err(failed)?;
        Ok(Self { name, pendulum, bodies, file })
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

/// Pendulum that moves as two bodies without friction do, with masses of 1 kg: motion shows no more than five sums of its numbers.
pub(super) fn pendulum_of(bodies: &Bodies) -> Result<DoublePendulum, ControlError> {
    let torques = |q: [f64; 2], a: [f64; 2]| {
        let torques = bodies.inverse_dynamics([&q, &[0.0; 2], &a]).map_err(failed)?;
        <[f64; 2]>::try_from(torques).map_err(|_| failed("a double pendulum has two coordinates"))
    };
    let [both, second] = torques([FRAC_PI_2, 0.0], [0.0; 2])?;
    let [m11, m12] = torques([0.0; 2], [1.0, 0.0])?;
    let [_, m22] = torques([0.0; 2], [0.0, 1.0])?;
    let (gravity, coupling) = (DoublePendulum::competition().gravity, m12 - m22);
    let [first, second] = [both - second, second].map(|weight| weight / gravity);
    let length = coupling / second;
    Ok(DoublePendulum {
        mass: [1.0; 2],
        length: [length, DoublePendulum::competition().length[1]],
        centre: [first - length, second],
        inertia: [m11 - m22 - length * length - 2.0 * coupling, m22],
        ..DoublePendulum::competition()
    })
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
