//! Where training of an arm begins: bodies, rotors and friction that need the logged torques.

use crate::config::Config;
use crate::data::{Dataset, Trajectory};
use crate::torque::fit::{Bodies, FitError, Fitted, JointNumbers, Learned, SOFTNESS, fit, fit_by_folds};
use crate::torque::{SampleError, Samples};
use crate::torque_numbers::TorqueNumbers;
use crate::torques::{TorqueErrors, samples};
use crate::windows::{Calibrated, Setting};
use leastaction_core::model::ModelError;
use leastaction_models::tree::Tree;
use leastaction_models::{Actuator, Architecture, ArmArchitecture, Family};
use std::fmt;
use thiserror::Error;

/// A log that does not become samples of torques, or friction that they do not show one by one.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TorqueError {
    /// No trajectory can be filtered.
    #[error("no trajectory can be filtered for the loss of torques: {0}")]
    Samples(#[from] SampleError),
    /// Known numbers of friction.
    #[error(
        "[model.friction]: from torques viscous, coulomb and load are learned or left out, and smoothing is {SOFTNESS}; leave out known \
         numbers"
    )]
    KnownFriction,
}

/// Of samples that are held back together, s.
const BLOCK: f64 = 0.75;
/// Parts of the samples that are held back in turn.
const FOLDS: usize = 5;
/// Strengths of the prior that are tried.
const STRENGTHS: [f64; 9] = [1000.0, 300.0, 100.0, 30.0, 10.0, 3.0, 1.0, 0.1, 0.01];

/// An arm that needs the logged torques.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueFit {
    /// Its weight block.
    pub weights: Vec<f64>,
    /// What adds to the commands of its drives, where that is learned.
    pub calibrated: Option<Calibrated>,
    /// How good it is.
    pub report: TorqueReport,
}

/// How well an arm explains torques.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueReport {
    /// Numbers that were learned, and of them what the samples alone determine.
    pub learned: (usize, usize),
    /// Strength of the prior.
    pub prior: f64,
    /// Where it was learned from.
    pub train: TorqueErrors,
    /// Of trajectories that are held back, if there are any.
    pub held_back: Option<TorqueErrors>,
    /// What the log that was learned from says alone of what was learned.
    pub numbers: TorqueNumbers,
}

impl fmt::Display for TorqueReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { learned: (learned, rank), prior, train, held_back, numbers } = self;
        let TorqueErrors { nmse, samples, .. } = train;
        let rmse =
            |of: &TorqueErrors| of.rmse.iter().map(|x| format!("{x:.3}")).collect::<Vec<_>>().join(", ");
        write!(
            f,
            "fitted to the torques of {samples} samples: {learned} numbers, of which the log alone determines {rank}; prior of strength \
             {prior}; squared error over variance {nmse:.4}"
        )?;
        match held_back {
            Some(held) => write!(
                f,
                ", of held-back trajectories {:.4}, there joint by joint {} N m (root mean square)",
                held.nmse,
                rmse(held)
            ),
            None => write!(f, ", joint by joint {} N m (root mean square)", rmse(train)),
        }?;
        write!(f, "; {numbers}")
    }
}

/// Fits an arm to the torques of the first so many trajectories; the others judge.
///
/// # Errors
/// Where the logs do not become samples, the friction is not learned, or bodies cannot be fitted.
pub(super) fn fitted(
    (architecture, arm): (&Architecture, &ArmArchitecture),
    initial: &[f64],
    (data, training): (&Dataset, usize),
    config: &Config,
) -> Result<TorqueFit, super::PlanError> {
    let offsets = config.calibration.calibration().offset == Setting::Learned;
    let learned = learned(architecture, arm, offsets)?;
    let samples = |part: &[Trajectory]| samples(part, (data.h, data.control_kind()), config.training.cut_off);
    let (train, held) = data.trajectories.split_at(training.min(data.trajectories.len()));
    let train = samples(train).map_err(TorqueError::from)?;
    let held = samples(held).ok();
    let what = "numbers of bodies";
    let tree = arm.host_tree(initial).ok_or(ModelError::OutOfRange { what })?;
    let found = best(&tree, &train, &learned)?;
    let mut weights = initial.to_vec();
    arm.put(&found.arm.tree, &mut weights);
    put_friction(architecture, &found.arm.joints, &mut weights);
    let n = arm.n();
    let calibrated = offsets.then(|| Calibrated {
        actuator: Actuator {
            offset: found.arm.joints.iter().map(|joint| -joint.offset).collect(),
            ..Actuator::ideal(n)
        },
        zeros: Vec::new(),
    });
    let errors = |of: &Samples| TorqueErrors::of(&found.arm, of);
    let report = TorqueReport {
        learned: (found.parameters, found.rank),
        prior: found.prior,
        train: errors(&train),
        held_back: held.as_ref().map(errors),
        numbers: TorqueNumbers::of((architecture, arm), &found.arm, (&train, &learned))?,
    };
    Ok(TorqueFit { weights, calibrated, report })
}

/// The fit whose prior is as strong as parts of the samples ask for that are held back in turn.
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

/// Which part each sample belongs to, in blocks of time.
fn folds(samples: &Samples) -> Vec<usize> {
    samples.t.iter().map(|t| (t / BLOCK) as usize % FOLDS).collect()
}

/// What the shape learns.
fn learned(
    architecture: &Architecture,
    arm: &ArmArchitecture,
    offsets: bool,
) -> Result<Learned, TorqueError> {
    let friction = &architecture.friction;
    let is_absent = |number: &leastaction_models::Number| !number.learned && number.value == 0.0;
    let of_dry = |place: usize| friction.dry.iter().map(move |numbers| &numbers[place]);
    let (viscous, dry) = (!friction.viscous.is_empty(), !friction.dry.is_empty());
    let load = dry && !of_dry(1).all(is_absent);
    let must = friction.viscous.iter().chain(of_dry(0)).chain(of_dry(1).filter(|_| load));
    let smooth = of_dry(2).all(|number| !number.learned && (number.value - SOFTNESS).abs() < 1e-9);
    if must.into_iter().any(|number| !number.learned) || of_dry(3).any(|number| !number.learned) || !smooth {
        return Err(TorqueError::KnownFriction);
    }
    let known = arm.bodies.iter().enumerate().filter(|(_, body)| !body.is_learned).map(|(k, _)| k).collect();
    let bodies = arm.bodies.iter().any(|body| body.is_learned);
    let rotors = arm.bodies.iter().any(|body| body.rotor.learned);
    let bodies = if bodies { Bodies::Consistent } else { Bodies::Known };
    Ok(Learned { bodies, known, rotors, viscous, coulomb: dry, load, offsets, ..Learned::default() })
}

/// b, then c, c_load, τ_s and ε of every joint, where the shape has them.
fn put_friction(architecture: &Architecture, joints: &[JointNumbers], weights: &mut [f64]) {
    let friction = &architecture.friction;
    let viscous = joints.iter().filter(|_| !friction.viscous.is_empty()).map(|joint| joint.viscous);
    let dry = joints.iter().filter(|_| !friction.dry.is_empty());
    let dry = dry.flat_map(|joint| [joint.coulomb, joint.load, SOFTNESS, joint.width]);
    let own = weights.iter_mut().skip(architecture.friction_start());
    own.zip(viscous.chain(dry)).for_each(|(weight, number)| *weight = number);
}
