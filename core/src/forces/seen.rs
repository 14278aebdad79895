use crate::energy::SizeError;
use crate::energy::inertia_network::{Coordinate, feature_count};
use crate::expected::expected;

/// The few of N coordinates that a law's network sees and acts on, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen<const N: usize> {
    /// Kinds of the seen coordinates; unseen ones are [`Coordinate::Cyclic`].
    kinds: [Coordinate; N],
    /// Indices of the seen coordinates, at the front.
    coordinates: [u8; N],
    count: usize,
}

impl<const N: usize> Seen<N> {
    /// Creates the list from the kind of every coordinate, `None` for an unseen one; coordinates after the last kind are unseen, too.
    ///
    /// # Errors
    /// [`SizeError`] if there are more than N kinds.
    pub fn new(kinds: impl IntoIterator<Item = Option<Coordinate>>) -> Result<Self, SizeError> {
        let mut seen = Self { kinds: [Coordinate::Cyclic; N], coordinates: [0; N], count: 0 };
        let mut found = 0;
        for (i, kind) in kinds.into_iter().enumerate() {
            found = i + 1;
            if let (Some(kind), Some(slot)) = (kind, seen.kinds.get_mut(i)) {
                *slot = kind;
                if let Some(slot) = seen.coordinates.get_mut(seen.count) {
                    *slot = i as u8;
                    seen.count += 1;
                }
            }
        }
        SizeError::check("coordinates of a law's network", found, N)?;
        Ok(seen)
    }

    /// Kinds of the coordinates as network inputs.
    #[inline(always)]
    pub(super) fn kinds(&self) -> &[Coordinate; N] {
        &self.kinds
    }

    /// Number m of seen coordinates.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Number of position features for a network: one per length, two per angle.
    #[inline(always)]
    pub fn features(&self) -> usize {
        feature_count(&self.kinds)
    }

    /// Indices of the seen coordinates, in order.
    #[inline(always)]
    pub fn iter(&self) -> impl Iterator<Item = usize> {
        expected(self.coordinates.get(..self.count), &[]).iter().map(|i| usize::from(*i))
    }
}
