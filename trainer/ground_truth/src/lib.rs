//! Mechanisms with exactly known motion, and data sets from them: SyMo's pendulum, cart-pole and acrobot; ModLaNet's chains of pendulums
//! and attracting bodies; LGNN's pendulums, springs and hybrids in Cartesian coordinates; and logs as robots write them ([`robot`]).

mod bodies;
mod chain;
mod generate;
mod integrate;
mod lgnn;
mod lgnn_shapes;
mod load;
mod logged;
mod modlanet;
mod motion;
pub mod robot;
mod truss;

pub use bodies::Bodies;
pub use chain::{Chain, Link};
pub use generate::{Drive, Settings, generate, noisy, symo_set};
pub use integrate::{Extrapolation, IntegrationError, second_order};
pub use lgnn::{LgnnSettings, LgnnSystem, lgnn_set, lgnn_starts};
pub use lgnn_shapes::{lgnn_graph, lgnn_shape};
pub use load::Waves;
pub use logged::{GenerationError, Horizon, Start, follow, follow_flow, logged};
pub use modlanet::{
    ManyBody, ModlanetSettings, circular_speed, generate_many, modlanet_set, modlanet_set_of, starts,
};
pub use motion::{BadMechanism, ExactMotion};
pub use truss::{Rod, Truss};

use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM, Trigonometric};

/// A mechanism, by its name on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mechanism {
    /// A rod on a pivot, θ = 0 upright, torque u: θ̈ = 1.5 g sin θ + 3u.
    Pendulum,
    /// A pole on a cart, θ = 0 upright, force u on the cart.
    Cartpole,
    /// Two links hanging at 0, torque u at the second joint.
    Acrobot,
}

/// Ranges of a coordinate's initial state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spread {
    /// Range of q, ±.
    pub q: f64,
    /// Range of v, ±.
    pub v: f64,
}

/// The exact Lagrangian, with its number of coordinates.
#[derive(Clone, Copy, Debug)]
pub enum Exact {
    /// One coordinate.
    One(Trigonometric<'static, 1>),
    /// Two coordinates.
    Two(Trigonometric<'static, 2>),
}

impl Mechanism {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pendulum => "pendulum",
            Self::Cartpole => "cartpole",
            Self::Acrobot => "acrobot",
        }
    }

    /// The exact Lagrangian.
    pub fn exact(self) -> Exact {
        match self {
            Self::Pendulum => Exact::One(PENDULUM),
            Self::Cartpole => Exact::Two(CARTPOLE),
            Self::Acrobot => Exact::Two(ACROBOT),
        }
    }

    /// Kinds of the coordinates.
    pub fn coordinates(self) -> &'static [Coordinate] {
        match self {
            Self::Pendulum => &[Coordinate::Angle],
            Self::Cartpole => &[Coordinate::Translation, Coordinate::Angle],
            Self::Acrobot => &[Coordinate::Angle, Coordinate::Angle],
        }
    }

    /// The coordinate that the control acts on.
    pub fn actuated(self) -> usize {
        match self {
            Self::Pendulum | Self::Cartpole => 0,
            Self::Acrobot => 1,
        }
    }

    /// SyMo's step, s.
    pub fn step(self) -> f64 {
        match self {
            Self::Pendulum => 0.1,
            Self::Cartpole | Self::Acrobot => 0.05,
        }
    }

    /// SyMo's distribution of initial states.
    #[expect(clippy::approx_constant, reason = "SyMo draws from ±3.14, not ±π")]
    pub(crate) fn spread(self) -> &'static [Spread] {
        use std::f64::consts::{PI, TAU};
        match self {
            Self::Pendulum => &[Spread { q: PI, v: TAU }],
            Self::Cartpole => &[Spread { q: 0.5, v: 0.05 }, Spread { q: 3.14, v: 3.0 }],
            Self::Acrobot => &[Spread { q: 3.14, v: 3.14 }, Spread { q: 3.14, v: 3.14 }],
        }
    }
}
