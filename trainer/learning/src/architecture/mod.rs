//! The shape of a model on the host, where widths and the number of coordinates are known only at run time.

mod graph;
mod lgnn;
mod modular;
mod rigid;

pub use graph::{GraphArchitecture, GraphType, HostTypes, MAX_WIDTH as MAX_GRAPH_WIDTH, NamedGraph};
pub use modular::{ModularArchitecture, NamedTree, NamedType, Number, TYPE_NUMBERS};
pub use rigid::{HostSystem, RigidArchitecture, largest_factor};

use leastaction_core::energy::NetworkShape;
use leastaction_core::model::{Family as FamilyHeader, Header, Law, Laws, ModelError};
use leastaction_core::network::Dense;
use leastaction_programs::dynamics::Rods;
use leastaction_programs::energies::{Energies, GraphEnergies, ModularEnergies};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// Coordinates of a rigid model at most, as in a model file.
pub const MAX_COORDINATES: usize = 16;
/// Units of a hidden layer at most.
pub const MAX_UNITS: usize = 1024;
/// Units of a hidden layer of a network of an element, a node or an edge at most.
pub const MAX_ELEMENT_UNITS: usize = MAX_GRAPH_WIDTH;
/// Coordinates of a tree at most, as in a model file.
pub const MAX_TREE_COORDINATES: usize = 64;
/// Coordinates at most of a graph to train: the mass matrix of a sample is dense, and takes a pass over the graph for each of them.
pub const MAX_GRAPH_COORDINATES: usize = 192;
/// Hidden layers at most, as in a model file.
pub use leastaction_core::energy::MAX_HIDDEN;

/// Hidden layers at most of what is compiled for its sizes: the firmware loop of this machine, and the counting of operations.
pub const DEPTH: usize = 3;
/// Units of a hidden layer of a rigid model at most that is compiled for its sizes.
pub const MAX_WIDTH: usize = 256;

/// The shape of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Architecture {
    /// Inertia matrix and potential from one network.
    Rigid(RigidArchitecture),
    /// A tree of elements.
    Modular(ModularArchitecture),
    /// A graph of particles.
    Graph(GraphArchitecture),
}

impl From<GraphArchitecture> for Architecture {
    fn from(graph: GraphArchitecture) -> Self {
        Self::Graph(graph)
    }
}

impl From<RigidArchitecture> for Architecture {
    fn from(rigid: RigidArchitecture) -> Self {
        Self::Rigid(rigid)
    }
}

impl From<ModularArchitecture> for Architecture {
    fn from(modular: ModularArchitecture) -> Self {
        Self::Modular(modular)
    }
}

impl Architecture {
    /// The shape that a model file has; of several trees the first.
    ///
    /// # Errors
    /// [`ModelError::OtherFamily`] for a family that this program does not know, [`ModelError::Law`] for a law of force.
    pub fn from_header(header: &FamilyHeader, laws: Laws, weights: &[f64]) -> Result<Self, ModelError> {
        if let Some(law) = laws.iter().find(|law| *law != Law::Viscous) {
            return Err(ModelError::Law { number: law as u8 });
        }
        match header {
            FamilyHeader::Rigid(rigid) => Ok(RigidArchitecture::from_header(rigid, laws).into()),
            FamilyHeader::Modular(modular) => Ok(ModularArchitecture::from_header(modular, weights).into()),
            FamilyHeader::Graph(graph) => Ok(GraphArchitecture::from_header(graph, weights).into()),
            other => Err(ModelError::OtherFamily { found: other.name() }),
        }
    }

    /// The shape, if it is of the rigid family.
    pub fn rigid(&self) -> Option<&RigidArchitecture> {
        match self {
            Self::Rigid(rigid) => Some(rigid),
            Self::Modular(_) | Self::Graph(_) => None,
        }
    }

    /// The shape, if it is of the modular family.
    pub fn modular(&self) -> Option<&ModularArchitecture> {
        match self {
            Self::Modular(modular) => Some(modular),
            Self::Rigid(_) | Self::Graph(_) => None,
        }
    }

    /// The shape, if it is of the graph family.
    pub fn graph(&self) -> Option<&GraphArchitecture> {
        match self {
            Self::Graph(graph) => Some(graph),
            Self::Rigid(_) | Self::Modular(_) => None,
        }
    }

