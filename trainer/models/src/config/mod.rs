//! `[model]` of a configuration, for any family: its contents, and how a model is made from it.

pub mod checks;
pub mod family;
pub mod fields;
pub mod origin;
pub mod parts;
pub mod place;
pub mod problem;
pub mod registry;

pub use crate::bodies::plane::config::{BodiesConfig, BodyConfig, BodyNumber, JointKind};
pub use crate::bodies::space::config::{ArmConfig, LearnedBodies, Learning};
pub use crate::graph::config::{
    EdgeConfig, EdgeTypeConfig, GraphConfig, LayoutConfig, NodeTypeConfig, RodConfig, SeparationKind,
};
pub use crate::inertia_network::config::{InertiaKind, InertiaNetworkConfig};
pub use crate::inertia_network::coordinates::Coordinates;
pub use crate::laws::corrections::config::{DissipationConfig, PotentialConfig, ScaleConfig};
pub use crate::laws::friction::config::FrictionConfig;
pub use crate::laws::numbers::{GroupNumber, GroupNumbers};
pub use crate::laws::servo::ServoConfig;
pub use crate::laws::stops::{StopsConfig, StopsProblem};
pub use crate::modular::config::{
    Assembled, ElementConfig, ModularConfig, PairConfig, PairKind, TransformKind, TypeConfig,
};
pub use family::{FamilyConfig, NetworksBeside, Source};
pub use origin::{Open, Origin};
pub use parts::NumberConfig;
pub use place::{ShapeError, Step};
pub use problem::Problem;
pub use registry::ModelConfig;
