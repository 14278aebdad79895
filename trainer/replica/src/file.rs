use crate::particles::{ParticleSystem, RodsOf};
use crate::sizes::{AnySystem, Load};
use crate::{AnyLagrangian, ForcesOf, INERTIA_NETWORK_UNITS, LAYERS, Replica, ReplicaError, SystemOf, UNITS};
use leastaction_core::energy::arm::ArmBodies;
use leastaction_core::energy::bodies::PlanarBodies;
use leastaction_core::energy::graph::Edge;
use leastaction_core::energy::inertia_network::InertiaNetwork;
use leastaction_core::energy::modular::{MAX_TYPES, Modular};
use leastaction_core::forces::System;
use leastaction_core::model::{
    ArmHeader, BodiesHeader, Family, GraphHeader, GraphLayout, InertiaNetworkHeader, Laws, ModelError,
    ModularHeader, Parsed, TreeHeader, parse,
};

/// A validated model file in memory, with its weights widened to single precision.
pub struct ModelFile {
    words: Vec<u32>,
    length: usize,
    weights: Vec<f32>,
    /// Edges and rods of each graph, in order.
    graphs: Vec<Lists>,
}

/// Lists of a graph.
struct Lists {
    edges: Vec<Edge>,
    plane: RodsOf<2>,
    space: RodsOf<3>,
}

impl ModelFile {
    /// Reads a file of the current version of the format; `bytes` may lie at any address.
    ///
    /// # Errors
    /// [`ReplicaError::Model`] for invalid bytes.
    pub fn new(bytes: &[u8]) -> Result<Self, ReplicaError> {
        let mut file = Self::aligned(bytes);
        let Parsed { header, weights } = file.parsed()?;
        let weights = weights.iter().collect();
        let graphs = match header.family {
            Family::Graph(graph) => graph.graphs().map(|layout| Lists::new(&graph, layout)).collect(),
            _ => Vec::new(),
        };
        (file.weights, file.graphs) = (weights, graphs);
        Ok(file)
    }

    fn aligned(bytes: &[u8]) -> Self {
        let mut words = vec![0_u32; bytes.len().div_ceil(size_of::<u32>())];
        bytemuck::cast_slice_mut::<u32, u8>(&mut words)
            .iter_mut()
            .zip(bytes)
            .for_each(|(to, from)| *to = *from);
        Self { words, length: bytes.len(), weights: Vec::new(), graphs: Vec::new() }
    }

    fn parsed(&self) -> Result<Parsed<'_>, ModelError> {
        parse(bytemuck::cast_slice(&self.words).get(..self.length).unwrap_or_default())
    }

    /// Shape, laws and weights of a model of bodies, which determine its system.
    pub(crate) fn changeable(&self) -> Result<(Family<'_>, Laws<'_>, &[f32]), ModelError> {
        let Parsed { header, .. } = self.parsed()?;
        match header.family {
            Family::Bodies(_) | Family::Arm(_) => Ok((header.family, header.laws, &self.weights)),
            other => Err(ModelError::OtherFamily { found: other.name() }),
        }
    }

    /// Returns the model; of several trees or graphs the one with the given name, or the first if no name is given.
    ///
    /// # Errors
    /// [`ReplicaError::Model`] if no tree or graph has that name, or there are more layers, units or types than this program is compiled
    /// for; [`ReplicaError::Coordinates`] for a number of coordinates that it is not compiled for.
    pub fn replica(&self, part: Option<&str>) -> Result<Replica<'_>, ReplicaError> {
        let Parsed { header, .. } = self.parsed()?;
        let (laws, weights) = (header.laws, self.weights.as_slice());
        let (system, is_first) = match header.family {
            Family::InertiaNetwork(shape) => {
                (AnySystem::load(shape.n(), InertiaNetworkLoader { header: shape, laws, weights })?, true)
            }
            Family::Modular(modular) => self.tree(modular, laws, part)?,
            Family::Graph(graph) => self.graph(&graph, laws, part)?,
            Family::Bodies(shape) => {
                (AnySystem::load(shape.n(), BodiesLoader { header: shape, laws, weights })?, true)
            }
            Family::Arm(shape) => {
                (AnySystem::load(shape.n(), ArmLoader { header: shape, laws, weights })?, true)
            }
            other => return Err(ModelError::OtherFamily { found: other.name() }.into()),
        };
        // The range of the training data belongs to the first tree or graph.
        let range = header.range.filter(|_| is_first);
        Ok(Replica::new(system, header.trained_step, range, header.actuator))
    }

    fn tree<'f>(
        &'f self,
        header: ModularHeader<'f>,
        laws: Laws<'f>,
        name: Option<&str>,
    ) -> Result<(AnySystem<'f>, bool), ReplicaError> {
        let none = ModelError::NoSuchTree { trees: header.trees().count() };
        let (index, tree) = named(header.trees(), |tree| tree.name, name).ok_or(none)?;
        let tree = *tree;
        let n = tree.coordinates(&header.shape).ok_or(none)?;
        let system = AnySystem::load(n, TreeLoader { header, tree, laws, weights: &self.weights })?;
        Ok((system, index == 0))
    }

    fn graph<'f>(
        &'f self,
        header: &GraphHeader<'f>,
        laws: Laws,
        name: Option<&str>,
    ) -> Result<(AnySystem<'f>, bool), ReplicaError> {
        let none = ModelError::NoSuchGraph { graphs: header.graphs().count() };
        // Graphs have their drag in their node types, and no other law yet.
        if let Some(law) = laws.iter().next() {
            return Err(ModelError::Law { number: law as u8 }.into());
        }
        let (index, layout) = named(header.graphs(), |graph| graph.name, name).ok_or(none)?;
        let Lists { edges, plane, space } = self.graphs.get(index).ok_or(none)?;
        let (nodes, weights) = (layout.nodes, self.weights.as_slice());
        let system = if header.shape.dimension == 3 {
            AnySystem::Space(Box::new(ParticleSystem::new(header.types(weights)?, (nodes, edges), space)?))
        } else {
            AnySystem::Plane(Box::new(ParticleSystem::new(header.types(weights)?, (nodes, edges), plane)?))
        };
        Ok((system, index == 0))
    }
}

