//! Loaders of model files.

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use leastaction_core::constraints::Holonomic;
use leastaction_core::energy::graph::Edge;
use leastaction_core::forces::{
    Coulomb, Directional, Dissipation, PotentialCorrection, Servo, Sticking, Stops, Viscous,
};
use leastaction_core::model::{
    ArmModel, BodiesModel, FORMAT_VERSION, Family, GraphModel, InertiaNetworkModel, MAGIC, ModelError,
    ModularModel, parse,
};
use leastaction_core::scalar::{FileWeightFormat, Weights, f16};

static CRC: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC);

/// A whole model file or plan, placed as a linker would place it.
pub struct File {
    words: Vec<u32>,
    length: usize,
}

impl File {
    /// Creates a model file around these sections, with the prefix and the right checksum.
    #[must_use]
    pub fn of(sections: &[u8]) -> Self {
        Self::with(MAGIC, FORMAT_VERSION, sections)
    }

    /// Creates a file around these contents, with this prefix and the right checksum.
    #[must_use]
    pub fn with(magic: [u8; 4], version: u8, contents: &[u8]) -> Self {
        let length = magic.len() + 1 + contents.len() + 4;
        let mut words = vec![0_u32; length.div_ceil(4)];
        let bytes: &mut [u8] = &mut bytemuck::cast_slice_mut(&mut words)[..length];
        bytes[..4].copy_from_slice(&magic);
        bytes[4] = version;
        let (body, sum) = bytes.split_at_mut(length - 4);
        body[5..].copy_from_slice(contents);
        sum.copy_from_slice(&CRC.checksum(body).to_le_bytes());
        Self { words, length }
    }

    /// Bytes of the file.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.words)[..self.length]
    }
}

/// Every law, with networks of up to 8 units.
type Laws<'a, W, const N: usize> = (
    ((Viscous<f32, N>, Coulomb<f32, N>), (Dissipation<'a, W, N, 8, 2>, PotentialCorrection<'a, W, N, 8, 2>)),
    (Servo<f32, N>, (Directional<f32, N>, (Sticking<f32, N>, Stops<f32, N>))),
);

/// Loads the file as any family, and then like the programs of a chip. The latter may refuse a valid file only for its size, its precision
/// or its laws, and must accept nothing but valid files.
pub fn load(sections: &[u8]) {
    let file = File::of(sections);
    let parsed = parse(file.bytes());
    let bytes = file.bytes();
    match &parsed {
        Ok(parsed) => {
            let half = matches!(parsed.weights, Weights::Half(_));
            let loaded = if half {
                by_type::<f16>(bytes, &parsed.header.family)
            } else {
                by_type::<f32>(bytes, &parsed.header.family)
            };
            if let Err(error) = loaded {
                assert!(is_of_size(&error), "{error:?}");
            }
        }
        // Nothing is known of the file: a controller meets it in the same way.
        Err(_) => drop(InertiaNetworkModel::<2, 8, 2, f32, Laws<f32, 2>>::load(bytes)),
    }
}

fn is_of_size(error: &ModelError) -> bool {
    matches!(
        error,
        ModelError::Shape { .. } | ModelError::Law { .. } | ModelError::Graph(_) | ModelError::Tree(_)
    )
}

fn by_type<W: FileWeightFormat>(bytes: &[u8], family: &Family) -> Result<(), ModelError> {
    match family {
        Family::InertiaNetwork(inertia_network) if inertia_network.n() == 1 => {
            InertiaNetworkModel::<1, 8, 2, W, Laws<W, 1>>::load(bytes).map(drop)
        }
        Family::InertiaNetwork(_) => InertiaNetworkModel::<2, 8, 2, W, Laws<W, 2>>::load(bytes).map(drop),
        Family::Modular(modular) => {
            let name = modular.trees().next().map_or("", |tree| tree.name);
            ModularModel::<2, 5, 8, 2, W, Laws<W, 2>>::load(bytes, name).map(drop)
        }
        Family::Bodies(bodies) if bodies.n() == 1 => BodiesModel::<1, W, Laws<W, 1>>::load(bytes).map(drop),
        Family::Bodies(_) => BodiesModel::<2, W, Laws<W, 2>>::load(bytes).map(drop),
        Family::Arm(arm) if arm.n() == 1 => ArmModel::<1, W, Laws<W, 1>>::load(bytes).map(drop),
        Family::Arm(_) => ArmModel::<2, W, Laws<W, 2>>::load(bytes).map(drop),
        Family::Graph(graph) if graph.shape.dimension == 3 => graph_of::<3, W>(bytes, graph),
        Family::Graph(graph) => graph_of::<2, W>(bytes, graph),
        _ => Ok(()),
    }
}

fn graph_of<const D: usize, W: FileWeightFormat>(
    bytes: &[u8],
    graph: &leastaction_core::model::GraphHeader,
) -> Result<(), ModelError> {
    let name = graph.graphs().next().map_or("", |graph| graph.name);
    let mut edges = [Edge::default(); 8];
    let mut rods = [Holonomic::Anchor { node: 0, to: [0.0; D], length: 1.0 }; 4];
    GraphModel::<D, 11, 8, 2, W>::load(bytes, name, &mut edges, &mut rods).map(drop)
}
