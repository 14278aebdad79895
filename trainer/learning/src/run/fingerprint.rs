//! Fingerprints that distinguish inputs; they guard against accidents, not against malice.

use crate::checksummed::Fingerprint;
use crate::config::TrainingLoss;
use crate::data::{Dataset, Rows, Trajectory, control_name};
use leastaction_core::forces::ControlKind;

/// CRC-64/XZ over all numbers of a data set that the loss reads. The same motion in another file or format has the same
/// fingerprint; if the loss needs only positions and controls, logged velocities and accelerations do not matter. A
/// changing control that is held and one that is linear between samples have different fingerprints.
pub(super) fn of_data(data: &Dataset, loss: TrainingLoss) -> u64 {
    let (state, acceleration) = (loss.reads_velocities(), loss == TrainingLoss::Acceleration);
    let mut fingerprint = Fingerprint::default();
    fingerprint.add(&(data.n as u64).to_le_bytes());
    fingerprint.add(&data.h.to_le_bytes());
    for trajectory in &data.trajectories {
        let Trajectory { q, v, a, u, .. } = trajectory;
        for rows in [Some(q), v.as_ref().filter(|_| state), a.as_ref().filter(|_| acceleration), u.as_ref()] {
            add_rows(&mut fingerprint, rows);
        }
    }
    if !acceleration && data.control_changes() && data.control_kind() == ControlKind::Held {
        fingerprint.add(control_name(ControlKind::Held).as_bytes());
    }
    fingerprint.finish()
}

fn add_rows(fingerprint: &mut Fingerprint, rows: Option<&Rows>) {
    let values = rows.map_or(&[][..], Rows::as_flat);
    fingerprint.add(&(values.len() as u64).to_le_bytes());
    for value in values {
        fingerprint.add(&value.to_le_bytes());
    }
}
