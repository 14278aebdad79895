//! Model files of the emulated chips.

use std::path::Path;

/// The bytes of a model file.
pub fn model(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../firmware-sim/chip/models");
    std::fs::read(folder.join(format!("{name}.postcard"))).unwrap()
}
