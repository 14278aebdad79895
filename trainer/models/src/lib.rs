//! Models on the host, where sizes are run-time values: the interfaces of families and laws of force, and one model object for every use.
//!
//! ```text
//! number, bounds ─► family (the trait) ─► inertia_network, modular, graph, bodies ─► registry ─► architecture ─► file ─► model
//!                   laws: friction, networks that correct, the actuator ─────────────────────────┘                   │
//!                   config (the trait), the families' and laws' config ─► config::registry ◄─────────────────────────┘
//! ```
//!
//! A family writes down its energies once, as a program ([`leastaction_programs`]), from which all computations in double precision follow.
//! In single precision a model is core itself, behind slices ([`leastaction_replica`]).

/// Calls a macro with the list of all families, the only one: name in configurations and messages, former names, accessor of the shape,
/// shape, configuration and description.
macro_rules! with_families {
    ($then:ident) => {
        $then! {
            /// Inertia matrix and potential from one network.
            InertiaNetwork: "inertia-network" | "rigid", inertia_network,
                crate::inertia_network::InertiaNetworkArchitecture, crate::inertia_network::config::InertiaNetworkConfig,
                crate::inertia_network::describe::InertiaNetworkDescription;
            /// A tree of elements.
            Modular: "modular", modular, crate::modular::ModularArchitecture, crate::modular::config::ModularConfig,
                crate::modular::describe::ModularDescription;
            /// A graph of particles.
            Graph: "graph", graph, crate::graph::GraphArchitecture, crate::graph::config::GraphConfig,
                crate::graph::describe::GraphDescription;
            /// A tree of rigid bodies on joints in a plane.
            Bodies: "bodies", bodies, crate::bodies::plane::BodiesArchitecture, crate::bodies::plane::config::BodiesConfig,
                crate::bodies::plane::describe::BodiesDescription;
            /// A tree of rigid bodies on joints in space.
            Arm: "arm", arm, crate::bodies::space::ArmArchitecture, crate::bodies::space::config::ArmConfig,
                crate::bodies::space::describe::ArmDescription;
        }
    };
}

pub mod accelerations;
pub mod architecture;
pub mod bodies;
pub mod bounds;
pub mod change;
pub mod config;
pub mod describe;
pub mod family;
pub mod file;
pub mod forces;
pub mod graph;
pub mod inertia_network;
pub mod inverse;
pub mod laws;
pub mod layers;
pub mod limits;
pub mod linearize;
pub mod model;
pub mod modular;
pub mod names;
pub mod number;
pub mod parallel;
pub mod particles;
pub mod precision;
pub mod registry;
pub mod rest;
pub mod rollout;
pub mod scales;
pub mod source;
pub mod tree;
pub mod urdf;
mod words;

pub use architecture::Architecture;
pub use bodies::{ArmArchitecture, ArmBody, ArmDynamics, BodiesArchitecture, BodyNumbers, letters_of_joints};
pub use change::{ChangeError, PointMass};
pub use family::{Family, OpenGauge, Parts};
pub use graph::{GraphArchitecture, GraphType, HostTypes, NamedGraph};
pub use inertia_network::{HostSystem, InertiaNetworkArchitecture, largest_factor};
pub use laws::{
    Actuator, CoordinateFriction, CorrectionNetwork, Corrections, DissipationNetwork, DryNumbers, GroupLaws,
    LaggingCommands, LawEntry, MOST_LOAD, NumberKind, StopNumbers, WIDTH_PARTS, WIDTHS,
};
pub use layers::random_layers;
pub use limits::{
    DEPTH, MAX_COORDINATES, MAX_ELEMENT_UNITS, MAX_GRAPH_COORDINATES, MAX_HIDDEN, MAX_TREE_COORDINATES,
    MAX_UNITS, MAX_WIDTH,
};
pub use linearize::Linearization;
pub use model::{Facts, Model};
pub use modular::{ModularArchitecture, NamedTree, NamedType, TYPE_NUMBERS};
pub use names::NumberName;
pub use number::Number;
pub use precision::Precision;
pub use registry::AnyFamily;
pub use rollout::{Beginning, NEWTON};
pub use scales::Scales;
