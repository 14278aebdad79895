//! Weights of other programs.

use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_ground_truth::ManyBody;
use leastaction_learning::import::{Imported, lgnn, modlanet, symo};
use leastaction_models::file::encode;

/// Reads a file of tensors in the layout of each program: an imported model must have as many weights as its shape needs, and become a
/// model file.
pub fn safetensors(input: &[u8]) {
    let Some((program, bytes)) = input.split_first() else { return };
    let imported = match program % 4 {
        0 => symo(bytes, &[Coordinate::Angle]),
        1 => modlanet(bytes, ManyBody::Pendulum(2), None),
        2 => modlanet(bytes, ManyBody::Bodies(2), Some(1.0)),
        _ => lgnn(bytes, 2, true),
    };
    let Ok(Imported { architecture, weights, .. }) = imported else { return };
    assert_eq!(architecture.parameters().ok(), Some(weights.len()));
    // Weights may be too large for single precision.
    drop(encode(&architecture, &weights, None, "fuzz"));
}
