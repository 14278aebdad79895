use crate::energy::SizeError;
use crate::energy::inertia_network::{Coordinate, feature_count};
use crate::expected::expected;

/// The coordinates that the network of a law sees and acts on, of N: a few of them, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen<const N: usize> {
    /// How their positions enter; those that are not seen are [`Coordinate::Cyclic`].
    kinds: [Coordinate; N],
    /// Their numbers, in front.
    coordinates: [u8; N],
    count: usize,
}

impl<const N: usize> Seen<N> {
    /// Coordinates by their kinds, `None` for one that is not seen; those behind the last kind are not seen either.
    ///
    /// # Errors
    /// [`SizeError`] where there are more kinds than N.
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

    /// How positions enter.
    #[inline(always)]
    pub(super) fn kinds(&self) -> &[Coordinate; N] {
        &self.kinds
    }

    /// Their number m.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// What a network gets of their positions: one number a length, two an angle.
    #[inline(always)]
    pub fn features(&self) -> usize {
        feature_count(&self.kinds)
    }

    /// Their numbers in order.
    #[inline(always)]
    pub fn iter(&self) -> impl Iterator<Item = usize> {
        expected(self.coordinates.get(..self.count), &[]).iter().map(|i| usize::from(*i))
    }
}
