use super::ModelError;
use super::header::require;
use super::section::take_f32;
use serde::{Deserialize, Serialize};

/// Smallest and largest value of a quantity in the training data.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Smallest value.
    pub least: f32,
    /// Largest value, not below `least`.
    pub most: f32,
}

impl Interval {
    fn contains(&self, x: f32) -> bool {
        self.least <= x && x <= self.most
    }
}

/// Range of one coordinate in the training data.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoordinateRange {
    /// Position q, m or rad.
    pub q: Interval,
    /// Velocity v, m/s or rad/s.
    pub v: Interval,
    /// Control u, N or N m.
    pub u: Interval,
    /// Period of the coordinate, by which q may be changed without any effect: 2π for an angle, 0 for a length.
    pub period: f32,
}

/// A quantity outside the training data.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outside {
    /// The coordinate, from 0.
    pub coordinate: usize,
    /// `q`, `v` or `u`.
    pub quantity: char,
}

impl CoordinateRange {
    /// Length in a model file, bytes: least and most of q, v and u, then the period, four bytes each.
    pub const BYTES: usize = 28;

    /// Converts the range to its bytes in a model file.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let Self { q, v, u, period } = self;
        let numbers = [q.least, q.most, v.least, v.most, u.least, u.most, period];
        let mut bytes = [0; Self::BYTES];
        for (slot, number) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(numbers) {
            *slot = number.to_le_bytes();
        }
        bytes
    }

    fn from_bytes(mut bytes: &[u8]) -> Result<Self, ModelError> {
        let mut interval = || -> Result<_, ModelError> {
            Ok(Interval { least: take_f32(&mut bytes)?, most: take_f32(&mut bytes)? })
        };
        let (q, v, u) = (interval()?, interval()?, interval()?);
        Ok(Self { q, v, u, period: take_f32(&mut bytes)? })
    }

    fn validate(&self) -> Result<(), ModelError> {
        let rises = |x: &Interval| x.least.is_finite() && x.most.is_finite() && x.least <= x.most;
        require([self.q, self.v, self.u].iter().all(rises), "range of the training data")?;
        require(self.period.is_finite() && self.period >= 0.0, "period of a coordinate")
    }

    /// The first of q, v and u that lies outside.
    fn outside(&self, q: f32, v: f32, u: f32) -> Option<char> {
        if !self.contains_position(q) {
            return Some('q');
        }
        if !self.v.contains(v) {
            return Some('v');
        }
        if self.u.contains(u) { None } else { Some('u') }
    }

    /// Whether q, possibly shifted by whole periods, lies inside.
    fn contains_position(&self, q: f32) -> bool {
        if self.period > 0.0 && q.is_finite() {
            let turns = (q - self.q.least) / self.period;
            return self.q.least + (turns - libm::floorf(turns)) * self.period <= self.q.most;
        }
        self.q.contains(q)
    }
}

/// The training range of one mechanism in its file form, coordinate by coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrainingRange<'a>(&'a [u8]);

impl<'a> TrainingRange<'a> {
    /// Checks and borrows the bytes of a model file.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] if a number is not finite or a `most` is below its `least`.
    pub fn new(bytes: &'a [u8]) -> Result<Self, ModelError> {
        let range = Self(bytes);
        require(bytes.len().is_multiple_of(CoordinateRange::BYTES), "length of the training range")?;
        range.coordinates().try_for_each(|coordinate| coordinate?.validate())?;
        Ok(range)
    }

    /// The bytes of the range in the file.
    pub const fn bytes(&self) -> &'a [u8] {
        self.0
    }

    /// Number of coordinates.
    pub fn n(&self) -> usize {
        self.0.len() / CoordinateRange::BYTES
    }

    /// The range of every coordinate.
    pub fn coordinates(&self) -> impl Iterator<Item = Result<CoordinateRange, ModelError>> + use<'a> {
        let (coordinates, _) = self.0.as_chunks::<{ CoordinateRange::BYTES }>();
        coordinates.iter().map(|bytes| CoordinateRange::from_bytes(bytes))
    }

    /// Finds the first quantity of a state and control that lies outside the training data: there the model extrapolates, and a controller
    /// should not trust it. NaN lies outside.
    ///
    /// # Errors
    /// [`ModelError::Shape`] if the range has a different number of coordinates.
    pub fn outside<const N: usize>(
        &self,
        q: &[f32; N],
        v: &[f32; N],
        u: &[f32; N],
    ) -> Result<Option<Outside>, ModelError> {
        if self.n() != N {
            return Err(ModelError::Shape {
                what: "coordinates of the training range",
                found: self.n(),
                compiled: N,
            });
        }
        for (coordinate, (((range, q), v), u)) in self.coordinates().zip(q).zip(v).zip(u).enumerate() {
            if let Some(quantity) = range?.outside(*q, *v, *u) {
                return Ok(Some(Outside { coordinate, quantity }));
            }
        }
        Ok(None)
    }
}
