//! Plans in flash: those that are followed, those that decisions choose from, and those that are refused.

use super::*;
use crate::common::plans::{Written, resting};
use leastaction_firmware_sim::control::MAX_PLANS;

/// Answers to the beginning of a program and ticks of it; the same ticks run in place.
fn check_followed<const N: usize>(
    program: Program<N>,
    serve: impl FnOnce(&mut Script),
    mut in_place: impl FnMut(&[Option<f32>; N], &Target<N>) -> Outcome<N>,
) {
    let target = Target::of(&[0.0; N], 0.0, program.tick);
    let measured = |i: u32| [Some(0.25 + 2e-3 * i as f32); N];
    let mut heard = bytes(&request(&Request::Begin(program)).unwrap());
    for i in 0..20 {
        let samples = Samples { sequence: i, elapsed: 1, measured: measured(i), target };
        heard.extend(bytes(&request(&Request::Tick(samples)).unwrap()));
    }
    let mut script = Script { heard: heard.into_iter(), said: Vec::new() };
    serve(&mut script);
    let said: Vec<Frame> = frames(&script.said).into_iter().map(Result::unwrap).collect();
    assert_eq!((said.len(), parse_answer::<N>(&said[0])), (21, Ok(Answer::Ready { processor: "tester" })));
    let mut modes = Vec::new();
    for (i, frame) in (0..).zip(&said[1..]) {
        let outcome = in_place(&measured(i), &target);
        modes.push(outcome.command.mode);
        assert_eq!(parse_answer(frame), Ok(Answer::Done(Done { sequence: i, outcome, instructions: 0 })));
    }
    assert!(modes.contains(&Mode::Track) && modes.last() == Some(&Mode::Hold), "{modes:?}");
}

#[test]
fn a_plan_is_followed_as_it_is_in_place() {
    let program = following(program());
    let model = fingerprint(&CARTPOLE_FILE.0).unwrap();
    let written = resting((model, program.tick), ([0.25, 0.25], false), &[0], [0.5, 20.0, 2.0]);
    let words = in_flash(&[&CARTPOLE_FILE.0, written.bytes()]);
    let loaded = Cartpole::load(&CARTPOLE_FILE.0).unwrap();
    let plan = || Ok::<_, SetupError>(written.plan());
    let mut firmware = program.follow_with(&loaded.system, plan).unwrap();
    let serve = |script: &mut Script| {
        assert_eq!(
            serve::<_, 32, 2>(script, Flash(Files(&words)), &mut Workspace::new(), "tester"),
            Err(Silence)
        )
    };
    check_followed(program, serve, |measured, target| firmware.run(&loaded.system, 1, measured, target));
    assert!(firmware.last().command.u[0] != 0.0);

    let program = following(arm_program());
    let model = fingerprint(&ARM_FILE.0).unwrap();
    let driven = [0, 1, 2, 3, 4, 5, 6];
    let written = resting((model, program.tick), ([0.25; 7], true), &driven, [0.5, 20.0, 2.0]);
    let words = in_flash(&[&ARM_FILE.0, written.bytes()]);
    let loaded = Arm::load(&ARM_FILE.0).unwrap();
    let plan = || Ok::<_, SetupError>(written.plan());
    let mut firmware = program.follow_with(&loaded.system, plan).unwrap();
    let serve = |script: &mut Script| {
        assert_eq!(serve_arm::<_, 7, 256>(script, Flash(Files(&words)), "tester"), Err(Silence))
    };
    check_followed(program, serve, |measured, target| firmware.run(&loaded.system, 1, measured, target));
    assert!(firmware.last().command.u.iter().all(|u| *u != 0.0));
}

/// The refusal of a program over the cart-pole's model and some plans, if it is refused.
fn refused(program: Program<2>, plans: &[&[u8]]) -> Option<Refusal> {
    let sent = bytes(&request(&Request::Begin(program)).unwrap());
    let mut script = Script { heard: sent.into_iter(), said: Vec::new() };
    let words = in_flash(&[&[&CARTPOLE_FILE.0[..]], plans].concat());
    assert_eq!(
        serve::<_, 32, 2>(&mut script, Flash(Files(&words)), &mut Workspace::new(), "tester"),
        Err(Silence)
    );
    match parse_answer::<2>(frames(&script.said)[0].as_ref().unwrap()) {
        Ok(Answer::Refused(refusal)) => Some(refusal),
        _ => None,
    }
}

