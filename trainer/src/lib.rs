//! What the commands of leastaction share: where words go, options, and a controller on another processor.

pub mod cli;
pub mod processor;
