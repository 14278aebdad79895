//! Reading of models: from files, from run folders, and in the chip's arithmetic.

use crate::cli::Failure;
use leastaction_core::model::{ModelError, fingerprint};
use leastaction_learning::checkpoint::{Best, Trained};
use leastaction_models::Model;
use leastaction_models::file::{Precision, decode, encode_in};
use leastaction_planning::{Machine, PlanConfig};
use leastaction_replica::{ModelFile, Replica};
use std::path::Path;

/// A model, and its file in memory.
pub struct Loaded {
    /// The model.
    pub model: Model,
    /// Bytes of the file as read.
    pub bytes: Vec<u8>,
}

/// Reads a model file.
///
/// # Errors
/// [`Failure::Input`] if the file cannot be read, or is not a model file.
pub fn read(file: &Path) -> Result<Loaded, Failure> {
    let bytes = std::fs::read(file).map_err(|error| unread(file, &error))?;
    let model = decode(&bytes).map_err(|error| Failure::input(file, refused(error)))?;
    Ok(Loaded { model, bytes })
}

/// The failure to read a model file; for a folder with what makes a file of it, if it is that of a run.
fn unread(file: &Path, error: &std::io::Error) -> Failure {
    if error.kind() == std::io::ErrorKind::IsADirectory {
        let folder = file.display();
        let remedy = format!(
            "a folder, no model file; of a run, `leastaction export {folder} -o m.postcard` makes one"
        );
        return Failure::input(file, remedy);
    }
    Failure::input(file, error)
}

/// The message that explains why bytes are not a model, with a remedy.
pub fn refused(error: ModelError) -> String {
    format!("{error}; `leastaction export` makes a model file of a training run")
}

/// Reads a model file; also returns its size.
///
/// # Errors
/// See [`read`].
pub fn load(file: &Path) -> Result<(Model, usize), Failure> {
    let Loaded { model, bytes } = read(file)?;
    Ok((model, bytes.len()))
}

/// Reads a model file, selects the tree or graph called `name` if given, and returns the file's size, too.
///
/// # Errors
/// See [`read`] and [`of_part`].
pub fn load_part(file: &Path, name: Option<&str>) -> Result<(Model, usize), Failure> {
    let (model, bytes) = load(file)?;
    Ok((of_part(file, model, name)?, bytes))
}

/// Selects the tree or graph of a model called `name`, if given.
///
/// # Errors
/// [`Failure::Input`] if there is none of that name.
pub fn of_part(file: &Path, model: Model, name: Option<&str>) -> Result<Model, Failure> {
    let Some(name) = name else { return Ok(model) };
    let Some((what, _)) = model.architecture.part() else {
        return Err(Failure::input(file, "an inertia network has no trees or graphs; leave out --tree"));
    };
    let known = || model.architecture.parts().join(", ");
    let architecture = model.architecture.with_part_named(name).ok_or_else(|| {
        Failure::input(file, format!("no {what} is called {name:?}; there are: {}", known()))
    })?;
    Ok(Model { architecture, ..model })
}

/// The model of a file, or of a run folder as `leastaction export` makes it.
///
/// # Errors
/// [`Failure::Input`] if there is none.
pub fn of_file_or_run(path: &Path, part: Option<&str>) -> Result<Model, Failure> {
    if !path.is_dir() {
        return Ok(load_part(path, part)?.0);
    }
    let model = decode(&exported(path)?).map_err(|error| Failure::input(path, error))?;
    of_part(path, model, part)
}

/// Fingerprint of a model's file, or of the file that `leastaction export` makes of a run: plans, settings and patches are bound to it.
///
/// # Errors
/// [`Failure::Input`] if there is none.
pub fn fingerprint_of(path: &Path) -> Result<u32, Failure> {
    let bytes = if path.is_dir() { exported(path)? } else { read(path)?.bytes };
    fingerprint(&bytes).map_err(|error| Failure::input(path, refused(error)))
}

/// The model file of a run.
fn exported(run: &Path) -> Result<Vec<u8>, Failure> {
    let trained = Trained::read(run).map_err(|error| Failure::input(run, error))?;
    let encoded =
        encode_in(Precision::Single, &trained.architecture, &trained.best.weights, &trained.facts());
    encoded.map_err(|error| Failure::input(run, error))
}

/// The machine that a plan is for: a robot description, a run, or a model file, to whose bytes its plans are bound.
///
/// # Errors
/// [`Failure::Input`] if there is none.
pub fn machine(config: &PlanConfig) -> Result<Machine, Failure> {
    let (path, part) = (&config.model, config.part.as_deref());
    if Machine::is_description(path) {
        return Machine::of_description(path).map_err(|error| Failure::Input(error.to_string()));
    }
    if path.is_dir() {
        return of_file_or_run(path, part).map(Machine::new);
    }
    let Loaded { model, bytes } = read(path)?;
    Ok(Machine { file: Some(bytes), ..Machine::new(of_part(path, model, part)?) })
}

/// The model of a run, with its file.
///
/// # Errors
/// [`Failure::Input`] if there is no run; [`Failure::Work`] if it learned nothing.
pub fn encoded(run: &Path, precision: Precision) -> Result<(Trained, Vec<u8>), Failure> {
    let trained = Trained::read(run).map_err(|error| Failure::Input(error.to_string()))?;
    let Trained { architecture, best, .. } = &trained;
    if !best.is_a_model() {
        return Err(Failure::file(run, nothing(best)));
    }
    let bytes = encode_in(precision, architecture, &best.weights, &trained.facts())
        .map_err(|error| Failure::file(run, error))?;
    Ok((trained, bytes))
}

/// The reason why the weights of a run are not a usable model.
fn nothing(best: &Best) -> String {
    let found = if best.solves_nothing {
        "no training sample could be solved".to_owned()
    } else {
        format!("the training loss is {}", best.train)
    };
    format!(
        "nothing was learned that could be exported: {found} at iteration {}, the best one; look at the data and at [training] warm_up, \
         and train again",
        best.iteration
    )
}

/// The file of a model, loaded as on a chip.
///
/// # Errors
/// A message, if it cannot be encoded or loaded.
pub fn chip_file(model: &Model) -> Result<ModelFile, String> {
    let bytes = model.to_bytes().map_err(|error| error.to_string())?;
    ModelFile::new(&bytes).map_err(|error| error.to_string())
}

/// The selected tree or graph of a model, in the chip's arithmetic.
///
/// # Errors
/// A message, if core is not compiled for its size.
pub fn meant<'f>(file: &'f ModelFile, model: &Model) -> Result<Replica<'f>, String> {
    file.replica(model.architecture.part().map(|(_, name)| name)).map_err(|error| error.to_string())
}
