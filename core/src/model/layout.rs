use super::{ArmHeader, BodiesHeader, Family, Law, Laws, ModelError, ShapeHeader};
use crate::adapt::Number;
use crate::energy::arm::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, INERTIAL_PARAMETERS};
use crate::energy::bodies::{BODY_PARAMETERS, BodyParameters, GRAVITY_PARAMETERS, PlanarInertia};
use crate::forces::Coefficient;
use crate::network::Dense;
use crate::scalar::{Scalar, WeightFormat};

/// Places of the [numbers](Number) that may follow a machine in the weight block of its model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout<'a> {
    bodies: Bodies,
    /// Length of the energies' part of the block.
    pub(super) energies: usize,
    /// Whether each coordinate is a group of its own.
    own_groups: bool,
    /// Number of groups of coordinates with their own numbers of friction.
    groups: usize,
    pub(super) laws: Laws<'a>,
}

/// Kind of the bodies in a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Bodies {
    None,
    Plane,
    Space,
}

/// Output layer of a law's network in a block.
#[derive(Clone, Copy)]
struct LastLayer {
    /// Position of its first weight.
    first: usize,
    inputs: usize,
    outputs: usize,
}

impl LastLayer {
    /// Position of the weight from input j to output i.
    fn weight(&self, i: usize, j: usize) -> usize {
        self.first + Dense::<f32>::position(self.inputs, self.outputs, i, j)
    }

    /// Position of the weight from an input to the only output.
    fn of_input(&self, j: u8) -> Option<usize> {
        let j = usize::from(j);
        (j < self.inputs).then(|| self.weight(0, j))
    }

    /// Positions of the weights and the bias of output i.
    fn of_output(self, i: usize) -> impl Iterator<Item = usize> {
        let bias = self.first + self.inputs * self.outputs + i;
        (0..self.inputs).map(move |j| self.weight(i, j)).chain([bias])
    }
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
        let groups = shape.groups();
        Ok(Self {
            bodies,
            energies: shape.parameters()?,
            own_groups: groups == shape.coordinates(),
            groups,
            laws,
        })
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

    /// The value of a number in the block, 1 for the strength of a column of dissipation; `None` if the block does not have it, as gains and
    /// offsets of drives.
    pub fn value<W: WeightFormat<Wide = f32>>(&self, weights: &[W], number: Number) -> Option<f32> {
        match (number, self.bodies) {
            (Number::Inertia { body, index }, Bodies::Plane) => {
                let inertia = PlanarInertia::of_body(&planar(weights, body)?).into_array();
                inertia.get(usize::from(index)).copied()
            }
            (Number::Dissipation(j), _) => self.has_column(j).then_some(1.0),
            (Number::Potential(j), _) => weights.get(self.unit(j)?).map(|weight| weight.wide()),
            _ => weights.get(self.place(number)?).map(|weight| weight.wide()),
        }
    }

    /// Writes the numbers of a model file with the distances δ added; the block is otherwise what it was. Numbers that the block does not have
    /// are left out. The entries of a column of dissipation grow with √(1 + δ), and vanish for δ ≤ −1.
    pub fn write<W: WeightFormat<Wide = f32>>(
        &self,
        file: &[W],
        changed: (&[Number], &[f32]),
        block: &mut [f32],
    ) {
        self.write_knowing(file, changed, block, |_| true);
    }

    /// [`Layout::write`] for a program that knows only some laws, and needs no code for the others.
    #[inline(always)]
    pub(super) fn write_knowing<W: WeightFormat<Wide = f32>>(
        &self,
        file: &[W],
        (numbers, distances): (&[Number], &[f32]),
        block: &mut [f32],
        knows: impl Fn(Law) -> bool,
    ) {
        // Numbers of one coefficient follow each other, and their places are found together.
        let (mut coefficient, mut friction, mut potential) = (None, None, None);
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
                Number::Dissipation(_) if !knows(Law::Dissipation) => None,
                Number::Dissipation(column) => {
                    self.write_column((file, block), column, *distance);
                    None
                }
                Number::Potential(_) if !knows(Law::Potential) => None,
                Number::Potential(j) => {
                    let last = potential.get_or_insert_with(|| self.last_layer(Law::Potential));
                    last.and_then(|last| last.of_input(j))
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
        Some([self.first(law)? + position, law.ranges().len()])
    }

    /// Position of the first number of a law.
    fn first(&self, law: Law) -> Option<usize> {
        if !self.laws.contains(law) {
            return None;
        }
        let before = self.laws.iter().take_while(|other| *other != law);
        let parameters = |sum: usize, law| Some(sum + self.laws.parameters_of(law, self.groups)?);
        before.into_iter().try_fold(self.energies, parameters)
    }

    /// Output layer of a law's network.
    fn last_layer(&self, law: Law) -> Option<LastLayer> {
        let shape = self.laws.network(law)?.network(law).ok()?;
        let (inputs, outputs) = (shape.last_inputs(), usize::from(shape.outputs));
        let end = self.first(law)? + self.laws.parameters_of(law, self.groups)?;
        let first = end.checked_sub((inputs + 1) * outputs)?;
        Some(LastLayer { first, inputs, outputs })
    }

    /// Position of the weight of a unit in the last layer of the correcting potential's network.
    fn unit(&self, j: u8) -> Option<usize> {
        self.last_layer(Law::Potential)?.of_input(j)
    }

    /// Whether the dissipation's factor has this column.
    fn has_column(&self, column: u8) -> bool {
        let network = self.laws.network(Law::Dissipation);
        network.is_some_and(|network| usize::from(column) < network.count())
    }

    /// Writes the entries of a column of the dissipation's factor for the strength 1 + δ.
    fn write_column<W: WeightFormat<Wide = f32>>(
        &self,
        (file, block): (&[W], &mut [f32]),
        column: u8,
        distance: f32,
    ) -> Option<()> {
        let (last, column) = (self.last_layer(Law::Dissipation)?, usize::from(column));
        let factor = Scalar::sqrt((1.0 + distance).max(0.0));
        let entries =
            (column..last.outputs).map(|row| row * (row + 1) / 2 + column).take_while(|i| *i < last.outputs);
        for place in entries.flat_map(|i| last.of_output(i)) {
            if let (Some(own), Some(weight)) = (block.get_mut(place), file.get(place)) {
                *own = factor * weight.wide();
            }
        }
        Some(())
    }

    fn of_coordinate(&self, [first, apart]: [usize; 2], i: u8) -> Option<usize> {
        let i = usize::from(i);
        (self.own_groups && i < self.groups).then_some(first + i * apart)
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
