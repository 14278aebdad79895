//! The shape of a model on the host, where widths and the number of coordinates are known only at run time.

mod arm;
mod bodies;
mod corrections;
mod family;
mod friction;
mod graph;
mod lgnn;
mod modular;
mod names;
mod rigid;

pub use arm::{ArmArchitecture, ArmBody};
pub use bodies::{BodiesArchitecture, BodyNumbers};
pub use corrections::{CorrectionNetwork, Corrections, DissipationNetwork};
pub use family::Family;
pub use friction::{CoordinateFriction, FrictionArchitecture, MOST_LOAD, WIDTHS};
pub use graph::{GraphArchitecture, GraphType, HostTypes, MAX_WIDTH as MAX_GRAPH_WIDTH, NamedGraph};
pub use modular::{ModularArchitecture, NamedTree, NamedType, Number, TYPE_NUMBERS};
pub use names::NumberName;
pub use rigid::{HostSystem, RigidArchitecture, largest_factor};

use crate::training::{Bounds, Range};
use friction::dry_friction;
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::bodies::Joint;
use leastaction_core::model::{Family as FamilyHeader, Header, Law, Laws, ModelError};
use leastaction_core::network::Dense;
use leastaction_programs::dynamics::Rods;
use leastaction_programs::energies::{Energies, WithFriction};
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

/// The shape of a model: energies of a family, friction beside them, and networks that correct both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Architecture {
    /// The energies, with the forces that the family has of its own.
    pub family: Family,
    /// Friction beside those.
    pub friction: FrictionArchitecture,
    /// Networks beside both.
    pub corrections: Corrections,
}

impl<F: Into<Family>> From<F> for Architecture {
    fn from(family: F) -> Self {
        Self {
            family: family.into(),
            friction: FrictionArchitecture::default(),
            corrections: Corrections::default(),
        }
    }
}

impl Architecture {
    /// The shape that a model file has; of several trees the first. All numbers of laws are known.
    ///
    /// # Errors
    /// [`ModelError::OtherFamily`] for a family that this program does not know, [`ModelError::Law`] for a law of force that the
    /// family cannot have.
    pub fn from_header(header: &FamilyHeader, laws: Laws, weights: &[f64]) -> Result<Self, ModelError> {
        let family = Family::from_header(header, laws, weights)?;
        if let Some(law) = laws.iter().next().filter(|_| family.groups() == 0) {
            return Err(ModelError::Law { number: law as u8 });
        }
        let corrections = Corrections::from_laws(laws, weights);
        let weights = weights.get(..weights.len().saturating_sub(corrections.count())).unwrap_or_default();
        let friction = FrictionArchitecture::from_laws(laws, family.laws(), family.groups(), weights);
        Ok(Self { family, friction, corrections })
    }

    /// The shape, if it is of the rigid family.
    pub fn rigid(&self) -> Option<&RigidArchitecture> {
        match &self.family {
            Family::Rigid(rigid) => Some(rigid),
            _ => None,
        }
    }

    /// The shape, if it is of the modular family.
    pub fn modular(&self) -> Option<&ModularArchitecture> {
        match &self.family {
            Family::Modular(modular) => Some(modular),
            _ => None,
        }
    }

    /// The shape, if it is of the graph family.
    pub fn graph(&self) -> Option<&GraphArchitecture> {
        match &self.family {
            Family::Graph(graph) => Some(graph),
            _ => None,
        }
    }

    /// The shape, if it is of the family of bodies.
    pub fn bodies(&self) -> Option<&BodiesArchitecture> {
        match &self.family {
            Family::Bodies(bodies) => Some(bodies),
            _ => None,
        }
    }

    /// The shape, if it is of the family of arms.
    pub fn arm(&self) -> Option<&ArmArchitecture> {
        match &self.family {
            Family::Arm(arm) => Some(arm),
            _ => None,
        }
    }

    /// What a model of several mechanisms calls them, tree or graph, and the name of the one that is meant.
    pub fn part(&self) -> Option<(&'static str, &str)> {
        match &self.family {
            Family::Rigid(_) | Family::Bodies(_) | Family::Arm(_) => None,
            Family::Modular(modular) => Some(("tree", modular.tree_name())),
            Family::Graph(graph) => Some(("graph", graph.graph().map_or("", |graph| &graph.name))),
        }
    }

