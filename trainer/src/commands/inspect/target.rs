//! Report of a model's cost on a processor.

use clap::ValueEnum;
use leastaction_cost::processor::{Prediction, Processor, Taken};
use serde::Serialize;
use std::fmt;

/// A processor to predict for.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Target {
    /// Cortex-M4F.
    #[value(name = "cortex-m4f")]
    CortexM4f,
    /// Cortex-M7 with a single-precision floating-point unit.
    #[value(name = "cortex-m7")]
    CortexM7,
}

impl Target {
    /// The processor.
    pub fn processor(self) -> Processor {
        match self {
            Self::CortexM4f => Processor::CortexM4f,
            Self::CortexM7 => Processor::CortexM7,
        }
    }
}

/// A prediction, and the known memory.
#[derive(Serialize)]
pub struct OnTarget {
    /// Fitted prediction.
    #[serde(flatten)]
    pub prediction: Prediction,
    /// Bytes of the model file, which stays in flash.
    pub model_bytes: usize,
    /// Bytes of static RAM.
    pub static_ram_bytes: usize,
}

impl fmt::Display for OnTarget {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Prediction { processor, acceleration, step_order_2, step_order_4, code_bytes } = &self.prediction;
        writeln!(
            f,
            "\npredicted for a {processor}: an image compiled for exactly these sizes at opt-level 2 with the flags of firmware-sim/chip,\n\
             with its loader; a step takes two updates of Newton's method by one Jacobian. `firmware-sim/chip/shapes.sh model.rs` measures"
        )?;
        writeln!(f, "{:<30} {:>13} {:>13} {:>13}", "", "instructions", "stack bytes", "code bytes")?;
        let row = |f: &mut fmt::Formatter, name: &str, taken: &Taken, code: String| {
            let Taken { instructions, stack_bytes } = taken;
            writeln!(f, "{name:<30} {instructions:>13} {stack_bytes:>13} {code:>13}")
        };
        let [second, fourth] = code_bytes;
        row(f, "acceleration", acceleration, String::new())?;
        row(f, "step, order 2", step_order_2, second.to_string())?;
        row(f, "step, order 4", step_order_4, fourth.to_string())?;
        writeln!(
            f,
            "flash: code and {} bytes of model; static RAM {} bytes",
            self.model_bytes, self.static_ram_bytes
        )
    }
}
