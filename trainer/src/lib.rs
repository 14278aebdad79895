//! The common library of leastaction's commands, also called by programs in other languages: output, options, reading of models, training,
//! evaluation, adaptation, surveys of logs, and controllers on other processors.

pub mod adaptation;
pub mod cli;
pub mod evaluation;
pub mod look;
pub mod models;
pub mod notes;
pub mod processor;
pub mod training;
