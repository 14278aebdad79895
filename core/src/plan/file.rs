//! Reading a plan: the only parser, for the chip and for the host.

use super::{FORMAT_VERSION, MAGIC, PlanError, PlanHeader};
use crate::expected::expected;
use crate::frame::Framed;
use crate::model::unpadded;

/// A validated plan of any size, with its numbers in place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanFile<'a> {
    header: PlanHeader<'a>,
    records: &'a [f32],
}

/// The plan at the start of a node, or at the goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<'a> {
    /// Planned positions q̄, m or rad.
    pub q: &'a [f32],
    /// Planned velocities v̄, m/s or rad/s.
    pub v: &'a [f32],
    /// Planned command ū of every driven coordinate, N or N m, held over the node; at the goal, the command that holds it.
    pub u: &'a [f32],
    /// Gain K, row by row: for every driven coordinate the gains of all positions, then of all velocities.
    pub gain: &'a [f32],
}

impl<'a> PlanFile<'a> {
    /// Reads and validates a plan: magic, version, checksum, header, lengths, alignment, finite numbers, limits.
    ///
    /// `bytes` must be 4-aligned (as `#[repr(align(4))]` or a linker section gives it) and is borrowed, not copied.
    ///
    /// # Errors
    /// See [`PlanError`].
    pub fn parse(bytes: &'a [u8]) -> Result<Self, PlanError> {
        let Framed { contents, .. } = Framed::open(bytes, MAGIC, FORMAT_VERSION)?;
        let (mut header, rest): (PlanHeader, _) =
            postcard::take_from_bytes(contents).map_err(|_| PlanError::Malformed)?;
        header.validate()?;
        let padding = |_| PlanError::OutOfRange { what: "padding" };
        let numbers = numbers(unpadded(rest).map_err(padding)?, header.numbers()?)?;
        let (limits, records) = expected(numbers.split_at_checked(2 * header.commands()), (&[], &[]));
        header.limits = limits.as_chunks().0;
        header.validate_limits()?;
        Ok(Self { header, records })
    }

    /// Description of the plan.
    pub const fn header(&self) -> &PlanHeader<'a> {
        &self.header
    }

    /// All records, one after the other: positions, velocities, commands, gains.
    pub const fn records(&self) -> &'a [f32] {
        self.records
    }

    /// The record at the start of a node, from 0; the last one, with the number of the nodes, is the goal.
    pub fn record(&self, node: u32) -> Option<Record<'a>> {
        let (n, m) = (self.header.n(), self.header.commands());
        let start = usize::try_from(node).ok()?.checked_mul(self.header.record_length())?;
        let (q, rest) = self.records.get(start..)?.split_at_checked(n)?;
        let (v, rest) = rest.split_at_checked(n)?;
        let (u, rest) = rest.split_at_checked(m)?;
        Some(Record { q, v, u, gain: rest.get(..2 * n * m)? })
    }

    /// Checks that the plan was made for the model with this [fingerprint](crate::model::fingerprint).
    ///
    /// # Errors
    /// [`PlanError::OtherModel`] if it was not.
    pub fn check_model(&self, fingerprint: u32) -> Result<(), PlanError> {
        let (planned, given) = (self.header.model, fingerprint);
        if planned == given { Ok(()) } else { Err(PlanError::OtherModel { planned, given }) }
    }
}

/// The limits and records in place: exactly `needed` numbers, all finite.
fn numbers(block: &[u8], needed: usize) -> Result<&[f32], PlanError> {
    const BYTES: usize = size_of::<f32>();
    let offset = (block.as_ptr() as usize % BYTES) as u8;
    if offset != 0 {
        return Err(PlanError::Unaligned { offset });
    }
    if cfg!(target_endian = "big") {
        return Err(PlanError::BigEndian);
    }
    let needed = needed.saturating_mul(BYTES);
    let count = PlanError::NumberCount { found: block.len(), needed };
    let numbers = bytemuck::try_cast_slice::<u8, f32>(block).map_err(|_| count)?;
    if block.len() != needed {
        return Err(count);
    }
    let bad = numbers.iter().position(|x| !x.is_finite());
    bad.map_or(Ok(numbers), |index| Err(PlanError::NotFinite { index }))
}
