//! Torques of a model along logged motion, after filtering.

use crate::data::{Dataset, Rows, Trajectory};
use crate::torque::fit::{Arm, JointNumbers, mean_nmse, squared_errors, variances};
use crate::torque::{Preparation, SampleError, Samples};
use crate::training;
use crate::windows::Calibrated;
use leastaction_core::forces::ControlKind;
use leastaction_models::{Actuator, Architecture, CoordinateFriction, Model};
use serde::Serialize;
use std::fmt;

/// Time between samples, s: at shorter intervals samples of a filtered motion are redundant.
const APART: f64 = 0.02;

/// Ratio of a torque's variance to that of the training trajectories below which the torque of a held-back trajectory
/// judges nothing: a robot at rest.
const AT_REST: f64 = 0.01;

/// Torque errors of a model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TorqueErrors {
    /// Mean over coordinates of mean squared error divided by variance.
    pub nmse: f64,
    /// Root mean squared error of every coordinate, N m or N.
    pub rmse: Vec<f64>,
    /// Number of samples.
    pub samples: usize,
}

/// Torque errors of a model along logs filtered at `cut_off` (Hz). The model's inverse dynamics is compared with the
/// forces that its actuator produces from the logged commands.
///
/// `None` for a graph, if some coordinate is not driven, if the model has no torque, or if the logs are too short or
/// too coarse for the filter.
pub fn torque_errors(model: &Model, data: &Dataset, cut_off: f64) -> Option<TorqueErrors> {
    if model.architecture.family.graph().is_some() || !drives_all(data) {
        return None;
    }
    TorqueErrors::along(model, &data.trajectories, (data.h, data.control_kind()), cut_off)
}

/// Whether the command of every coordinate changes somewhere.
fn drives_all(data: &Dataset) -> bool {
    let controls = || data.trajectories.iter().filter_map(|trajectory| trajectory.u.as_ref());
    let changes = |u: &Rows, i: usize| u.column(i).zip(u.column(i).skip(1)).any(|(a, b)| a != b);
    (0..data.n).all(|i| controls().any(|u| i < u.width() && changes(u, i)))
}

impl TorqueErrors {
    /// The errors of a model along some trajectories with this step; `None` if there are no samples or no torques.
    pub(crate) fn along(
        model: &Model,
        trajectories: &[Trajectory],
        step: (f64, ControlKind),
        cut_off: f64,
    ) -> Option<Self> {
        let samples = samples(trajectories, step, &Driven::of(model), cut_off).ok()?;
        Self::at(model, &samples, &[])
    }

    /// The errors at samples; coordinates whose torque varies much less than these variances are left out of the mean.
    fn at(model: &Model, samples: &Samples, usual: &[f64]) -> Option<Self> {
        let (n, actuator) = (model.n().max(1), &model.facts.actuator);
        let commands =
            model.inverse_dynamics([&samples.q, &samples.v, &samples.a].map(Rows::as_flat)).ok()?;
        let forces = commands.iter().enumerate().map(|(k, u)| actuator.output(k % n, *u));
        let errors = squared_errors(&forces.collect::<Vec<f64>>(), samples);
        let variances = variances(samples);
        let is_driven = |i: &usize| usual.get(*i).is_none_or(|usual| variances[*i] >= AT_REST * usual);
        let driven: Vec<usize> = (0..errors.len()).filter(is_driven).collect();
        let of = |all: &[f64]| driven.iter().map(|i| all[*i]).collect::<Vec<f64>>();
        let nmse = mean_nmse(&of(&errors), &of(&variances));
        let rmse = errors.into_iter().map(f64::sqrt).collect();
        nmse.is_finite().then_some(Self { nmse, rmse, samples: samples.count() })
    }
}

impl fmt::Display for TorqueErrors {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let rmse = self.rmse.iter().map(|x| format!("{x:.3}")).collect::<Vec<_>>().join(", ");
        write!(
            f,
            "squared error over variance {:.4}, joint by joint {rmse} N m (root mean square)",
            self.nmse
        )
    }
}

/// Torque errors on the training trajectories and, if there are any, on the held-back trajectories.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SplitErrors {
    /// Errors on training trajectories.
    pub train: TorqueErrors,
    /// Errors on held-back trajectories, over the coordinates that are driven there; `None` if none is, as at rest.
    pub held_back: Option<TorqueErrors>,
}

impl SplitErrors {
    /// The errors of a model whose training trajectories are the first `training` ones; `None` if [`torque_errors`]
    /// would be `None`.
    pub(crate) fn along(model: &Model, (data, training): (&Dataset, usize), cut_off: f64) -> Option<Self> {
        let (train, held) = data.trajectories.split_at(training.min(data.trajectories.len()));
        let (step, driven) = ((data.h, data.control_kind()), Driven::of(model));
        let [train, held] = [train, held].map(|part| samples(part, step, &driven, cut_off).ok());
        let train = train?;
        let usual = variances(&train);
        let held_back = held.and_then(|held| TorqueErrors::at(model, &held, &usual));
        Some(Self { train: TorqueErrors::at(model, &train, &[])?, held_back })
    }
}

