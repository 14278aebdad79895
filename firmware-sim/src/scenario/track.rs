use super::run::run_in_place;
use super::setup::CART_AND_POLE;
use super::{Setup, Start};
use crate::control::{ByEncoders, Gains, Law, Reference, Trajectory};
use crate::devices::{Devices, EncoderConfig};
use crate::error::SetupError;
use crate::firmware::Firmware;
use crate::program::diagonal;
use crate::summary::{Goal, Summary};
use crate::tick::Tick;
use crate::{Mechanism, Program, Task, Timeline};
use core::f32::consts::PI;

/// Time at which the motions begin, s.
const BEGIN: f32 = 0.1;

/// A fully actuated mechanism following a trajectory from its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackConfig<const N: usize, T = Reference<N>> {
    /// Loop, devices, goal; the limits of the actuators must suffice for the motion.
    pub setup: Setup<N>,
    /// Motion to follow.
    pub reference: T,
    /// Feedback gains.
    pub gains: Gains,
    /// Use of feed-forward and feedback.
    pub law: Law,
}

impl<const N: usize, T: Copy> TrackConfig<N, T> {
    /// Creates a run of 10 s in ticks of 10 ms along a motion from rest at `start`; errors must stay within 0.05 rad or m throughout.
    pub const fn new(
        encoders: [EncoderConfig; N],
        limit: [f32; N],
        (start, reference): ([f32; N], T),
    ) -> Self {
        let devices = Devices::new(encoders, limit);
        let goal = Goal { tolerance: [0.05; N], hold: f32::INFINITY, bounds: [f32::INFINITY; N] };
        let setup = Setup::new(Start::at_rest(start), devices, goal);
        Self { setup, reference, gains: Gains { frequency: 8.0, damping: 1.0 }, law: Law::ComputedTorque }
    }
}

impl<const N: usize, T: Trajectory<N>> TrackConfig<N, T> {
    /// Checks that every number of the loop and of the motion is in its range.
    ///
    /// # Errors
    /// The first number that is out of range.
    pub fn validate(&self) -> Result<(), SetupError> {
        self.setup.validate()?;
        self.reference.validate()
    }

    /// Program of the firmware.
    pub fn program(&self) -> Program<N> {
        self.setup.program(Task::Track { begin: self.reference.at(0.0).q, gains: self.gains, law: self.law })
    }

    /// Creates the firmware over a model that follows the motion by gravity compensation and the encoders' readings alone, with velocities
    /// filtered at the cut-off frequency `cut_off`, Hz: [`ByEncoders`]. The observer runs at the same time, but only
    /// for the record.
    ///
    /// # Errors
    /// See [`Program::follow`]; also a cut-off frequency out of range.
    pub fn by_encoders<M: Mechanism<N>>(
        &self,
        model: &M,
        cut_off: f32,
    ) -> Result<Firmware<ByEncoders<N>, N>, SetupError> {
        let program = self.program();
        program.check(model)?;
        let control = (self.gains, diagonal(model, &self.reference.at(0.0).q), program.angle);
        let delay = program.observer.lateness() * program.tick;
        Ok(program.firmware(ByEncoders::new(control, program.tick, delay, cut_off)?))
    }
}

impl TrackConfig<1> {
    /// The pendulum from hanging to upright and back every 4 s, at most 10 N m.
    pub const fn pendulum() -> Self {
        let from = [PI];
        let reference = Reference::there_and_back(BEGIN, from, [0.0], [0.25]);
        Self::new([EncoderConfig::rotary()], [10.0], (from, reference))
    }
}

impl TrackConfig<2> {
    /// The cart-pole, cart and pole both actuated: the cart 1 m to and fro, the pole from hanging to upright and back.
    pub const fn cartpole() -> Self {
        let from = [-0.5, PI];
        let reference = Reference::there_and_back(BEGIN, from, [0.5, 0.0], [0.4, 0.25]);
        Self::new(CART_AND_POLE, [15.0, 2.0], (from, reference))
    }

    /// The acrobot, both joints actuated, moving from hanging with at most 40 N m.
    pub const fn acrobot() -> Self {
        let from = [0.0, 0.0];
        let reference = Reference::there_and_back(BEGIN, from, [2.0, -1.5], [0.25, 0.4]);
        Self::new([EncoderConfig::rotary(); 2], [40.0, 40.0], (from, reference))
    }
}

/// Follows a trajectory by the model's inverse dynamics and PD feedback.
///
/// # Errors
/// Numbers out of range, a step that the model was not trained for, and a kinetic energy that is not quadratic in v.
pub fn track<'a, P: Mechanism<N> + 'a, M: Mechanism<N>, T: Trajectory<N>, const N: usize>(
    plant: impl Into<Timeline<'a, P>>,
    model: &M,
    config: &TrackConfig<N, T>,
    sink: impl FnMut(&Tick<N>),
) -> Result<Summary<N>, SetupError> {
    config.validate()?;
    let firmware = config.program().follow(model)?;
    run_in_place(plant, (model, firmware), &config.setup, &config.reference, sink)
}
