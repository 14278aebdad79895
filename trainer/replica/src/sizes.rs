//! The only place in which a size given by a file becomes a type.

use crate::{ParticleSystem, Replica, ReplicaError, SystemOf};
use leastaction_core::control::{Coordinates, States};
use leastaction_core::model::ModelError;

/// A loader of systems in any requested number of coordinates.
pub(crate) trait Load<'f> {
    fn load<const N: usize>(self) -> Result<SystemOf<'f, N>, ModelError>;
}

/// An operation on a system whose size is a type. `'c` is the lifetime of the borrow of the [`Replica`](crate::Replica).
pub trait Visitor<'c> {
    /// Result of the visit.
    type Output;

    /// Visits a system of N coordinates. The bound on [`Replica`] lets the visitor ask another replica for a system of the same N
    /// ([`OfSize::of_size`]).
    fn coordinates<const N: usize>(self, system: &'c SystemOf<'c, N>) -> Self::Output
    where
        for<'f> Replica<'f>: OfSize<N>;

    /// Visits a graph in D dimensions.
    fn particles<const D: usize>(self, particles: &'c ParticleSystem<'c, D>) -> Self::Output;
}

/// An operation on a system whose state (q, v) has D = 2N numbers; stable Rust does not compute one size from another.
pub trait StateVisitor<'c> {
    /// Result of the visit.
    type Output;

    /// Visits a system of N coordinates.
    fn states<const N: usize, const D: usize>(self, system: &'c SystemOf<'c, N>) -> Self::Output
    where
        for<'f> Replica<'f>: OfSize<N>,
        Coordinates<N>: States<D>;

    /// Visits a graph in any number of dimensions, which has no state of a fixed size.
    fn graph(self) -> Self::Output;
}

/// Access to the system of a replica that has N coordinates, for each N of [`COORDINATES`].
pub trait OfSize<const N: usize> {
    /// Returns the system; `None` if it has a different number of coordinates, or is a graph.
    fn of_size(&self) -> Option<&SystemOf<'_, N>>;
}

macro_rules! sizes {
    ($($size:ident = $n:literal, $d:literal);*) => {
        /// Numbers of coordinates that core is compiled for in this program; graphs may have any.
        pub const COORDINATES: [usize; [$($n),*].len()] = [$($n),*];

        /// A system of any size.
        pub(crate) enum AnySystem<'f> {
            $($size(SystemOf<'f, $n>),)*
            Plane(Box<ParticleSystem<'f, 2>>),
            Space(Box<ParticleSystem<'f, 3>>),
        }

        $(impl OfSize<$n> for Replica<'_> {
            fn of_size(&self) -> Option<&SystemOf<'_, $n>> {
                match self.system() {
                    AnySystem::$size(system) => Some(system),
                    _ => None,
                }
            }
        })*

        impl<'f> AnySystem<'f> {
            /// Loads the system of n coordinates.
            pub fn load(n: usize, loader: impl Load<'f>) -> Result<Self, ReplicaError> {
                match n {
                    $($n => Ok(Self::$size(loader.load()?)),)*
                    found => Err(ReplicaError::Coordinates { found }),
                }
            }

            pub fn visit<'c, V: Visitor<'c>>(&'c self, visitor: V) -> V::Output {
                match self {
                    $(Self::$size(system) => visitor.coordinates(system),)*
                    Self::Plane(particles) => visitor.particles(particles),
                    Self::Space(particles) => visitor.particles(particles),
                }
            }

            pub fn visit_states<'c, V: StateVisitor<'c>>(&'c self, visitor: V) -> V::Output {
                match self {
                    $(Self::$size(system) => visitor.states::<$n, $d>(system),)*
                    Self::Plane(_) | Self::Space(_) => visitor.graph(),
                }
            }
        }
    };
}

// Each size takes two to three seconds of processor time to compile in release.
sizes!(One = 1, 2; Two = 2, 4; Three = 3, 6; Four = 4, 8; Five = 5, 10; Six = 6, 12; Seven = 7, 14; Eight = 8, 16; Twelve = 12, 24);