impl Lists {
    /// Creates the lists; the rods have the dimension of the graph.
    fn new(header: &GraphHeader, layout: &GraphLayout) -> Self {
        let is_in_space = header.shape.dimension == 3;
        let rods = |dimensions| layout.rods().filter(move |_| is_in_space == (dimensions == 3));
        Self {
            edges: layout.edges().collect(),
            plane: rods(2).map(|rod| rod.constraint()).collect(),
            space: rods(3).map(|rod| rod.constraint()).collect(),
        }
    }
}

/// Returns the part of that name with its position, or the first part if no name is given.
fn named<'p, P: 'p>(
    mut parts: impl Iterator<Item = &'p P>,
    name_of: impl Fn(&'p P) -> &'p str,
    name: Option<&str>,
) -> Option<(usize, &'p P)> {
    parts.by_ref().enumerate().find(|(_, part)| name.is_none_or(|name| name_of(part) == name))
}

/// A loader for a family whose shape and laws determine its system.
macro_rules! loader {
    ($(#[$doc:meta])* $loader:ident, $header:ident, $energies:ty) => {
        $(#[$doc])*
        pub(crate) struct $loader<'f> {
            pub header: $header<'f>,
            pub laws: Laws<'f>,
            pub weights: &'f [f32],
        }

        impl<'f> Load<'f> for $loader<'f> {
            fn load<const N: usize>(self) -> Result<SystemOf<'f, N>, ModelError> {
                let system: System<$energies, ForcesOf<'f, N>> = self.header.system(self.laws, self.weights)?;
                Ok(AnyLagrangian::erased(system))
            }
        }
    };
}

loader!(
    /// Loads inertia networks.
    InertiaNetworkLoader, InertiaNetworkHeader, InertiaNetwork<'f, f32, N, INERTIA_NETWORK_UNITS, LAYERS>
);
loader!(
    /// Loads trees of bodies in the plane.
    BodiesLoader, BodiesHeader, PlanarBodies<'f, f32, N>
);
loader!(
    /// Loads trees of bodies in space.
    ArmLoader, ArmHeader, ArmBodies<'f, f32, N>
);

/// Loads trees.
struct TreeLoader<'f> {
    header: ModularHeader<'f>,
    tree: TreeHeader<'f>,
    laws: Laws<'f>,
    weights: &'f [f32],
}

impl<'f> Load<'f> for TreeLoader<'f> {
    fn load<const N: usize>(self) -> Result<SystemOf<'f, N>, ModelError> {
        let system: System<Modular<'f, f32, N, MAX_TYPES, UNITS, LAYERS>, ForcesOf<'f, N>> =
            self.header.system(&self.tree, self.laws, self.weights)?;
        Ok(AnyLagrangian::erased(system))
    }
}
