use super::run::RunError;
use crate::Processor;
use crate::angle::difference;
use crate::firmware::{FIRST_TICK, Outcome};
use crate::program::Program;
use crate::summary::{Goal, Recorder, Summary};
use crate::tick::Tick;

/// A tick of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Logged<const N: usize> {
    /// Number of ticks since the previous one; [`Logged::FIRST`] where another recording begins.
    pub elapsed: u32,
    /// Time, s.
    pub time: f32,
    /// Encoder readings, rad or m.
    pub measured: [Option<f32>; N],
    /// Command that was given at that time.
    pub command: [f32; N],
}

impl<const N: usize> Logged<N> {
    /// More ticks than any patience: the firmware forgets the state that it knew, but not the zeros that it learned,
    /// and assumes that the first command was already given at all earlier ticks.
    pub const FIRST: u32 = FIRST_TICK;
}

/// Runs a firmware along a log: its observer takes the readings, and the commands of the log replace the controller's.
///
/// q of a tick is the last reading, the reference is the model's prediction of the reading, and the error is the innovation, the reading
/// minus the prediction, 0 before there was an estimate; v, which no encoder reads, is 0. The applied force is the program's force for the
/// command of the log, without delays. The goal is that the model never fails.
///
/// # Errors
/// A program out of range, and the first tick that the processor does not run.
pub fn replay<R: Processor<N>, const N: usize>(
    mut processor: R,
    program: &Program<N>,
    log: impl IntoIterator<Item = Logged<N>>,
    mut sink: impl FnMut(&Tick<N>, &Outcome<N>),
) -> Result<Summary<N>, RunError<R::Error>> {
    program.validate().map_err(RunError::Setup)?;
    let free = [f32::INFINITY; N];
    let mut recorder = Recorder::new(Goal { tolerance: free, hold: 0.0, bounds: free }, program.angle);
    let (mut index, mut seen, mut errors) = (0, [0.0; N], 0);
    for logged in log {
        let outcome = processor.replay(logged.elapsed, &logged.measured, logged.command);
        let outcome = outcome.map_err(|error| RunError::Processor { tick: index, error })?;
        seen = core::array::from_fn(|i| logged.measured[i].unwrap_or(seen[i]));
        let tick = tick(index, &logged, seen, &outcome, program);
        recorder.errors(outcome.errors, 0);
        recorder.record(&tick);
        sink(&tick, &outcome);
        (index, errors) = (index + 1, errors + outcome.errors);
    }
    let summary = recorder.finish();
    Ok(Summary { success: summary.success && errors == 0, ..summary })
}

fn tick<const N: usize>(
    index: u32,
    logged: &Logged<N>,
    seen: [f32; N],
    outcome: &Outcome<N>,
    program: &Program<N>,
) -> Tick<N> {
    let innovation = difference(&seen, &outcome.predicted, &program.angle);
    let arrived = |i: usize| logged.measured[i].is_some();
    Tick {
        index,
        time: logged.time,
        q: seen,
        v: [0.0; N],
        measured: logged.measured,
        q_estimate: outcome.estimate.q,
        v_estimate: outcome.estimate.v,
        reference: outcome.predicted,
        error: core::array::from_fn(|i| if arrived(i) { innovation[i] } else { 0.0 }),
        commanded: logged.command,
        applied: program.actuator.drive.force(&logged.command),
        newton: outcome.newton,
        lateness: 0.0,
        missed: false,
        mode: outcome.command.mode,
    }
}
