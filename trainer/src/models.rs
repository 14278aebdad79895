//! Models that are read: from files, from the folders of runs, and in the chip's arithmetic.

use crate::cli::Failure;
use leastaction_core::model::ModelError;
use leastaction_learning::checkpoint::{Best, Trained};
use leastaction_models::Model;
use leastaction_models::file::{Precision, decode, encode_in};
use leastaction_replica::{ModelFile, Replica};
use std::path::Path;

/// A model file in memory.
pub struct Loaded {
    /// What it is.
    pub model: Model,
    /// As it was read.
    pub bytes: Vec<u8>,
}

/// Reads a model file.
///
/// # Errors
/// [`Failure::Input`] where it cannot be read, or is none.
pub fn read(file: &Path) -> Result<Loaded, Failure> {
    let bytes = std::fs::read(file).map_err(|error| Failure::input(file, error))?;
    let model = decode(&bytes).map_err(|error| Failure::input(file, refused(error)))?;
    Ok(Loaded { model, bytes })
}

/// Why bytes are no model, and what makes one.
pub fn refused(error: ModelError) -> String {
    format!("{error}; `leastaction export` makes a model file of a training run")
}

/// Reads a model file; also its size.
///
/// # Errors
/// As [`read`].
pub fn load(file: &Path) -> Result<(Model, usize), Failure> {
    let Loaded { model, bytes } = read(file)?;
    Ok((model, bytes.len()))
}

/// The same with the tree or graph of that name in mind, where one is named.
///
/// # Errors
/// As [`read`] and [`of_part`].
pub fn load_part(file: &Path, name: Option<&str>) -> Result<(Model, usize), Failure> {
    let (model, bytes) = load(file)?;
    Ok((of_part(file, model, name)?, bytes))
}

/// A model with the tree or graph of that name in mind, where one is named.
///
/// # Errors
/// [`Failure::Input`] where there is none of that name.
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

/// The model of a file, or as `leastaction export` makes it of a run's folder.
///
/// # Errors
/// [`Failure::Input`] where there is none.
pub fn of_file_or_run(path: &Path, part: Option<&str>) -> Result<Model, Failure> {
    if !path.is_dir() {
        return Ok(load_part(path, part)?.0);
    }
    let refused = |error: &dyn std::fmt::Display| Failure::input(path, error);
    let trained = Trained::read(path).map_err(|error| refused(&error))?;
    let bytes = encode_in(Precision::Single, &trained.architecture, &trained.best.weights, &trained.facts())
        .map_err(|error| refused(&error))?;
    let model = decode(&bytes).map_err(|error| refused(&error))?;
    of_part(path, model, part)
}

/// The model of a run, and its file.
///
/// # Errors
/// [`Failure::Input`] where there is no run; [`Failure::Work`] where it learned nothing.
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

/// Why weights are no model.
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

/// The file of a model as the chip has it.
///
/// # Errors
/// In words, where it cannot be.
pub fn chip_file(model: &Model) -> Result<ModelFile, String> {
    let bytes = model.to_bytes().map_err(|error| error.to_string())?;
    ModelFile::new(&bytes).map_err(|error| error.to_string())
}

/// The tree or graph of it that is meant.
///
/// # Errors
/// In words, where core is not compiled for its size.
pub fn meant<'f>(file: &'f ModelFile, model: &Model) -> Result<Replica<'f>, String> {
    file.replica(model.architecture.part().map(|(_, name)| name)).map_err(|error| error.to_string())
}
