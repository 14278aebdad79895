//! Frames of the link, whole and damaged, and the answers of the processor's end.

mod adapting;
mod plans;

use leastaction_core::model::{CATALOGUE, Entry, ModelError, fingerprint};
use leastaction_firmware_sim::control::{Gains, Law, MpcSettings, Target, Tolerance, blank_nodes};
use leastaction_firmware_sim::devices::{ActuatorConfig, Drive};
use leastaction_firmware_sim::link::{
    Answer, Broken, Done, Files, Flash, Frame, LoggedSamples, ModelRefusal, PlanFault, Port, ProgramFault,
    Receiver, Refusal, Request, Samples, VERSION, Workspace, answer, parse_answer, parse_request, request,
    serve, serve_arm,
};
use leastaction_firmware_sim::observer::{LearnZeros, Order, OtherStep};
use leastaction_firmware_sim::scenario::{MpcConfig, SwingUpConfig, TrackConfig};
use leastaction_firmware_sim::trajectory::reference::{Arm, Cartpole, DryBodies};
use leastaction_firmware_sim::{Mode, Outcome, Program, SetupError, Task};
use proptest::prelude::*;
use std::convert::Infallible;

#[repr(align(4))]
struct Aligned<const N: usize>([u8; N]);

static CARTPOLE_FILE: Aligned<{ include_bytes!("../../chip/models/cartpole.postcard").len() }> =
    Aligned(*include_bytes!("../../chip/models/cartpole.postcard"));
static DOUBLE_FILE: Aligned<{ include_bytes!("../../chip/models/double.postcard").len() }> =
    Aligned(*include_bytes!("../../chip/models/double.postcard"));

static ARM_FILE: Aligned<{ include_bytes!("../../chip/models/arm.postcard").len() }> =
    Aligned(*include_bytes!("../../chip/models/arm.postcard"));

static DRY_FILE: Aligned<{ include_bytes!("../../chip/models/cartpole-dry.postcard").len() }> =
    Aligned(*include_bytes!("../../chip/models/cartpole-dry.postcard"));

/// Words of flash with files.
fn in_flash(files: &[&[u8]]) -> Vec<u32> {
    let length = files.iter().map(|file| 1 + file.len().div_ceil(4)).sum();
    let mut words = vec![0; length];
    assert_eq!(Files::put(&mut words, files).unwrap().0.len(), length);
    words
}

/// The bytes of a frame as they go over the link.
fn bytes(frame: &Frame) -> Vec<u8> {
    let mut bytes = Vec::new();
    let Ok(()) = frame.send(|byte| {
        bytes.push(byte);
        Ok::<(), Infallible>(())
    });
    bytes
}

/// All frames, whole or broken, that the bytes give.
fn frames(bytes: &[u8]) -> Vec<Result<Frame, Broken>> {
    let mut receiver = Receiver::default();
    bytes.iter().filter_map(|byte| receiver.push(*byte)).collect()
}

/// A program in which no number is a default.
fn program() -> Program<2> {
    let mut config = SwingUpConfig::cartpole();
    config.setup.tick = 0.0125;
    config.setup.devices.actuator.limit = [8.5, 0.25];
    config.setup.devices.actuator.delay = 3.25;
    config.setup.observer.order = Order::Four;
    config.setup.observer.other_step = OtherStep::Accepted;
    config.setup.observer.newton.max_iterations = 5;
    (config.setup.observer.newton.stop, config.setup.observer.newton.accept) = (1e-6, 2e-3);
    (config.setup.observer.memory, config.setup.observer.delay, config.setup.observer.patience) =
        (7, 2.5, 31);
    config.setup.observer.zeros = Some(LearnZeros { deviation: 0.025, innovation: 4e-3 });
    (config.pump.effort, config.pump.energy_band, config.pump.rate_band) = (4.5, 0.03, 0.4);
    (config.tolerance.q, config.tolerance.v, config.tolerance.u) = ([0.31, 0.21], [0.61, 0.62], 1.25);
    (config.catch.angle, config.catch.force, config.catch.release) = (0.45, 1.4, 0.9);
    config.program()
}

/// A program that follows a plan, with the drive of the plan's model and another that the firmware knows.
fn following<const N: usize>(program: Program<N>) -> Program<N> {
    let drive = Drive { gain: [0.75; N], offset: [0.125; N] };
    Program { task: Task::Follow { drive }, ..program }
}

