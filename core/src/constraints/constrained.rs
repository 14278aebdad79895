use super::{Banded, ConstraintError, Constraints};
use crate::particles::Particles;
use crate::scalar::Real;
use core::marker::PhantomData;

/// A system of particles with its constraints, checked, and the band of A M⁻¹ Aᵀ.
#[derive(Debug)]
pub struct Constrained<'a, R, S, C: ?Sized, const D: usize> {
    system: &'a S,
    constraints: &'a C,
    band: usize,
    scalar: PhantomData<R>,
}

impl<'a, R, S, C, const D: usize> Constrained<'a, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    /// Checks nodes and lengths, and finds the band: the largest distance in the list between two equations that share a node. Takes time
    /// quadratic in the number of equations, once.
    ///
    /// List constraints along the chain: a step takes time in proportion to (nodes) + (equations)(band + 1)².
    pub fn new(system: &'a S, constraints: &'a C) -> Result<Self, ConstraintError<R>> {
        for equation in 0..constraints.equations() {
            check(constraints, equation, system.nodes())?;
        }
        Ok(Self { system, constraints, band: band(constraints), scalar: PhantomData })
    }

    /// Wraps a system whose constraints [`Constrained::new`] has already checked and whose band it has found.
    pub(crate) const fn known(system: &'a S, constraints: &'a C, band: usize) -> Self {
        Self { system, constraints, band, scalar: PhantomData }
    }

    /// The system.
    pub fn system(&self) -> &'a S {
        self.system
    }

    /// The constraints.
    pub fn constraints(&self) -> &'a C {
        self.constraints
    }

    /// Number of diagonals of A M⁻¹ Aᵀ on either side of the main one.
    pub fn band(&self) -> usize {
        self.band
    }

    /// Number of constraint equations.
    pub fn equations(&self) -> usize {
        self.constraints.equations()
    }

    /// Workspace length of the matrix A M⁻¹ Aᵀ.
    pub(crate) fn matrix_workspace(&self) -> usize {
        Banded::<R>::workspace(self.equations(), self.band)
    }

    /// Checks that a slice has one item per node.
    pub(crate) fn check_nodes<T>(&self, slice: &[T]) -> Result<(), ConstraintError<R>> {
        check_length(slice, self.system.nodes())
    }

    /// Checks that a slice has one multiplier per equation.
    pub(crate) fn check_equations<T>(&self, slice: &[T]) -> Result<(), ConstraintError<R>> {
        check_length(slice, self.equations())
    }
}

/// Checks the length of a slice.
pub(crate) fn check_length<R, T>(slice: &[T], expected: usize) -> Result<(), ConstraintError<R>> {
    let given = slice.len();
    if given == expected { Ok(()) } else { Err(ConstraintError::Shape { expected, given }) }
}

// Called once per start, so optimised for size, not speed.
#[inline(never)]
fn check<R: Real, C: Constraints<R, D> + ?Sized, const D: usize>(
    constraints: &C,
    constraint: usize,
    nodes: usize,
) -> Result<(), ConstraintError<R>> {
    if let Some(node) = constraints.nodes(constraint).iter().find(|node| **node >= nodes) {
        return Err(ConstraintError::Node { constraint, node: *node, nodes });
    }
    let length = constraints.size(constraint);
    let positive = length > R::zero() && length.is_finite();
    if positive { Ok(()) } else { Err(ConstraintError::Length { constraint, length }) }
}

#[inline(never)]
fn band<R: Real, C: Constraints<R, D> + ?Sized, const D: usize>(constraints: &C) -> usize {
    let equations = constraints.equations();
    let share =
        |k: usize, l: usize| constraints.nodes(k).iter().any(|node| constraints.nodes(l).contains(node));
    let reach = |k: usize| (k + 1..equations).rev().find(|l| share(k, *l)).map_or(0, |l| l - k);
    (0..equations).map(reach).max().unwrap_or(0)
}
