use super::ModelError;
use super::header::require;
use super::section::take_f32;
use crate::discrete::{Del, Order, Path};
use crate::forces::ControlKind;
use crate::scalar::Real;
use serde::{Deserialize, Serialize};

/// The step that a model was trained with. With another step the model is less accurate, because a model trained as a
/// discrete Lagrangian has absorbed the error of its integrator.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrainedStep {
    /// Order of the integrator.
    pub order: Order,
    /// Step size h > 0, s.
    pub h: f32,
    /// Course of the command between two samples.
    pub control: ControlKind,
}

impl TrainedStep {
    /// Length in a model file, bytes: the order, h, the kind of control.
    pub const BYTES: usize = 6;

    /// Converts the step to its bytes in a model file.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let [a, b, c, d] = self.h.to_le_bytes();
        [self.order.number(), a, b, c, d, self.control as u8]
    }

    /// Reads the step of a model file.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for an order other than 2 and 4, a step that is not positive and finite, or an unknown kind
    /// of control.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ModelError> {
        let [order, h @ .., control] =
            *<&[u8; Self::BYTES]>::try_from(bytes).map_err(|_| ModelError::Malformed)?;
        let order = Order::from_number(order).ok_or(ModelError::OutOfRange { what: "order" })?;
        let h = take_f32(&mut h.as_slice())?;
        let control = match control {
            0 => ControlKind::Held,
            1 => ControlKind::Linear,
            _ => return Err(ModelError::OutOfRange { what: "kind of control" }),
        };
        Self { order, h, control }.checked()
    }

    /// Returns the step unchanged if it is valid.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] unless h is positive and finite.
    pub(crate) fn checked(self) -> Result<Self, ModelError> {
        require(self.h.is_finite() && self.h > 0.0, "step h")?;
        Ok(self)
    }

    /// The integrator that the model was trained with, along paths of type `P`.
    ///
    /// # Errors
    /// [`ModelError::Order`] if the model was trained with another order than that of `P`.
    pub fn del<R: Real, P: Path>(&self) -> Result<Del<R, P>, ModelError> {
        self.check_order(P::ORDER)?;
        Ok(Del::new(R::constant(self.h.into())))
    }

    /// Checks the program's kind of control against the one used in training.
    ///
    /// # Errors
    /// [`ModelError::Control`] if they differ.
    pub fn check_control(&self, compiled: ControlKind) -> Result<(), ModelError> {
        let found = self.control;
        if found == compiled { Ok(()) } else { Err(ModelError::Control { found }) }
    }

    /// Checks the order of an integrator against the order used in training.
    ///
    /// # Errors
    /// [`ModelError::Order`] if they differ.
    pub fn check_order(&self, compiled: Order) -> Result<(), ModelError> {
        let found = self.order;
        if found == compiled {
            Ok(())
        } else {
            Err(ModelError::Order { found: found.number(), compiled: compiled.number() })
        }
    }
}
