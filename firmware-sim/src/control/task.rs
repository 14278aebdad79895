use super::{Command, Controller, Pump, SwingUp, Track};
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::StepError;

/// A controller whose task is chosen at run time.
#[derive(Clone, Copy, Debug)]
pub enum TaskController<P, const N: usize> {
    /// Follows a motion.
    Track(Track<N>),
    /// Brings the mechanism upright.
    SwingUp(SwingUp<P, N>),
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
        }
    }
}
