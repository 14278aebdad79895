//! The robot description with what was identified.

use super::Export;
use leastaction::cli::{Failure, FileKind, Output, replaceable};
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::Config;
use leastaction_models::NumberKind;
use leastaction_models::config::{ArmConfig, ModelConfig};
use leastaction_models::urdf::{Format, Identified, JointNumbers, Written, write_back};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// A description that was written.
#[derive(Serialize)]
pub struct Description {
    /// The file.
    file: PathBuf,
    /// Description that the run was learned from.
    source: PathBuf,
    /// Whether the file is the source with other numbers.
    edited: bool,
    /// The text.
    #[serde(skip)]
    text: String,
}

impl fmt::Display for Description {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let how = if self.edited { "with the identified numbers" } else { "moving bodies, written anew" };
        writeln!(f, "{}: {}, {how}", self.file.display(), self.source.display())
    }
}

impl Description {
    /// Writes the file.
    pub fn write(&self) -> Result<(), Failure> {
        leastaction_learning::atomic::write(&self.file, self.text.as_bytes())
            .map_err(|error| Failure::file(&self.file, error))
    }
}

impl Export {
    /// Descriptions that the options name, with notes printed once each.
    pub(super) fn descriptions(
        &self,
        trained: &Trained,
        output: Output,
    ) -> Result<Vec<Description>, Failure> {
        let named = [(&self.urdf, Format::Urdf), (&self.mjcf, Format::Mjcf)];
        let named: Vec<(&Path, Format)> =
            named.into_iter().filter_map(|(file, format)| Some((file.as_deref()?, format))).collect();
        if named.is_empty() {
            return Ok(Vec::new());
        }
        let arm = self.arm()?;
        let identified = self.identified(trained)?;
        let mut notes = left_out(trained);
        let mut all = Vec::new();
        for (file, format) in named {
            check(file, &arm.urdf)?;
            let written = write_back(&arm.urdf, &arm.options(), &identified, format);
            let Written { text, is_edited, notes: own } =
                written.map_err(|error| Failure::input(&arm.urdf, error))?;
            notes.extend(own.iter().map(|note| format!("{}: {note}", file.display())));
            let (file, source) = (file.to_owned(), arm.urdf.clone());
            all.push(Description { file, source, edited: is_edited, text });
        }
        output.notes(&notes);
        Ok(all)
    }

    /// Configuration of the arm that was learned.
    fn arm(&self) -> Result<ArmConfig, Failure> {
        match Config::read(&self.run.join("config.toml"))?.model {
            ModelConfig::Arm(arm) => Ok(arm),
            _ => Err(self.no_description()),
        }
    }

    fn no_description(&self) -> Failure {
        let message = "this run was not learned from a robot description, so there is none to write numbers into; \
                       --urdf and --mjcf are for runs with [model] family = \"arm\"";
        Failure::input(&self.run, message)
    }

    fn identified(&self, trained: &Trained) -> Result<Identified, Failure> {
        let (architecture, weights) = (&trained.architecture, &trained.best.weights);
        let tree = architecture.family.arm().and_then(|arm| arm.host_tree(weights));
        let tree = tree.ok_or_else(|| self.no_description())?;
        let has_viscous = architecture.has_law_number(NumberKind::Damping);
        let friction = architecture.friction_of_coordinates(weights).into_iter();
        let joints = friction.map(|own| JointNumbers {
            damping: has_viscous.then_some(own.viscous),
            friction: own.dry.map(|dry| dry.constant),
        });
        Ok(Identified { tree, joints: joints.collect() })
    }
}

/// Refuses to overwrite the source, and files of another kind.
fn check(file: &Path, source: &Path) -> Result<(), Failure> {
    let same = |path: &Path| path.canonicalize().ok();
    if same(file).is_some_and(|file| same(source) == Some(file)) {
        let message = "the run was learned from this file, which would be lost; name another one";
        return Err(Failure::input(file, message));
    }
    replaceable(file, FileKind::Description)
}

/// Parts of the model that have no place in a description.
fn left_out(trained: &Trained) -> Vec<String> {
    let (architecture, weights) = (&trained.architecture, &trained.best.weights);
    let dry = || architecture.friction_of_coordinates(weights).into_iter().filter_map(|own| own.dry);
    let friction = architecture.friction_of_coordinates(weights);
    let damping_turns = friction.iter().any(|own| own.viscous_asymmetry != 0.0);
    let actuator = trained.facts().actuator;
    let parts = [
        (dry().any(|dry| dry.load != 0.0), "friction that grows with the load"),
        (dry().any(|dry| dry.asymmetry != 0.0) || damping_turns, "the differences of friction by direction"),
        (dry().next().is_some(), "the width of the transition of Coulomb friction around rest"),
        (!architecture.corrections.is_none(), "the networks beside the arm"),
        (actuator.offset.iter().any(|offset| *offset != 0.0), "the offsets of the drives' torques"),
        (actuator.gain.iter().any(|gain| *gain != 1.0), "the gains of the drives"),
        (actuator.delay != 0.0, "the delay of the drives"),
        (actuator.lag != 0.0, "the lag of the drives"),
    ];
    let left: Vec<&str> = parts.iter().filter(|(is_there, _)| *is_there).map(|(_, what)| *what).collect();
    let sentence = || format!("no place in a description, so only in the model file: {}", left.join("; "));
    if left.is_empty() { Vec::new() } else { vec![sentence()] }
}