#[test]
fn plans_that_cannot_be_followed_are_refused_with_their_reason() {
    let program = following(program());
    let model = fingerprint(&CARTPOLE_FILE.0).unwrap();
    let plan = |model: u32, h: f32, angle: bool| resting((model, h), ([0.0; 2], angle), &[0, 1], [0.0; 3]);
    let whole = plan(model, program.tick, false);
    assert_eq!(refused(program, &[whole.bytes()]), None);
    let fault = |fault| Some(Refusal::Plan(fault));
    assert_eq!(refused(program, &[]), Some(Refusal::NoPlan));
    let cut = &whole.bytes()[..whole.bytes().len() - 4];
    assert_eq!(refused(program, &[cut]), fault(PlanFault::Unreadable));
    let other = plan(model ^ 1, program.tick, false);
    assert_eq!(refused(program, &[other.bytes()]), fault(PlanFault::OtherModel));
    let one = resting((model, program.tick), ([0.0], false), &[0], [0.0; 3]);
    assert_eq!(refused(program, &[one.bytes()]), fault(PlanFault::Shape));
    let slow = plan(model, 0.05, false);
    assert_eq!(refused(program, &[slow.bytes()]), fault(PlanFault::Tick));
    // The cart's encoder reads no angle.
    let turning = plan(model, program.tick, true);
    assert_eq!(refused(program, &[turning.bytes()]), fault(PlanFault::Angle));
    // A plan that is not followed may be anything.
    assert_eq!(refused(self::program(), &[cut]), None);
    for (refusal, words) in [(Refusal::NoPlan, "no plan"), (Refusal::Plan(PlanFault::Tick), "another length")]
    {
        assert!(refusal.to_string().contains(words), "{refusal}");
    }
}

/// A program that decides at every tick, with plans.
fn deciding() -> Program<2> {
    let mut config = MpcConfig::<2>::cartpole().with_tick(program().tick);
    (config.settings.stride, config.setup.observer.other_step) = (1, OtherStep::Accepted);
    config.settings.plan = Some(Drive::ideal());
    config.program()
}

/// A plan of the cart at x m, pushed by `u` N.
fn pushed(x: f32, u: f32) -> Written {
    let model = fingerprint(&CARTPOLE_FILE.0).unwrap();
    resting((model, program().tick), ([x, 0.0], false), &[0], [u, 0.0, 0.0])
}

#[test]
fn decisions_choose_from_several_plans_as_they_do_in_place() {
    let (program, loaded) = (deciding(), Cartpole::load(&CARTPOLE_FILE.0).unwrap());
    let plans = [pushed(1.0, 0.5), pushed(0.0, -3.0)];
    let [far, near] = plans.each_ref().map(|plan| plan.plan());
    let samples = |sequence| Samples { sequence, elapsed: 1, measured: [Some(0.0); 2], target: target(0.0) };
    let mut heard = bytes(&request(&Request::Begin(program)).unwrap());
    (0..6).for_each(|i| heard.extend(bytes(&request(&Request::Tick(samples(i))).unwrap())));
    let words = in_flash(&[&CARTPOLE_FILE.0, plans[0].bytes(), plans[1].bytes()]);
    let mut script = Script { heard: heard.into_iter(), said: Vec::new() };
    assert_eq!(
        serve::<_, 32, 2>(&mut script, Flash(Files(&words)), &mut Workspace::new(), "tester"),
        Err(Silence)
    );
    let mut nodes = blank_nodes();
    let mut firmware = program.mpc(&loaded.system, &[far, near], &mut nodes).unwrap();
    for (i, frame) in (0..6).zip(&frames(&script.said)[1..]) {
        let Samples { elapsed, measured, target, .. } = samples(i);
        let outcome = firmware.run(&loaded.system, elapsed, &measured, &target);
        let done = Answer::Done(Done { sequence: i, outcome, instructions: 0 });
        assert_eq!(parse_answer(frame.as_ref().unwrap()), Ok(done));
    }
    assert_eq!(firmware.last().command.mode, Mode::Mpc);
}

#[test]
fn plans_of_decisions_are_refused_with_their_reason() {
    let refused = |plans: &[Written]| {
        let files: Vec<_> = plans.iter().map(Written::bytes).collect();
        self::refused(deciding(), &files)
    };
    let many = |count: usize| (0..count).map(|_| pushed(0.0, 0.0)).collect::<Vec<_>>();
    assert_eq!(refused(&[]), Some(Refusal::NoPlan));
    assert_eq!(refused(&many(MAX_PLANS)), None);
    assert_eq!(refused(&many(MAX_PLANS + 1)), Some(Refusal::Program(ProgramFault::OutOfRange)));
    let other = resting((1, program().tick), ([0.0; 2], false), &[0], [0.0; 3]);
    assert_eq!(refused(&[pushed(0.0, 0.0), other]), Some(Refusal::Plan(PlanFault::OtherModel)));
}

#[test]
fn the_list_of_files_ends_with_the_flash_and_with_lengths_that_are_none() {
    let list = |words: &[u32]| Files(words).map(<[u8]>::to_vec).collect::<Vec<_>>();
    let [a, b] = [vec![1, 2, 3], vec![4, 5, 6, 7]];
    let words = in_flash(&[&a, &b]);
    assert_eq!(words.len(), 4);
    assert_eq!(list(&words), [a.clone(), b.clone()]);
    assert_eq!(list(&[&words[..], &[0, 9]].concat()), [a.clone(), b.clone()]);
    assert_eq!(list(&[&words[..], &[5, 0]].concat()), [a.clone(), b], "longer than the flash");
    assert_eq!(list(&[&words[..2], &[u32::MAX, 0]].concat()), [a]);
    assert_eq!(list(&[]), [[0; 0]; 0]);
    assert_eq!(Files::put(&mut [0; 3], &[&[1, 2, 3, 4], &[5]]), None, "no room for the last");
}
