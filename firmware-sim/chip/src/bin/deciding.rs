//! Ticks of a program that decides at every tick, over the learned cart-pole, which hangs: the first ones of a swing-up.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::instructions::Counts;
use leastaction_chip::{Aligned, image, models, print, stack};
use leastaction_firmware_sim::Mode;
use leastaction_firmware_sim::control::{Target, blank_nodes};
use leastaction_firmware_sim::scenario::MpcConfig;
use leastaction_firmware_sim::trajectory::reference::Cartpole;

static MODEL: &Aligned<{ include_bytes!("../../models/cartpole.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/cartpole.postcard"));

const TICKS: u32 = 20;

fn run() -> Result<(), &'static [u8]> {
    let model = models::load(|| Cartpole::load(black_box(&MODEL.0)))?;
    let (program, mut nodes) = (MpcConfig::<2>::cartpole().program(), blank_nodes::<2, 4>());
    print::number(b"nodes_bytes", size_of_val(&nodes) as u32);
    let firmware = program.mpc(&model.system, &[], &mut nodes);
    let mut firmware = firmware.map_err(|_| b"the program is refused".as_slice())?;
    print::number(b"firmware_bytes", size_of_val(&firmware) as u32);
    let target = Target::of(&[0.0; 2], 0.0, program.tick);
    let (mut counts, mut decided, mut deepest) = (Counts::default(), 0, 0);
    for _ in 0..TICKS {
        let measured = black_box([Some(0.0), Some(core::f32::consts::PI)]);
        let (depth, outcome) =
            stack::deepest(|| counts.of(|| firmware.run(&model.system, 1, &measured, &target)));
        decided += u32::from(outcome.command.mode == Mode::Mpc);
        deepest = depth.max(deepest);
    }
    if 2 * decided < TICKS {
        return Err(b"few decisions");
    }
    print::number(b"tick_stack", deepest as u32);
    print::number(b"tick_instructions", counts.median());
    print::number(b"tick_instructions_worst", counts.worst);
    Ok(())
}

image!(run);
