//! What a family has of its own: energies, and the forces that its numbers are for.

use super::{
    ArmArchitecture, BodiesArchitecture, GraphArchitecture, ModularArchitecture, NamedGraph,
    RigidArchitecture,
};
use crate::training::Range;
use leastaction_core::model::{Family as FamilyHeader, Header, Laws, ModelError};
use leastaction_programs::energies::{Energies, GraphEnergies, ModularEnergies};
use serde::{Deserialize, Serialize};

/// The energies of a model by their family, with the forces that the family has of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Family {
    /// Inertia matrix and potential from one network.
    Rigid(RigidArchitecture),
    /// A tree of elements.
    Modular(ModularArchitecture),
    /// A graph of particles.
    Graph(GraphArchitecture),
    /// A tree of rigid bodies on joints.
    Bodies(BodiesArchitecture),
    /// A tree of rigid bodies on joints in space.
    Arm(ArmArchitecture),
}

impl From<ArmArchitecture> for Family {
    fn from(arm: ArmArchitecture) -> Self {
        Self::Arm(arm)
    }
}

impl From<BodiesArchitecture> for Family {
    fn from(bodies: BodiesArchitecture) -> Self {
        Self::Bodies(bodies)
    }
}

impl From<GraphArchitecture> for Family {
    fn from(graph: GraphArchitecture) -> Self {
        Self::Graph(graph)
    }
}

impl From<RigidArchitecture> for Family {
    fn from(rigid: RigidArchitecture) -> Self {
        Self::Rigid(rigid)
    }
}

impl From<ModularArchitecture> for Family {
    fn from(modular: ModularArchitecture) -> Self {
        Self::Modular(modular)
    }
}

impl Family {
    /// The family of a model file of these laws; of several trees the first.
    ///
    /// # Errors
    /// [`ModelError::OtherFamily`] for a family that this program does not know.
    pub(super) fn from_header(
        header: &FamilyHeader,
        laws: Laws,
        weights: &[f64],
    ) -> Result<Self, ModelError> {
        match header {
            FamilyHeader::Rigid(rigid) => Ok(RigidArchitecture::from_header(rigid, laws).into()),
            FamilyHeader::Modular(modular) => {
                Ok(ModularArchitecture::from_header(modular, laws, weights).into())
            }
            FamilyHeader::Graph(graph) => Ok(GraphArchitecture::from_header(graph, weights).into()),
            FamilyHeader::Bodies(bodies) => Ok(BodiesArchitecture::from_header(bodies, weights).into()),
            FamilyHeader::Arm(arm) => Ok(ArmArchitecture::from_header(arm, weights).into()),
            other => Err(ModelError::OtherFamily { found: other.name() }),
        }
    }

    /// Calls `read` with the shape in the words of the model file.
    pub fn with_header<T>(&self, read: impl FnOnce(FamilyHeader) -> T) -> T {
        match self {
            Self::Rigid(rigid) => read(FamilyHeader::Rigid(rigid.header())),
            Self::Modular(modular) => read(FamilyHeader::Modular(modular.header())),
            Self::Graph(graph) => graph.with_header(|header| read(FamilyHeader::Graph(header))),
            Self::Bodies(bodies) => read(FamilyHeader::Bodies(bodies.header())),
            Self::Arm(arm) => read(FamilyHeader::Arm(arm.header())),
        }
    }

