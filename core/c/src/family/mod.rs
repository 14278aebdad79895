//! The one family that the library is built for: its [`Mechanism`], its loading, and the lists that loading fills.

#[cfg(feature = "arm")]
mod arm;
#[cfg(feature = "bodies")]
mod bodies;
#[cfg(feature = "graph")]
mod graph;
#[cfg(feature = "inertia-network")]
mod inertia_network;
#[cfg(feature = "modular")]
mod modular;
#[cfg(not(feature = "graph"))]
mod no_lists;

#[cfg(feature = "arm")]
pub(crate) use arm::{Energy, FAMILY, Mechanism};
#[cfg(all(feature = "adapt", feature = "arm"))]
pub(crate) use arm::{Shape, Tuned};
#[cfg(feature = "bodies")]
pub(crate) use bodies::{Energy, FAMILY, Mechanism};
#[cfg(all(feature = "adapt", feature = "bodies"))]
pub(crate) use bodies::{Shape, Tuned};
#[cfg(all(feature = "graph", not(feature = "rods")))]
pub(crate) use graph::system;
#[cfg(feature = "rods")]
pub(crate) use graph::{AnyGraph, constrained};
#[cfg(feature = "graph")]
pub(crate) use graph::{FAMILY, Lists, Mechanism, load};
#[cfg(feature = "inertia-network")]
pub(crate) use inertia_network::{Energy, FAMILY, Mechanism};
#[cfg(feature = "modular")]
pub(crate) use modular::{Energy, FAMILY, Mechanism, load};
#[cfg(not(any(feature = "graph", feature = "modular")))]
pub(crate) use no_lists::load;
#[cfg(not(feature = "graph"))]
pub(crate) use no_lists::{Lists, system};

#[cfg(not(feature = "graph"))]
use crate::config::LEASTACTION_COORDINATES as N;
#[cfg(feature = "networks")]
use crate::config::{LEASTACTION_LAW_HIDDEN as H, LEASTACTION_LAW_LAYERS as L};
use crate::error::Error;
use crate::status::Status;
use core::ffi::{CStr, c_char};

/// Storage format of a model file's weights.
#[cfg(not(feature = "half"))]
type Weight = f32;
#[cfg(feature = "half")]
type Weight = leastaction_core::scalar::f16;

/// Laws of friction that the library is built for; a file may have fewer.
#[cfg(not(any(feature = "friction", feature = "graph")))]
type Friction = leastaction_core::forces::Viscous<f32, N>;
#[cfg(feature = "friction")]
type Friction = (leastaction_core::forces::Viscous<f32, N>, leastaction_core::forces::Coulomb<f32, N>);

/// Laws of force that the library is built for.
#[cfg(not(any(feature = "axes", feature = "graph")))]
type Laws = Driven;
#[cfg(feature = "axes")]
type Laws = (Driven, Axes);

/// Friction by direction, friction that sticks, and end stops.
#[cfg(feature = "axes")]
type Axes = (
    leastaction_core::forces::Directional<f32, N>,
    (leastaction_core::forces::Sticking<f32, N>, leastaction_core::forces::Stops<f32, N>),
);

/// Laws beside those of axes.
#[cfg(not(any(feature = "servo", feature = "graph")))]
type Driven = Beside;
#[cfg(feature = "servo")]
type Driven = (Beside, leastaction_core::forces::Servo<f32, N>);

/// Laws beside servos.
#[cfg(not(any(feature = "networks", feature = "graph")))]
type Beside = Friction;
#[cfg(feature = "networks")]
type Beside = (
    Friction,
    (
        leastaction_core::forces::Dissipation<'static, Weight, N, H, L>,
        leastaction_core::forces::PotentialCorrection<'static, Weight, N, H, L>,
    ),
);

/// Maximum length of the name of a tree or graph, bytes, without the zero at its end.
#[cfg_attr(
    not(any(feature = "modular", feature = "graph")),
    allow(dead_code, reason = "this family has no names")
)]
const MAX_NAME: usize = 64;

/// The name of a tree or graph; it is never read beyond the maximum length.
///
/// # Safety
/// `name` is NULL, or bytes up to a zero.
#[cfg_attr(
    not(any(feature = "modular", feature = "graph")),
    allow(dead_code, reason = "this family has no names")
)]
unsafe fn text<'a>(name: *const c_char) -> Result<&'a str, Error> {
    if name.is_null() {
        return Err(Error::new(Status::NullPointer, [6]));
    }
    // SAFETY: bytes up to a zero, each read only if the one before it is no zero.
    let ends = (0..=MAX_NAME).any(|i| unsafe { name.add(i).read() } == 0);
    if !ends {
        return Err(Status::BadName.into());
    }
    // SAFETY: the name ends, as was just seen.
    unsafe { CStr::from_ptr(name) }.to_str().map_err(|_| Status::BadName.into())
}