    /// The names of all trees or graphs.
    pub fn parts(&self) -> Vec<&str> {
        match &self.family {
            Family::Rigid(_) | Family::Bodies(_) | Family::Arm(_) => Vec::new(),
            Family::Modular(modular) => modular.trees.iter().map(|tree| tree.name.as_str()).collect(),
            Family::Graph(graph) => graph.graphs.iter().map(|graph| graph.name.as_str()).collect(),
        }
    }

    /// The same with the tree or graph of that name in mind; `None` where there is none.
    #[must_use]
    pub fn with_part_named(&self, name: &str) -> Option<Self> {
        match &self.family {
            Family::Rigid(_) | Family::Bodies(_) | Family::Arm(_) => None,
            Family::Modular(modular) => self.with_family(modular.with_tree_named(name)?),
            Family::Graph(graph) => self.with_family(graph.with_graph_named(name)?),
        }
    }

    /// The same friction and networks beside other energies.
    fn with_family(&self, family: impl Into<Family>) -> Option<Self> {
        Some(Self { family: family.into(), ..self.clone() })
    }

    /// Whether evaluation steps it by the discrete Euler–Lagrange equation: it has no rods.
    pub fn has_steps(&self) -> bool {
        !self.graph().is_some_and(GraphArchitecture::has_rods)
    }

    /// Calls `read` with the shape in the words of the model file.
    pub fn with_header<T>(&self, read: impl FnOnce(FamilyHeader) -> T) -> T {
        self.family.with_header(read)
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
        self.family.name()
    }

    /// One letter a coordinate: `t` translation, `a` angle, `c` cyclic.
    pub fn coordinates(&self) -> String {
        match &self.family {
            Family::Rigid(rigid) => rigid.coordinates.clone(),
            Family::Modular(modular) => modular.coordinates(),
            Family::Graph(graph) => "t".repeat(graph.n()),
            Family::Bodies(bodies) => bodies.coordinates(),
            Family::Arm(arm) => arm.coordinates(),
        }
    }

    /// Every hidden layer's units, of the energies.
    pub fn widths(&self) -> Vec<usize> {
        match &self.family {
            Family::Rigid(rigid) => rigid.widths.iter().map(|width| usize::from(*width)).collect(),
            Family::Modular(modular) => modular.shape.networks.iter().flat_map(hidden).collect(),
            Family::Graph(graph) => graph.shape.networks.iter().flat_map(hidden).collect(),
            Family::Bodies(_) | Family::Arm(_) => Vec::new(),
        }
    }

    /// Hidden layers of the deepest network of the energies.
    pub fn depth(&self) -> usize {
        match &self.family {
            Family::Rigid(rigid) => rigid.widths.len(),
            Family::Modular(modular) => {
                modular.shape.networks.iter().map(|n| n.widths().1).max().unwrap_or(0)
            }
            Family::Graph(graph) => graph.shape.networks.iter().map(|n| n.widths().1).max().unwrap_or(0),
            Family::Bodies(_) | Family::Arm(_) => 0,
        }
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.family.n()
    }

