use super::Number;
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;

/// A model in N coordinates whose numbers may be changed while it runs.
pub trait Tunable<const N: usize> {
    /// Lagrangian with some choice of the numbers.
    type Lagrangian<'s>: Lagrangian<f32, N>
    where
        Self: 's;
    /// Forces with some choice of the numbers.
    type Forces<'s>: Forces<f32, N>
    where
        Self: 's;

    /// The model of the file.
    fn of_file(&self) -> &System<Self::Lagrangian<'_>, Self::Forces<'_>>;

    /// The model with the numbers in use.
    fn in_use(&self) -> System<Self::Lagrangian<'_>, Self::Forces<'_>>;

    /// Sets numbers at distances from those of the file. Numbers that the file does not have are left out.
    fn set(&mut self, numbers: &[Number], distances: &[f32]);
}
