//! Mechanisms by their names on the command line.

use clap::ValueEnum;
use leastaction_ground_truth::{LgnnSystem, ManyBody, Mechanism};

/// Systems that can be simulated, and that models can be compared with.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub enum System {
    /// A rod on a pivot, with a torque there.
    Pendulum,
    /// A pole on a cart, with a force on the cart.
    Cartpole,
    /// Two links, with a torque at the second joint.
    Acrobot,
    /// A chain of pendulums; masses and lengths are 1.
    NPendulum,
    /// Bodies in the plane that attract each other; masses and k are 1.
    NBody,
    /// Bobs in Cartesian coordinates on rods; masses and lengths are 1.
    RodPendulum,
    /// A ring of nodes joined by springs; masses and lengths are 1.
    NSpring,
    /// Two bobs on rods, and two nodes that each hang by a spring from both bobs.
    Hybrid,
}

/// SyMo's systems.
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

/// Origin of a system.
pub enum Kind {
    /// One of SyMo's systems.
    Symo(Mechanism),
    /// One of ModLaNet's systems, with any number of elements.
    Modlanet(fn(usize) -> ManyBody),
    /// One of LGNN's systems, with any number of nodes except for the hybrid.
    Lgnn(fn(usize) -> LgnnSystem),
}

impl System {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self.kind() {
            Kind::Symo(mechanism) => mechanism.name(),
            Kind::Modlanet(system) => system(2).name(),
            Kind::Lgnn(system) => system(2).name(),
        }
    }

    /// Origin of the system.
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
