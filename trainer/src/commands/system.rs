//! Mechanisms by their names on the command line.

use clap::ValueEnum;
use leastaction_ground_truth::{LgnnSystem, ManyBody, Mechanism};

/// What can be simulated, and what models can be compared with.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub enum System {
    /// A rod on a pivot, torque at it.
    Pendulum,
    /// A pole on a cart, force on the cart.
    Cartpole,
    /// Two links, torque at the second joint.
    Acrobot,
    /// A chain of pendulums, masses and lengths 1.
    NPendulum,
    /// Bodies in the plane that attract each other, masses and k 1.
    NBody,
    /// Bobs in Cartesian coordinates on rods, masses and lengths 1.
    RodPendulum,
    /// A ring of nodes joined by springs, masses and lengths 1.
    NSpring,
    /// Two bobs on rods and two nodes that each hang by a spring from either bob.
    Hybrid,
}

/// SyMo's alone.
#[derive(Clone, Copy, ValueEnum)]
pub enum SymoSystem {
    /// A rod on a pivot, θ = 0 upright, torque u: θ̈ = 1.5 g sin θ + 3u.
    Pendulum,
    /// A pole on a cart, θ = 0 upright, force u on the cart.
    Cartpole,
    /// Two links hanging at 0, torque u at the second joint.
    Acrobot,
}

impl From<SymoSystem> for Mechanism {
    fn from(system: SymoSystem) -> Self {
        match system {
            SymoSystem::Pendulum => Self::Pendulum,
            SymoSystem::Cartpole => Self::Cartpole,
            SymoSystem::Acrobot => Self::Acrobot,
        }
    }
}

/// Whose systems.
pub enum Kind {
    /// Of SyMo's.
    Symo(Mechanism),
    /// Of ModLaNet's, of any number of elements.
    Modlanet(fn(usize) -> ManyBody),
    /// Of LGNN's, of any number of nodes but for the hybrid.
    Lgnn(fn(usize) -> LgnnSystem),
}

impl System {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self.kind() {
            Kind::Symo(mechanism) => mechanism.name(),
            Kind::Modlanet(system) => system(2).name(),
            Kind::Lgnn(system) => system(2).name(),
        }
    }

    /// Which one.
    pub fn kind(self) -> Kind {
        match self {
            Self::Pendulum => Kind::Symo(Mechanism::Pendulum),
            Self::Cartpole => Kind::Symo(Mechanism::Cartpole),
            Self::Acrobot => Kind::Symo(Mechanism::Acrobot),
            Self::NPendulum => Kind::Modlanet(ManyBody::Pendulum),
            Self::NBody => Kind::Modlanet(ManyBody::Bodies),
            Self::RodPendulum => Kind::Lgnn(LgnnSystem::Pendulum),
            Self::NSpring => Kind::Lgnn(LgnnSystem::Spring),
            Self::Hybrid => Kind::Lgnn(|_| LgnnSystem::Hybrid),
        }
    }
}
