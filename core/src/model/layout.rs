use super::{ArmHeader, BodiesHeader, Family, Law, Laws, ModelError, ShapeHeader};
use crate::adapt::Number;
use crate::energy::arm::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, INERTIAL_PARAMETERS};
use crate::energy::bodies::{BODY_PARAMETERS, BodyParameters, GRAVITY_PARAMETERS, PlanarInertia};
use crate::forces::Coefficient;
use crate::scalar::WeightFormat;

/// Places of the [numbers](Number) that may follow a machine in the weight block of its model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout<'a> {
    bodies: Bodies,
    /// Length of the energies' part of the block.
    pub(super) energies: usize,
    /// Number of coordinates, if each has friction of its own.
    coordinates: usize,
    pub(super) laws: Laws<'a>,
}

/// Kind of the bodies in a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Bodies {
    None,
    Plane,
    Space,
}

/// Numbers of a body in space that come before its inertia in the block.
const BEFORE_INERTIA: usize = ARM_PARAMETERS - INERTIAL_PARAMETERS - 1;

impl<'a> Layout<'a> {
    /// Creates the layout of a model's block.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for an impossible shape.
    pub fn new<'s, H: ShapeHeader<'s>>(shape: &H, laws: Laws<'a>) -> Result<Self, ModelError> {
        let (number, _) = H::FAMILY;
        let bodies = match number {
            _ if number == BodiesHeader::FAMILY.0 => Bodies::Plane,
            _ if number == ArmHeader::FAMILY.0 => Bodies::Space,
            _ => Bodies::None,
        };
        let own = shape.groups() == shape.coordinates();
        let coordinates = if own { shape.coordinates() } else { 0 };
        Ok(Self { bodies, energies: shape.parameters()?, coordinates, laws })
    }

    /// Creates the layout of the block of any family.
    ///
    /// # Errors
    /// See [`Layout::new`].
    pub fn of(family: &Family, laws: Laws<'a>) -> Result<Self, ModelError> {
        match family {
            Family::InertiaNetwork(shape) => Self::new(shape, laws),
            Family::Modular(shape) => Self::new(shape, laws),
            Family::Graph(shape) => Self::new(shape, laws),
            Family::Bodies(shape) => Self::new(shape, laws),
            Family::Arm(shape) => Self::new(shape, laws),
        }
    }

    /// The value of a number in the block; `None` if the block does not have it, as gains and offsets of drives.
    pub fn value<W: WeightFormat<Wide = f32>>(&self, weights: &[W], number: Number) -> Option<f32> {
        match (number, self.bodies) {
            (Number::Inertia { body, index }, Bodies::Plane) => {
                let inertia = PlanarInertia::of_body(&planar(weights, body)?).into_array();
                inertia.get(usize::from(index)).copied()
            }
            _ => weights.get(self.place(number)?).map(|weight| weight.wide()),
        }
    }

    /// Writes the numbers of a model file with the distances δ added; the block is otherwise what it was. Numbers that the block does not have
    /// are left out.
    pub fn write<W: WeightFormat<Wide = f32>>(
        &self,
        file: &[W],
        (numbers, distances): (&[Number], &[f32]),
        block: &mut [f32],
    ) {
        // Numbers of one coefficient follow each other, and their places are found together.
        let (mut coefficient, mut friction) = (None, None);
        for (j, (number, distance)) in numbers.iter().zip(distances).enumerate() {
            if let (Number::Inertia { body, index: 0 }, Bodies::Plane) = (number, self.bodies) {
                write_planar((file, block), *body, distances.get(j..).unwrap_or_default());
                continue;
            }
            let place = match *number {
                Number::Friction(of, i) => {
                    if coefficient != Some(of) {
                        (coefficient, friction) = (Some(of), self.friction(of));
                    }
                    friction.and_then(|friction| self.of_coordinate(friction, i))
                }
                number => self.place(number),
            };
            let Some(place) = place else { continue };
            if let (Some(own), Some(weight)) = (block.get_mut(place), file.get(place)) {
                *own = weight.wide() + distance;
            }
        }
    }

    /// Position of a number that the block has as it is.
    fn place(&self, number: Number) -> Option<usize> {
        let of_body = |body: u8| ARM_GRAVITY_PARAMETERS + usize::from(body) * ARM_PARAMETERS;
        match (number, self.bodies) {
            (Number::Inertia { body, index }, Bodies::Space) => {
                Some(of_body(body) + BEFORE_INERTIA + usize::from(index))
            }
            (Number::Rotor(i), Bodies::Space) => Some(of_body(i) + ARM_PARAMETERS - 1),
            (Number::Friction(coefficient, i), _) => self.of_coordinate(self.friction(coefficient)?, i),
            _ => None,
        }
    }

    /// Position of the first coordinate's number of a coefficient, and the distance to that of the next coordinate.
    fn friction(&self, coefficient: Coefficient) -> Option<[usize; 2]> {
        let (law, position) = match coefficient {
            Coefficient::Viscous => (Law::Viscous, 0),
            Coefficient::Coulomb => (Law::Coulomb, 0),
            Coefficient::DirectionalViscous => (Law::Directional, 0),
            Coefficient::Directional => (Law::Directional, 2),
            Coefficient::Sticking => (Law::Sticking, 0),
        };
        if !self.laws.contains(law) {
            return None;
        }
        let before = self.laws.iter().take_while(|other| *other != law);
        let parameters = |sum: usize, law| Some(sum + self.laws.parameters_of(law, self.coordinates)?);
        let first = before.into_iter().try_fold(self.energies, parameters)?;
        Some([first + position, law.ranges().len()])
    }

    fn of_coordinate(&self, [first, apart]: [usize; 2], i: u8) -> Option<usize> {
        let i = usize::from(i);
        (i < self.coordinates).then_some(first + i * apart)
    }
}

/// Numbers of a body in the plane.
fn planar<W: WeightFormat<Wide = f32>>(weights: &[W], body: u8) -> Option<BodyParameters<f32>> {
    let first = GRAVITY_PARAMETERS + usize::from(body) * BODY_PARAMETERS;
    let own = weights.get(first..)?.first_chunk::<BODY_PARAMETERS>()?;
    Some(BodyParameters::from_array(own.map(W::wide)))
}

/// Writes a body in the plane with the distances of its four inertial numbers.
fn write_planar<W: WeightFormat<Wide = f32>>(
    (file, block): (&[W], &mut [f32]),
    body: u8,
    distances: &[f32],
) -> Option<()> {
    let own = planar(file, body)?;
    let mut inertia = PlanarInertia::of_body(&own).into_array();
    inertia.iter_mut().zip(distances).for_each(|(own, distance)| *own += distance);
    let adapted = PlanarInertia::from_array(inertia).given_to(&own).into_array();
    let first = GRAVITY_PARAMETERS + usize::from(body) * BODY_PARAMETERS;
    *block.get_mut(first..)?.first_chunk_mut()? = adapted;
    Some(())
}
