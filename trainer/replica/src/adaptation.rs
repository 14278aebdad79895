//! Core's adapter behind a slice interface.

use crate::control::copied;
use crate::{ParticleSystem, ReplicaError, SystemOf, Visitor};
use leastaction_core::adapt::{
    Adapter, Agreement, Announcement, Difference, Following, Moment, Settings, Tuning,
};

/// Maximum number of numbers that follow a machine on the host.
pub const PLACES: usize = 64;
/// Number of pairs of different places.
pub const PAIRS: usize = PLACES * (PLACES - 1) / 2;
/// Settings of an adapter with a place for every number of a model.
pub type TuningOf<const N: usize> = Tuning<f32, N, PLACES>;
/// An adapter with a place for every number of a model.
pub type AdapterOf<const N: usize> = Adapter<f32, N, PLACES, PAIRS>;

/// Settings of an adapter with the sizes of a model.
pub type AdapterSettings = Settings<Vec<f32>, Vec<Following>>;

/// State of a machine and what its drives do, as [`Moment`] with the sizes of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant<'a> {
    /// Position.
    pub q: &'a [f32],
    /// Velocity.
    pub v: &'a [f32],
    /// Command, behind the delays of the drives.
    pub command: &'a [f32],
    /// Force at the outputs of the drives, N or N m.
    pub force: &'a [f32],
}

/// Numbers that follow a machine, bit for bit as on the chip; see [`leastaction_core::adapt`].
pub trait Adaptation: Send {
    /// Takes a tick.
    ///
    /// # Errors
    /// [`ReplicaError::Length`].
    fn take(&mut self, instant: Instant) -> Result<Option<Agreement<f32>>, ReplicaError>;

    /// Passes a tick of which nothing can be learned.
    fn skip(&mut self);

    /// Findings so far.
    fn findings(&self) -> &dyn Findings;
}

/// Findings of an adapter about its machine.
pub trait Findings {
    /// Estimated distance of number j from the model, with its standard error.
    fn estimate(&self, j: usize) -> Option<Difference<f32>>;

    /// Balance of the model without any adaptation over the last window, N or N m.
    fn residuals(&self) -> &[f32];

    /// The distance of number j that is in use.
    fn applied(&self, j: usize) -> Option<f32>;

    /// The difference that is announced, if it is.
    fn announced(&self, announcement: &Announcement<f32>) -> Option<Difference<f32>>;

    /// Whether no choice of the numbers explains the machine.
    fn unlike(&self) -> bool;
}

/// A model with its adapter.
struct Running<'c, const N: usize> {
    system: &'c SystemOf<'c, N>,
    tuning: Box<TuningOf<N>>,
    adapter: Box<AdapterOf<N>>,
}

impl<const N: usize> Adaptation for Running<'_, N> {
    fn take(
        &mut self,
        Instant { q, v, command, force }: Instant,
    ) -> Result<Option<Agreement<f32>>, ReplicaError> {
        let (q, v) = (copied("q", q)?, copied("v", v)?);
        let (command, force) = (copied("the command", command)?, copied("the force", force)?);
        Ok(self.adapter.take(&self.tuning, self.system, &Moment { q, v, command, force }))
    }

    fn skip(&mut self) {
        self.adapter.skip(&self.tuning);
    }

    fn findings(&self) -> &dyn Findings {
        &*self.adapter
    }
}

impl<const N: usize> Findings for AdapterOf<N> {
    fn estimate(&self, j: usize) -> Option<Difference<f32>> {
        let filter = self.filter();
        Some(Difference { estimate: *filter.estimate().get(j)?, error: filter.variance(j).sqrt() })
    }

    fn residuals(&self) -> &[f32] {
        AdapterOf::residuals(self)
    }

    fn applied(&self, j: usize) -> Option<f32> {
        AdapterOf::applied(self).get(j).copied()
    }

    fn announced(&self, announcement: &Announcement<f32>) -> Option<Difference<f32>> {
        announcement.of(self.filter())
    }

    fn unlike(&self) -> bool {
        AdapterOf::unlike(self)
    }
}

/// Visitor that creates adapters.
pub(crate) struct Adapt<'s>(pub &'s AdapterSettings);

impl<'c> Visitor<'c> for Adapt<'_> {
    type Output = Result<Box<dyn Adaptation + 'c>, ReplicaError>;

    fn coordinates<const N: usize>(self, system: &'c SystemOf<'c, N>) -> Self::Output {
        let tuning = Box::new(self.0.tuning().map_err(ReplicaError::Settings)?);
        let adapter = Box::new(Adapter::new(&tuning).map_err(ReplicaError::Unfit)?);
        Ok(Box::new(Running { system, tuning, adapter }))
    }

    fn particles<const D: usize>(self, _: &'c ParticleSystem<'c, D>) -> Self::Output {
        Err(ReplicaError::OfGraph { what: "adapter" })
    }
}
