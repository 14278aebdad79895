//! What the commands of leastaction share: where words go, options, the look at logs, and a controller on another processor.

pub mod cli;
pub mod look;
pub mod processor;
