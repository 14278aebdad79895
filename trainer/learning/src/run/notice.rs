//! Notices for the user, and preparation of the data for training.

use super::TorqueReport;
use super::doubt::Unexplained;
use super::plan::PlanError;
use crate::config::Config;
use crate::config::TrainingLoss;
use crate::data::{Dataset, Doubt, Note};
use crate::windows::Noise;
use leastaction_models::Architecture;
use leastaction_models::urdf::DescriptionNote;

/// A notice for the user, given before training begins or when it ends.
#[derive(Clone, Debug, PartialEq)]
pub enum Notice {
    /// No sample is forced: the energies are known only up to a common factor.
    UnknownScale,
    /// The warm-up was left out because no sample is forced.
    NoWarmUp,
    /// Validation was asked for, but there is only one trajectory that is long enough.
    NoValidation,
    /// Trajectories are shorter than a window, and left out.
    ShortLogs {
        /// Number of short trajectories.
        short: usize,
        /// Number of all trajectories.
        all: usize,
        /// Length of a window, s.
        seconds: f64,
    },
    /// The positions are noisy; therefore training is over windows.
    Noisy {
        /// Noise of the noisiest coordinate.
        noise: Noise,
        /// Length of a window, s.
        window: f64,
    },
    /// An arm was fitted to torques.
    Torques(TorqueReport),
    /// The description of the robot was changed, or is not modelled as a whole.
    Described(DescriptionNote),
    /// The data was changed.
    Changed(Note),
    /// The data is implausible.
    Doubtful(Doubt),
    /// The residuals of a fit over windows are far above the noise of the logs.
    Unexplained(Unexplained),
    /// The learned dry friction is so stiff that steps of the trained size ring.
    Rings {
        /// The coordinate, from 0.
        coordinate: usize,
        /// Stiffness a = h c (M⁻¹)_ii/(2ε).
        stiffness: f64,
        /// Largest stiffness at which the step does not ring.
        most: f64,
        /// Order of the step.
        order: u8,
    },
}

impl std::fmt::Display for Notice {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::UnknownScale => f.write_str(
                "no sample is forced (u is zero or missing): the motion does not show the scale of L, so energies, \
                 momenta and forces of this model are known up to one common factor; it predicts free motion only",
            ),
            Self::NoWarmUp => f.write_str("no warm-up: without a force the DEL residual is least for L = 0"),
            Self::NoValidation => {
                f.write_str("no validation: the data is one trajectory, and trajectories are held back whole")
            }
            Self::ShortLogs { short, all, seconds } => write!(
                f,
                "left out {short} of {all} trajectories, which are shorter than a window of {seconds} s; a shorter [training] window \
                 would take more of them"
            ),
            Self::Noisy { noise: Noise { coordinate, deviation, part }, window } => write!(
                f,
                "coordinate {coordinate} has noise of {deviation:.1e} (m or rad), {:.0}% of its second differences: training is on windows \
                 of {window} s, each from a start state of its own; [training] loss = \"windows\" says so without this note, \
                 \"next-position\" trains on single steps nonetheless",
                100.0 * part.min(1.0),
            ),
            Self::Torques(report) => report.fmt(f),
            Self::Described(note) => note.fmt(f),
            Self::Changed(note) => note.fmt(f),
            Self::Doubtful(doubt) => doubt.fmt(f),
            Self::Unexplained(of) => of.fmt(f),
            Self::Rings { coordinate, stiffness, most, order } => write!(
                f,
                "the dry friction of coordinate {} (counted from 1) is stiff for this step: a = h c/(2 m ε) is {stiffness:.2}, and beyond {most} \
                 the velocity in steps of order {order} rings or dies out too slowly near rest; take a shorter step or a larger width",
                coordinate + 1
            ),
        }
    }
}

/// The data as training takes it: the first `count` trajectories, with angles unwrapped and the control kind that the
/// configuration asks for.
pub(super) fn prepared(
    data: &Dataset,
    config: &Config,
    architecture: &Architecture,
) -> Result<(Dataset, Vec<Notice>), PlanError> {
    let letters = architecture.coordinates();
    let mut data = config.data.trajectories.map_or_else(|| data.clone(), |count| data.truncated(count));
    if let Some(asked) = config.data.control {
        data.set_control(asked).map_err(|stated| PlanError::Control { asked, stated })?;
    }
    let mut notices: Vec<Notice> = data.unwrap_angles(&letters).into_iter().map(Notice::Changed).collect();
    for doubt in data.doubts(&letters) {
        match doubt {
            Doubt::Value { field, .. } if reads(config.training.loss, field) => {
                return Err(PlanError::Data(doubt));
            }
            doubt => notices.push(Notice::Doubtful(doubt)),
        }
    }
    Ok((data, notices))
}

/// Whether a loss reads the field `field` of the data: q, v, a or u.
fn reads(loss: Option<TrainingLoss>, field: &str) -> bool {
    match field {
        "v" => loss.is_some_and(TrainingLoss::reads_velocities),
        "a" => loss == Some(TrainingLoss::Acceleration),
        _ => true,
    }
}

/// Advice for a step that cannot be solved.
pub(super) fn advice(notices: &[Notice]) -> String {
    let doubts = notices.iter().filter(|notice| matches!(notice, Notice::Doubtful(_)));
    let doubts: Vec<String> = doubts.map(Notice::to_string).collect();
    if doubts.is_empty() {
        "a network may begin elsewhere: raise [training] warm_up, or change the seed; a model of bodies needs inertias above 0 and \
         forces in the units of the log"
            .to_owned()
    } else {
        format!("look at the data first: {}", doubts.join("; "))
    }
}
