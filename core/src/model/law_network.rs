//! Shape of a law's network; it follows the law's number in the section of forces.

use super::header::{MAX_COORDINATES, require};
use super::{Law, ModelError};
use crate::energy::inertia_network::{Coordinate, feature_count};
use crate::energy::{MAX_HIDDEN, NetworkShape};
use crate::forces::Seen;
use crate::network::Activation;
use serde::{Deserialize, Serialize};

/// Inputs and hidden layers of a law's network. The numbers of inputs and outputs follow from the law.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LawNetwork<'a> {
    /// One letter per coordinate of the model, up to the last that the network sees: `t` for a length, `a` for the cosine and sine of an
    /// angle, `c` for a coordinate whose position is not seen (dissipation sees its velocity), `-` for one that is not seen at all.
    pub coordinates: &'a str,
    /// Units of the hidden layers; the first 0 ends the list.
    pub widths: [u16; MAX_HIDDEN],
    /// Activation of the hidden layers.
    pub activation: Activation,
}

/// The letter for a coordinate that a law's network does not see.
const UNSEEN: char = '-';

impl LawNetwork<'_> {
    /// The kind of every coordinate, `None` for an unseen one; an error for an unknown letter.
    // Reads bytes, since decoding characters would take more code.
    fn letters(&self) -> impl Iterator<Item = Result<Option<Coordinate>, ModelError>> {
        self.coordinates.as_bytes().iter().map(|letter| match char::from(*letter) {
            UNSEEN => Ok(None),
            letter => Coordinate::from_letter(letter)
                .map(Some)
                .ok_or(ModelError::OutOfRange { what: "coordinate of a law's network" }),
        })
    }

    fn seen_kinds(&self) -> impl Iterator<Item = Coordinate> {
        self.letters().flatten().flatten()
    }

    /// Returns the coordinates that the network sees, out of N.
    ///
    /// # Errors
    /// [`ModelError::Shape`] for more than N letters, [`ModelError::OutOfRange`] for an unknown letter.
    pub fn seen<const N: usize>(&self) -> Result<Seen<N>, ModelError> {
        self.letters().try_for_each(|letter| letter.map(|_| ()))?;
        Ok(Seen::new(self.letters().flatten())?)
    }

    /// Number m of seen coordinates.
    pub fn count(&self) -> usize {
        self.seen_kinds().count()
    }

    /// Shape of the network for the given law.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for a law without a network.
    pub fn network(&self, law: Law) -> Result<NetworkShape, ModelError> {
        let (m, features) =
            (self.count(), self.seen_kinds().map(|kind| feature_count(&[kind])).sum::<usize>());
        let sizes = match law {
            Law::Dissipation => Some((features + m, m * (m + 1) / 2)),
            Law::Potential => Some((features, 1)),
            _ => None,
        };
        let shape = |(inputs, outputs): (usize, usize)| {
            let (inputs, outputs) = (inputs.try_into().ok()?, outputs.try_into().ok()?);
            NetworkShape::new(inputs, &self.widths, outputs, self.activation)
        };
        sizes.and_then(shape).ok_or(ModelError::OutOfRange { what: "coordinates of a law's network" })
    }

    /// Length of the weight block in numbers: the scale of every velocity (dissipation only), then the network's. `None` if no such network
    /// can exist.
    pub(super) fn parameters(&self, law: Law) -> Option<usize> {
        let scales = if law == Law::Dissipation { self.count() } else { 0 };
        self.network(law).ok()?.parameters()?.checked_add(scales)
    }

    /// Checks the shape for a model of at least `coordinates` coordinates.
    pub(super) fn validate(&self, law: Law, coordinates: usize) -> Result<(), ModelError> {
        const WHAT: &str = "coordinates of a law's network";
        let letters = self.coordinates.len();
        require((1..=MAX_COORDINATES).contains(&self.count()) && letters <= coordinates, WHAT)?;
        self.letters().try_for_each(|letter| letter.map(|_| ()))?;
        // Each shape is written in one way only: no letters behind the last seen coordinate, and no `c` for a potential.
        require(!self.coordinates.ends_with(UNSEEN), WHAT)?;
        let cyclic = self.seen_kinds().any(|kind| kind == Coordinate::Cyclic);
        require(law != Law::Potential || !cyclic, WHAT)?;
        require(self.network(law)?.is_valid(), "hidden width")
    }
}