    /// What the family is called.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Rigid(_) => "rigid",
            Self::Modular(_) => "modular",
            Self::Graph(_) => "graph",
            Self::Bodies(_) => "bodies",
            Self::Arm(_) => "arm",
        }
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        match self {
            Self::Rigid(rigid) => rigid.n(),
            Self::Modular(modular) => modular.n(),
            Self::Graph(graph) => graph.n(),
            Self::Bodies(bodies) => bodies.n(),
            Self::Arm(arm) => arm.n(),
        }
    }

    /// Numbers of its own in the weight block, from its front.
    ///
    /// # Errors
    /// Where the shape is out of the format's range.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        self.with_header(|family| Header { laws: self.laws(), ..Header::new(family) }.parameters())
    }

    /// The laws of force of its own, whose numbers end its part of the weight block.
    pub fn laws(&self) -> Laws<'static> {
        match self {
            Self::Rigid(rigid) => rigid.laws(),
            Self::Modular(modular) => modular.laws(),
            Self::Graph(_) | Self::Bodies(_) | Self::Arm(_) => Laws::NONE,
        }
    }

    /// Groups of coordinates that laws have numbers of their own for, as in a model file; none where there can be no laws.
    pub fn groups(&self) -> usize {
        match self {
            Self::Rigid(rigid) => rigid.n(),
            Self::Modular(modular) => modular.types.len(),
            Self::Graph(_) => 0,
            Self::Bodies(bodies) => bodies.n(),
            Self::Arm(arm) => arm.n(),
        }
    }

    /// The group of every coordinate of the tree that is meant; none where there can be no laws.
    pub fn group_of_coordinates(&self) -> Vec<usize> {
        match self {
            Self::Rigid(rigid) => (0..rigid.n()).collect(),
            Self::Modular(modular) => modular.type_of_coordinates(),
            Self::Graph(_) => Vec::new(),
            Self::Bodies(bodies) => (0..bodies.n()).collect(),
            Self::Arm(arm) => (0..arm.n()).collect(),
        }
    }

    /// Random weights where they are learned, the given numbers elsewhere.
    pub(super) fn initial_weights(&self, seed: u64) -> Vec<f64> {
        match self {
            Self::Rigid(rigid) => rigid.initial_weights(seed),
            Self::Modular(modular) => modular.initial_weights(seed),
            Self::Graph(graph) => graph.initial_weights(seed),
            Self::Bodies(bodies) => bodies.initial_weights(),
            Self::Arm(arm) => arm.initial_weights(),
        }
    }

    /// The numbers of its own that training must leave as they are.
    pub(super) fn fixed_positions(&self) -> Vec<usize> {
        match self {
            Self::Rigid(_) => Vec::new(),
            Self::Modular(modular) => modular.fixed_positions(),
            Self::Graph(graph) => graph.fixed_positions(),
            Self::Bodies(bodies) => bodies.fixed_positions(),
            Self::Arm(arm) => arm.fixed_positions(),
        }
    }

    /// The ranges of numbers of its own that are learned.
    pub(super) fn ranges(&self) -> Vec<(usize, Range)> {
        match self {
            Self::Rigid(_) | Self::Modular(_) | Self::Graph(_) => Vec::new(),
            Self::Bodies(bodies) => bodies.ranges(),
            Self::Arm(arm) => arm.ranges(),
        }
    }

    /// Brings numbers of its own that have a range but are learned as they are (masses, damping) back into it.
    pub(super) fn project(&self, weights: &mut [f64]) {
        match self {
            Self::Rigid(rigid) => rigid.project(weights),
            Self::Modular(modular) => modular.project(weights),
            Self::Graph(graph) => graph.project(weights),
            // Ranges hold them.
            Self::Bodies(_) | Self::Arm(_) => {}
        }
    }

    /// Its energies and forces, written down for the tree or graph that is meant.
    ///
    /// # Errors
    /// [`ModelError`] where the shape does not fit in itself.
    pub(super) fn energies(&self) -> Result<Box<dyn Energies>, ModelError> {
        match self {
            Self::Rigid(rigid) => Ok(Box::new(rigid.energies()?)),
            Self::Modular(modular) => {
                let elements: Vec<_> = modular.tree_header().nodes().collect();
                Ok(Box::new(ModularEnergies::new(&modular.shape, &elements, modular.damped)?))
            }
            Self::Graph(graph) => {
                let NamedGraph { nodes, edges, .. } = graph.graph()?;
                Ok(Box::new(GraphEnergies::new(&graph.shape, nodes, edges, 0)?))
            }
            Self::Bodies(bodies) => Ok(Box::new(bodies.energies()?)),
            Self::Arm(arm) => Ok(Box::new(arm.energies()?)),
        }
    }
}
