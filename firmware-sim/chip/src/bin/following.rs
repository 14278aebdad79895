//! Ticks of a program that follows a plan, and ticks that only estimate the state along the same readings: for the cart-pole with friction and
//! for the double pendulum.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::instructions::Counts;
use leastaction_chip::{Aligned, image, models, print};
use leastaction_core::model::fingerprint;
use leastaction_core::plan::{Plan, PlanFile};
use leastaction_firmware_sim::control::Target;
use leastaction_firmware_sim::devices::EncoderConfig;
use leastaction_firmware_sim::scenario::FollowConfig;
use leastaction_firmware_sim::trajectory::reference::{Double, DryBodies, TREE};
use leastaction_firmware_sim::{Mechanism, Mode, Program, SetupError, Task};

macro_rules! in_flash {
    ($name:ident, $file:literal) => {
        static $name: &Aligned<{ include_bytes!(concat!("../../models/", $file)).len() }> =
            &Aligned(*include_bytes!(concat!("../../models/", $file)));
    };
}
in_flash!(CARTPOLE, "cartpole-dry.postcard");
in_flash!(SWING_UP, "swing-up.postcard");
in_flash!(DOUBLE, "double.postcard");
in_flash!(REACH, "reach.postcard");

fn run() -> Result<(), &'static [u8]> {
    let cartpole = models::load(|| DryBodies::load(black_box(&CARTPOLE.0)))?;
    let up = plan(&CARTPOLE.0, &SWING_UP.0).map_err(|_| b"the swing-up is refused".as_slice())?;
    let encoders = [EncoderConfig::linear(), EncoderConfig::rotary()];
    let names = [b"cartpole_follow_instructions".as_slice(), b"cartpole_observe_instructions"];
    ticks(&cartpole.system, (&up, encoders), names)?;
    let double = models::load(|| Double::load(black_box(&DOUBLE.0), TREE))?;
    let reach = plan(&DOUBLE.0, &REACH.0).map_err(|_| b"the reach is refused".as_slice())?;
    let names = [b"double_follow_instructions".as_slice(), b"double_observe_instructions"];
    ticks(&double.system, (&reach, [EncoderConfig::rotary(); 2]), names)
}

/// A plan for the model in a file.
fn plan<'p>(model: &[u8], file: &'p [u8]) -> Result<Plan<'p, 2, 2>, SetupError> {
    let file = PlanFile::parse(black_box(file))?;
    file.check_model(fingerprint(model).map_err(|_| SetupError::NoPlan)?)?;
    Ok(Plan::at_most(file)?)
}

/// Prints the median instructions of the ticks of both programs along the planned motion.
fn ticks<M: Mechanism<2>>(
    model: &M,
    (plan, encoders): (&Plan<2, 2>, [EncoderConfig; 2]),
    names: [&[u8]; 2],
) -> Result<(), &'static [u8]> {
    let program = FollowConfig::new(plan, encoders).program();
    let programs = [program, Program { task: Task::Listen, ..program }];
    for ((program, name), mode) in programs.iter().zip(names).zip([Mode::Track, Mode::Open]) {
        let firmware = program.follow_with(model, || Ok::<_, SetupError>(*plan));
        let mut firmware = firmware.map_err(|_| b"the program is refused".as_slice())?;
        let (mut counts, mut wrong) = (Counts::default(), 0);
        for tick in 0..plan.ticks() {
            let at = plan.reference(tick);
            let (measured, target) = (black_box(at.q.map(Some)), Target::of(&at.q, 0.0, program.tick));
            let outcome = counts.of(|| firmware.run(model, 1, &measured, &target));
            wrong += u32::from(outcome.command.mode != mode);
        }
        // Only the first ticks have no estimate.
        if 10 * wrong > plan.ticks() {
            return Err(b"ticks of another mode");
        }
        print::number(name, counts.median());
    }
    Ok(())
}

image!(run);
