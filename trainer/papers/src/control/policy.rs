//! Robots, and the controllers that are judged.

use super::anywhere;
use super::model::Believed;
use super::observed::Observed;
use super::tables::Table;
use super::tvlqr::Tvlqr;
use leastaction_core::control::riccati::RegulatorError;
use leastaction_core::discrete::StepError;
use thiserror::Error;

/// Tick of the competition: time between two calls of a controller, and step of the integrator, s.
pub const TICK: f64 = 0.002;
/// Largest torque of the driven joint, N m.
pub const TORQUE_LIMIT: f64 = 6.0;

/// Robot: the joint that is driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Robot {
    /// Joint 2 alone is driven.
    Acrobot,
    /// Joint 1 alone is driven.
    Pendubot,
}

impl Robot {
    /// Name on the command line and in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Acrobot => "acrobot",
            Self::Pendubot => "pendubot",
        }
    }

    /// Driven joint, from 0.
    pub const fn driven(self) -> usize {
        match self {
            Self::Acrobot => 1,
            Self::Pendubot => 0,
        }
    }

    /// Torques of both joints for a torque of the driven one.
    pub const fn torques(self, u: f64) -> [f64; 2] {
        match self {
            Self::Acrobot => [0.0, u],
            Self::Pendubot => [u, 0.0],
        }
    }
}

/// Law that is judged: the torque of the driven joint from what is measured.
pub trait Policy {
    /// Forgets everything of the last run.
    fn reset(&mut self);

    /// Torque of the driven joint, N m, at time t, s, for positions q, rad, from hanging, q₂ relative to link 1, not wrapped, and velocities
    /// v, rad/s. It is asked every tick, except during a disturbance.
    fn torque(&mut self, t: f64, q: [f64; 2], v: [f64; 2]) -> f64;
}

/// Maker of one policy per run, so that runs go side by side. What all runs share has been prepared.
pub type Maker<'m> = Box<dyn Fn() -> Box<dyn Policy + 'm> + Send + Sync + 'm>;

/// Controller of ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Controller {
    /// The shortest motion that is found from wherever the pendulum is, with the help of a library.
    Anywhere,
    /// A swing-up with time-varying LQR, held by LQR.
    Tvlqr,
    /// The law of [`Tvlqr`](Self::Tvlqr) along the swing-up of the best score in the table of single swing-ups, with velocities from positions, and
    /// measurements that may be late.
    Economical,
}

/// Reason why a controller cannot be prepared.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ControlError {
    /// A posture cannot be held.
    #[error("no regulator about the goal: {0}")]
    Regulator(RegulatorError),
    /// A motion cannot be computed.
    #[error("no motion can be computed: {0}")]
    Motion(StepError<f64>),
    /// No swing-up was found.
    #[error(
        "no swing-up was found; the best of {starts} searches ends {violation:.1e} rad or rad/s from the goal"
    )]
    NoSwingUp {
        /// Number of searches.
        starts: usize,
        /// Largest deviation from the goal.
        violation: f64,
    },
    /// There is no model, or no policy for it.
    #[error("{0}")]
    Policy(String),
}

impl Controller {
    /// Controllers that are made for a table: a plan from hanging is no policy, and a policy that searches takes hours on 722 faulty machines.
    pub const fn of_table(table: Table) -> &'static [Self] {
        match table {
            Table::Policy => &[Self::Anywhere, Self::Tvlqr],
            Table::Single => &[Self::Economical, Self::Anywhere, Self::Tvlqr],
            Table::Robustness => &[Self::Economical, Self::Tvlqr],
        }
    }

    /// Name in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tvlqr => "leastaction tvlqr",
            Self::Economical => "leastaction economical",
            Self::Anywhere => "leastaction anywhere",
        }
    }

    /// Prepares the controller for a robot with the model that it believes in.
    ///
    /// # Errors
    /// [`ControlError`].
    pub fn prepare<'m>(
        self,
        robot: Robot,
        believed: &Believed<'m>,
        note: &(dyn Fn(&str) + Sync),
    ) -> Result<Maker<'m>, ControlError> {
        match self {
            Self::Tvlqr => Ok(Tvlqr::plan(robot, &believed.pendulum)?.maker()),
            Self::Economical => {
                let law = Tvlqr::economical(robot, &believed.pendulum)?.maker();
                Ok(Observed::maker(law, believed.pendulum, robot))
            }
            Self::Anywhere => anywhere::prepare(robot, believed, note),
        }
    }
}
