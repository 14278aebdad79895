//! The model file: golden files, sections, damage, writing.

#[path = "../common/mod.rs"]
mod common;

mod actuator;
mod arm_model;
mod axes;
mod bodies_model;
mod golden;
mod graph_model;
mod half;
mod lag;
mod model;
mod modular_model;
mod network_laws;
mod section_contents;
mod sections;
mod training_range;
mod writing;
