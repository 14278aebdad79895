//! The extension module `leastaction._leastaction`, which the package's Python code calls.
//!
//! ```text
//! arrays of Python ─► arrays ─► single  (the chip's arithmetic, Replica of leastaction-replica) ─► arrays of Python
//!                             ├► motion  (the same, step by step), observer
//!                             └► double, derivatives  (programs of any size, in f64)
//! files ─► training, tools, adaptation (what the command does, by its library)
//! files, models ─► planning, controller, regulators, viewer (plans, policies, linear regulators and drawings, of leastaction-planning)
//! ```
//!
//! Arrays are copied before the interpreter's lock is released, and rows are computed in blocks of a fixed size, so
//! neither Python threads nor the module's own threads change a bit. The Python code beside this module
//! (`python/leastaction`) documents shapes, units and defaults.

mod adaptation;
mod arguments;
mod arm;
mod arrays;
mod attend;
mod blocks;
mod controller;
mod derivatives;
mod double;
mod errors;
mod facts;
mod model;
mod motion;
mod observer;
mod planning;
mod regulators;
mod single;
mod tools;
mod training;
mod viewer;

use pyo3::prelude::*;

/// The x86-64 instruction level of this machine, 4, 3 or 2; 0 on other machines.
#[pyfunction]
fn cpu_level() -> u8 {
    #[cfg(target_arch = "x86_64")]
    {
        use std::is_x86_feature_detected as has;
        let third = has!("avx2")
            && has!("fma")
            && has!("bmi1")
            && has!("bmi2")
            && has!("f16c")
            && has!("lzcnt")
            && has!("movbe");
        let fourth =
            has!("avx512f") && has!("avx512bw") && has!("avx512cd") && has!("avx512dq") && has!("avx512vl");
        match (third, fourth) {
            (true, true) => 4,
            (true, false) => 3,
            (false, _) => 2,
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    0
}

/// Contents of the extension module.
#[pymodule]
fn _leastaction(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(cpu_level, module)?)?;
    module.add_class::<model::Model>()?;
    module.add_class::<motion::Motions>()?;
    module.add_class::<observer::Observer>()?;
    module.add_class::<controller::Controller>()?;
    module.add_class::<planning::Plan>()?;
    module.add_function(wrap_pyfunction!(derivatives::jacobians, module)?)?;
    module.add_function(wrap_pyfunction!(planning::plan_motion, module)?)?;
    module.add_function(wrap_pyfunction!(regulators::linearize, module)?)?;
    module.add_function(wrap_pyfunction!(regulators::linearize_step, module)?)?;
    module.add_function(wrap_pyfunction!(regulators::regulator, module)?)?;
    module.add_function(wrap_pyfunction!(training::train_run, module)?)?;
    module.add_function(wrap_pyfunction!(training::defaults, module)?)?;
    module.add_function(wrap_pyfunction!(training::checked, module)?)?;
    module.add_function(wrap_pyfunction!(tools::look_at, module)?)?;
    module.add_function(wrap_pyfunction!(tools::evaluate, module)?)?;
    module.add_function(wrap_pyfunction!(adaptation::adapt, module)?)?;
    module.add_function(wrap_pyfunction!(tools::model_of_run, module)?)?;
    module.add_function(wrap_pyfunction!(tools::write_file, module)?)?;
    module.add_function(wrap_pyfunction!(tools::read_log, module)?)?;
    module.add_function(wrap_pyfunction!(viewer::scene, module)?)?;
    module.add_function(wrap_pyfunction!(viewer::model_of_description, module)?)?;
    module.add_function(wrap_pyfunction!(tools::import_symo, module)?)?;
    module.add_function(wrap_pyfunction!(tools::import_modlanet, module)?)?;
    module.add_function(wrap_pyfunction!(tools::import_lgnn, module)?)?;
    Ok(())
}
