//! The model file: checksummed sections, with the weights in an aligned block that is borrowed in place.
//!
//! The byte table is in `core/FORMAT.md`. Loading validates everything once; after that, evaluation cannot fail except numerically.
//!
//! The type of a model names the family, the sizes and the laws of force that the program is compiled for: [`InertiaNetworkModel`],
//! [`ModularModel`], [`GraphModel`], [`BodiesModel`] or [`ArmModel`]. On the host, [`parse`] reads a file of any family, and
//! [`write`](fn@write) writes one.

/// Calls a macro with the only list of families: shape, number in a file, and name.
macro_rules! with_families {
    ($then:ident) => {
        $then! {
            /// Inertia matrix and potential from one network.
            InertiaNetwork(InertiaNetworkHeader): 0, "inertia-network";
            /// Trees of reusable elements.
            Modular(ModularHeader): 1, "modular";
            /// Particles with energies of nodes and edges.
            Graph(GraphHeader): 2, "graph";
            /// A tree of rigid bodies on joints in the plane.
            Bodies(BodiesHeader): 3, "bodies";
            /// A tree of rigid bodies on joints in space.
            Arm(ArmHeader): 4, "arm";
        }
    };
}

mod actuator;
mod arm;
mod bodies;
mod catalogue;
mod error;
mod families;
mod graph;
mod header;
mod inertia_network;
mod law_network;
mod law_numbers;
mod laws;
mod layout;
mod load_forces;
mod loaded;
mod modular;
mod parse;
mod range;
mod section;
mod step;
mod tuned;
mod write;

pub use crate::energy::MAX_HIDDEN;
pub use actuator::ActuatorBytes;
pub use arm::{ArmHeader, ArmModel};
pub use bodies::{BodiesHeader, BodiesModel};
pub(crate) use catalogue::entry;
pub use catalogue::{CATALOGUE, Coded, Entry, entry_of};
pub use error::ModelError;
pub use families::Family;
pub use graph::{GraphHeader, GraphLayout, GraphModel, GraphSystem, MAX_GRAPHS, ORIGIN, Rod};
pub use header::{FORMAT_VERSION, Header, MAGIC};
pub use inertia_network::{InertiaNetworkHeader, InertiaNetworkModel};
pub use law_network::LawNetwork;
pub use law_numbers::{DirectionalNumber, FrictionNumber, NumberRange, StickingNumber, StopsNumber};
pub use laws::{Law, Laws};
pub use layout::Layout;
pub use load_forces::{LawNumbers, LoadForces};
pub use loaded::Model;
pub use modular::{MAX_TREES, ModularHeader, ModularModel, TreeHeader};
pub(crate) use parse::unpadded;
pub use parse::{Parsed, ParsedAs, ShapeHeader, fingerprint, parse, parse_as, stored_fingerprint};
pub use range::{CoordinateRange, Interval, Outside, TrainingRange};
pub use section::{Section, Sections};
pub use step::TrainedStep;
pub use tuned::Tuned;
pub(crate) use write::File;
pub use write::{WriteError, write};

use crate::checksum::Checksum;

/// Length of the checksum at the end of a file, bytes.
pub(crate) const CRC_BYTES: usize = 4;
/// Maximum number of padding bytes that bring the weights to a multiple of 4.
const MAX_PADDING: usize = 3;
/// Length of the magic letters and the version, bytes.
pub(crate) const PREFIX_BYTES: usize = MAGIC.len() + 1;

/// Computes the checksum at the end of a file, CRC-32/ISO-HDLC, from all bytes before it.
pub fn checksum(body: &[u8]) -> u32 {
    Checksum::new().over(body).value()
}
