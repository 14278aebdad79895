use super::PlanError;
use serde::{Deserialize, Serialize};

/// Maximum number of coordinates of a plan.
pub const MAX_COORDINATES: usize = 64;

/// Description of a plan: everything except its records.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanHeader<'a> {
    /// Fingerprint of the model that the plan was made for: see [`fingerprint`](crate::model::fingerprint).
    #[serde(with = "postcard::fixint::le")]
    pub model: u32,
    /// The driven coordinates, ascending, from 0.
    pub driven: &'a [u8],
    /// One number for every coordinate: 1 for an angle whose differences are taken the short way, 0 otherwise.
    pub angles: &'a [u8],
    /// Tick h > 0, s.
    pub h: f32,
    /// Ticks of a node, at least 1: the command is held over a node.
    pub ticks_per_node: u32,
    /// Number of nodes K, at least 1; there is one record more.
    pub nodes: u32,
    /// Least and largest command of every driven coordinate, N or N m. The file has them in front of the records, where they are borrowed.
    #[serde(skip)]
    pub limits: &'a [[f32; 2]],
}

impl PlanHeader<'_> {
    /// Number of coordinates.
    pub const fn n(&self) -> usize {
        self.angles.len()
    }

    /// Number of driven coordinates.
    pub const fn commands(&self) -> usize {
        self.driven.len()
    }

    /// Length of the motion in ticks.
    pub const fn ticks(&self) -> u32 {
        self.ticks_per_node.saturating_mul(self.nodes)
    }

    /// Length of the motion, s.
    pub const fn seconds(&self) -> f32 {
        self.h * self.ticks() as f32
    }

    /// Length of a record in numbers: q and v of every coordinate; u and a row of 2n gains of every driven coordinate.
    pub const fn record_length(&self) -> usize {
        let x = self.n().saturating_mul(2);
        x.saturating_add(self.commands().saturating_mul(x.saturating_add(1)))
    }

    /// Length of the limits and all records in numbers.
    pub(super) fn numbers(&self) -> Result<usize, PlanError> {
        let records = usize::try_from(self.nodes).ok().and_then(|nodes| nodes.checked_add(1));
        let numbers = records
            .and_then(|records| records.checked_mul(self.record_length()))
            .and_then(|records| records.checked_add(2 * self.commands()));
        numbers.ok_or(PlanError::OutOfRange { what: "number of nodes" })
    }

    /// Checks everything that the file has in front of the numbers.
    pub(super) fn validate(&self) -> Result<(), PlanError> {
        require((1..=MAX_COORDINATES).contains(&self.n()), "number of coordinates")?;
        require(self.angles.iter().all(|angle| *angle <= 1), "mark of an angle")?;
        require(self.commands() > 0, "number of driven coordinates")?;
        self.validate_driven()?;
        require(self.h.is_finite() && self.h > 0.0, "tick h")?;
        require(self.ticks_per_node > 0, "number of ticks of a node")?;
        require(self.nodes > 0, "number of nodes")?;
        let fits = self.ticks_per_node.checked_mul(self.nodes).is_some() && self.seconds().is_finite();
        require(fits, "duration")
    }

    fn validate_driven(&self) -> Result<(), PlanError> {
        let mut least = 0;
        for coordinate in self.driven {
            let position = usize::from(*coordinate);
            if !(least..self.n()).contains(&position) {
                return Err(PlanError::Driven { coordinate: *coordinate });
            }
            least = position + 1;
        }
        Ok(())
    }

    pub(super) fn validate_limits(&self) -> Result<(), PlanError> {
        let mut limits = self.driven.iter().zip(self.limits);
        limits.try_for_each(|(coordinate, [least, most])| {
            let (coordinate, least, most) = (*coordinate, *least, *most);
            if least <= most { Ok(()) } else { Err(PlanError::Limits { coordinate, least, most }) }
        })
    }
}

fn require(condition: bool, what: &'static str) -> Result<(), PlanError> {
    if condition { Ok(()) } else { Err(PlanError::OutOfRange { what }) }
}
