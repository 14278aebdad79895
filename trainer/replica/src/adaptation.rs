//! Core's adapter behind a slice interface.

use crate::control::copied;
use crate::{ParticleSystem, ReplicaError, SystemOf, Visitor};
use leastaction_core::adapt::{Adapter, Agreement, Announcement, Difference, Limits, Moment, Number, Tuning};
use leastaction_core::forces::Coefficient;

/// Maximum number of numbers that follow a machine on the host.
pub const PLACES: usize = 64;
/// Number of pairs of different places.
pub const PAIRS: usize = PLACES * (PLACES - 1) / 2;
/// Settings of an adapter with a place for every number of a model.
pub type TuningOf<const N: usize> = Tuning<f32, N, PLACES>;
/// An adapter with a place for every number of a model.
pub type AdapterOf<const N: usize> = Adapter<f32, N, PLACES, PAIRS>;

/// Settings of an adapter, as [`Tuning`] and [`Limits`] with the sizes of a model: lists have one entry for each coordinate or number.
#[derive(Clone, Debug, PartialEq)]
pub struct AdapterSettings {
    /// Ticks of half a window.
    pub half: u16,
    /// Tick, s.
    pub h: f32,
    /// Standard deviation of the balance of every coordinate, N or N m.
    pub deviation: Vec<f32>,
    /// Share that is forgotten in a window.
    pub forgotten: f32,
    /// Threshold of a change.
    pub change: f32,
    /// Dry friction of every coordinate.
    pub dry: Option<(Coefficient, Vec<f32>)>,
    /// Share of its own inertia that a body keeps.
    pub kept: f32,
    /// Numbers that follow, at most [`PLACES`].
    pub numbers: Vec<Following>,
}

/// A number that follows the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following {
    /// The number.
    pub number: Number,
    /// Value in the model.
    pub model: f32,
    /// Standard deviation of its distance from the model, before anything was seen.
    pub prior: f32,
    /// Variance that it gains in a second, up to that of the prior.
    pub walk: f32,
    /// Smallest and largest distance in use.
    pub limits: [f32; 2],
}

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
        let tuning = Box::new(self.0.tuning()?);
        let adapter = Box::new(Adapter::new(&tuning).map_err(ReplicaError::Unfit)?);
        Ok(Box::new(Running { system, tuning, adapter }))
    }

    fn particles<const D: usize>(self, _: &'c ParticleSystem<'c, D>) -> Self::Output {
        Err(ReplicaError::OfGraph { what: "adapter" })
    }
}

impl AdapterSettings {
    /// The settings for a model of N coordinates.
    ///
    /// # Errors
    /// [`ReplicaError::Length`], [`ReplicaError::Numbers`].
    pub fn tuning<const N: usize>(&self) -> Result<TuningOf<N>, ReplicaError> {
        if self.numbers.len() > PLACES {
            return Err(ReplicaError::Numbers { found: self.numbers.len() });
        }
        let each = |of: fn(&Following) -> f32| std::array::from_fn(|j| self.numbers.get(j).map_or(0.0, of));
        let limits = Limits {
            model: each(|number| number.model),
            lower: each(|number| number.limits[0]),
            upper: each(|number| number.limits[1]),
            kept: self.kept,
        };
        let dry = self.dry.as_ref().map(|(coefficient, level)| {
            Ok::<_, ReplicaError>((*coefficient, copied("the dry friction", level)?))
        });
        let number = |j: usize| self.numbers.get(j).map_or(Number::None, |following| following.number);
        Ok(Tuning {
            numbers: std::array::from_fn(number),
            half: self.half,
            h: self.h,
            deviation: copied("the deviation", &self.deviation)?,
            prior: each(|number| number.prior),
            forgotten: self.forgotten,
            walk: each(|number| number.walk),
            change: self.change,
            limits,
            dry: dry.transpose()?,
        })
    }
}
