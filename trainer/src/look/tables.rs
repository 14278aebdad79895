//! The tables of a first configuration that say what the machine is: model, calibration and training.

use super::configuration::{quoted, relative};
use super::mechanism::Mechanism;
use leastaction_learning::data::survey::Goals;
use std::path::{Path, PathBuf};

/// Knowledge of a machine, from its logs and its description.
#[derive(Clone, Copy)]
pub struct Tables<'a> {
    /// Number of coordinates.
    pub n: usize,
    /// Whether there are commands.
    pub is_driven: bool,
    /// How near commands are to positions, if they are positions, as those of servos.
    pub goals: Option<Goals>,
    /// The robot's description, URDF or MJCF.
    pub description: Option<&'a PathBuf>,
    /// The mechanism; without it, and without a description, the model is a network.
    pub mechanism: Option<&'a Mechanism>,
}

impl Tables<'_> {
    /// The text, in a configuration for a file of this name.
    pub fn text(&self, at: &Path) -> String {
        let [head, bodies] = self.model(at);
        let (forces, calibration) = match &self.goals {
            Some(goals) => (self.servo(goals), self.of_servos()),
            None => (self.friction(), self.of_drives()),
        };
        // Torques are the loss of an arm with drives, else windows are.
        let is_torque = self.description.is_some() && self.goals.is_none() && self.is_driven;
        let training = if is_torque { "" } else { "\n[training]\nloss = \"windows\"\n" };
        [head, forces, bodies, calibration, training.to_owned()].concat()
    }

    /// The table of the model before its friction, and the bodies after it.
    fn model(&self, at: &Path) -> [String; 2] {
        match (self.description, self.mechanism) {
            (Some(file), _) => [self.arm(&relative(std::slice::from_ref(file), at)), String::new()],
            (None, Some(mechanism)) => mechanism.tables(self.goals.is_some()),
            (None, None) => [network(self.n), String::new()],
        }
    }

    fn arm(&self, files: &[String]) -> String {
        let known = if self.goals.is_some() { "bodies = \"known\"\nrotors = \"known\"\n" } else { "" };
        let others = "# all keys: leastaction train --print-defaults arm";
        format!("\n[model]\nfamily = \"arm\" {others}\nurdf = {}\n{known}", quoted(&files.concat()))
    }

    /// Friction: of an arm that is fitted to its torques it sticks; that of a slide's guide and seals differs by direction; in the gears of
    /// other joints it grows with the load.
    fn friction(&self) -> String {
        let slides = self.mechanism.is_some_and(|mechanism| *mechanism == Mechanism::slide());
        let rest = match (self.description.is_some(), slides, self.is_driven) {
            (_, _, false) => "coulomb = \"learned\"",
            (true, ..) => "coulomb = \"sticking\"",
            (_, true, _) => "viscous_asymmetry = \"learned\", coulomb = \"learned\"",
            _ => "coulomb = \"learned\", load = \"learned\"",
        };
        format!("friction = {{ viscous = \"learned\", {rest} }}\n")
    }

    /// Servos, and why they are proposed.
    fn servo(&self, Goals { distance, correlation }: &Goals) -> String {
        let description = match self.mechanism.is_none() && self.description.is_none() {
            true => "# With a description: leastaction look LOG --urdf robot.urdf -o FILE.\n",
            false => "",
        };
        format!(
            "{description}\
             # u are positions to go to: u - q is {distance:.2} of the spread of q, and u correlates with q by {correlation:.2}. Force: k (u - q) - d v.\n\
             # Such a log shows masses, friction and stiffnesses up to a common factor, and lag as softness or as delay: give what you know.\n\
             servo = \"learned\" # or {{ stiffness = 17.0, damping = \"learned\" }}\n\
             friction = {{ coulomb = \"learned\" }}\n"
        )
    }

    fn of_servos(&self) -> String {
        "\n[calibration] # sensors and servos; a number if it is known\nzero = \"learned\"\ndelay = \"learned\"\n".to_owned()
    }

    /// Sensors and drives. The gain of a slide's drive is a factor of all masses and friction, which are learned; its zero has no effect, and
    /// its drive's offset is all that pushes it at rest. A joint that turns may turn against its drive, which the sign of its gain tells.
    fn of_drives(&self) -> String {
        if !self.is_driven {
            return String::new();
        }
        let head = "\n[calibration] # sensors and actuators; a number if it is known\n";
        let slides = self.mechanism.is_some_and(|mechanism| *mechanism == Mechanism::slide());
        let keys: &[&str] = match (self.description.is_some(), slides, self.n) {
            (true, ..) => &["offset"],
            (_, true, _) => &["offset", "delay"],
            _ => &["zero", "gain", "delay"],
        };
        let lines: String = keys.iter().map(|key| format!("{key} = \"learned\"\n")).collect();
        let scale = if slides {
            "# gain = -1.0 if u acts against q; else a factor of all masses and friction, to be learned only if a mass is known\n"
        } else {
            ""
        };
        format!("{head}{lines}{scale}")
    }
}

/// The table of a network with n coordinates.
fn network(n: usize) -> String {
    let angles = vec!["\"angle\""; n].join(", ");
    format!("\n[model]\ncoordinates = [{angles}] # \"translation\", \"angle\" or \"cyclic\"\n")
}
