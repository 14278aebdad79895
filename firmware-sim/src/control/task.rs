use super::{Command, Controller, Pump, SwingUp, Track};
use crate::tick::Mode;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::StepError;

/// A controller whose task is chosen at run time.
#[derive(Clone, Copy, Debug)]
pub enum TaskController<P, const N: usize> {
    /// Follows a motion.
    Track(Track<N>),
    /// Brings the mechanism upright.
    SwingUp(SwingUp<P, N>),
    /// Gives no command.
    Listen(Listen),
}

impl<M, P, const N: usize> Controller<M, N> for TaskController<P, N>
where
    Track<N>: Controller<M, N>,
    P: Pump<M, N>,
{
    fn reference(&self, t: f32) -> [f32; N] {
        match self {
            Self::Track(track) => Controller::<M, N>::reference(track, t),
            Self::SwingUp(swing_up) => Controller::<M, N>::reference(swing_up, t),
            Self::Listen(listen) => Controller::<M, N>::reference(listen, t),
        }
    }

    fn command(
        &mut self,
        model: &M,
        t: f32,
        state: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>> {
        match self {
            Self::Track(track) => track.command(model, t, state),
            Self::SwingUp(swing_up) => swing_up.command(model, t, state),
            Self::Listen(listen) => listen.command(model, t, state),
        }
    }
}

/// No controller: the commands are somebody else's.
#[derive(Clone, Copy, Debug)]
pub struct Listen;

impl<M, const N: usize> Controller<M, N> for Listen {
    fn reference(&self, _: f32) -> [f32; N] {
        [0.0; N]
    }

    fn command(&mut self, _: &M, _: f32, _: &ContinuousState<f32, N>) -> Result<Command<N>, StepError<f32>> {
        Ok(Command { u: [0.0; N], mode: Mode::Open })
    }
}
