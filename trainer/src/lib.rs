//! What the commands of leastaction share, and what a program in another language calls: where words go, options, models that are read,
//! training, evaluation, the look at logs, and a controller on another processor.

pub mod cli;
pub mod evaluation;
pub mod look;
pub mod models;
pub mod notes;
pub mod processor;
pub mod training;