impl fmt::Display for SplitErrors {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match &self.held_back {
            Some(held) => write!(
                f,
                "squared error over variance {:.4}; of held-back trajectories {held}",
                self.train.nmse
            ),
            None => self.train.fmt(f),
        }
    }
}

/// The arm of a model without networks. Its offsets are the negative of those of the actuator: the log has τ minus what
/// the actuator adds.
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
        (joint.viscous, joint.viscous_asymmetry) = (friction.viscous, friction.viscous_asymmetry);
        let Some(dry) = friction.dry else { continue };
        (joint.coulomb, joint.asymmetry, joint.load) = (dry.constant, dry.asymmetry, dry.load);
        (joint.width, joint.smoothing) = (dry.width, dry.smoothing);
    }
    let offsets = &facts.actuator.offset;
    joints.iter_mut().zip(offsets).for_each(|(joint, offset)| joint.offset = -offset);
    Some(Arm { tree, joints })
}

/// Widths ε of the smooth law of every coordinate's friction that sticks, m/s or rad/s; 0 where none does.
pub fn widths_at_rest(architecture: &Architecture, weights: &[f64]) -> Vec<f64> {
    let sticking = |own: &CoordinateFriction| own.dry.filter(|dry| dry.breakaway.is_some());
    let friction = architecture.friction_of_coordinates(weights);
    friction.iter().map(|own| sticking(own).map_or(0.0, |dry| dry.width)).collect()
}

/// Drives of a model and its friction at rest, as samples see them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Driven {
    /// Actuator, which makes forces of the logged commands.
    pub actuator: Actuator,
    /// [`widths_at_rest`].
    pub widths: Vec<f64>,
}

impl Driven {
    /// The drives and the friction of a model.
    pub fn of(Model { architecture, weights, facts, .. }: &Model) -> Self {
        Self { actuator: facts.actuator.clone(), widths: widths_at_rest(architecture, weights) }
    }
}

/// Filtered samples of all trajectories that are long enough, with the forces that the actuator produces from the
/// logged commands, and with the friction of joints at rest ([`Samples::with_friction_at_rest`]).
pub(crate) fn samples(
    trajectories: &[Trajectory],
    (h, control): (f64, ControlKind),
    Driven { actuator, widths }: &Driven,
    cut_off: f64,
) -> Result<Samples, SampleError> {
    let every = ((APART / h).round() as usize).max(1);
    let how = Preparation { step: h, cut_off, every, ..Preparation::default() };
    let mut all: Option<Samples> = None;
    let mut failure = SampleError::Short { duration: 0.0, margin: how.margin };
    let drive = Calibrated { actuator: actuator.clone(), zeros: Vec::new() };
    let force = |u: &Rows| drive.forces(u, (h, control)).unwrap_or_else(|| u.clone());
    for trajectory in trajectories {
        let torques = trajectory.u.as_ref().map(|u| at_samples(&force(u), control));
        let states = (&trajectory.q, trajectory.v.as_ref(), torques.as_ref());
        let own = Samples::of_even(states, &how).map(|own| own.with_friction_at_rest(widths));
        match (own, all.as_mut()) {
            (Err(error), _) => failure = error,
            (Ok(own), None) => all = Some(own),
            (Ok(own), Some(all)) => all.append(&own),
        }
    }
    all.ok_or(failure)
}

/// Filtered samples for a loss over single samples; commands are taken as forces.
pub(crate) fn filtered(data: &Dataset, cut_off: f64) -> Result<training::Samples, SampleError> {
    let own = samples(&data.trajectories, (data.h, data.control_kind()), &Driven::default(), cut_off)?;
    Ok(training::Samples::of_torques(&own, data.h))
}

/// Torques at the samples. If a torque is held between samples, it is the mean of the values before and after the
/// sample.
fn at_samples(u: &Rows, control: ControlKind) -> Rows {
    if control == ControlKind::Linear {
        return u.clone();
    }
    let n = u.width();
    let of = |k: usize, i: usize| u.get(k).and_then(|row| row.get(i)).copied().unwrap_or_default();
    // The last row of u does not act on any step.
    let last = u.len().saturating_sub(2);
    let mean = |k: usize, i: usize| 0.5 * (of(k.saturating_sub(1), i) + of(k.min(last), i));
    let values = (0..u.len()).flat_map(|k| (0..n).map(move |i| (k, i))).map(|(k, i)| mean(k, i)).collect();
    Rows::from_flat(n, values).unwrap_or_else(|| u.clone())
}
