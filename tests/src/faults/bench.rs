use super::chip::{Chip, Message, Silence};
use super::judge::{Caught, Guard, Record, Stop, judge};
use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::System;
use leastaction_firmware_sim::control::{Command, Controller, Target};
use leastaction_firmware_sim::observer::OtherStep;
use leastaction_firmware_sim::scenario::TrackConfig;
use leastaction_firmware_sim::trajectory::reference::SmallCartpole;
use leastaction_firmware_sim::{InPlace, Mechanism, Mode, Outcome, Processor, Trained, scenario};

const N: usize = 2;

// Words that begin the chip's messages.
const BEGUN: u32 = 0xb;
const STARTED: u32 = 0xe;
const READY: u32 = 0xa;
const DONE: u32 = 0xd;
const STOPPED: u32 = 0x5;

/// Number of ticks before the first in which a bit flips: the estimate is trusted, and the motion has begun.
pub const TICKS_BEFORE: u32 = 12;
/// Length of a tick, instructions: 10 ms at 100 million instructions a second.
const TICK: u32 = 1_000_000;
/// Part of the limit by which a wrong command is off.
const OFF: f32 = 0.01;
/// Number of messages in a tick after which the program counts as lost.
const MESSAGES: usize = 100;
/// Instructions of a count of the chip's timer.
const COUNT: u32 = 40;

/// Part of memory in which a bit flips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// State of the controller.
    State,
    /// Stack, from the stack pointer at the flip to the top.
    Stack,
    /// Weights of the model, in flash.
    Weights,
}

impl Place {
    /// All places.
    pub const ALL: [Self; 3] = [Self::State, Self::Stack, Self::Weights];

    /// Name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::State => "state",
            Self::Stack => "stack",
            Self::Weights => "weights",
        }
    }
}

/// A flipped bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Part of memory; `None` for an interrupt without a flip.
    pub place: Option<Place>,
    /// The tick.
    pub tick: u32,
    /// Instructions from the beginning of the tick.
    pub after: u32,
    /// Number that chooses the byte.
    pub byte: u32,
    /// Bit of the byte.
    pub bit: u32,
}

impl Fault {
    fn order(&self, guards: u32, settling: u32) -> [u32; 8] {
        let place = self.place.map_or(0, |place| place as u32 + 1);
        let (counts, turns) = ((self.after / COUNT).max(1), self.after % COUNT / 3);
        [guards, self.tick, counts, turns, place, self.byte, self.bit, settling]
    }
}

/// A run with one fault.
#[derive(Clone, Debug)]
pub struct Run {
    /// Records since the tick of the fault.
    pub records: Vec<Record>,
    /// Instructions of all ticks.
    pub instructions: Vec<u32>,
    /// Early end.
    pub stop: Option<Stop>,
    /// Static memory of the controller, bytes.
    pub memory: u32,
}

/// Instructions of the ticks without a fault, and memory, of a controller with some guards.
#[derive(Clone, Debug)]
pub struct Costs {
    /// Instructions of every tick.
    pub instructions: Vec<u32>,
    /// State, bytes.
    pub memory: u32,
}

/// The world around a chip: the exact cart-pole and its devices, and a controller without fault on the same readings.
pub struct Bench<'a> {
    model: &'a SmallCartpole<'a>,
    config: TrackConfig<N>,
}

impl<'a> Bench<'a> {
    /// Creates the world.
    pub fn new(model: &'a SmallCartpole<'a>) -> Self {
        let mut config = TrackConfig::cartpole();
        // The model was learned with longer steps.
        config.setup.observer.other_step = OtherStep::Accepted;
        Self { model, config }
    }

    /// Settling time of the observer, ticks.
    pub fn settling(&self) -> u32 {
        self.config.setup.observer.settling()
    }

    /// Number of ticks of a run after its fault: the settling time twice, and a few more.
    pub fn ticks_after(&self) -> u32 {
        2 * self.settling() + 4
    }

    /// Judges a run.
    pub fn judge(&self, run: &Run) -> Caught {
        judge(&run.records, run.stop, self.settling() as usize, TICK)
    }

    /// Runs a controller with guards, bits of 1 for the state and 2 for the weights, and a fault.
    ///
    /// # Errors
    /// [`Silence`] if the image does not begin.
    pub fn run(&self, chip: &mut Chip, guards: u32, fault: &Fault) -> Result<Run, Silence> {
        let mut heard = chip.hear()?;
        // The end of the run before.
        if heard[0] == STOPPED {
            heard = chip.hear()?;
        }
        expect(heard, BEGUN)?;
        chip.say(&fault.order(guards, self.settling()))?;
        let [_, memory, repeated @ ..] = expect(chip.hear()?, STARTED)?;
        if repeated != [fault.tick, fault.byte, 0, 0] {
            return Err(Silence);
        }
        let model = Trained { system: &self.model.system, step: self.model.trained_step };
        let firmware = self.config.program().follow(&model).map_err(|_| Silence)?;
        let mut remote = Remote {
            chip,
            healthy: InPlace { model: &model, firmware },
            limit: self.config.setup.devices.actuator.limit,
            records: Vec::new(),
            instructions: Vec::new(),
            ready: false,
            u: [0.0; N],
        };
        let plant = System::conservative(CARTPOLE);
        let setup = &self.config.setup;
        let mut run =
            scenario::Run::new(&plant, &mut remote, setup, &self.config.reference).map_err(|_| Silence)?;
        let ticks = fault.tick + self.ticks_after();
        let stop = (0..ticks).find_map(|_| run.tick().err()).or_else(|| remote.wait().err());
        let Remote { records, instructions, .. } = remote;
        if stop.is_none() {
            chip.say(&[0; 14])?;
        }
        let records = records.into_iter().skip(fault.tick as usize).collect();
        Ok(Run { records, instructions, stop, memory })
    }
}