/// A tick of a log: the pole hangs, the cart is pushed.
fn logged(sequence: u32) -> LoggedSamples<2> {
    let x = 1e-3 * sequence as f32;
    let measured = [Some(x), (!sequence.is_multiple_of(3)).then_some(3.0 - x)];
    LoggedSamples { sequence, elapsed: 1, measured, command: [0.5, 0.0] }
}

/// Target of a motion of the cart-pole.
fn target(t: f32) -> Target<2> {
    Target::of(&TrackConfig::<2>::cartpole().reference, t, 0.0125)
}

fn tick() -> Request<2> {
    let measured = [Some(-0.25), None];
    Request::Tick(Samples { sequence: 258, elapsed: 3, measured, target: target(2.57) })
}

#[test]
fn requests_and_answers_come_back_as_they_went() {
    let track = Request::Begin(TrackConfig::<2>::acrobot().program());
    let follow = Request::Begin(following(program()));
    for sent in [Request::Begin(program()), track, follow, tick(), Request::Log(logged(7)), Request::End] {
        let received = frames(&bytes(&request(&sent).unwrap()));
        assert_eq!(parse_request::<2>(received[0].as_ref().unwrap()), Ok(sent));
    }
    let one = Request::Begin(TrackConfig::<1>::pendulum().program());
    assert_eq!(parse_request::<1>(&request(&one).unwrap()), Ok(one));

    let mut outcome = Outcome::<2>::waiting();
    (outcome.estimate.q, outcome.estimate.v) = ([f32::MIN_POSITIVE, -0.0], [1.0 / 3.0, f32::MAX]);
    (outcome.command.u, outcome.newton.iterations, outcome.errors) = ([-1.0, 0.0], 4, 77);
    let done = Answer::Done(Done { sequence: 258, outcome, instructions: 1_000_000 });
    let refused = Refusal::Model(ModelRefusal { code: 35, numbers: [2, 1, u32::MAX] });
    for sent in [Answer::Ready { processor: "cortex-m4f" }, done, Answer::Refused(refused)] {
        let received = frames(&bytes(&answer(&sent).unwrap()));
        assert_eq!(parse_answer(received[0].as_ref().unwrap()), Ok(sent));
    }
}

#[test]
fn a_tick_has_the_bytes_of_the_document() {
    // Version, coordinates, the kind (a tick), number 258, 3 elapsed ticks, a reading of −0.25, a missing reading.
    let head = [VERSION, 2, 1, 0x82, 2, 3, 1, 0, 0, 0x80, 0xbe, 0];
    // The target: position 0.5 and 0 at rest, now and in the middle of the tick.
    let position = [0, 0, 0, 0x3f, 0, 0, 0, 0];
    let document = [&head[..], &position, &[0; 8], &position, &[0; 8], &[0; 8]].concat();
    let sum = leastaction_core::model::checksum(&document).to_le_bytes();
    let stuffed = [document, sum.to_vec()].concat();
    let blocks = stuffed.split(|byte| *byte == 0).map(|run| [&[run.len() as u8 + 1], run].concat());
    let expected: Vec<u8> = blocks.flatten().chain([0]).collect();
    let target = Target::of(&[0.5, 0.0], 0.0, 0.01);
    let samples = Samples { sequence: 258, elapsed: 3, measured: [Some(-0.25), None], target };
    assert_eq!(bytes(&request(&Request::Tick(samples)).unwrap()), expected);
}

#[test]
fn a_zero_is_only_at_the_end() {
    for sent in [Request::Begin(program()), tick(), Request::End] {
        let bytes = bytes(&request(&sent).unwrap());
        assert_eq!(bytes.iter().position(|byte| *byte == 0), Some(bytes.len() - 1));
    }
}

