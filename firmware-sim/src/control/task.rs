use super::{Command, Controller, Float, Follow, Pump, SwingUp, Target, Track};
use crate::Mechanism;
use crate::tick::Mode;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::StepError;

/// A controller whose task is chosen at run time; P is the pump of a swing-up, or [`NoPump`](super::NoPump), and R is [`Mpc`](super::Mpc) or
/// [`NoMpc`](super::NoMpc).
#[derive(Clone, Debug, PartialEq)]
pub enum TaskController<'p, P, R, const N: usize> {
    /// Follows a motion.
    Track(Track<N>),
    /// Holds the mechanism against gravity.
    Float(Float),
    /// Brings the mechanism upright.
    SwingUp(SwingUp<P, N>),
    /// Gives no command.
    Listen(Listen),
    /// Follows a plan.
    Follow(Follow<'p, N>),
    /// Decides at every tick.
    Mpc(R),
}

impl<P: Pump<N>, R: Controller<N>, const N: usize> Controller<N> for TaskController<'_, P, R, N> {
    fn read(&mut self, elapsed: u32, measured: &[Option<f32>; N]) {
        match self {
            Self::Follow(follow) => Controller::<N>::read(follow, elapsed, measured),
            Self::Mpc(mpc) => mpc.read(elapsed, measured),
            // The other tasks use only the estimate.
            _ => {}
        }
    }

    fn command<M: Mechanism<N>>(
        &mut self,
        model: &M,
        target: &Target<N>,
        state: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>> {
        match self {
            Self::Track(track) => track.command(model, target, state),
            Self::Float(float) => float.command(model, target, state),
            Self::SwingUp(swing_up) => swing_up.command(model, target, state),
            Self::Listen(listen) => listen.command(model, target, state),
            Self::Follow(follow) => follow.command(model, target, state),
            Self::Mpc(mpc) => mpc.command(model, target, state),
        }
    }
}

/// No controller: commands come from elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Listen;

impl<const N: usize> Controller<N> for Listen {
    fn command<M: Mechanism<N>>(
        &mut self,
        _: &M,
        _: &Target<N>,
        _: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>> {
        Ok(Command { u: [0.0; N], mode: Mode::Open })
    }
}
