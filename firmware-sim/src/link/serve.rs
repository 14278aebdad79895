use super::frame::{Frame, Receiver};
use super::message::{Answer, Done, LoggedSamples, Request, Samples, answer, parse_request};
use super::refusal::Refusal;
use super::slot::Flash;
use crate::control::{Controller, Nodes, blank_nodes};
use crate::firmware::Firmware;
use crate::trajectory::reference::Friction;
use crate::{Mechanism, Trained};
use leastaction_core::forces::{Dissipation, PotentialCorrection};
use leastaction_core::model::{ArmModel, BodiesModel, InertiaNetworkModel, ModelError};

/// A board's end of a link.
pub trait Port {
    /// Reason why no more bytes come or go.
    type Error;

    /// Waits for a byte.
    ///
    /// # Errors
    /// An error if no byte will come.
    fn receive(&mut self) -> Result<u8, Self::Error>;
    /// Sends a byte.
    ///
    /// # Errors
    /// An error if the byte cannot be sent.
    fn send(&mut self, byte: u8) -> Result<(), Self::Error>;
    /// Does some work, and counts its instructions if the board can.
    fn count<T>(&mut self, work: impl FnOnce() -> T) -> (u32, T) {
        (0, work())
    }
}

/// Friction and laws with networks. Models without such laws run as in a program that knows none.
type AllForces<'a, const H: usize, const D: usize, const N: usize> =
    (Friction<N>, (Dissipation<'a, f32, N, H, D>, PotentialCorrection<'a, f32, N, H, D>));

/// Memory of decisions at every tick, for programs of 1 and of 2 coordinates.
#[derive(Debug)]
pub struct Workspace {
    one: Nodes<1, 2>,
    two: Nodes<2, 4>,
}

impl Workspace {
    /// Creates the memory, in a static without flash.
    pub const fn new() -> Self {
        Self { one: blank_nodes(), two: blank_nodes() }
    }
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}

/// Runs a program of `$n` coordinates over the model in a file, an inertia network or rigid bodies; decisions work in `$nodes`.
macro_rules! run {
    ($link:ident, $flash:ident, $program:ident, $n:literal, $nodes:expr) => {
        match $flash.model().map(InertiaNetworkModel::<$n, H, D, f32, Friction<$n>>::load) {
            Some(Err(ModelError::OtherFamily { .. })) => {
                match $flash.model().map(BodiesModel::<$n, f32, Friction<$n>>::load) {
                    Some(Err(ModelError::Law { .. })) => {
                        let loaded = $flash.model().map(BodiesModel::<$n, f32, AllForces<H, D, $n>>::load);
                        over!($link, loaded, |model| $program.start_with(model, || $flash.plans(), $nodes))
                    }
                    loaded => {
                        over!($link, loaded, |model| $program.start_with(model, || $flash.plans(), $nodes))
                    }
                }
            }
            Some(Err(ModelError::Law { .. })) => {
                let loaded =
                    $flash.model().map(InertiaNetworkModel::<$n, H, D, f32, AllForces<H, D, $n>>::load);
                over!($link, loaded, |model| $program.start_with(model, || $flash.plans(), $nodes))
            }
            loaded => over!($link, loaded, |model| $program.start_with(model, || $flash.plans(), $nodes)),
        }
    };
}

/// Runs the program that `$start` begins over a loaded model, or answers with the reason for refusing it.
macro_rules! over {
    ($link:ident, $loaded:expr, $start:expr) => {{
        let loaded = $loaded.ok_or(Refusal::NoModel).and_then(|model| Ok(model?));
        let model = loaded.as_ref().map_err(|refusal| *refusal);
        let model = model.map(|model| Trained { system: &model.system, step: model.trained_step });
        $link.program(model.as_ref(), $start)?
    }};
}

/// Serves requests, as the processor named `processor`, until one ends the program. Programs run over an inertia
/// network of 1 or 2 coordinates with at most `D` hidden layers of at most `H` units, or over 1 or 2 rigid bodies,
/// optionally with laws of force whose networks have these sizes. Model and plan are borrowed in place; decisions at every tick work in
/// `workspace`.
///
/// # Errors
/// Errors of the port.
pub fn serve<P: Port, const H: usize, const D: usize>(
    port: &mut P,
    flash: Flash,
    workspace: &mut Workspace,
    processor: &str,
) -> Result<(), P::Error> {
    let mut link = Link { port, receiver: Receiver::default(), processor };
    let mut next = link.receive()?;
    loop {
        next = match (parse_request::<1>(&next), parse_request::<2>(&next)) {
            (Ok(Request::End), _) | (_, Ok(Request::End)) => return Ok(()),
            (Ok(Request::Begin(program)), _) => run!(link, flash, program, 1, &mut workspace.one),
            (_, Ok(Request::Begin(program))) => run!(link, flash, program, 2, &mut workspace.two),
            (Ok(Request::Tick(_) | Request::Log(_)), _) | (_, Ok(Request::Tick(_) | Request::Log(_))) => {
                link.refuse(Refusal::NotBegun)?
            }
            (Err(Refusal::Coordinates { .. }), Err(refusal)) | (Err(refusal), Err(_)) => {
                link.refuse(refusal)?
            }
        };
    }
}

