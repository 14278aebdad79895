//! The only place in which a size given by a file becomes a type.

use crate::{ParticleSystem, Replica, ReplicaError, SystemOf};
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

/// Access to the system of a replica that has N coordinates, for each N of [`COORDINATES`].
pub trait OfSize<const N: usize> {
    /// Returns the system; `None` if it has a different number of coordinates, or is a graph.
    fn of_size(&self) -> Option<&SystemOf<'_, N>>;
}

macro_rules! sizes {
    ($($size:ident = $n:literal),*) => {
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
        }
    };
}

// Each size takes two to three seconds of processor time to compile in release.
sizes!(One = 1, Two = 2, Three = 3, Four = 4, Five = 5, Six = 6, Seven = 7, Eight = 8, Twelve = 12);