fn expect(message: Message, word: u32) -> Result<Message, Silence> {
    if message[0] == word { Ok(message) } else { Err(Silence) }
}

/// The chip as a processor, beside a controller without fault.
struct Remote<'a, M, C> {
    chip: &'a mut Chip,
    healthy: InPlace<'a, M, C, N>,
    limit: [f32; N],
    records: Vec<Record>,
    instructions: Vec<u32>,
    /// Whether the chip waits for its next tick.
    ready: bool,
    /// Command that the drive holds.
    u: [f32; N],
}

impl<M, C> Remote<'_, M, C> {
    /// Asks the chip for a tick's command; `None` if it waits for the next tick without one, over which the drive holds the command before.
    fn ask(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Result<Option<Message>, Stop> {
        let Target { q, v, middle } = target;
        let measured = measured.map(|y| y.unwrap_or(f32::NAN));
        let numbers = [measured, *q, *v, middle.q, middle.v, middle.a];
        let number = self.instructions.len() as u32 + 1;
        let words: Vec<u32> =
            [number, elapsed].into_iter().chain(numbers.as_flattened().iter().map(|x| x.to_bits())).collect();
        // A program that ran astray may say before what makes no sense, or one command twice: a drive takes whole messages of the present tick.
        self.wait()?;
        self.chip.say(&words).map_err(|Silence| Stop::Silent)?;
        let heard = self.hear_until(|heard| heard[0] == READY || heard[0] == DONE | number << 8)?;
        self.ready = heard[0] == READY;
        Ok((!self.ready).then_some(heard))
    }

    /// Waits until the chip waits for its next tick.
    fn wait(&mut self) -> Result<(), Stop> {
        if !self.ready {
            self.hear_until(|heard| heard[0] == READY)?;
            self.ready = true;
        }
        Ok(())
    }

    /// Hears messages until one is wanted.
    fn hear_until(&mut self, wanted: impl Fn(&Message) -> bool) -> Result<Message, Stop> {
        for _ in 0..MESSAGES {
            match self.hear()? {
                [STOPPED, 0, 0, cause @ 1..=3, _, instructions] => {
                    let guards = [Guard::Handler, Guard::Watchdog, Guard::End];
                    return Err(Stop::Stopped(guards[cause as usize - 1], instructions));
                }
                [BEGUN, ..] => return Err(Stop::BegunAnew),
                heard if wanted(&heard) => return Ok(heard),
                _ => {}
            }
        }
        Err(Stop::Babble)
    }

    fn hear(&mut self) -> Result<Message, Stop> {
        self.chip.hear().map_err(|Silence| Stop::Silent)
    }

    fn record(&mut self, expected: &[f32; N], found: Option<Guard>, u: &[f32; N]) {
        let right = |i: usize| (u[i] - expected[i]).abs() <= OFF * self.limit[i];
        let record = Record { off: !(0..N).all(right), zero: *u == [0.0; N], found };
        self.records.push(record);
    }
}

/// The guard that a message names.
fn found(mode: u32, found: u32) -> Option<Guard> {
    match found {
        _ if found >> 17 & 1 == 1 => Some(Guard::Sweep),
        _ if found >> 16 & 1 == 1 => Some(Guard::Disagreement),
        _ if mode == Mode::Safe as u32 => Some(Guard::Step),
        0 => None,
        _ => Some(Guard::Vote),
    }
}

impl<M, C> Processor<N> for &mut Remote<'_, M, C>
where
    M: Mechanism<N>,
    C: Controller<N> + Clone,
{
    type Error = Stop;

    fn run(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Result<Outcome<N>, Stop> {
        let mut expected = InPlace { model: self.healthy.model, firmware: self.healthy.firmware.clone() };
        let Ok(expected) = expected.run(elapsed, measured, target);
        let before = [DONE, self.u[0].to_bits(), self.u[1].to_bits(), Mode::Open as u32, 0, 0];
        let heard = self.ask(elapsed, measured, target)?.unwrap_or(before);
        let [_, u0, u1, mode, finding, instructions] = heard;
        let u = [u0, u1].map(f32::from_bits);
        self.record(&expected.command.u, found(mode, finding), &u);
        self.instructions.push(instructions);
        // The drive clamps; what is not a number is its lower limit.
        let u = core::array::from_fn(|i| u[i].max(-self.limit[i]).min(self.limit[i]));
        self.u = u;
        let Ok(outcome) = self.healthy.replay(elapsed, measured, u);
        Ok(Outcome { command: Command { u, mode: expected.command.mode }, ..outcome })
    }

    fn replay(&mut self, _: u32, _: &[Option<f32>; N], _: [f32; N]) -> Result<Outcome<N>, Stop> {
        unreachable!("a run does not replay")
    }

    fn last(&self) -> &Outcome<N> {
        self.healthy.last()
    }
}
