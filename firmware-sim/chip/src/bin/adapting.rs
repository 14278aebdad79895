//! Ticks of a program whose model follows what a seven-jointed arm carries, and of one whose model stays what it is.
#![no_std]
#![no_main]

use core::convert::Infallible;
use core::hint::black_box;
use leastaction_chip::instructions::Counts;
use leastaction_chip::{Aligned, board, image, models, print, stack};
use leastaction_firmware_sim::Processor;
use leastaction_firmware_sim::trajectory::Fingerprint;
use leastaction_firmware_sim::trajectory::carrying::{Carrying, adapting, plain, tuning};
use leastaction_firmware_sim::trajectory::reference::Arm;

static MODEL: &Aligned<{ include_bytes!("../../models/arm.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/arm.postcard"));

/// Steps if no number was left in flash.
const STEPS: u32 = 1_000;
/// Ticks over which the depth of the stack is found: several windows.
const WATCHED: u32 = 100;

/// Runs an arm, and prints the bytes of its firmware and of a model beside it, and instructions and stack of the firmware's ticks.
#[inline(never)]
fn ticks<'f, F: Processor<7, Error = Infallible>>(
    arm: &mut Carrying<'f, F>,
    (names, model): ([&[u8]; 4], usize),
    mut after: impl FnMut(&Carrying<'f, F>),
) -> Result<(), &'static [u8]> {
    let (mut counts, mut deepest) = (Counts::default(), 0);
    for index in 0..board::argument().unwrap_or(STEPS) {
        let run = |firmware: &mut F, measured: &_, target: &_| {
            let (measured, target) = (black_box(measured), black_box(target));
            let mut counted = || counts.of(|| firmware.run(1, measured, target));
            let (depth, Ok(outcome)) = if index < WATCHED { stack::deepest(counted) } else { (0, counted()) };
            (outcome, depth)
        };
        let (_, depth) = arm.tick(index, run).map_err(|_| b"a step is refused".as_slice())?;
        deepest = depth.max(deepest);
        after(arm);
    }
    let [bytes, stack, median, worst] = names;
    print::number(bytes, (size_of::<F>() + model) as u32);
    print::number(stack, deepest as u32);
    print::number(median, counts.median());
    print::number(worst, counts.worst);
    Ok(())
}

fn run() -> Result<(), &'static [u8]> {
    let refused = b"the arm is refused".as_slice();
    let file = black_box(&MODEL.0);
    let tuning = tuning(file).map_err(|_| refused)?;
    let mut fingerprint = Fingerprint::default();
    let mut arm = Carrying::new(file, adapting(file, &tuning).map_err(|_| refused)?).map_err(|_| refused)?;
    let names = [b"adapting_bytes".as_slice(), b"adapting_stack", b"adapting", b"adapting_worst"];
    ticks(&mut arm, (names, 0), |arm| fingerprint.update(arm))?;
    print::hash(b"hash", fingerprint.value());
    let model = models::load(|| Arm::load(file))?;
    let mut arm = Carrying::new(file, plain(&model.system).map_err(|_| refused)?).map_err(|_| refused)?;
    let names = [b"plain_bytes".as_slice(), b"plain_stack", b"plain", b"plain_worst"];
    ticks(&mut arm, (names, size_of_val(&model.system)), |_| {})
}

image!(run);