    /// Numbers in the weight block.
    ///
    /// # Errors
    /// Where the shape is out of the format's range.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        self.with_header(|family| Header { laws: self.laws(), ..Header::new(family) }.parameters())
    }

    /// The laws of force beside the energies, whose numbers end the weight block.
    pub fn laws(&self) -> Laws<'_> {
        self.corrections.laws(self.friction_laws())
    }

    /// Those without a network.
    pub fn friction_laws(&self) -> Laws<'static> {
        self.friction.laws(self.family.laws())
    }

    /// Where the numbers of friction begin that are not the family's own.
    pub(crate) fn friction_start(&self) -> usize {
        self.family.parameters().unwrap_or(0)
    }

    /// Where the numbers of the networks that correct begin.
    pub fn corrections_start(&self) -> usize {
        self.friction_start() + self.friction.count()
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
        self.with_laws(self.family.initial_weights(seed), seed)
    }

    /// The weights of the family with the given numbers of friction and random weights of networks that correct behind them.
    pub(crate) fn with_laws(&self, mut weights: Vec<f64>, seed: u64) -> Vec<f64> {
        weights.extend(self.friction.numbers().map(|number| number.value));
        weights.extend(self.corrections.initial_weights(seed));
        weights
    }

    /// The friction of every coordinate at these weights, the family's own damping included; empty where there is no law.
    pub fn friction_of_coordinates(&self, weights: &[f64]) -> Vec<CoordinateFriction> {
        let (laws, groups) = (self.friction_laws(), self.family.groups());
        let end = weights.len().saturating_sub(self.corrections.count());
        let start = end.saturating_sub(laws.parameters(groups).unwrap_or(0));
        let numbers = weights.get(start..end).unwrap_or_default();
        let viscous = if laws.contains(Law::Viscous) { groups } else { 0 };
        let (viscous, dry) = numbers.split_at(viscous.min(numbers.len()));
        let dry = dry.as_chunks().0;
        let of = |group: usize| CoordinateFriction {
            viscous: viscous.get(group).copied().unwrap_or(0.0),
            dry: dry.get(group).copied().map(dry_friction),
        };
        let coordinates = if laws == Laws::NONE { Vec::new() } else { self.family.group_of_coordinates() };
        coordinates.into_iter().map(of).collect()
    }

    /// The numbers of the weight block that training must leave as they are.
    pub fn fixed_positions(&self) -> Vec<usize> {
        let friction = self.friction.fixed_positions(self.friction_start());
        let networks = self.corrections.fixed_positions(self.corrections_start());
        self.family.fixed_positions().into_iter().chain(friction).chain(networks).collect()
    }

    /// The ranges of numbers that are learned as free numbers ([`Bounds`]), by their positions.
    pub fn ranges(&self) -> Vec<(usize, Range)> {
        let friction = self.friction.ranges(self.friction_start());
        self.family.ranges().into_iter().chain(friction).collect()
    }

    /// The ranges of all learned numbers as the optimisers see them.
    pub fn bounds(&self) -> Bounds {
        let bodies = self.arm().map(ArmArchitecture::learned_bodies).unwrap_or_default();
        Bounds::new(self.ranges()).with_bodies(bodies)
    }

    /// Brings numbers that have a range but are learned as they are (masses, a family's own damping) back into it.
    pub fn project(&self, weights: &mut [f64]) {
        self.family.project(weights);
    }

    /// Its energies and forces, written down for the tree or graph that is meant.
    ///
    /// # Errors
    /// [`ModelError`] where the shape does not fit in itself.
    pub fn energies(&self) -> Result<Box<dyn Energies>, ModelError> {
        let family = self.family.energies()?;
        if self.friction.is_none() {
            return self.corrections.energies(family);
        }
        let groups = self.family.groups();
        self.friction.check(self.family.laws(), groups)?;
        let beside = self.family.group_of_coordinates();
        let all = WithFriction::new(family, self.friction.laws_beside(), groups, beside);
        self.corrections.energies(Box::new(all.ok_or(ModelError::OutOfRange { what: "friction" })?))
    }

    /// The rods of the graph that is meant; none of another family.
    ///
    /// # Errors
    /// Where there is no such graph.
    pub fn rods(&self) -> Result<Rods, ModelError> {
        let Some(graph) = self.graph() else { return Ok(Rods::default()) };
        Ok(Rods::new(graph.dimension(), &graph.graph()?.rods))
    }

    /// Refuses rods where there must be none; `what` says where.
    ///
    /// # Errors
    /// [`ModelError::Shape`] with their number, or as [`Architecture::rods`].
    pub(crate) fn check_without_rods(&self, what: &'static str) -> Result<(), ModelError> {
        match self.rods()?.count() {
            0 => Ok(()),
            found => Err(ModelError::Shape { what, found, compiled: 0 }),
        }
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

/// One letter a joint: `t` translation, `a` angle.
pub(crate) fn letters_of_joints(joints: impl Iterator<Item = Joint>) -> String {
    let letter = |joint| match joint {
        Joint::Revolute => 'a',
        Joint::Prismatic => 't',
    };
    joints.map(letter).collect()
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
