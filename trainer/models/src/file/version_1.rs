//! Files of version 1 of the format: a single postcard document, with the damping among the numbers of the element types. This module only
//! converts them to version 2.

use super::assemble;
use crate::TYPE_NUMBERS;
use leastaction_core::discrete::Order;
use leastaction_core::energy::MAX_HIDDEN;
use leastaction_core::energy::inertia_network::Inertia;
use leastaction_core::forces::ControlKind;
use leastaction_core::model::{
    Family, GraphHeader, Header, InertiaNetworkHeader, Laws, MAGIC, ModelError, ModularHeader, TrainedStep,
    checksum,
};
use leastaction_core::network::Activation;
use serde::Deserialize;

const VERSION: u8 = 1;

/// The whole file.
#[derive(Deserialize)]
struct Document<'a> {
    _magic: [u8; 4],
    _version: u8,
    #[serde(borrow)]
    family: OldFamily<'a>,
    step: Option<OldStep>,
    provenance: &'a str,
    padding: &'a [u8],
    weights: &'a [u8],
    _checksum: [u8; 4],
}

#[derive(Deserialize)]
#[allow(clippy::large_enum_variant, reason = "read once")]
enum OldFamily<'a> {
    #[serde(borrow)]
    InertiaNetwork(OldInertiaNetwork<'a>),
    Modular(ModularHeader<'a>),
    Graph(GraphHeader<'a>),
}

#[derive(Deserialize)]
struct OldInertiaNetwork<'a> {
    coordinates: &'a str,
    widths: [u16; MAX_HIDDEN],
    activation: Activation,
    inertia: Inertia,
    damped: bool,
}

#[derive(Deserialize)]
struct OldStep {
    order: u8,
    h: f32,
}

/// Whether the bytes are a file of version 1.
pub fn is(bytes: &[u8]) -> bool {
    bytes.get(..MAGIC.len()) == Some(&MAGIC) && bytes.get(MAGIC.len()) == Some(&VERSION)
}

/// Converts the file to version 2, with the same numbers to the last bit; the caller validates the result.
///
/// # Errors
/// [`ModelError`] for a wrong checksum or an invalid document.
pub fn converted(bytes: &[u8]) -> Result<Vec<u8>, ModelError> {
    check_sum(bytes)?;
    let document: Document = postcard::from_bytes(bytes).map_err(|_| ModelError::Malformed)?;
    if document.padding.len() > 3 || document.padding.iter().any(|byte| *byte != 0) {
        return Err(ModelError::OutOfRange { what: "padding" });
    }
    let trained_step = document.step.map(OldStep::converted).transpose()?;
    let (family, laws, weights) = document.family.converted(document.weights)?;
    let header = Header { laws, trained_step, provenance: document.provenance, ..Header::new(family) };
    assemble(&header, &weights).map_err(|_| ModelError::Malformed)
}

fn check_sum(bytes: &[u8]) -> Result<(), ModelError> {
    let (body, stored) = bytes.split_last_chunk::<4>().ok_or(ModelError::TooShort { bytes: bytes.len() })?;
    let (stored, computed) = (u32::from_le_bytes(*stored), checksum(body));
    if stored == computed { Ok(()) } else { Err(ModelError::Checksum { stored, computed }) }
}

impl OldStep {
    /// Version 1 did not state the behaviour of a control between samples: the losses took it to be linear.
    fn converted(self) -> Result<TrainedStep, ModelError> {
        let order = Order::from_number(self.order).ok_or(ModelError::OutOfRange { what: "order" })?;
        Ok(TrainedStep { order, h: self.h, control: ControlKind::Linear })
    }
}

impl<'a> OldFamily<'a> {
    /// Family, laws and weight block in version 2.
    fn converted(self, weights: &[u8]) -> Result<(Family<'a>, Laws<'static>, Vec<u8>), ModelError> {
        match self {
            Self::Graph(graph) => Ok((Family::Graph(graph), Laws::NONE, weights.to_vec())),
            Self::Modular(modular) => {
                let weights = with_damping_last(&modular, weights)?;
                Ok((Family::Modular(modular), Laws::VISCOUS, weights))
            }
            Self::InertiaNetwork(OldInertiaNetwork { coordinates, widths, activation, inertia, damped }) => {
                let laws = if damped { Laws::VISCOUS } else { Laws::NONE };
                let inertia_network = InertiaNetworkHeader { coordinates, widths, activation, inertia };
                Ok((Family::InertiaNetwork(inertia_network), laws, weights.to_vec()))
            }
        }
    }
}

/// Moves the damping of each type from its place after the type's length to the end of the block, after the networks,
/// the mass, inertia, centre and length of each element type, and c₁ and c₂.
fn with_damping_last(modular: &ModularHeader, weights: &[u8]) -> Result<Vec<u8>, ModelError> {
    let kinds = modular.shape.types.len();
    // Version 2 has the same numbers in another order.
    let needed = modular.parameters()? + kinds;
    let width = weights.len() / needed.max(1);
    let wrong = ModelError::WeightCount { found: weights.len() / size_of::<f32>(), needed };
    if !matches!(width, 2 | 4) || weights.len() != width * needed {
        return Err(wrong);
    }
    let numbers = TYPE_NUMBERS * kinds;
    let (networks, rest) = weights.split_at_checked(width * (needed - numbers - 2)).ok_or(wrong)?;
    let (types, coefficients) = rest.split_at_checked(width * numbers).ok_or(wrong)?;
    let (mut parameters, mut damping) = (Vec::new(), Vec::new());
    for kind in types.chunks(width * TYPE_NUMBERS) {
        let (own, of_damping) = kind.split_at_checked(width * (TYPE_NUMBERS - 1)).ok_or(wrong)?;
        parameters.extend_from_slice(own);
        damping.extend_from_slice(of_damping);
    }
    Ok([networks, &parameters, coefficients, &damping].concat())
}
