//! The torques of an arm along logged motion, filtered.

use crate::data::{Dataset, Rows, Trajectory};
use crate::torque::fit::{Arm, JointNumbers, SOFTNESS, mean_nmse, squared_errors, variances};
use crate::torque::{Preparation, SampleError, Samples};
use crate::training;
use leastaction_core::forces::ControlKind;
use leastaction_models::Model;

/// Time between samples, s: closer ones of a filtered motion say the same.
const APART: f64 = 0.02;

/// How far off the torques of an arm are.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueErrors {
    /// Mean over joints of mean squared error over variance.
    pub nmse: f64,
    /// Root mean squared error of every joint, N m or N.
    pub rmse: Vec<f64>,
    /// Samples.
    pub samples: usize,
}

/// Torque errors of a model along logs that are filtered at so many Hz; `None` of another family, of an arm with networks or with friction
/// whose growth with the load is smoothed otherwise, and where the logs have no torques or are too short.
pub fn torque_errors(model: &Model, data: &Dataset, cut_off: f64) -> Option<TorqueErrors> {
    let arm = arm(model)?;
    let samples = samples(&data.trajectories, (data.h, data.control_kind()), cut_off).ok()?;
    Some(TorqueErrors::of(&arm, &samples))
}

impl TorqueErrors {
    /// Those of an arm at samples.
    pub(crate) fn of(arm: &Arm, samples: &Samples) -> Self {
        let errors = squared_errors(&arm.torques(samples), samples);
        let nmse = mean_nmse(&errors, &variances(samples));
        Self { nmse, rmse: errors.into_iter().map(f64::sqrt).collect(), samples: samples.count() }
    }
}

/// The arm of a model. The log has τ less what its actuator adds.
pub(crate) fn arm(Model { architecture, weights, facts, .. }: &Model) -> Option<Arm> {
    let family = architecture.family.arm()?;
    if !architecture.corrections.is_none() {
        return None;
    }
    let tree = family.host_tree(weights)?;
    let mut joints: Vec<JointNumbers> = tree
        .rotors
        .iter()
        .map(|rotor| JointNumbers { rotor: *rotor, width: 1.0, ..JointNumbers::default() })
        .collect();
    for (joint, friction) in joints.iter_mut().zip(architecture.friction_of_coordinates(weights)) {
        joint.viscous = friction.viscous;
        let Some(dry) = friction.dry else { continue };
        if dry.load != 0.0 && (dry.smoothing - SOFTNESS).abs() > 1e-6 {
            return None;
        }
        (joint.coulomb, joint.load, joint.width) = (dry.constant, dry.load, dry.width);
    }
    let offsets = &facts.actuator.offset;
    joints.iter_mut().zip(offsets).for_each(|(joint, offset)| joint.offset = -offset);
    Some(Arm { tree, joints })
}

/// Those of all trajectories that are long enough.
pub(crate) fn samples(
    trajectories: &[Trajectory],
    (h, control): (f64, ControlKind),
    cut_off: f64,
) -> Result<Samples, SampleError> {
    let every = ((APART / h).round() as usize).max(1);
    let how = Preparation { step: h, cut_off, every, ..Preparation::default() };
    let mut all: Option<Samples> = None;
    let mut failure = SampleError::Short { duration: 0.0, margin: how.margin };
    for trajectory in trajectories {
        let torques = trajectory.u.as_ref().map(|u| at_samples(u, control));
        let states = (&trajectory.q, trajectory.v.as_ref(), torques.as_ref());
        match (Samples::of_even(states, &how), all.as_mut()) {
            (Err(error), _) => failure = error,
            (Ok(own), None) => all = Some(own),
            (Ok(own), Some(all)) => all.append(&own),
        }
    }
    all.ok_or(failure)
}

/// Those of all trajectories that are long enough, as a loss over single samples takes them.
pub(crate) fn filtered(data: &Dataset, cut_off: f64) -> Result<training::Samples, SampleError> {
    let own = samples(&data.trajectories, (data.h, data.control_kind()), cut_off)?;
    Ok(training::Samples::of_torques(&own, data.h))
}

/// Torques at the samples: of those that are held between samples the mean of before and after.
fn at_samples(u: &Rows, control: ControlKind) -> Rows {
    if control == ControlKind::Linear {
        return u.clone();
    }
    let n = u.width();
    let of = |k: usize, i: usize| u.get(k).and_then(|row| row.get(i)).copied().unwrap_or_default();
    // The last row acts on nothing.
    let last = u.len().saturating_sub(2);
    let mean = |k: usize, i: usize| 0.5 * (of(k.saturating_sub(1), i) + of(k.min(last), i));
    let values = (0..u.len()).flat_map(|k| (0..n).map(move |i| (k, i))).map(|(k, i)| mean(k, i)).collect();
    Rows::from_flat(n, values).unwrap_or_else(|| u.clone())
}