    /// What a model of several mechanisms calls them, tree or graph, and the name of the one that is meant.
    pub fn part(&self) -> Option<(&'static str, &str)> {
        match self {
            Self::Rigid(_) => None,
            Self::Modular(modular) => Some(("tree", modular.tree_name())),
            Self::Graph(graph) => Some(("graph", graph.graph().map_or("", |graph| &graph.name))),
        }
    }

    /// The names of all trees or graphs.
    pub fn parts(&self) -> Vec<&str> {
        match self {
            Self::Rigid(_) => Vec::new(),
            Self::Modular(modular) => modular.trees.iter().map(|tree| tree.name.as_str()).collect(),
            Self::Graph(graph) => graph.graphs.iter().map(|graph| graph.name.as_str()).collect(),
        }
    }

    /// The same with the tree or graph of that name in mind; `None` where there is none.
    #[must_use]
    pub fn with_part_named(&self, name: &str) -> Option<Self> {
        match self {
            Self::Rigid(_) => None,
            Self::Modular(modular) => modular.with_tree_named(name).map(Self::from),
            Self::Graph(graph) => graph.with_graph_named(name).map(Self::from),
        }
    }

    /// Whether evaluation steps it by the discrete Euler–Lagrange equation: it has no rods.
    pub fn has_steps(&self) -> bool {
        !self.graph().is_some_and(GraphArchitecture::has_rods)
    }

    /// Calls `read` with the shape in the words of the model file.
    pub fn with_header<T>(&self, read: impl FnOnce(FamilyHeader) -> T) -> T {
        match self {
            Self::Rigid(rigid) => read(FamilyHeader::Rigid(rigid.header())),
            Self::Modular(modular) => read(FamilyHeader::Modular(modular.header())),
            Self::Graph(graph) => graph.with_header(|header| read(FamilyHeader::Graph(header))),
        }
    }

    /// The unit of every coordinate, as a model file has them; of graphs, all of whose coordinates are lengths, one.
    pub fn units(&self) -> String {
        if self.graph().is_some() {
            return "m".to_owned();
        }
        let unit = |letter| match letter {
            't' => "m",
            'a' => "rad",
            _ => "",
        };
        self.coordinates().chars().map(unit).collect::<Vec<_>>().join(",")
    }

