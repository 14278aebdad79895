//! A model that was read, in the chip's arithmetic.

use leastaction_chip::{Chip, ModelFile};
use leastaction_learning::model_file::HostModel;

/// The file of a model as the chip has it; an error in words where it cannot be.
pub fn file(model: &HostModel) -> Result<ModelFile, String> {
    let bytes = model.to_bytes().map_err(|error| error.to_string())?;
    ModelFile::new(&bytes).map_err(|error| error.to_string())
}

/// The tree or graph of it that is meant.
pub fn meant<'f>(file: &'f ModelFile, model: &HostModel) -> Result<Chip<'f>, String> {
    file.chip(model.architecture.part().map(|(_, name)| name)).map_err(|error| error.to_string())
}
