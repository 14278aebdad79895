//! A processor in a thread of its own, at the other end of a byte line, runs the loop exactly as it runs in place; any fault of the line
//! ends the run.

use leastaction::processor::{Line, LinkError, Remote};
use leastaction_core::energy::trigonometric::{CARTPOLE, PENDULUM};
use leastaction_core::forces::System;
use leastaction_firmware_sim::link::{Files, Flash, Port, Refusal, Workspace, serve};
use leastaction_firmware_sim::observer::OtherStep;
use leastaction_firmware_sim::scenario::{RunError, SwingUpConfig, TrackConfig, run_on};
use leastaction_firmware_sim::trajectory::reference::Cartpole;
use leastaction_firmware_sim::{InPlace, Program, Summary, Tick};
use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

#[repr(align(4))]
struct Aligned<const N: usize>([u8; N]);

static MODEL: Aligned<{ include_bytes!("../../firmware-sim/chip/models/cartpole.postcard").len() }> =
    Aligned(*include_bytes!("../../firmware-sim/chip/models/cartpole.postcard"));

/// Fault that bytes suffer on their way to the simulator.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    /// A bit of the byte with this index is changed.
    Flip(usize),
    /// The byte with this index is lost.
    Lose(usize),
    /// No byte from this index on arrives.
    Silence(usize),
    /// The other end disappears at this index.
    Gone(usize),
    /// The bytes from the first index to the second are sent twice.
    Repeat(usize, usize),
}

/// The simulator's end, in memory.
struct Wire {
    to: Sender<u8>,
    from: Receiver<u8>,
    fault: Fault,
    count: usize,
    again: VecDeque<u8>,
    seen: Vec<u8>,
}

impl Line for Wire {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let gone = |_| LinkError::Closed("the thread ended".to_owned());
        bytes.iter().try_for_each(|byte| self.to.send(*byte)).map_err(gone)
    }

    fn receive(&mut self, deadline: Instant) -> Result<Option<u8>, LinkError> {
        if let Some(byte) = self.again.pop_front() {
            return Ok(Some(byte));
        }
        let byte = match self.from.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
            Ok(byte) => byte,
            Err(RecvTimeoutError::Timeout) => return Ok(None),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(LinkError::Closed("the thread ended".to_owned()));
            }
        };
        self.count += 1;
        self.seen.push(byte);
        match self.fault {
            Fault::Flip(at) if at == self.count => Ok(Some(byte ^ 0x10)),
            Fault::Lose(at) if at == self.count => self.receive(deadline),
            Fault::Silence(at) if at <= self.count => self.receive(deadline),
            Fault::Gone(at) if at <= self.count => Err(LinkError::Closed("unplugged".to_owned())),
            Fault::Repeat(from, to) if to == self.count => {
                self.again.extend(&self.seen[from - 1..to]);
                Ok(Some(byte))
            }
            _ => Ok(Some(byte)),
        }
    }
}

/// The processor's end.
struct Socket {
    to: Sender<u8>,
    from: Receiver<u8>,
}

impl Port for Socket {
    type Error = ();

    fn receive(&mut self) -> Result<u8, ()> {
        self.from.recv().map_err(drop)
    }

    fn send(&mut self, byte: u8) -> Result<(), ()> {
        self.to.send(byte).map_err(drop)
    }

    fn count<T>(&mut self, work: impl FnOnce() -> T) -> (u32, T) {
        (1234, work())
    }
}

/// A processor with a model in its flash, and the line to it.
fn processor(model: Option<&'static [u8]>, fault: Fault) -> (Wire, JoinHandle<Result<(), ()>>) {
    let ((to, heard), (said, from)) = (channel(), channel());
    let mut socket = Socket { to: said, from: heard };
    let thread = thread::spawn(move || {
        let mut memory = vec![0; 1 << 14];
        let flash = Flash(Files::put(&mut memory, model.as_slice()).expect("the model fits"));
        serve::<_, 32, 2>(&mut socket, flash, &mut Workspace::new(), "thread")
    });
    (Wire { to, from, fault, count: 0, again: VecDeque::new(), seen: Vec::new() }, thread)
}

const PATIENCE: Duration = Duration::from_secs(20);
/// State at which the pole is held.
const REST: [f32; 2] = [0.0; 2];
const SHORT: Duration = Duration::from_millis(200);

fn config() -> SwingUpConfig<2> {
    let mut config = SwingUpConfig::cartpole();
    config.setup.seed = 3;
    config.setup.observer.other_step = OtherStep::Accepted;
    config.setup.devices.clock.missed = 0.05;
    config.setup.devices.encoders[1].drop = 0.1;
    config
}

/// The run in place.
fn in_place(config: &SwingUpConfig<2>) -> Summary<2> {
    let model = Cartpole::load(&MODEL.0).unwrap();
    let plant = System::conservative(CARTPOLE);
    let firmware = InPlace { model: &model.system, firmware: config.program().start(&model.system).unwrap() };
    run_on(&plant, firmware, &config.setup, REST, |_| {}).unwrap()
}

