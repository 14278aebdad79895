//! Element types: motion of an element with its coordinates, its mass and other parameters, and its potential.

use super::tree::{SPACE, Vector};
use crate::expected::first;
use crate::network::{Jet, Mlp};
use crate::scalar::{Scalar, WeightFormat};
use serde::{Deserialize, Serialize};

/// Form in which a coordinate enters a position network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Input {
    /// A length (m), unchanged.
    Translation,
    /// An angle (rad), as (cos q, sin q): no seam.
    Angle,
    /// An angle (rad), wrapped to [0, 2π) (ModLaNet's program): with a seam at 0.
    WrappedAngle,
}

impl Input {
    /// Number of features that the coordinate gives the network.
    pub const fn features(self) -> usize {
        match self {
            Self::Translation | Self::WrappedAngle => 1,
            Self::Angle => 2,
        }
    }

    /// The features with their first E derivatives in q.
    fn series<S: Scalar, const E: usize>(self, q: S) -> [Jet<S, E>; 2] {
        match self {
            Self::Translation => [Jet::parameter(q), Jet::zero()],
            Self::WrappedAngle => [Jet::parameter(q.wrapped()), Jet::zero()],
            Self::Angle => {
                let (sin, cos) = q.sin_cos();
                [Jet::series(cos, [-sin, -cos, sin]), Jet::series(sin, [cos, -sin, -cos])]
            }
        }
    }
}

/// Displacement of an element, and of everything that it carries, as a function of its coordinates.
#[derive(Clone, Copy, Debug)]
pub enum Transform<'a, W, const H: usize, const L: usize> {
    /// x = T(q), learned (ModLaNet, section 4.1); one coordinate.
    Network {
        /// T.
        position: Mlp<'a, W, H, L>,
        /// Separate velocity network of ModLaNet, ẋ = T_v(q)q̇; without it, ẋ is the exact derivative of T.
        velocity: Option<Mlp<'a, W, H, L>>,
        /// Form in which q enters.
        input: Input,
    },
    /// A rod rotating about a pivot, x = ℓ(sin q, −cos q), q from the downward vertical; one coordinate.
    Rod,
    /// A slide along the horizontal, x = (q, 0); one coordinate.
    Slide,
    /// A free point, x = (q₁, q₂); two coordinates.
    Free,
}

impl<W, const H: usize, const L: usize> Transform<'_, W, H, L> {
    /// Number of coordinates of an element.
    pub const fn coordinates(&self) -> usize {
        match self {
            Self::Free => 2,
            Self::Network { .. } | Self::Rod | Self::Slide => 1,
        }
    }
}

/// Displacement s(q) that one coordinate adds to everything it carries, and the map g(q) from v to velocity: g = s′ unless the velocity has
/// a network of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion<S> {
    pub s: Vector<S>,
    pub s_q: Vector<S>,
    pub s_qq: Vector<S>,
    pub g: Vector<S>,
    pub g_q: Vector<S>,
    pub g_qq: Vector<S>,
}

impl<S: Scalar> Motion<S> {
    pub fn none() -> Self {
        let zero = [S::zero(); SPACE];
        Self { s: zero, s_q: zero, s_qq: zero, g: zero, g_q: zero, g_qq: zero }
    }

    /// Motion from s with its derivatives; g = s′.
    #[inline(always)]
    fn exact<const E: usize>(s: &[Jet<S, E>; SPACE]) -> Self {
        let at = |k: usize| s.each_ref().map(|s| s.tangent.get(k).copied().unwrap_or(S::zero()));
        let (first, second, third) = (at(0), at(1), at(2));
        Self { s: s.map(|s| s.value), s_q: first, s_qq: second, g: first, g_q: second, g_qq: third }
    }

    /// Replaces the velocity map by g with its derivatives.
    #[inline(always)]
    fn with_velocity<const E: usize>(self, g: &[Jet<S, E>; SPACE]) -> Self {
        let Self { s: value, s_q: first, s_qq: second, .. } = Motion::exact(g);
        Self { g: value, g_q: first, g_qq: second, ..self }
    }
}

/// An element type over borrowed weights.
#[derive(Clone, Copy, Debug)]
pub struct ElementType<'a, W, const H: usize, const L: usize> {
    /// Displacement of the element.
    pub transform: Transform<'a, W, H, L>,
    /// Potential U₁(x) of the element's centre, per unit of mass; `None`: no potential of its own.
    pub potential: Option<Mlp<'a, W, H, L>>,
    /// Parameters of the element.
    pub numbers: ElementParameters<W>,
}

/// The numbers of an element type, in the order of the weight block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementParameters<W> {
    /// m > 0, kg.
    pub mass: W,
    /// Moment of inertia about the centre per coordinate (rad), I ≥ 0, kg m²; 0 for a point.
    pub inertia: W,
    /// Position of the centre between the point that the element hangs from (0) and the point that it carries (1): 1 for a point at the
    /// end.
    pub centre: W,
    /// Length ℓ of a [`Transform::Rod`], m; unused by all other transforms.
    pub length: W,
}

/// Number of [`ElementParameters`].
pub const ELEMENT_PARAMETERS: usize = 4;

impl<W: WeightFormat> ElementParameters<W> {
    /// Takes the parameters from the front of the weight block.
    pub(super) fn take(block: &mut &[W]) -> Option<Self> {
        let (numbers, rest) = block.split_first_chunk::<ELEMENT_PARAMETERS>()?;
        *block = rest;
        let [mass, inertia, centre, length] = *numbers;
        Some(Self { mass, inertia, centre, length })
    }
}

impl<'a, W: WeightFormat, const H: usize, const L: usize> ElementType<'a, W, H, L> {
    /// s(q) of the element's coordinate `axis` (from 0), with its first E derivatives.
    pub(super) fn motion<S: Scalar<Weight = W::Wide>, const E: usize>(&self, axis: usize, q: S) -> Motion<S> {
        match &self.transform {
            Transform::Network { position, velocity, input } => {
                let features = input.series::<S, E>(q);
                let x = first(&features, input.features());
                let motion = Motion::exact(&series::<W, S, E, H, L>(position, x));
                match velocity {
                    None => motion,
                    Some(velocity) => motion.with_velocity(&series::<W, S, E, H, L>(velocity, x)),
                }
            }
            Transform::Rod => {
                let (sin, cos) = q.sin_cos();
                let unit: [Jet<S, 3>; SPACE] =
                    [Jet::series(sin, [cos, -sin, -cos]), Jet::series(-cos, [sin, cos, -sin])];
                Motion::exact(&unit.map(|u| u.scaled(self.numbers.length.scalar())))
            }
            Transform::Slide => Motion::exact::<3>(&[Jet::parameter(q), Jet::zero()]),
            Transform::Free if axis == 0 => Motion::exact::<3>(&[Jet::parameter(q), Jet::zero()]),
            Transform::Free => Motion::exact::<3>(&[Jet::zero(), Jet::parameter(q)]),
        }
    }
}

/// Position or velocity from a network, with its first E derivatives in the coordinate.
fn series<W: WeightFormat, S: Scalar<Weight = W::Wide>, const E: usize, const H: usize, const L: usize>(
    network: &Mlp<W, H, L>,
    x: &[Jet<S, E>],
) -> [Jet<S, E>; SPACE] {
    let mut y = [Jet::zero(); SPACE];
    network.series(x, &mut y);
    y
}