#[test]
fn every_truncation_is_refused_and_the_next_frame_is_read() {
    let (long, next) =
        (bytes(&request(&Request::Begin(program())).unwrap()), bytes(&request(&tick()).unwrap()));
    for length in 1..long.len() {
        // The end of the frame is lost, with and without the final 0.
        let cut: Vec<u8> = long[..length].iter().chain(&[0]).chain(&next).copied().collect();
        let received = frames(&cut);
        let first = received[0].as_ref().map_err(|_| Refusal::Frame).and_then(parse_request::<2>);
        if length < long.len() - 1 {
            assert_eq!((first, received.len()), (Err(Refusal::Frame), 2), "{length}");
        }
        assert_eq!(parse_request::<2>(received[1].as_ref().unwrap()), Ok(tick()), "{length}");
        // The beginning of the frame is lost.
        let received = frames(&long[length..]);
        assert!(
            received
                .iter()
                .all(|frame| frame.as_ref().map_or(true, |frame| parse_request::<2>(frame).is_err()))
        );
    }
    assert!(frames(&[0, 0, 0]).is_empty(), "zeros between frames are nothing");
}

#[test]
fn every_changed_bit_is_refused() {
    for sent in [Request::Begin(program()), tick()] {
        let whole = bytes(&request(&sent).unwrap());
        for bit in 0..8 * whole.len() {
            let mut damaged = whole.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            damaged.push(0);
            let received = frames(&damaged);
            let good = |frame: &Result<Frame, Broken>| {
                frame.as_ref().is_ok_and(|frame| parse_request::<2>(frame).is_ok())
            };
            assert!(!received.is_empty() && !received.iter().any(good), "bit {bit}");
        }
    }
}

proptest! {
    #[test]
    fn any_bytes_are_read_without_harm(noise: Vec<u8>) {
        for frame in frames(&noise).into_iter().flatten() {
            prop_assert!(parse_request::<1>(&frame).is_err() && parse_request::<2>(&frame).is_err());
        }
    }
}

/// A port that hears prepared bytes and keeps the answers.
struct Script {
    heard: std::vec::IntoIter<u8>,
    said: Vec<u8>,
}

/// Error at the end of the prepared bytes.
#[derive(Debug, PartialEq)]
struct Silence;

impl Port for Script {
    type Error = Silence;

    fn receive(&mut self) -> Result<u8, Silence> {
        self.heard.next().ok_or(Silence)
    }

    fn send(&mut self, byte: u8) -> Result<(), Silence> {
        self.said.push(byte);
        Ok(())
    }
}

/// Answers of a processor with a model to some bytes, and its end.
fn answers(model: Option<&[u8]>, heard: Vec<u8>) -> (Vec<Frame>, Result<(), Silence>) {
    let mut script = Script { heard: heard.into_iter(), said: Vec::new() };
    let words = in_flash(model.as_slice());
    let end = serve::<_, 32, 2>(&mut script, Flash(Files(&words)), &mut Workspace::new(), "tester");
    (frames(&script.said).into_iter().map(Result::unwrap).collect(), end)
}

