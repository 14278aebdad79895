use super::{Command, Controller, Float, Follow, Pump, SwingUp, Target, Track};
use crate::tick::Mode;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::StepError;

/// A controller whose task is chosen at run time.
#[derive(Clone, Copy, Debug)]
pub enum TaskController<'p, P, const N: usize> {
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
}

impl<M, P, const N: usize> Controller<M, N> for TaskController<'_, P, N>
where
    Track<N>: Controller<M, N>,
    Float: Controller<M, N>,
    P: Pump<M, N>,
{
    fn read(&mut self, elapsed: u32, measured: &[Option<f32>; N]) {
        // The other tasks use only the estimate.
        if let Self::Follow(follow) = self {
            Controller::<M, N>::read(follow, elapsed, measured);
        }
    }

    fn command(
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
        }
    }
}

/// No controller: commands come from elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Listen;

impl<M, const N: usize> Controller<M, N> for Listen {
    fn command(
        &mut self,
        _: &M,
        _: &Target<N>,
        _: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>> {
        Ok(Command { u: [0.0; N], mode: Mode::Open })
    }
}
