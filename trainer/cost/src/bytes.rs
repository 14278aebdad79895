//! RAM of a solver's arrays on a controller, for any number of coordinates.

use leastaction_core::discrete::{Galerkin, Linearised, Midpoint, Path, Solved, State};
use leastaction_core::forces::{Coulomb, Viscous};

/// Sizes in bytes of arrays with one entry per coordinate, or per pair of coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Bytes {
    /// State that a program keeps between steps.
    pub state: usize,
    /// Viscous damping.
    pub damping: usize,
    /// Dry friction.
    pub dry: usize,
    /// Workspace of Newton's method in a step of order 2.
    pub newton_order_2: usize,
    /// Workspace of Newton's method in a step of order 4.
    pub newton_order_4: usize,
}

impl Bytes {
    /// The sizes for n coordinates, extrapolated from those of core's types for 1, 2 and 3 coordinates: all are
    /// polynomials of degree 2 in n.
    pub fn of(n: usize) -> Self {
        let sizes = [Self::compiled::<1>(), Self::compiled::<2>(), Self::compiled::<3>()];
        let at = |field: fn(&Self) -> usize| extrapolated(sizes.each_ref().map(field), n);
        Self {
            state: at(|bytes| bytes.state),
            damping: at(|bytes| bytes.damping),
            dry: at(|bytes| bytes.dry),
            newton_order_2: at(|bytes| bytes.newton_order_2),
            newton_order_4: at(|bytes| bytes.newton_order_4),
        }
    }

    fn compiled<const N: usize>() -> Self {
        Self {
            state: size_of::<State<f32, N>>(),
            damping: size_of::<Viscous<f32, N>>(),
            dry: size_of::<Coulomb<f32, N>>(),
            newton_order_2: newton::<Midpoint, N>(),
            newton_order_4: newton::<Galerkin, N>(),
        }
    }
}

fn newton<P: Path, const N: usize>() -> usize {
    size_of::<Linearised<f32, P, N>>() + size_of::<Solved<f32, P, N>>() + size_of::<State<f32, N>>()
}

/// Value at n of the polynomial of degree 2 with these values at 1, 2 and 3, by Newton's forward differences.
fn extrapolated([one, two, three]: [usize; 3], n: usize) -> usize {
    let (k, first, second) = (n.saturating_sub(1), two - one, three + one - 2 * two);
    one + k * first + k * k.saturating_sub(1) / 2 * second
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_of_any_number_of_coordinates_are_those_that_are_compiled() {
        assert_eq!(Bytes::of(1), Bytes::compiled::<1>());
        assert_eq!(Bytes::of(4), Bytes::compiled::<4>());
        assert_eq!(Bytes::of(7), Bytes::compiled::<7>());
        assert_eq!(Bytes::of(16), Bytes::compiled::<16>());
    }
}
