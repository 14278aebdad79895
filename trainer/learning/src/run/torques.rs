//! Start of training for an arm: a fit of bodies, rotors and friction to the logged torques.

use crate::config::Config;
use crate::data::Dataset;
use crate::torque::fit::{
    Bodies, FitError, Fitted, JointNumber, JointNumbers, Learned, fit, fit_by_folds, mean_nmse,
    squared_errors, variances,
};
use crate::torque::{SampleError, Samples};
use crate::torque_numbers::TorqueNumbers;
use crate::torques::{Driven, SplitErrors, samples, widths_at_rest};
use crate::windows::Setting;
use leastaction_core::model::{Law, ModelError};
use leastaction_models::tree::Tree;
use leastaction_models::{
    Actuator, Architecture, ArmArchitecture, Facts, Family, LawEntry, Model, NumberKind,
};
use std::fmt;
use thiserror::Error;

/// A log that cannot be made into torque samples.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TorqueError {
    /// No trajectory can be filtered.
    #[error("no trajectory can be filtered for the loss of torques: {0}")]
    Samples(#[from] SampleError),
}

/// Range of a learned load smoothing, N m or N.
const SMOOTHINGS: [f64; 2] = [1e-3, 1e2];
/// Length of a contiguous block of samples that belongs to one fold, s.
const BLOCK: f64 = 0.75;
/// Number of folds of the samples.
const FOLDS: usize = 5;
/// Candidate strengths of the prior.
const STRENGTHS: [f64; 9] = [1000.0, 300.0, 100.0, 30.0, 10.0, 3.0, 1.0, 0.1, 0.01];

/// An arm fitted to the logged torques.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueFit {
    /// Weight block.
    pub weights: Vec<f64>,
    /// Drives, with their offsets if these are learned.
    pub actuator: Actuator,
    /// Quality of the fit.
    pub report: TorqueReport,
}

/// Quality of an arm's fit to torques.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueReport {
    /// Number of learned parameters, and how many of these the samples alone determine.
    pub learned: (usize, usize),
    /// Strength of the prior.
    pub prior: f64,
    /// Torque errors.
    pub errors: SplitErrors,
    /// Estimates of the learned numbers from the training log alone.
    pub numbers: TorqueNumbers,
}

impl fmt::Display for TorqueReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { learned: (learned, rank), prior, errors, numbers } = self;
        let count = numbers.names.len();
        let samples = errors.train.samples;
        write!(
            f,
            "fitted to the torques of {samples} samples: {learned} numbers, of which the log alone determines {rank}; prior of strength \
             {prior}; {errors}; {count} numbers by the log alone, with standard errors, and in the model are on the page of the run"
        )
    }
}

/// Fits an arm to the torques of the first `training` trajectories; the other trajectories are used to evaluate the
/// fit.
///
/// # Errors
/// [`PlanError`](super::PlanError) if the logs cannot be made into samples, or the bodies cannot be fitted.
pub(super) fn fitted(
    (architecture, arm): (&Architecture, &ArmArchitecture),
    initial: &[f64],
    (data, training): (&Dataset, usize),
    config: &Config,
) -> Result<TorqueFit, super::PlanError> {
    let cut_off = config.training.cut_off;
    let Posed { tree, samples: train, learned, actuator } =
        posed((architecture, arm), initial, (data, training), config)?;
    let (found, offsets) = (best(&tree, &train, &learned)?, learned.offsets);
    let mut weights = initial.to_vec();
    arm.put(&found.arm.tree, &mut weights);
    put_friction(architecture, &found.arm.joints, &mut weights);
    let offset = found.arm.joints.iter().map(|joint| -joint.offset).collect();
    let actuator = if offsets { Actuator { offset, ..actuator } } else { actuator };
    let facts = Facts { actuator: actuator.clone(), ..Facts::default() };
    let model = Model::new(architecture.clone(), weights.clone()).with_facts(facts);
    let what = "torques of the fit";
    let report = TorqueReport {
        learned: (found.parameters, found.rank),
        prior: found.prior,
        errors: SplitErrors::along(&model, (data, training), cut_off)
            .ok_or(ModelError::OutOfRange { what })?,
        numbers: TorqueNumbers::of((architecture, arm), &found.arm, (&train, &learned))?,
    };
    Ok(TorqueFit { weights, actuator, report })
}

/// A fit to torques: the arm at its start, samples of the training trajectories, what is learned, and the known drives.
struct Posed {
    tree: Tree,
    samples: Samples,
    learned: Learned,
    actuator: Actuator,
}

