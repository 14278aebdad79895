use super::frame::{Frame, Receiver};
use super::message::{Answer, Done, LoggedSamples, PART, Request, Samples, answer, parse_request};
use super::refusal::{ProgramFault, Refusal};
use super::slot::Flash;
use crate::control::{Controller, Nodes, blank_nodes};
use crate::firmware::Firmware;
use crate::trajectory::reference::Friction;
use crate::{Adapting, InPlace, Mechanism, Processor, Trained};
use core::convert::Infallible;
use heapless::Vec;
use leastaction_core::adapt::{Patch, SettingsError, StoredSettings, Tunable};
use leastaction_core::energy::arm::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS};
use leastaction_core::energy::bodies::{BODY_PARAMETERS, GRAVITY_PARAMETERS};
use leastaction_core::forces::{Dissipation, PotentialCorrection};
use leastaction_core::model::{
    ArmHeader, ArmModel, BodiesHeader, BodiesModel, InertiaNetworkModel, ModelError, Tuned, parse_as,
};

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

/// Maximum number of numbers that follow.
pub const PLACES: usize = 32;
const PAIRS: usize = PLACES * (PLACES - 1) / 2;

/// Runs the program that `$start` begins over a model of `$header` whose numbers may be changed, and lets them follow by the settings in the flash.
macro_rules! adapt {
    ($link:ident, $flash:ident, $program:ident, $header:ty, $tuned:ty, |$model:ident| $start:expr) => {{
        let loaded = $flash.model().ok_or(Refusal::NoModel).and_then(|file| {
            let parsed = parse_as::<$header, f32>(file)?;
            Ok((<$tuned>::new(&parsed, parsed.shape.tree()?)?, parsed.trained_step))
        });
        let begun = loaded.map_err(without_numbers).and_then(|(model, step)| {
            let settings = $flash.settings::<_, PLACES>($program.tick)?;
            let $model = &Trained { system: model.of_file(), step };
            let firmware: Result<_, Refusal> = $start;
            let firmware = firmware?;
            Ok((model, firmware, settings))
        });
        match begun {
            Ok((model, firmware, settings)) => $link.following(model, firmware, &settings)?,
            Err(refusal) => $link.refuse(refusal)?,
        }
    }};
}

/// Numbers of a model of one body and of two bodies, with at most five numbers of friction for each.
const ONE: usize = GRAVITY_PARAMETERS + BODY_PARAMETERS + 5;
const TWO: usize = GRAVITY_PARAMETERS + 2 * (BODY_PARAMETERS + 5);

/// A model of bodies in the plane whose numbers may be changed.
type TunedBodies<'f, const N: usize, const K: usize> =
    Tuned<'f, Friction<N>, GRAVITY_PARAMETERS, BODY_PARAMETERS, N, K>;
/// An arm whose numbers may be changed.
type TunedArm<'f, const N: usize, const K: usize> =
    Tuned<'f, Friction<N>, ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, N, K>;

/// Numbers of other families than bodies do not follow.
fn without_numbers(refusal: Refusal) -> Refusal {
    let other = Refusal::from(ModelError::OtherFamily { found: "" });
    if refusal == other { Refusal::Program(ProgramFault::NoAdaptation) } else { refusal }
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
            (Ok(Request::Adapt(program)), _) => {
                adapt!(link, flash, program, BodiesHeader, TunedBodies<1, ONE>, |model| program.start_with(model, || flash.plans(), &mut workspace.one))
            }
            (_, Ok(Request::Adapt(program))) => {
                adapt!(link, flash, program, BodiesHeader, TunedBodies<2, TWO>, |model| program.start_with(model, || flash.plans(), &mut workspace.two))
            }
            (Ok(_), _) | (_, Ok(_)) => link.refuse(Refusal::NotBegun)?,
            (Err(Refusal::Coordinates { .. }), Err(refusal)) | (Err(refusal), Err(_)) => {
                link.refuse(refusal)?
            }
        };
    }
}

/// Serves requests, as the processor named `processor`, until one ends the program. Programs run over an arm of N
/// joints, optionally with damping and dry friction; model and plan are borrowed in place. Programs follow
/// targets and plans; they bring nothing upright, and decide nothing. Numbers follow in models of at most K numbers.
///
/// # Errors
/// Errors of the port.
pub fn serve_arm<P: Port, const N: usize, const K: usize>(
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
            Ok(Request::Adapt(program)) => {
                adapt!(link, flash, program, ArmHeader, TunedArm<N, K>, |model| program
                    .follow_with(model, || flash.plan()))
            }
            Ok(_) => link.refuse(Refusal::NotBegun)?,
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
            Ok((model, firmware)) => self.ticks(InPlace { model, firmware }, |_, _| None),
            Err(refusal) => self.refuse(refusal),
        }
    }

    /// Runs a firmware whose model's numbers follow by the settings.
    fn following<S: Tunable<N>, C: Controller<N>, const N: usize>(
        &mut self,
        model: S,
        firmware: Firmware<C, N>,
        settings: &StoredSettings<N, PLACES>,
    ) -> Result<Frame, P::Error> {
        let tuning = match settings.settings.tuning() {
            Ok(tuning) => tuning,
            Err(error) => return self.refuse(error.into()),
        };
        let blocks = settings.settings.blocks(settings.block);
        match Adapting::<_, _, N, PLACES, PAIRS>::new(model, firmware, (blocks, &tuning)) {
            Err(unfit) => self.refuse(SettingsError::Unfit(unfit).into()),
            Ok(adapting) => self.ticks(adapting, |adapting, part| {
                let mut memory = [0; Patch::<PLACES>::MAX_BYTES];
                let patch = adapting.patch(settings.model);
                let bytes = patch.write(&mut memory).ok()?;
                let own = Vec::from_slice(bytes.chunks(PART).nth(part)?).ok()?;
                Some((bytes.len().div_ceil(PART) as u8, own))
            }),
        }
    }

    /// Runs ticks up to the first frame that is no tick; `save` gives a part of a patch, and how many there are.
    fn ticks<R: Processor<N, Error = Infallible>, const N: usize>(
        &mut self,
        mut processor: R,
        save: impl Fn(&R, usize) -> Option<(u8, Vec<u8, PART>)>,
    ) -> Result<Frame, P::Error> {
        let ready: Answer<'_, N> = Answer::Ready { processor: self.processor };
        self.send(&ready)?;
        loop {
            let frame = self.receive()?;
            let (sequence, (instructions, Ok(outcome))) = match parse_request::<N>(&frame) {
                Ok(Request::Tick(Samples { sequence, elapsed, measured, target })) => {
                    (sequence, self.port.count(|| processor.run(elapsed, &measured, &target)))
                }
                Ok(Request::Log(LoggedSamples { sequence, elapsed, measured, command })) => {
                    (sequence, self.port.count(|| processor.replay(elapsed, &measured, command)))
                }
                Ok(Request::Save { part }) => {
                    match save(&processor, part.into()) {
                        Some((parts, bytes)) => self.send::<N>(&Answer::Saved { parts, bytes: &bytes })?,
                        None => self.send::<N>(&Answer::Refused(Refusal::NotAdapting))?,
                    }
                    continue;
                }
                _ => return Ok(frame),
            };
            self.send(&Answer::Done(Done { sequence, outcome, instructions }))?;
        }
    }
}
