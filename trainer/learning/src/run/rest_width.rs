//! Choice of the width ε from which the friction of an arm at rest takes its time to turn.

use super::plan::PlanError;
use super::torques::training_error;
use crate::config::Config;
use crate::data::Dataset;
use leastaction_core::model::{Law, StickingNumber};
use leastaction_models::{Architecture, LawEntry, NumberKind};

/// Ratios of the widths that are tried to the usual one, in ascending order.
const FACTORS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
/// Ratio to the error of a narrower width below which a wider one is taken.
const WORTH: f64 = 0.99;

/// The widths of friction that sticks that were not given, of an architecture that has seen no log.
pub(super) fn open(architecture: &Architecture) -> Vec<LawEntry> {
    let is_open = |entry: &LawEntry| {
        let number = entry.number;
        (entry.law, entry.kind) == (Law::Sticking, NumberKind::Width)
            && (number.learned || number.part.is_some())
    };
    architecture.law_entries().filter(is_open).collect()
}

/// Chooses the `open` widths of friction that sticks of an arm whose torques are fitted: the one with the least error of a fit to
/// the training logs. It says how far a joint moves back before its friction has turned, which differs by ten times from gear to gear.
///
/// # Errors
/// [`PlanError`] if the logs cannot be made into samples, or the bodies cannot be fitted.
pub(super) fn choose(
    architecture: &mut Architecture,
    (open, initial): (&[LawEntry], &mut [f64]),
    of: (&Dataset, usize),
    config: &Config,
) -> Result<(), PlanError> {
    let has_torques = architecture.family.arm().is_some() && !architecture.group_laws.has_servos();
    if open.is_empty() || !has_torques {
        return Ok(());
    }
    let widened = |factor: f64| {
        let (mut own, mut weights) = (architecture.clone(), initial.to_vec());
        let each = Law::Sticking.ranges().len();
        for entry in open {
            let number = &mut own.group_laws.sticking[entry.group * each + StickingNumber::Width as usize];
            number.value *= factor;
            weights[entry.position] = number.value;
        }
        (own, weights)
    };
    let (mut least, mut best) = (f64::INFINITY, None);
    for (own, weights) in FACTORS.map(widened) {
        let error = training_error(&own, &weights, of, config)?;
        if error < WORTH * least {
            (least, best) = (error, Some((own, weights)));
        }
    }
    if let Some((own, weights)) = best {
        initial.copy_from_slice(&weights);
        *architecture = own;
    }
    Ok(())
}