fn refusal(model: Option<&[u8]>, sent: &Frame) -> Refusal {
    match parse_answer::<2>(&answers(model, bytes(sent)).0[0]) {
        Ok(Answer::Refused(refusal)) => refusal,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_program_runs_tick_by_tick_as_it_does_in_place() {
    let model = Cartpole::load(&CARTPOLE_FILE.0).unwrap();
    let mut firmware = program().start(&model.system).unwrap();
    let readings = |i: u32| [Some(0.01 * i as f32), (!i.is_multiple_of(3)).then_some(3.0 - 0.02 * i as f32)];
    let tick =
        |i| Samples { sequence: i, elapsed: 1, measured: readings(i), target: target(0.0125 * i as f32) };
    let mut heard = bytes(&request(&Request::Begin(program())).unwrap());
    (0..40).for_each(|i| heard.extend(bytes(&request(&Request::Tick(tick(i))).unwrap())));
    heard.extend(bytes(&request::<2>(&Request::End).unwrap()));
    heard.push(99);
    let (said, end) = answers(Some(&CARTPOLE_FILE.0), heard);
    assert_eq!(end, Ok(()), "what comes after the end is not read");
    assert_eq!(parse_answer::<2>(&said[0]), Ok(Answer::Ready { processor: "tester" }));
    assert_eq!(said.len(), 41);
    for (i, frame) in (0..).zip(&said[1..]) {
        let Samples { elapsed, measured, target, .. } = tick(i);
        let outcome = firmware.run(&model.system, elapsed, &measured, &target);
        assert_eq!(parse_answer(frame), Ok(Answer::Done(Done { sequence: i, outcome, instructions: 0 })));
    }
}

/// Rigid bodies with friction behind a drive that gives less force than commanded.
#[test]
fn bodies_with_friction_run_as_they_do_in_place() {
    let model = DryBodies::load(&DRY_FILE.0).unwrap();
    let mut program = program();
    program.actuator.drive = Drive { gain: [0.9, 1.0], offset: [0.1, 0.0] };
    let mut firmware = program.start(&model.system).unwrap();
    let tick = |i: u32| {
        let measured = [Some(0.0), Some(3.0 - 0.02 * i as f32)];
        Samples { sequence: i, elapsed: 1, measured, target: target(0.0125 * i as f32) }
    };
    let mut heard = bytes(&request(&Request::Begin(program)).unwrap());
    (0..20).for_each(|i| heard.extend(bytes(&request(&Request::Tick(tick(i))).unwrap())));
    let (said, _) = answers(Some(&DRY_FILE.0), heard);
    for (i, frame) in (0..).zip(&said[1..]) {
        let Samples { elapsed, measured, target, .. } = tick(i);
        let outcome = firmware.run(&model.system, elapsed, &measured, &target);
        assert_eq!(parse_answer(frame), Ok(Answer::Done(Done { sequence: i, outcome, instructions: 0 })));
    }
    assert!(said.len() == 21 && firmware.last().command.u[0] != 0.0);
}

/// A program of seven joints in which every number takes the most bytes.
fn arm_program() -> Program<7> {
    let Program { tick, observer, .. } = program();
    let (actuator, gains) = (ActuatorConfig::new([80.0; 7]), Gains { frequency: 20.0, damping: 1.0 });
    let task = Task::Track { begin: [0.25; 7], gains, law: Law::ComputedTorque };
    Program { tick, angle: [true; 7], actuator, observer, task }
}

#[test]
fn an_arm_runs_tick_by_tick_as_it_does_in_place() {
    let model = Arm::load(&ARM_FILE.0).unwrap();
    let mut firmware = arm_program().follow(&model.system).unwrap();
    let tick = |i: u32| {
        let target = Target::of(&[0.25 + 1e-3 * i as f32; 7], 0.0, 0.0125);
        Samples { sequence: u32::MAX - i, elapsed: 1, measured: [Some(0.25); 7], target }
    };
    let mut heard = bytes(&request(&Request::Begin(arm_program())).unwrap());
    (0..20).for_each(|i| heard.extend(bytes(&request(&Request::Tick(tick(i))).unwrap())));
    heard.extend(bytes(&request(&Request::Begin(program())).unwrap()));
    heard.extend(bytes(&request::<7>(&Request::End).unwrap()));
    let mut script = Script { heard: heard.into_iter(), said: Vec::new() };
    assert_eq!(
        serve_arm::<_, 7, 256>(&mut script, Flash(Files(&in_flash(&[&ARM_FILE.0]))), "tester"),
        Ok(())
    );
    let said: Vec<Frame> = frames(&script.said).into_iter().map(Result::unwrap).collect();
    assert_eq!((said.len(), parse_answer::<7>(&said[0])), (22, Ok(Answer::Ready { processor: "tester" })));
    for (i, frame) in (0..).zip(&said[1..21]) {
        let Samples { sequence, elapsed, measured, target } = tick(i);
        let outcome = firmware.run(&model.system, elapsed, &measured, &target);
        assert_eq!(parse_answer(frame), Ok(Answer::Done(Done { sequence, outcome, instructions: 0 })));
    }
    assert!(firmware.last().command.u.iter().all(|u| *u != 0.0));
    assert_eq!(parse_answer::<7>(&said[21]), Ok(Answer::Refused(Refusal::Coordinates { supported: 7 })));
}

/// The refusal of a program of seven joints.
fn arm_refusal(task: Task<7>) -> Refusal {
    let program = Program { task, ..arm_program() };
    let sent = bytes(&request(&Request::Begin(program)).unwrap());
    let mut script = Script { heard: sent.into_iter(), said: Vec::new() };
    assert_eq!(
        serve_arm::<_, 7, 256>(&mut script, Flash(Files(&in_flash(&[&ARM_FILE.0]))), "tester"),
        Err(Silence)
    );
    let said: Vec<Frame> = frames(&script.said).into_iter().map(Result::unwrap).collect();
    match parse_answer::<7>(&said[0]) {
        Ok(Answer::Refused(refusal)) => refusal,
        answer => panic!("{answer:?}"),
    }
}

#[test]
fn nothing_brings_an_arm_upright() {
    let SwingUpConfig { pump, catch, .. } = SwingUpConfig::cartpole();
    let tolerance = Tolerance { q: [0.1; 7], v: [1.0; 7], u: 1.0 };
    let refusal = arm_refusal(Task::SwingUp { pump, tolerance, catch });
    assert_eq!(refusal, Refusal::Program(ProgramFault::NoSwingUp));
}

/// The cart-pole near upright, then far from it: what the processor answers is what a program in place decides.
#[test]
fn decisions_at_every_tick_are_those_in_place() {
    let mut config = MpcConfig::<2>::cartpole().with_tick(program().tick);
    (config.settings.stride, config.setup.observer.other_step) = (1, OtherStep::Accepted);
    let program = config.program();
    let model = Cartpole::load(&CARTPOLE_FILE.0).unwrap();
    let mut nodes = blank_nodes();
    let mut firmware = program.mpc(&model.system, &[], &mut nodes).unwrap();
    let target = target(0.0);
    let tick = |i: u32| {
        let measured = [Some(0.0), (!i.is_multiple_of(5)).then_some(0.2 * i as f32)];
        Samples { sequence: i, elapsed: 1 + u32::from(i == 7), measured, target }
    };
    let mut heard = bytes(&request(&Request::Begin(program)).unwrap());
    (0..16).for_each(|i| heard.extend(bytes(&request(&Request::Tick(tick(i))).unwrap())));
    let (said, _) = answers(Some(&CARTPOLE_FILE.0), heard);
    assert_eq!(said.len(), 17);
    let mut decided = 0;
    for (i, frame) in (0..).zip(&said[1..]) {
        let Samples { elapsed, measured, target, .. } = tick(i);
        let outcome = firmware.run(&model.system, elapsed, &measured, &target);
        decided += u32::from(outcome.command.mode == Mode::Mpc && outcome.command.u[0] != 0.0);
        assert_eq!(parse_answer(frame), Ok(Answer::Done(Done { sequence: i, outcome, instructions: 0 })));
    }
    assert!(decided > 8, "{decided}");
}

#[test]
fn decisions_of_an_arm_at_every_tick_are_refused() {
    let MpcSettings { ticks, stride, iterations, trials, sample_every, piece, drag, .. } =
        MpcConfig::<2>::cartpole().settings;
    let (goal, tolerance) = ([0.0; 7], Tolerance { q: [0.1; 7], v: [1.0; 7], u: 1.0 });
    let settings = MpcSettings {
        goal,
        tolerance,
        ticks,
        stride,
        iterations,
        trials,
        sample_every,
        piece,
        drag,
        plan: None,
    };
    assert_eq!(arm_refusal(Task::Mpc(settings)), Refusal::Program(ProgramFault::NoMpc));
}

#[test]
fn a_log_runs_tick_by_tick_as_it_does_in_place() {
    let model = Cartpole::load(&CARTPOLE_FILE.0).unwrap();
    let program = Program::listening(0.05, [false, true], Drive::ideal(), program().observer);
    let mut firmware = program.listen(&model.system).unwrap();
    let mut heard = bytes(&request(&Request::Begin(program)).unwrap());
    (0..40).for_each(|i| heard.extend(bytes(&request(&Request::Log(logged(i))).unwrap())));
    let (said, _) = answers(Some(&CARTPOLE_FILE.0), heard);
    assert_eq!(said.len(), 41);
    for (sequence, frame) in (0..).zip(&said[1..]) {
        let LoggedSamples { elapsed, measured, command, .. } = logged(sequence);
        let outcome = firmware.replay(&model.system, elapsed, &measured, command);
        assert_eq!(parse_answer(frame), Ok(Answer::Done(Done { sequence, outcome, instructions: 0 })));
        assert_eq!((outcome.command.u, outcome.errors), (command, 0));
    }
    assert_ne!(firmware.last().zeros, [0.0; 2]);
}

#[test]
fn a_program_can_be_begun_again_and_a_damaged_frame_is_refused() {
    let begin = bytes(&request(&Request::Begin(program())).unwrap());
    let mut damaged = bytes(&request(&tick()).unwrap());
    damaged[4] ^= 1;
    let (said, end) = answers(Some(&CARTPOLE_FILE.0), [&begin[..], &damaged, &begin].concat());
    assert_eq!(end, Err(Silence));
    let said: Vec<_> = said.iter().map(|frame| parse_answer::<2>(frame).unwrap()).collect();
    let ready = Answer::Ready { processor: "tester" };
    assert_eq!(said, [ready, Answer::Refused(Refusal::Frame), ready]);
}

#[test]
fn what_cannot_be_run_is_refused_with_its_reason() {
    let begin = request(&Request::Begin(program())).unwrap();
    let file = &CARTPOLE_FILE.0;
    assert_eq!(refusal(None, &begin), Refusal::NoModel);
    assert_eq!(refusal(Some(&DOUBLE_FILE.0), &begin), of_model(34, [0; 3]));
    let Refusal::Model(damaged) = refusal(Some(&file[..file.len() - 4]), &begin) else { panic!("accepted") };
    assert_eq!(damaged.code, 23);
    assert!(damaged.numbers[0] != damaged.numbers[1] && damaged.numbers[2] == 0, "{damaged}");
    assert_eq!(refusal(Some(file), &request(&tick()).unwrap()), Refusal::NotBegun);
    let pendulum = request(&Request::Begin(TrackConfig::<1>::pendulum().program())).unwrap();
    assert_eq!(refusal(Some(file), &pendulum), of_model(35, [2, 1, 0]));

    let mut wrong = program();
    wrong.tick = f32::NAN;
    let wrong = request(&Request::Begin(wrong)).unwrap();
    assert_eq!(refusal(Some(file), &wrong), Refusal::Program(ProgramFault::OutOfRange));

    // The file names a step of 0.05 s and order 4.
    let mut other = program();
    other.observer.other_step = OtherStep::Refused;
    let other = request(&Request::Begin(other)).unwrap();
    assert_eq!(refusal(Some(file), &other), Refusal::Program(ProgramFault::OutOfRange));

    let three = Frame::of(&(VERSION, 3_u8, Request::<2>::End)).unwrap();
    assert_eq!(refusal(Some(file), &three), Refusal::Coordinates { supported: 2 });
    let newer = Frame::of(&(VERSION + 1, 2_u8, Request::<2>::End)).unwrap();
    assert_eq!(refusal(Some(file), &newer), Refusal::Version { supported: VERSION });
}

/// Refusal of a model by the given number of core's catalogue.
fn of_model(code: u8, numbers: [u32; 3]) -> Refusal {
    Refusal::Model(ModelRefusal { code, numbers })
}

#[test]
fn refusals_of_models_are_core_s_own() {
    let refusal = ModelRefusal::from(ModelError::NoSuchTree { trees: 3 });
    assert_eq!(Refusal::Model(refusal), of_model(32, [3, 0, 0]));
    assert_eq!(refusal.to_string(), "no tree in the file has that name (code 32: 3, 0, 0)");
    let far = ModelRefusal::from(ModelError::NotFinite { index: usize::MAX });
    assert_eq!(Refusal::Model(far), of_model(29, [u32::MAX, 0, 0]));
    let unknown = ModelRefusal { code: 250, numbers: [0; 3] };
    assert_eq!(unknown.to_string(), "refused (code 250: 0, 0, 0)");
}

/// LINK.md has every code, and no other.
#[test]
fn the_codes_that_are_written_down_are_core_s_catalogue() {
    let text = include_str!("../../LINK.md");
    let (_, table) = text.split_once("| code | name | why |\n|---|---|---|\n").unwrap();
    let rows: Vec<&str> = table.lines().take_while(|line| line.starts_with('|')).collect();
    let catalogue = CATALOGUE.iter();
    let expected: Vec<String> = catalogue
        .map(|Entry { code, name, message }| format!("| {code} | `{name}` | {} |", message.to_str().unwrap()))
        .collect();
    assert_eq!(rows, expected, "the table of codes:\n{}\n", expected.join("\n"));
}
