//! Shapes of networks, one by one and in lists, and the sizes that a program is compiled for.

use super::List;
use crate::network::{Activation, Mlp};
use crate::scalar::WeightFormat;
use core::fmt;
use serde::{Deserialize, Serialize};

/// Maximum number of hidden layers of a network.
pub const MAX_HIDDEN: usize = 4;

/// The shape of one network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NetworkShape {
    /// Number of inputs.
    pub inputs: u8,
    /// Units of the hidden layers; the first 0 ends the list.
    pub widths: [u16; MAX_HIDDEN],
    /// Number of outputs.
    pub outputs: u8,
    /// Activation of the hidden layers.
    pub activation: Activation,
}

impl NetworkShape {
    /// Creates a network shape with hidden layers of the given widths; `None` for more than `MAX_HIDDEN` of them.
    pub fn new(inputs: u8, widths: &[u16], outputs: u8, activation: Activation) -> Option<Self> {
        let mut all = [0; MAX_HIDDEN];
        all.get_mut(..widths.len())?.copy_from_slice(widths);
        Some(Self { inputs, widths: all, outputs, activation })
    }

    /// Units of each hidden layer, and the number of hidden layers.
    pub fn widths(&self) -> ([usize; MAX_HIDDEN], usize) {
        let depth = self.widths.iter().take_while(|width| **width != 0).count();
        (self.widths.map(usize::from), depth)
    }

    /// Number of inputs of the output layer.
    pub fn last_inputs(&self) -> usize {
        let last = self.widths.iter().take_while(|width| **width != 0).last();
        last.map_or(self.inputs.into(), |width| usize::from(*width))
    }

    /// Length of the weight block, in numbers; `None` on overflow.
    pub fn parameters(&self) -> Option<usize> {
        let (widths, depth) = self.widths();
        Mlp::<f32, 0, 0>::parameters(self.inputs.into(), widths.get(..depth)?, self.outputs.into())
    }

    /// Whether only zeros follow the first 0 of the widths.
    pub fn is_valid(&self) -> bool {
        let (_, depth) = self.widths();
        self.widths.iter().skip(depth).all(|width| *width == 0)
    }

    /// Whether the network has the given numbers of inputs and outputs.
    pub fn serves(&self, inputs: usize, outputs: usize) -> bool {
        usize::from(self.inputs) == inputs && usize::from(self.outputs) == outputs
    }

    /// Takes the network from the front of `block`. `None` if the block is too short, or the network has more than `L` hidden layers or `H`
    /// units in a layer.
    #[inline(always)]
    pub(crate) fn take<'a, W: WeightFormat, const H: usize, const L: usize>(
        &self,
        block: &mut &'a [W],
    ) -> Option<Mlp<'a, W, H, L>> {
        let (widths, depth) = self.widths();
        Mlp::take(block, self.inputs.into(), widths.get(..depth)?, self.outputs.into(), self.activation)
    }

    /// Checks that the network has at most `L` hidden layers, each of at most `H` units.
    ///
    /// # Errors
    /// [`SizeError`] with the first limit that is exceeded.
    pub fn check_size<const H: usize, const L: usize>(&self) -> Result<(), SizeError> {
        let (widths, depth) = self.widths();
        SizeError::check("hidden layers", depth, L)?;
        widths.into_iter().try_for_each(|width| SizeError::check("units in a hidden layer", width, H))
    }
}

/// Operations on all networks of a model.
impl<const MAX: usize> List<NetworkShape, MAX> {
    /// Length of all networks in the weight block, in numbers; `None` on overflow.
    pub fn parameters(&self) -> Option<usize> {
        self.iter().try_fold(0usize, |sum, network| sum.checked_add(network.parameters()?))
    }

    /// Whether the network with this number exists and has the given numbers of inputs and outputs.
    // Not generic: one copy of the code serves every use of a network.
    #[inline(never)]
    pub fn serves(&self, network: u8, inputs: usize, outputs: usize) -> bool {
        self.get(network).is_some_and(|network| network.serves(inputs, outputs))
    }

    /// Name of the first part that is invalid for every use of the networks; `None` if there is none.
    pub fn invalid_part(&self) -> Option<&'static str> {
        let invalid = [
            (self.has_gap(), "list of networks"),
            (!self.iter().all(NetworkShape::is_valid), "hidden width"),
        ];
        first_invalid(&invalid)
    }

    /// Checks that there are at most `K` networks, each of at most `L` hidden layers of at most `H` units.
    ///
    /// # Errors
    /// [`SizeError`] with the first limit that is exceeded.
    pub fn check_size<const K: usize, const H: usize, const L: usize>(&self) -> Result<(), SizeError> {
        SizeError::check("networks", self.len(), K)?;
        self.iter().try_for_each(NetworkShape::check_size::<H, L>)
    }

    /// Takes all networks from the front of `block`. `None` if the block is too short, there are more than `K` networks, or a network has
    /// more than `L` hidden layers or `H` units in a layer.
    pub(super) fn take<'a, W: WeightFormat, const K: usize, const H: usize, const L: usize>(
        &self,
        block: &mut &'a [W],
    ) -> Option<List<Mlp<'a, W, H, L>, K>> {
        self.try_map(|network| network.take(block))
    }
}

/// Name of the first invalid part; `None` if all are valid.
pub(super) fn first_invalid(parts: &[(bool, &'static str)]) -> Option<&'static str> {
    parts.iter().find(|(invalid, _)| *invalid).map(|(_, name)| *name)
}

/// A size of a model that the program was not compiled for.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizeError {
    /// Counted quantity: coordinates, dimensions of space, types, networks, hidden layers, or units in a layer.
    pub what: &'static str,
    /// Count in the model.
    pub found: usize,
    /// Count compiled in: exact for coordinates and dimensions of space, a maximum for all other quantities.
    pub compiled: usize,
}

impl SizeError {
    /// Checks a number that may be at most `compiled`.
    ///
    /// # Errors
    /// The error itself, for a larger number.
    pub fn check(what: &'static str, found: usize, compiled: usize) -> Result<(), Self> {
        if found <= compiled { Ok(()) } else { Err(Self { what, found, compiled }) }
    }
}

impl fmt::Display for SizeError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { what, found, compiled } = self;
        write!(f, "{found} {what}, but this program was compiled for {compiled}")
    }
}

impl core::error::Error for SizeError {}
