use thiserror::Error;

/// A mechanism whose exact equations of motion are known, of a size known at run time.
///
/// Slices have one entry for each coordinate. Energies of shorter ones panic.
pub trait ExactMotion: Send + Sync {
    /// Number of coordinates, n.
    fn coordinates(&self) -> usize;

    /// Whether coordinate `i` is an angle, the same after whole turns.
    fn is_angle(&self, i: usize) -> bool;

    /// Writes v̇(q, v), m/s² or rad/s²; `None` where it does not exist (bodies in one place) or a slice is too short.
    fn acceleration(&self, q: &[f64], v: &[f64], out: &mut [f64]) -> Option<()>;

    /// T(q, v), J.
    fn kinetic_energy(&self, q: &[f64], v: &[f64]) -> f64;

    /// V(q), J.
    fn potential_energy(&self, q: &[f64]) -> f64;

    /// Brings a state (q, v) that is off by the error of a step back to where constraints keep it; `None` where none is near.
    /// Without constraints every state is good.
    fn project(&self, _state: &mut [f64]) -> Option<()> {
        Some(())
    }

    /// T + V, J.
    fn energy(&self, q: &[f64], v: &[f64]) -> f64 {
        self.kinetic_energy(q, v) + self.potential_energy(q)
    }
}

/// A mechanism that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum BadMechanism {
    /// Nothing that moves.
    #[error("no element; give at least one mass")]
    Empty,
    /// Lists of different lengths.
    #[error("{masses} masses and {lengths} lengths; give as many of one as of the other")]
    Unpaired {
        /// Masses given.
        masses: usize,
        /// Lengths given.
        lengths: usize,
    },
    /// A quantity out of its range.
    #[error("element {element} has {quantity} {value}; it must be {range}")]
    OutOfRange {
        /// From 0.
        element: usize,
        /// Which one.
        quantity: &'static str,
        /// As given.
        value: f64,
        /// In words.
        range: &'static str,
    },
}

/// Refuses what is not finite and above zero.
pub(super) fn above_zero(element: usize, quantity: &'static str, value: f64) -> Result<(), BadMechanism> {
    let range = "finite and above 0";
    let good = value.is_finite() && value > 0.0;
    if good { Ok(()) } else { Err(BadMechanism::OutOfRange { element, quantity, value, range }) }
}