    /// What the family is called.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Rigid(_) => "rigid",
            Self::Modular(_) => "modular",
            Self::Graph(_) => "graph",
        }
    }

    /// One letter a coordinate: `t` translation, `a` angle, `c` cyclic.
    pub fn coordinates(&self) -> String {
        match self {
            Self::Rigid(rigid) => rigid.coordinates.clone(),
            Self::Modular(modular) => modular.coordinates(),
            Self::Graph(graph) => "t".repeat(graph.n()),
        }
    }

    /// Every hidden layer's units.
    pub fn widths(&self) -> Vec<usize> {
        match self {
            Self::Rigid(rigid) => rigid.widths.iter().map(|width| usize::from(*width)).collect(),
            Self::Modular(modular) => modular.shape.networks.iter().flat_map(hidden).collect(),
            Self::Graph(graph) => graph.shape.networks.iter().flat_map(hidden).collect(),
        }
    }

    /// Hidden layers of the deepest network.
    pub fn depth(&self) -> usize {
        match self {
            Self::Rigid(rigid) => rigid.widths.len(),
            Self::Modular(modular) => modular.shape.networks.iter().map(|n| n.widths().1).max().unwrap_or(0),
            Self::Graph(graph) => graph.shape.networks.iter().map(|n| n.widths().1).max().unwrap_or(0),
        }
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        match self {
            Self::Rigid(rigid) => rigid.n(),
            Self::Modular(modular) => modular.n(),
            Self::Graph(graph) => graph.n(),
        }
    }

    /// Numbers in the weight block.
    ///
    /// # Errors
    /// Where the shape is out of the format's range.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        self.with_header(|family| Header { laws: self.laws(), ..Header::new(family) }.parameters())
    }

    /// The laws of force beside the energies, whose numbers end the weight block.
    pub fn laws(&self) -> Laws<'static> {
        match self {
            Self::Rigid(rigid) => rigid.laws(),
            Self::Modular(_) => Laws::VISCOUS,
            Self::Graph(_) => Laws::NONE,
        }
    }

    /// Numbers in the weight block that training changes.
    ///
    /// # Errors
    /// Where the shape is out of the format's range.
    pub fn learned_parameters(&self) -> Result<usize, ModelError> {
        Ok(self.parameters()? - self.fixed_positions().len())
    }

    /// Random weights where they are learned, the given numbers elsewhere.
    pub fn initial_weights(&self, seed: u64) -> Vec<f64> {
        match self {
            Self::Rigid(rigid) => rigid.initial_weights(seed),
            Self::Modular(modular) => modular.initial_weights(seed),
            Self::Graph(graph) => graph.initial_weights(seed),
        }
    }

    /// Where in the weight block the damping of each coordinate is; empty where there is none.
    pub fn damping_positions(&self) -> Vec<usize> {
        match self {
            Self::Rigid(rigid) => rigid.damping_positions(),
            Self::Modular(modular) => modular.damping_positions(),
            Self::Graph(_) => Vec::new(),
        }
    }

    /// The numbers of the weight block that training must leave as they are.
    pub fn fixed_positions(&self) -> Vec<usize> {
        match self {
            Self::Rigid(_) => Vec::new(),
            Self::Modular(modular) => modular.fixed_positions(),
            Self::Graph(graph) => graph.fixed_positions(),
        }
    }

    /// Brings numbers that have a range (masses, damping) back into it.
    pub fn project(&self, weights: &mut [f64]) {
        match self {
            Self::Rigid(_) => {}
            Self::Modular(modular) => modular.project(weights),
            Self::Graph(graph) => graph.project(weights),
        }
        for position in self.damping_positions() {
            if let Some(damping) = weights.get_mut(position) {
                *damping = damping.max(0.0);
            }
        }
    }

    /// Its energies and forces, written down for the tree or graph that is meant.
    ///
    /// # Errors
    /// [`ModelError`] where the shape does not fit in itself.
    pub fn energies(&self) -> Result<Box<dyn Energies>, ModelError> {
        match self {
            Self::Rigid(rigid) => Ok(Box::new(rigid.energies()?)),
            Self::Modular(modular) => {
                let elements: Vec<_> = modular.tree_header().nodes().collect();
                Ok(Box::new(ModularEnergies::new(&modular.shape, &elements, true)?))
            }
            Self::Graph(graph) => {
                let NamedGraph { nodes, edges, .. } = graph.graph()?;
                Ok(Box::new(GraphEnergies::new(&graph.shape, nodes, edges, 0)?))
            }
        }
    }

    /// The rods of the graph that is meant; none of another family.
    ///
    /// # Errors
    /// Where there is no such graph.
    pub fn rods(&self) -> Result<Rods, ModelError> {
        let Some(graph) = self.graph() else { return Ok(Rods::default()) };
        Ok(Rods::new(graph.dimension(), &graph.graph()?.rods))
    }
}

/// Random weights of layers of these inputs and outputs: uniform with Glorot's variance, biases zero.
pub fn random_layers(layers: impl IntoIterator<Item = (usize, usize)>, seed: u64) -> Vec<f64> {
    let (mut stream, mut weights) = (Pcg64::seed_from_u64(seed), Vec::new());
    for (inputs, outputs) in layers {
        uniform_layer(&mut weights, inputs, outputs, &mut stream);
    }
    weights
}

/// The positions, from `start` on, of the numbers that are known.
fn known_positions(start: usize, numbers: impl Iterator<Item = Number>) -> Vec<usize> {
    (start..).zip(numbers).filter(|(_, number)| !number.learned).map(|(position, _)| position).collect()
}

/// Appends a layer: uniform with Glorot's variance, biases zero.
fn uniform_layer(weights: &mut Vec<f64>, inputs: usize, outputs: usize, stream: &mut impl Rng) {
    let limit = (6.0 / (inputs + outputs) as f64).sqrt();
    let mut layer = vec![0.0; inputs * outputs];
    for i in 0..outputs {
        for j in 0..inputs {
            layer[Dense::<f64>::position(inputs, outputs, i, j)] = stream.random_range(-limit..limit);
        }
    }
    weights.extend(layer);
    weights.extend(std::iter::repeat_n(0.0, outputs));
}

/// Units of the hidden layers.
fn hidden(network: &NetworkShape) -> impl Iterator<Item = usize> + use<> {
    let (widths, depth) = network.widths();
    widths.into_iter().take(depth)
}

/// Inputs and outputs of every layer, first to last.
fn layers(network: &NetworkShape) -> Vec<(usize, usize)> {
    let mut sizes = vec![usize::from(network.inputs)];
    sizes.extend(hidden(network));
    sizes.push(network.outputs.into());
    sizes.windows(2).map(|pair| (pair[0], pair[1])).collect()
}
