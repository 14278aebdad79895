//! The file of a plan: golden file, damage, headers, writing; references and commands.

#[path = "../common/mod.rs"]
mod common;

mod commands;
mod damage;
mod golden;
mod headers;
mod references;
mod sample;
mod writing;
