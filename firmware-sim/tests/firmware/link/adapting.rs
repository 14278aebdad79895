//! Numbers that follow at the other end of the link.

use super::{ARM_FILE, CARTPOLE_FILE, DRY_FILE, Script, Silence, answers, bytes, frames, in_flash, program};
use leastaction_core::adapt::{Patch, SettingsError};
use leastaction_core::model::fingerprint;
use leastaction_firmware_sim::control::Target;
use leastaction_firmware_sim::link::{
    Answer, Done, Files, Flash, ProgramFault, Refusal, Request, Samples, SettingsFault, parse_answer,
    request, serve_arm,
};
use leastaction_firmware_sim::trajectory::carrying::{self, AdaptingArm, Carrying, adapting, tuning};
use leastaction_firmware_sim::{Processor, Program};

const TICKS: u32 = 400;

/// The settings for the arm, changed.
fn settings(change: impl FnOnce(&mut [u8])) -> Vec<u8> {
    let mut memory = [0; 1024];
    let file = carrying::settings(&ARM_FILE.0).unwrap();
    let mut bytes = file.write(&mut memory).unwrap().to_vec();
    change(&mut bytes);
    bytes
}

/// Answers of a processor with these files to these requests.
fn says(files: &[&[u8]], requests: &[Request<7>]) -> Vec<leastaction_firmware_sim::link::Frame> {
    let heard: Vec<u8> = requests.iter().flat_map(|sent| bytes(&request(sent).unwrap())).collect();
    let mut script = Script { heard: heard.into_iter(), said: Vec::new() };
    assert_eq!(serve_arm::<_, 7, 256>(&mut script, Flash(Files(&in_flash(files))), "tester"), Err(Silence));
    frames(&script.said).into_iter().map(Result::unwrap).collect()
}

fn refusal(files: &[&[u8]], program: Program<7>) -> Refusal {
    match parse_answer::<7>(&says(files, &[Request::Adapt(program)])[0]) {
        Ok(Answer::Refused(refusal)) => refusal,
        answer => panic!("{answer:?}"),
    }
}

/// The arm takes the commands of a firmware in place; the processor, which has more places for numbers, gives the same ones, and saves what the
/// firmware found.
#[test]
fn numbers_follow_as_they_do_in_place() {
    let (file, tuning) = (&ARM_FILE.0, tuning(&ARM_FILE.0).unwrap());
    let mut arm = Carrying::new(file, adapting(file, &tuning).unwrap()).unwrap();
    let (mut sent, mut done) = (vec![Request::Adapt(carrying::program())], Vec::new());
    for sequence in 0..TICKS {
        let run = |firmware: &mut AdaptingArm, measured: &[Option<f32>; 7], target: &Target<7>| {
            sent.push(Request::Tick(Samples { sequence, elapsed: 1, measured: *measured, target: *target }));
            let Ok(outcome) = firmware.run(1, measured, target);
            done.push(Done { sequence, outcome, instructions: 0 });
            (outcome, ())
        };
        arm.tick(sequence, run).unwrap();
    }
    sent.extend([0, 1, 2].map(|part| Request::Save { part }));
    let said = says(&[file, &settings(|_| {})], &sent);
    assert_eq!(parse_answer::<7>(&said[0]), Ok(Answer::Ready { processor: "tester" }));
    let ticks = TICKS as usize;
    for (frame, done) in said[1..=ticks].iter().zip(done) {
        assert_eq!(parse_answer(frame), Ok(Answer::Done(done)));
    }
    let mut patch = Vec::new();
    for frame in &said[ticks + 1..ticks + 3] {
        let Ok(Answer::Saved { parts: 2, bytes }) = parse_answer::<7>(frame) else {
            panic!("nothing is saved")
        };
        patch.extend(bytes);
    }
    let model = fingerprint(file).unwrap();
    assert_eq!(Patch::<17>::read(&patch, model).unwrap(), arm.firmware.patch(model));
    assert!(arm.firmware.adapter().applied()[0] > 0.5, "nothing was found");
    let none = Ok(Answer::Refused(Refusal::NotAdapting));
    assert_eq!(parse_answer::<7>(&said[ticks + 3]), none, "there is no third part");
}

#[test]
fn settings_that_do_not_fit_are_refused() {
    let (file, begin, good) = (&ARM_FILE.0[..], carrying::program(), settings(|_| {}));
    assert_eq!(refusal(&[file], begin), Refusal::NoSettings);
    assert_eq!(refusal(&[], begin), Refusal::NoModel);
    assert_eq!(refusal(&[&DRY_FILE.0, &good], begin), Refusal::Program(ProgramFault::NoAdaptation));
    let fault = |change: fn(&mut [u8])| refusal(&[file, &settings(change)], begin);
    assert_eq!(fault(|bytes| bytes[20] ^= 1), Refusal::Settings(SettingsFault::Unreadable));
    let other = |bytes: &mut [u8]| {
        bytes[5] ^= 1;
        let (body, sum) = bytes.split_last_chunk_mut::<4>().unwrap();
        *sum = leastaction_core::model::checksum(body).to_le_bytes();
    };
    assert_eq!(fault(other), Refusal::Settings(SettingsFault::OtherModel));
    let slow = Program { tick: 2.0 * begin.tick, ..begin };
    assert_eq!(refusal(&[file, &good], slow), Refusal::Settings(SettingsFault::Tick));
    let wrong = Program { tick: f32::NAN, ..begin };
    assert_eq!(refusal(&[file, &good], wrong), Refusal::Settings(SettingsFault::Tick));
    for (error, fault) in [
        (SettingsError::OutOfRange, SettingsFault::OutOfRange),
        (SettingsError::Number { index: 3 }, SettingsFault::OutOfRange),
        (SettingsError::Coordinates { found: 2, needed: 7 }, SettingsFault::Shape),
        (SettingsError::Malformed, SettingsFault::Unreadable),
    ] {
        assert_eq!(Refusal::from(error), Refusal::Settings(fault));
    }
}

/// A program that begins otherwise saves nothing, and a processor of small models lets no numbers of a network follow.
#[test]
fn other_programs_save_nothing() {
    let plain = says(&[&ARM_FILE.0], &[Request::Begin(carrying::program()), Request::Save { part: 0 }]);
    assert_eq!(parse_answer::<7>(&plain[1]), Ok(Answer::Refused(Refusal::NotAdapting)));
    let before = says(&[&ARM_FILE.0], &[Request::Save { part: 0 }]);
    assert_eq!(parse_answer::<7>(&before[0]), Ok(Answer::Refused(Refusal::NotBegun)));
    let (said, _) = answers(Some(&CARTPOLE_FILE.0), bytes(&request(&Request::Adapt(program())).unwrap()));
    let none = Ok(Answer::Refused(Refusal::Program(ProgramFault::NoAdaptation)));
    assert_eq!(parse_answer::<2>(&said[0]), none);
    let (said, _) = answers(None, bytes(&request(&Request::Adapt(program())).unwrap()));
    assert_eq!(parse_answer::<2>(&said[0]), Ok(Answer::Refused(Refusal::NoModel)));
}
