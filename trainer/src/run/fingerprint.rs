//! Fingerprints that tell one input from another by accident, not by malice.

use crate::data::{Dataset, Rows, Trajectory};
use crate::sealed::CRC;
use crate::training::LossKind;
use crc::{Digest, Table};

/// CRC-64/XZ over every number of a data set that the loss reads: the same for the same motion in another file or format,
/// and, where the loss needs positions and controls alone, whatever the logged velocities and accelerations are.
pub(super) fn of_data(data: &Dataset, loss: LossKind) -> u64 {
    let (state, acceleration) = (!loss.is_discrete(), loss == LossKind::Acceleration);
    let mut digest = CRC.digest();
    digest.update(&(data.n as u64).to_le_bytes());
    digest.update(&data.h.to_le_bytes());
    for trajectory in &data.trajectories {
        let Trajectory { q, v, a, u, .. } = trajectory;
        for rows in [Some(q), v.as_ref().filter(|_| state), a.as_ref().filter(|_| acceleration), u.as_ref()] {
            add_rows(&mut digest, rows);
        }
    }
    digest.finalize()
}

fn add_rows(digest: &mut Digest<'_, u64, Table<16>>, rows: Option<&Rows>) {
    let values = rows.map_or(&[][..], Rows::as_flat);
    digest.update(&(values.len() as u64).to_le_bytes());
    for value in values {
        digest.update(&value.to_le_bytes());
    }
}
