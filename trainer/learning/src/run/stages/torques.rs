//! The stage that learns networks beside an arm, by the torque loss.

use super::super::TorqueError;
use super::{NETWORKS, PlanError, Stage};
use crate::config::Config;
use crate::data::{Dataset, Trajectory};
use crate::torque;
use crate::torques::{Driven, samples, widths_at_rest};
use crate::training::{Objective, Offsets, Samples, TorqueTerms, torque_objective};
use crate::windows::{CalibrationLayout, Setting};
use leastaction_models::{Actuator, Architecture, Number};

/// The stage of networks beside the fitted bodies and rotors, which stay fixed; friction and drive offsets are refined
/// if they are learned. The parameters of the stage are those that all windows share.
///
/// # Errors
/// [`TorqueError`] if no trajectory can be filtered, [`PlanError`] if the shape is inconsistent.
pub(super) fn networks(
    (config, iterations): (&Config, u64),
    architecture: &Architecture,
    (data, training): (&Dataset, usize),
    layout: &CalibrationLayout,
) -> Result<Stage, PlanError> {
    let (shape, calibration) = (with_known_bodies(architecture), layout.calibration);
    let drives = Actuator { offset: Vec::new(), ..calibration.known_actuator(data.n) };
    let widths = widths_at_rest(architecture, &architecture.initial_weights(config.training.seed));
    let driven = Driven { actuator: drives, widths };
    let filtered = |part: &[Trajectory]| -> Result<Samples, torque::SampleError> {
        let own = samples(part, (data.h, data.control_kind()), &driven, config.training.cut_off)?;
        Ok(Samples::of_torques(&own, data.h))
    };
    let (train, held) = data.trajectories.split_at(training.min(data.trajectories.len()));
    let train = filtered(train).map_err(TorqueError::from)?;
    let are_known = calibration.offset != Setting::Learned;
    let offsets = Some(Offsets { beside: layout.beside_offsets(), are_known });
    let terms = TorqueTerms { units: train.torque_deviations(), offsets };
    let objective = |of: Samples| -> Result<Box<dyn Objective>, PlanError> {
        Ok(torque_objective(&shape, of, terms.clone())?)
    };
    let first = architecture.corrections.initial_weights(config.training.seed);
    Ok(Stage {
        name: NETWORKS,
        begins_with: Some((architecture.corrections_start(), first)),
        optimiser: config.training.optimiser,
        iterations,
        objective: objective(train)?,
        validation: filtered(held).ok().map(objective).transpose()?,
        judge: None,
    })
}

/// The architecture with bodies and rotors of the arm held fixed.
fn with_known_bodies(architecture: &Architecture) -> Architecture {
    let Some(mut arm) = architecture.family.arm().cloned() else { return architecture.clone() };
    for body in &mut arm.bodies {
        body.is_learned = false;
        body.rotor = Number::known(body.rotor.value);
    }
    Architecture { family: arm.into(), ..architecture.clone() }
}