fn posed(
    (architecture, arm): (&Architecture, &ArmArchitecture),
    initial: &[f64],
    (data, training): (&Dataset, usize),
    config: &Config,
) -> Result<Posed, super::PlanError> {
    let calibration = config.calibration.calibration();
    let learned = learned(architecture, arm, calibration.offset == Setting::Learned);
    let actuator = calibration.known_actuator(arm.n());
    let train = &data.trajectories[..training.min(data.trajectories.len())];
    let driven = Driven { actuator: actuator.clone(), widths: widths_at_rest(architecture, initial) };
    let samples = samples(train, (data.h, data.control_kind()), &driven, config.training.cut_off)
        .map_err(TorqueError::from)?;
    let what = "numbers of bodies";
    let tree = arm.host_tree(initial).ok_or(ModelError::OutOfRange { what })?;
    Ok(Posed { tree, samples, learned, actuator })
}

/// Error of a fit with the usual prior to the torques of the training trajectories: mean over coordinates of the mean squared error over the
/// variance; 0 for another family than an arm.
///
/// # Errors
/// [`PlanError`](super::PlanError) if the logs cannot be made into samples, or the bodies cannot be fitted.
pub(super) fn training_error(
    architecture: &Architecture,
    initial: &[f64],
    of: (&Dataset, usize),
    config: &Config,
) -> Result<f64, super::PlanError> {
    let Some(arm) = architecture.family.arm() else { return Ok(0.0) };
    let Posed { tree, samples, learned, .. } = posed((architecture, arm), initial, of, config)?;
    let found = fit(&tree, &samples, &learned, 1.0)?;
    let errors = squared_errors(&found.arm.torques(&samples), &samples);
    Ok(mean_nmse(&errors, &variances(&samples)))
}

/// The fit with the prior strength that cross-validation over folds of the samples chooses.
fn best(tree: &Tree, samples: &Samples, learned: &Learned) -> Result<Fitted, FitError> {
    if learned.bodies == Bodies::Consistent {
        let folds = folds(samples);
        let count = folds.iter().max().map_or(0, |last| last + 1);
        if count > 1 {
            return Ok(fit_by_folds(tree, samples, learned, (&STRENGTHS, &folds))?.0);
        }
    }
    fit(tree, samples, learned, 1.0)
}

/// Fold of each sample, in blocks of time.
fn folds(samples: &Samples) -> Vec<usize> {
    samples.t.iter().map(|t| (t / BLOCK) as usize % FOLDS).collect()
}

/// The numbers of the shape that are learned; known friction numbers stay fixed.
fn learned(architecture: &Architecture, arm: &ArmArchitecture, offsets: bool) -> Learned {
    let known = arm.bodies.iter().enumerate().filter(|(_, body)| !body.is_learned).map(|(k, _)| k).collect();
    let bodies = arm.bodies.iter().any(|body| body.is_learned);
    let rotors = arm.bodies.iter().any(|body| body.rotor.learned);
    Learned {
        bodies: if bodies { Bodies::Consistent } else { Bodies::Known },
        known,
        rotors,
        offsets,
        smoothing: SMOOTHINGS,
        held: held(architecture),
        ..Learned::friction_of(architecture)
    }
}

/// The friction numbers that no law learns, each with its coordinate; parts of several laws add up.
fn held(architecture: &Architecture) -> Vec<(usize, JointNumber, f64)> {
    let entries: Vec<LawEntry> = architecture.law_entries().collect();
    let place = |entry: &LawEntry| Some((entry.group, JointNumber::of(entry.kind)?));
    // Samples are made for the width of friction that sticks.
    let may_change =
        |of: &LawEntry| of.number.learned && (of.law, of.kind) != (Law::Sticking, NumberKind::Width);
    let is_learned = |of| entries.iter().any(|entry| place(entry) == Some(of) && may_change(entry));
    let mut held: Vec<(usize, JointNumber, f64)> = Vec::new();
    for entry in &entries {
        let Some(of) = place(entry).filter(|of| !is_learned(*of)) else { continue };
        let (i, number) = of;
        let adds = matches!(number, JointNumber::Viscous | JointNumber::Coulomb | JointNumber::Load);
        match held.iter_mut().find(|(group, own, _)| (*group, *own) == of) {
            Some((.., value)) if adds => *value += entry.number.value,
            Some((.., value)) => *value = entry.number.value,
            None => held.push((i, number, entry.number.value)),
        }
    }
    held
}

/// Writes the learned friction numbers of every joint into the weights.
fn put_friction(architecture: &Architecture, joints: &[JointNumbers], weights: &mut [f64]) {
    for entry in architecture.law_entries().filter(|entry| entry.number.learned) {
        let joint = joints.get(entry.group).zip(JointNumber::of(entry.kind));
        if let Some((joint, number)) = joint {
            weights[entry.position] = joint.array()[number as usize];
        }
    }
}