#[test]
fn the_trace_is_the_same_over_a_line() {
    let config = config();
    let (wire, thread) = processor(Some(&MODEL.0), Fault::None);
    let mut remote = Remote::begin(wire, &config.program(), PATIENCE).unwrap();
    assert_eq!(remote.name(), "thread");
    let plant = System::conservative(CARTPOLE);
    let summary = run_on(&plant, &mut remote, &config.setup, REST, |_| {}).unwrap();
    assert_eq!(summary, in_place(&config));
    assert!(summary.incidents.missed > 0 && summary.incidents.dropped > 0);
    let ran = (summary.ticks - summary.incidents.missed) as usize;
    assert_eq!(remote.instructions(), vec![1234; ran]);
    let _line = remote.end().unwrap();
    assert_eq!(thread.join().unwrap(), Ok(()));
}

#[test]
fn tracking_is_the_same_over_a_line() {
    let mut config = TrackConfig::<2>::cartpole();
    config.setup.observer.other_step = OtherStep::Accepted;
    let plant = System::conservative(CARTPOLE);
    let model = Cartpole::load(&MODEL.0).unwrap();
    let firmware = InPlace { model: &model.system, firmware: config.program().start(&model.system).unwrap() };
    let expected = run_on(&plant, firmware, &config.setup, config.reference, |_| {}).unwrap();
    let (wire, _thread) = processor(Some(&MODEL.0), Fault::None);
    let mut remote = Remote::begin(wire, &config.program(), PATIENCE).unwrap();
    assert_eq!(run_on(&plant, &mut remote, &config.setup, config.reference, |_| {}).unwrap(), expected);
}

/// A whole run; or the tick that was not run (`None` if the program did not begin), and the reason.
type End = Result<Summary<2>, (Option<u32>, LinkError)>;

/// The end of a run over a line with a fault, with the ticks before it.
fn faulty(fault: Fault, patience: Duration) -> (Vec<Tick<2>>, End) {
    let config = config();
    let (wire, _thread) = processor(Some(&MODEL.0), fault);
    let mut ticks = Vec::new();
    let mut remote = match Remote::begin(wire, &config.program(), patience) {
        Ok(remote) => remote,
        Err(error) => return (ticks, Err((None, error))),
    };
    let end =
        run_on(&System::conservative(CARTPOLE), &mut remote, &config.setup, REST, |tick| ticks.push(*tick));
    let end = end.map_err(|error| match error {
        RunError::Processor { tick, error } => (Some(tick), error),
        RunError::Setup(error) => panic!("{error}"),
    });
    (ticks, end)
}

#[test]
fn a_damaged_answer_ends_the_run_at_its_tick() {
    // The first fault hits the answer to the program, the others hit ticks.
    for (at, first) in [(3, true), (40, false), (2000, false)] {
        let (ticks, end) = faulty(Fault::Flip(at), PATIENCE);
        let (tick, error) = end.unwrap_err();
        assert!(matches!(error, LinkError::Broken | LinkError::OutOfStep), "{error}");
        assert_eq!(tick.is_none(), first);
        assert_eq!(ticks.len() as u32, tick.unwrap_or(0), "the ticks before are there");
        let (_, end) = faulty(Fault::Lose(at), SHORT);
        assert!(matches!(end, Err((_, LinkError::Broken | LinkError::Timeout(_)))), "{end:?}");
    }
}

#[test]
fn an_answer_that_comes_twice_is_not_taken_for_the_next() {
    let (wire, _thread) = processor(Some(&MODEL.0), Fault::None);
    let config = config();
    let mut remote = Remote::begin(wire, &config.program(), PATIENCE).unwrap();
    let plant = System::conservative(CARTPOLE);
    let _whole = run_on(&plant, &mut remote, &config.setup, REST, |_| {}).unwrap();
    let said = remote.end().unwrap().seen;
    let ends: Vec<usize> = (1..=said.len()).filter(|count| said[count - 1] == 0).collect();
    let (ticks, end) = faulty(Fault::Repeat(ends[10] + 1, ends[11]), PATIENCE);
    assert!(matches!(end, Err((Some(_), LinkError::OutOfStep))), "{end:?}");
    assert!((11..30).contains(&ticks.len()));
}

#[test]
fn a_processor_that_falls_silent_or_goes_away_ends_the_run() {
    for at in [1, 5, 900] {
        let (_, end) = faulty(Fault::Silence(at), SHORT);
        let (_, error) = end.unwrap_err();
        assert!(error.to_string().contains("no whole frame within 0.2 s"), "{error}");
        let (_, end) = faulty(Fault::Gone(at), PATIENCE);
        assert!(matches!(end, Err((_, LinkError::Closed(_)))), "{end:?}");
    }
}

#[test]
fn a_refusal_says_why() {
    let refused = |model, program: &Program<2>| {
        let (wire, _thread) = processor(model, Fault::None);
        match Remote::begin(wire, program, PATIENCE).map(drop) {
            Err(LinkError::Refused(refusal)) => refusal,
            other => panic!("{other:?}"),
        }
    };
    let program = config().program();
    assert_eq!(refused(None, &program), Refusal::NoModel);
    let damaged = &MODEL.0[..MODEL.0.len() - 8];
    let said = refused(Some(damaged), &program);
    assert!(matches!(said, Refusal::Model(model) if model.code == 23), "{said}");

    let (wire, _thread) = processor(Some(&MODEL.0), Fault::None);
    let pendulum = SwingUpConfig::<1>::pendulum();
    let error = Remote::begin(wire, &pendulum.program(), PATIENCE).map(drop).unwrap_err();
    assert!(
        error.to_string().contains("not the one that the program was built for (code 35: 2, 1, 0)"),
        "{error}"
    );
    assert!(pendulum.program().start(&System::conservative(PENDULUM)).is_ok());
}
