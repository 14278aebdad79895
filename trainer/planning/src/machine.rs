use crate::PlanError;
use leastaction_models::bodies::space::ArmArchitecture;
use leastaction_models::tree::{Limits, Tree};
use leastaction_models::urdf::{self, Described, Followers, Inertias, Options};
use leastaction_models::{Model, Number};
use leastaction_replica::{ModelFile, StateVisitor};
use std::path::Path;

/// A model with what is known of its joints.
#[derive(Clone, Debug)]
pub struct Machine {
    /// The model.
    pub model: Model,
    /// Names of the coordinates.
    pub names: Vec<String>,
    /// Limits of the joints; infinite where they are not known.
    pub limits: Vec<Limits>,
    /// Notes for the user.
    pub notes: Vec<String>,
    /// Model file as it is shipped, if there is one; else plans are bound to the file that [`Model::to_bytes`] makes.
    pub file: Option<Vec<u8>>,
}

impl Machine {
    /// A machine from a model, without names or limits of joints.
    pub fn new(model: Model) -> Self {
        let n = model.n();
        let names = (1..=n).map(|i| format!("q{i}")).collect();
        Self { model, names, limits: vec![Limits::none(); n], notes: Vec::new(), file: None }
    }

    /// Whether a file is a robot description, by its name.
    pub fn is_description(file: &Path) -> bool {
        let end = file.extension().and_then(|end| end.to_str()).unwrap_or_default();
        ["urdf", "xml", "mjcf", "xacro"].iter().any(|known| end.eq_ignore_ascii_case(known))
    }

    /// Reads a robot description, whose numbers are all known. Friction is not part of it.
    ///
    /// # Errors
    /// [`PlanError::Model`].
    pub fn of_description(file: &Path) -> Result<Self, PlanError> {
        let described = urdf::read_with(file, &options()).map_err(|error| PlanError::model(file, error))?;
        Self::described(described).ok_or_else(|| PlanError::model(file, FOLLOWER))
    }

    /// Reads the text of a robot description, as [`Machine::of_description`] does.
    ///
    /// # Errors
    /// [`PlanError::Motion`].
    pub fn of_text(text: &str) -> Result<Self, PlanError> {
        let described = urdf::parse_with(text, &options());
        let described = described.map_err(|error| PlanError::Motion(error.to_string()))?;
        Self::described(described).ok_or_else(|| PlanError::Motion(FOLLOWER.to_owned()))
    }

    /// The machine of a description; `None` if a joint follows another one.
    fn described(Described { tree, notes }: Described) -> Option<Self> {
        let coordinates = 0..tree.coordinates();
        Some(Self {
            model: known(&tree)?,
            names: coordinates.clone().map(|k| tree.coordinate_name(k).to_owned()).collect(),
            limits: coordinates.map(|k| tree.limits(k)).collect(),
            notes: notes.iter().map(ToString::to_string).collect(),
            file: None,
        })
    }

    /// Bytes of the model file that plans are bound to.
    ///
    /// # Errors
    /// [`PlanError::Motion`] if the model cannot be encoded.
    pub fn shipped(&self) -> Result<Vec<u8>, PlanError> {
        match &self.file {
            Some(bytes) => Ok(bytes.clone()),
            None => self.model.to_bytes().map_err(|error| PlanError::Motion(error.to_string())),
        }
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.model.n()
    }

    /// Flags of the coordinates that are angles.
    pub fn angles(&self) -> Vec<bool> {
        self.model.architecture.coordinates().chars().map(|letter| letter == 'a').collect()
    }
}

/// Message for a description whose joints are not free.
const FOLLOWER: &str = "a joint follows another one";

/// Options under which all numbers of a description are known.
fn options() -> Options {
    Options { inertias: Inertias::Required, followers: Followers::Held, ..Options::default() }
}

/// Passes the system of a model, in the chip's arithmetic, to a visitor.
pub fn visit<T>(
    model: &Model,
    visitor: impl for<'c> StateVisitor<'c, Output = Result<T, PlanError>>,
) -> Result<T, PlanError> {
    let failed = |error: &dyn std::fmt::Display| PlanError::Motion(error.to_string());
    let bytes = model.to_bytes().map_err(|error| failed(&error))?;
    let file = ModelFile::new(&bytes).map_err(|error| failed(&error))?;
    let part = model.architecture.part().map(|(_, name)| name);
    file.replica(part).map_err(|error| failed(&error))?.visit_states(visitor)
}

/// Model of a tree with known numbers.
fn known(tree: &Tree) -> Option<Model> {
    let architecture = ArmArchitecture::new(tree, |_| false, |k| Number::known(tree.rotors[k]))?;
    let architecture = leastaction_models::Architecture::from(architecture);
    let weights = architecture.initial_weights(0);
    Some(Model::new(architecture, weights))
}
