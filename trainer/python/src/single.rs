//! Evaluation of states side by side in the chip's arithmetic, bit for bit.

use crate::arrays::Table;
use crate::blocks::{BLOCK, fill};
use leastaction_replica::{Evaluator, Replica, ReplicaError};

/// Quantity computed for every state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Energies T and V, J.
    Energies,
    /// Acceleration v̇(q, v, τ), m/s² or rad/s².
    Acceleration,
    /// Forces τ(q, v, v̇), N or N m.
    InverseDynamics,
    /// Mass matrix M(q), row by row.
    MassMatrix,
}

impl Quantity {
    /// The quantity with this name.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "energies" => Some(Self::Energies),
            "acceleration" => Some(Self::Acceleration),
            "inverse_dynamics" => Some(Self::InverseDynamics),
            "mass_matrix" => Some(Self::MassMatrix),
            _ => None,
        }
    }

    /// Number of input vectors.
    pub const fn inputs(self) -> usize {
        match self {
            Self::MassMatrix => 1,
            Self::Energies => 2,
            Self::Acceleration | Self::InverseDynamics => 3,
        }
    }

    /// Number of output numbers for n coordinates.
    pub const fn width(self, n: usize) -> usize {
        match self {
            Self::Energies => 2,
            Self::Acceleration | Self::InverseDynamics => n,
            Self::MassMatrix => n * n,
        }
    }
}

/// A state for which a quantity cannot be computed, and the reason.
#[derive(Debug)]
pub struct Unsolved {
    /// Index of the state.
    pub index: usize,
    /// Reason.
    pub error: ReplicaError,
}

/// Computes a quantity of every state; a value that does not exist is NaN, or leads to an error.
///
/// # Errors
/// [`Unsolved`] for the first state without a value, unless `nan` is set.
pub fn evaluate(
    chip: &Replica,
    (quantity, nan): (Quantity, bool),
    (inputs, count): (&[Table<f32>], usize),
) -> Result<Vec<f32>, Unsolved> {
    let width = quantity.width(chip.n());
    let mut numbers = vec![0.0; count * width];
    fill((&mut numbers, width, BLOCK), |first, rows| {
        let failed = |index: usize| move |error| Unsolved { index, error };
        let mut evaluator = chip.evaluator().map_err(failed(first))?;
        for (k, to) in rows.chunks_exact_mut(width).enumerate() {
            let index = first + k;
            match of_state(&mut *evaluator, quantity, (inputs, index), to) {
                Err(_) if nan => to.fill(f32::NAN),
                done => done.map_err(failed(index))?,
            }
        }
        Ok(())
    })?;
    Ok(numbers)
}

fn of_state(
    evaluator: &mut dyn Evaluator,
    quantity: Quantity,
    (inputs, index): (&[Table<f32>], usize),
    to: &mut [f32],
) -> Result<(), ReplicaError> {
    let row = |which: usize| inputs.get(which).map_or(&[][..], |table| table.row(index));
    match quantity {
        Quantity::Energies => {
            let energies = evaluator.energies(row(0), row(1))?;
            to.copy_from_slice(&[energies.kinetic, energies.potential]);
            Ok(())
        }
        Quantity::Acceleration => evaluator.acceleration(row(0), row(1), row(2), to),
        Quantity::InverseDynamics => evaluator.inverse_dynamics(row(0), row(1), row(2), to),
        Quantity::MassMatrix => evaluator.mass_matrix(row(0), to),
    }
}
