//! A model file as a C header, for programs without a file system.

use super::decode;
use crate::Model;
use leastaction_core::model::ModelError;
use std::fmt::{self, Write};

/// Number of bytes in a line of the array.
const BYTES_A_LINE: usize = 16;

/// First words of every header.
pub const C_HEAD: &str = "/* A learned Lagrangian:";

/// Returns a header for C and C++ that holds the model file as an aligned constant of the given name, with its sizes, for
/// `leastaction_load` of the C library. Characters that no C identifier may contain become underscores.
///
/// # Errors
/// [`ModelError`]: what is wrong with the bytes.
pub fn c_source(bytes: &[u8], name: &str) -> Result<String, ModelError> {
    let model = decode(bytes)?;
    let mut source = String::new();
    // Writing to a string cannot fail.
    let _infallible = write_source(&mut source, &model, bytes, &identifier(name));
    Ok(source)
}

/// The name as a C identifier.
fn identifier(name: &str) -> String {
    let allowed = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = name.chars().map(allowed).collect();
    if name.chars().next().is_none_or(|first| first.is_ascii_digit()) { format!("m{name}") } else { name }
}

fn write_source(to: &mut String, model: &Model, bytes: &[u8], name: &str) -> fmt::Result {
    let (upper, length) = (name.to_ascii_uppercase(), bytes.len());
    let Model { architecture, weights, facts, .. } = model;
    writeln!(to, "{C_HEAD} {} parameters, {length} bytes.", weights.len())?;
    for line in facts.provenance.lines() {
        writeln!(to, "   {}", line.trim_end().replace("*/", "* /"))?;
    }
    writeln!(to, "*/\n#ifndef {upper}_H\n#define {upper}_H\n\n#include <stdint.h>\n")?;
    writeln!(to, "/* Family: {}. Coordinates: {}. */", architecture.name(), architecture.coordinates())?;
    writeln!(to, "#define {upper}_COORDINATES {}", architecture.n())?;
    if let Some(step) = facts.trained_step {
        writeln!(to, "/* The step that it was trained with, s, and its order. */")?;
        writeln!(to, "#define {upper}_STEP {:?}f\n#define {upper}_ORDER {}", step.h, step.order)?;
    }
    writeln!(to, "#define {upper}_BYTES {length}\n")?;
    writeln!(to, "/* The file, at a multiple of 4 as the weights need it. */")?;
    writeln!(to, "#ifdef __cplusplus\nalignas(4)\n#else\n_Alignas(4)\n#endif")?;
    writeln!(to, "static const uint8_t {name}[{upper}_BYTES] = {{")?;
    for line in bytes.chunks(BYTES_A_LINE) {
        write!(to, "   ")?;
        line.iter().try_for_each(|byte| write!(to, " {byte:#04x},"))?;
        writeln!(to)?;
    }
    writeln!(to, "}};\n\n#endif")
}
