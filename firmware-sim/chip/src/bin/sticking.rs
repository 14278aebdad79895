//! Instructions of a step of order 2 with friction that sticks, sliding and stuck, and with smooth friction of the same level.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::instructions::mean;
use leastaction_chip::{image, print};
use leastaction_core::discrete::{Control, Del, Midpoint, State};
use leastaction_core::energy::bodies::{BODY_PARAMETERS, BodyTree, Joint, PlanarBodies, TreeBody};
use leastaction_core::forces::{Coulomb, DryFriction, Forces, Sticking, StickingFriction, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_firmware_sim::trajectory::reference::{STEP, newton};

const CALLS: u32 = 200;
/// Friction of every coordinate, N or N m, which holds what rests.
const LEVEL: f32 = 0.25;
/// Friction that halves a velocity within a step, so that the end of the step is solved on its own.
const BRAKE: f32 = 2.0;
/// Width of the smooth sign, m/s or rad/s.
const WIDTH: f32 = 0.0625;

/// Gravity, m/s²: links hang at 0.
const GRAVITY: [f32; 2] = [9.81, 0.0];
/// A link: joint at 1 m on the one before, mass, centre, moment of inertia, no rotor.
const LINK: [f32; BODY_PARAMETERS] = [1.0, 0.0, 0.0, 0.125, 0.5, 0.0, 0.0078125, 0.0, 0.0];

/// Instructions of a step from a state after a step from (q, v) under no force.
fn step<L: Lagrangian<f32, N>, F: Forces<f32, N>, const N: usize>(
    system: &System<L, F>,
    [q, v]: &[[f32; N]; 2],
) -> Result<u32, &'static [u8]> {
    let refused = b"a step is refused".as_slice();
    let (del, none) = (Del::<f32, Midpoint>::with_newton(STEP, newton()), Control::held([0.0; N]));
    let mut before = State::new(&system.lagrangian, *q, *v).map_err(|_| refused)?;
    del.step(system, &mut before, &none).map_err(|_| refused)?;
    let mut solved = true;
    let count = mean(CALLS, || {
        let mut state = *black_box(&before);
        solved &= del.step(black_box(system), &mut state, black_box(&none)).is_ok();
        black_box(&state);
    });
    if solved { Ok(count) } else { Err(refused) }
}

/// Prints the instructions of a step of a chain of links with smooth friction of a level, and with friction that sticks.
#[inline(never)]
fn both<const N: usize>(names: [&[u8]; 2], level: f32, state: &[[f32; N]; 2]) -> Result<(), &'static [u8]> {
    let link = |i: usize| TreeBody { joint: Joint::Revolute, parent: i.checked_sub(1).map(|on| on as u8) };
    let tree = BodyTree::new((0..N).map(link)).map_err(|_| b"the tree is refused".as_slice())?;
    let lagrangian = PlanarBodies { tree, gravity: &GRAVITY, numbers: &[LINK; N] };
    let smooth = DryFriction { constant: level, width: WIDTH, ..DryFriction::none() };
    let smooth = System { lagrangian, forces: Coulomb { coordinates: [smooth; N] } };
    let friction = StickingFriction { constant: level, width: WIDTH, ..StickingFriction::none() };
    let sticking = System { lagrangian, forces: Sticking { coordinates: [friction; N] } };
    print::number(names[0], step(black_box(&smooth), state)?);
    print::number(names[1], step(black_box(&sticking), state)?);
    Ok(())
}

fn run() -> Result<(), &'static [u8]> {
    both([b"smooth_1", b"sliding_1"], LEVEL, &[[0.5], [2.0]])?;
    both([b"smooth_rest_1", b"stuck_1"], LEVEL, &[[0.0625], [0.0]])?;
    let moving = &[[0.5, 0.25], [2.0, -3.0]];
    both([b"smooth_2", b"sliding_2"], LEVEL, moving)?;
    both([b"smooth_rest_2", b"stuck_2"], LEVEL, &[[0.0625; 2], [0.0; 2]])?;
    both([b"smooth_braking_2", b"braking_2"], BRAKE, moving)
}

image!(run);
