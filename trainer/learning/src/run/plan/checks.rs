//! Whether data, model and loss fit each other.

use super::PlanError;
use crate::architecture::{Architecture, Family};
use crate::config::{OptimiserKind, TrainingConfig, TrainingLoss};
use crate::data::Dataset;

pub(super) fn check_coordinates(architecture: &Architecture, data: &Dataset) -> Result<(), PlanError> {
    let (model, data) = (architecture.n(), data.n);
    match &architecture.family {
        _ if model == data => Ok(()),
        Family::Rigid(_) => Err(PlanError::Coordinates { model, data }),
        Family::Bodies(_) => Err(PlanError::Bodies { model, data }),
        Family::Arm(arm) => {
            let joints = arm.bodies.iter().map(|body| body.name.as_str()).collect::<Vec<_>>().join(", ");
            Err(PlanError::Arm { joints, model, data })
        }
        Family::Graph(graph) => {
            let (graph, dimension) = (graph.graph()?.name.clone(), graph.dimension());
            Err(PlanError::Graph { graph, dimension, model, data })
        }
        Family::Modular(modular) => {
            let names =
                modular.kinds().filter_map(|kind| modular.types.get(kind)).map(|kind| kind.name.as_str());
            let (tree, elements) = (modular.tree_name().to_owned(), names.collect::<Vec<_>>().join(", "));
            Err(PlanError::Tree { tree, elements, model, data })
        }
    }
}

/// Refuses noisy states where they are not learned.
pub(super) fn check_state_noise(training: &TrainingConfig, loss: TrainingLoss) -> Result<(), PlanError> {
    let takes = (loss, training.optimiser) == (TrainingLoss::Acceleration, OptimiserKind::LevenbergMarquardt);
    if takes || training.state_noise.is_none() { Ok(()) } else { Err(PlanError::StateNoise) }
}

/// Refuses what free motion does not determine.
pub(super) fn check_gauge(architecture: &Architecture, forced: bool) -> Result<(), PlanError> {
    let (types, of, open) = match &architecture.family {
        Family::Rigid(_) => return Ok(()),
        Family::Modular(modular) => ("types", "tree", modular.learns_every_mass()),
        Family::Graph(graph) => ("node_types", "graph", !graph.shows_scale()),
        Family::Bodies(bodies) => ("bodies", "tree", !bodies.shows_scale()),
        // Only torques show them.
        Family::Arm(arm) => {
            return if arm.shows_scale() || forced { Ok(()) } else { Err(PlanError::NoTorques) };
        }
    };
    if open && !forced { Err(PlanError::Masses { types, of }) } else { Ok(()) }
}
