use thiserror::Error;

/// A mechanism with exactly known equations of motion, of a size known at run time.
///
/// Slices have one entry per coordinate; the energies panic for shorter slices.
pub trait ExactMotion: Send + Sync {
    /// Number of coordinates, n.
    fn coordinates(&self) -> usize;

    /// Whether coordinate `i` is an angle, which is unchanged by whole turns.
    fn is_angle(&self, i: usize) -> bool;

    /// Writes v̇(q, v), m/s² or rad/s²; `None` if it does not exist (coinciding bodies) or if a slice is too short.
    fn acceleration(&self, q: &[f64], v: &[f64], out: &mut [f64]) -> Option<()>;

    /// Kinetic energy T(q, v), J.
    fn kinetic_energy(&self, q: &[f64], v: &[f64]) -> f64;

    /// Potential energy V(q), J.
    fn potential_energy(&self, q: &[f64]) -> f64;

    /// Projects a state (q, v) that is off by an integration error back onto the constraints; `None` if no valid state
    /// is near. Without constraints every state is valid.
    fn project(&self, _state: &mut [f64]) -> Option<()> {
        Some(())
    }

    /// Total energy T + V, J.
    fn energy(&self, q: &[f64], v: &[f64]) -> f64 {
        self.kinetic_energy(q, v) + self.potential_energy(q)
    }
}

/// The reason why a mechanism is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum BadMechanism {
    /// There are no elements.
    #[error("no element; give at least one mass")]
    Empty,
    /// The lists of masses and lengths differ in length.
    #[error("{masses} masses and {lengths} lengths; give as many of one as of the other")]
    Unpaired {
        /// Number of masses.
        masses: usize,
        /// Number of lengths.
        lengths: usize,
    },
    /// A quantity is out of range.
    #[error("element {element} has {quantity} {value}; it must be {range}")]
    OutOfRange {
        /// Element, from 0.
        element: usize,
        /// Name of the quantity.
        quantity: &'static str,
        /// Given value.
        value: f64,
        /// Valid range, in words.
        range: &'static str,
    },
}

/// Refuses a value that is not finite and above zero.
pub(super) fn above_zero(element: usize, quantity: &'static str, value: f64) -> Result<(), BadMechanism> {
    let range = "finite and above 0";
    let good = value.is_finite() && value > 0.0;
    if good { Ok(()) } else { Err(BadMechanism::OutOfRange { element, quantity, value, range }) }
}