/// Serves requests, as the processor named `processor`, until one ends the program. Programs run over an arm of N
/// joints, optionally with damping and dry friction; model and plan are borrowed in place. Programs follow
/// targets and plans; they bring nothing upright, and decide nothing.
///
/// # Errors
/// Errors of the port.
pub fn serve_arm<P: Port, const N: usize>(
    port: &mut P,
    flash: Flash,
    processor: &str,
) -> Result<(), P::Error> {
    let mut link = Link { port, receiver: Receiver::default(), processor };
    let mut next = link.receive()?;
    loop {
        next = match parse_request::<N>(&next) {
            Ok(Request::End) => return Ok(()),
            Ok(Request::Begin(program)) => {
                let loaded = flash.model().map(ArmModel::<N, f32, Friction<N>>::load);
                over!(link, loaded, |model| program.follow_with(model, || flash.plan()))
            }
            Ok(Request::Tick(_) | Request::Log(_)) => link.refuse(Refusal::NotBegun)?,
            Err(refusal) => link.refuse(refusal)?,
        };
    }
}

/// A port that transfers frames.
struct Link<'a, P> {
    port: &'a mut P,
    receiver: Receiver,
    processor: &'a str,
}

impl<P: Port> Link<'_, P> {
    /// Waits for a whole frame, refusing broken frames on the way.
    fn receive(&mut self) -> Result<Frame, P::Error> {
        loop {
            let byte = self.port.receive()?;
            match self.receiver.push(byte) {
                None => {}
                Some(Ok(frame)) => return Ok(frame),
                Some(Err(_)) => self.send(&Answer::<1>::Refused(Refusal::Frame))?,
            }
        }
    }

    fn send<const N: usize>(&mut self, message: &Answer<'_, N>) -> Result<(), P::Error> {
        match answer(message) {
            Ok(frame) => frame.send(|byte| self.port.send(byte)),
            // Sends nothing: the other end would notice the missing answer and report it.
            Err(_) => {
                debug_assert!(false, "no answer is longer than a frame");
                Ok(())
            }
        }
    }

    fn refuse(&mut self, refusal: Refusal) -> Result<Frame, P::Error> {
        self.send(&Answer::<1>::Refused(refusal))?;
        self.receive()
    }

    /// Starts a program, and runs its ticks up to the first frame that is no tick.
    fn program<M: Mechanism<N>, C: Controller<N>, const N: usize>(
        &mut self,
        model: Result<&M, &Refusal>,
        start: impl FnOnce(&M) -> Result<Firmware<C, N>, Refusal>,
    ) -> Result<Frame, P::Error> {
        let begun = model.map_err(|refusal| *refusal).and_then(|model| Ok((model, start(model)?)));
        match begun {
            Ok((model, firmware)) => self.ticks(model, firmware),
            Err(refusal) => self.refuse(refusal),
        }
    }

    fn ticks<M: Mechanism<N>, C: Controller<N>, const N: usize>(
        &mut self,
        model: &M,
        mut firmware: Firmware<C, N>,
    ) -> Result<Frame, P::Error> {
        let ready: Answer<'_, N> = Answer::Ready { processor: self.processor };
        self.send(&ready)?;
        loop {
            let frame = self.receive()?;
            let (sequence, (instructions, outcome)) = match parse_request::<N>(&frame) {
                Ok(Request::Tick(Samples { sequence, elapsed, measured, target })) => {
                    (sequence, self.port.count(|| firmware.run(model, elapsed, &measured, &target)))
                }
                Ok(Request::Log(LoggedSamples { sequence, elapsed, measured, command })) => {
                    (sequence, self.port.count(|| firmware.replay(model, elapsed, &measured, command)))
                }
                _ => return Ok(frame),
            };
            self.send(&Answer::Done(Done { sequence, outcome, instructions }))?;
        }
    }
}
