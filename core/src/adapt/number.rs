use crate::forces::{Coefficient, Forces, System};
use crate::lagrangian::{Column, Lagrangian};
use crate::scalar::Real;
use serde::{Deserialize, Serialize};

/// Maximum number of inertial numbers of a body.
const INERTIAL: usize = crate::energy::arm::INERTIAL_PARAMETERS;

/// A number of a model that may follow the machine. The order is that of [patch](super::Patch) files.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Number {
    /// No number: a place that is not used.
    #[default]
    None,
    /// An inertial number of a body, in the order of [`Lagrangian::inertial_columns`].
    Inertia {
        /// The body, from 0.
        body: u8,
        /// Position of the number among those of the body.
        index: u8,
    },
    /// Rotor inertia J of a coordinate's drive, reflected to the coordinate: T = ½Jv².
    Rotor(u8),
    /// Coefficient of friction of a coordinate.
    Friction(Coefficient, u8),
    /// Offset o of a coordinate's drive, τ = gu + o.
    Offset(u8),
    /// Gain g of a coordinate's drive, τ = gu + o. It is known only while some inertia is.
    Gain(u8),
    /// Weight of a unit in the last layer of the network of [`PotentialCorrection`](crate::forces::PotentialCorrection), J; units count from 0.
    Potential(u8),
    /// Strength of a column of the factor L that the network of [`Dissipation`](crate::forces::Dissipation) returns, 1 in the model:
    /// Q = −L diag(1 + δ) Lᵀv. Columns count from 0.
    Dissipation(u8),
}

/// State of a machine between two steps, and what its drives do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment<R, const N: usize> {
    /// Position.
    pub q: [R; N],
    /// Velocity.
    pub v: [R; N],
    /// Command u, mean of those before and after; it is what a gain multiplies.
    pub command: [R; N],
    /// Force τ at the outputs of the drives, likewise, N or N m.
    pub force: [R; N],
}

/// Columns of all numbers.
pub(super) fn columns<R, L, F, const N: usize, const P: usize>(
    system: &System<L, F>,
    numbers: &[Number; P],
    moment: &Moment<R, N>,
) -> [Column<R, N>; P]
where
    R: Real,
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    let mut columns = [Column::zero(); P];
    // Numbers of one body, or of one coefficient, follow each other, and are evaluated together.
    let (mut body, mut friction) = (None, None);
    let mut inertial = [Column::zero(); INERTIAL];
    let mut slopes = [R::zero(); N];
    for (column, number) in columns.iter_mut().zip(numbers) {
        match *number {
            Number::None | Number::Potential(_) | Number::Dissipation(_) => {}
            Number::Inertia { body: of, index } => {
                if body != Some(of) {
                    inertial = [Column::zero(); INERTIAL];
                    system.lagrangian.inertial_columns(of.into(), &moment.q, &moment.v, &mut inertial);
                    body = Some(of);
                }
                *column = inertial.get(usize::from(index)).copied().unwrap_or(Column::zero());
            }
            Number::Friction(coefficient, i) => {
                if friction != Some(coefficient) {
                    slopes = system.forces.slopes(coefficient, &moment.v);
                    friction = Some(coefficient);
                }
                own(&mut column.force, i, &slopes);
            }
            Number::Rotor(i) => own(&mut column.momentum, i, &moment.v),
            Number::Offset(i) => own(&mut column.force, i, &[R::one(); N]),
            Number::Gain(i) => own(&mut column.force, i, &moment.command),
        }
    }
    system.forces.network_columns(&moment.q, &moment.v, numbers, &mut columns);
    columns
}

/// Copies the entry of one coordinate.
fn own<R: Real, const N: usize>(to: &mut [R; N], coordinate: u8, from: &[R; N]) {
    let i = usize::from(coordinate);
    if let (Some(to), Some(from)) = (to.get_mut(i), from.get(i)) {
        *to = *from;
    }
}

/// Bodies among the numbers: position of the first number and how many there are.
pub(super) fn bodies<const P: usize>(numbers: &[Number; P]) -> impl Iterator<Item = (usize, usize)> {
    let of = |number: &Number| match number {
        Number::Inertia { body, .. } => Some(*body),
        _ => None,
    };
    numbers.iter().enumerate().filter_map(move |(first, number)| {
        let Number::Inertia { body, index: 0 } = number else { return None };
        let count = numbers.iter().skip(first).take_while(|number| of(number) == Some(*body)).count();
        Some((first, count))
    })
}
