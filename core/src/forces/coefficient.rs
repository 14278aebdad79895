use serde::{Deserialize, Serialize};

/// A number of a law, one for every coordinate, in which the law's force is linear. The order is that of patch files.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Coefficient {
    /// Coefficient c of [`Viscous`](super::Viscous).
    Viscous,
    /// Friction c of [`Coulomb`](super::Coulomb).
    Coulomb,
    /// Damping b of [`Directional`](super::Directional).
    DirectionalViscous,
    /// Friction c of [`Directional`](super::Directional).
    Directional,
    /// Friction c of [`Sticking`](super::Sticking), by its smooth law.
    Sticking,
}
