//! A controller in whose memory a bit flips, with a handler of processor faults, a watchdog, and guards of its memory.
//!
//! The world is on this machine, at the other end of two pipes: `faults.sh`. It sends an order, which says what guards the controller, when
//! and where a bit flips; then the samples of every tick. The controller follows a motion of the learned cart-pole.
#![no_std]
#![no_main]

mod host;
mod injector;
mod memory;
mod stop;

use core::convert::Infallible;
use core::hint::black_box;
use core::mem::MaybeUninit;
use injector::Flip;
use leastaction_chip::Aligned;
use leastaction_chip::board::{INSTRUCTIONS_PER_TICK, stack_pointer, start, ticks};
use leastaction_firmware_sim::control::{Command, Controller, Setpoint, Target};
use leastaction_firmware_sim::observer::OtherStep;
use leastaction_firmware_sim::scenario::TrackConfig;
use leastaction_firmware_sim::trajectory::reference::SmallCartpole;
use leastaction_firmware_sim::{
    Firmware, InPlace, Input, Mechanism, Outcome, Processor, Swept, Trained, Voting,
};

const N: usize = 2;

static MODEL: Aligned<{ include_bytes!("../../../models/cartpole-16.postcard").len() }> =
    Aligned(*include_bytes!("../../../models/cartpole-16.postcard"));

// Guards of a controller.
const STATE: u32 = 1;
const WEIGHTS: u32 = 2;

/// Bytes of weights and of the checksum behind them.
const CHECKSUM: usize = 4;
const PARAMETERS: usize = (2 * 16 + 16) + (16 * 16 + 16) + (16 * 4 + 4);

/// Memory of the controller: all of its state.
static mut SPACE: Space = Space([MaybeUninit::uninit(); SPACE_BYTES]);
const SPACE_BYTES: usize = 8 << 10;

#[repr(align(8))]
struct Space(#[expect(dead_code, reason = "reached by its address")] [MaybeUninit<u8>; SPACE_BYTES]);

/// Puts a value behind the `used` bytes of the controller's memory.
fn place<T>(used: &mut usize, value: T) -> Option<&'static mut T> {
    let begin = used.next_multiple_of(align_of::<T>());
    let end = begin + size_of::<T>();
    *used = end;
    let at = (&raw mut SPACE).cast::<u8>().wrapping_add(begin).cast::<T>();
    // SAFETY: each value has bytes of its own, within the memory, at a multiple of its alignment, which is at most 8.
    (end <= SPACE_BYTES && align_of::<T>() <= 8).then(|| unsafe {
        at.write(value);
        &mut *at
    })
}

/// Registers of the devices: the message of a tick. They are no memory in which bits flip.
static mut DEVICES: [u32; 14] = [0; 14];

/// Number of the tick, from 1.
fn number() -> u32 {
    // SAFETY: one processor, and the handlers do not write there.
    unsafe { (&raw const DEVICES).cast::<u32>().read_volatile() }
}

/// Reads the devices.
#[inline(never)]
fn read() -> Input<N> {
    // SAFETY: one processor, and the handlers do not write there.
    let [_, elapsed, numbers @ ..] = unsafe { (&raw const DEVICES).read_volatile() };
    let [y0, y1, q0, q1, v0, v1, mq0, mq1, mv0, mv1, ma0, ma1] = numbers.map(f32::from_bits);
    let measured = [y0, y1].map(|y| (!y.is_nan()).then_some(y));
    let middle = Setpoint { q: [mq0, mq1], v: [mv0, mv1], a: [ma0, ma1] };
    Input { elapsed, measured, target: Target { q: [q0, q1], v: [v0, v1], middle } }
}

/// A controller with guards.
trait Guarded {
    /// Runs a tick on what the devices say.
    fn tick(&mut self) -> Outcome<N>;
    /// Number of outvoted copies in the lower half, a lost state and a damaged file above.
    fn found(&self) -> u32;
}

impl<M: Mechanism<N>, C: Controller<N>> Guarded for InPlace<'_, M, C, N> {
    fn tick(&mut self) -> Outcome<N> {
        let Input { elapsed, measured, target } = read();
        self.firmware.run(self.model, elapsed, &measured, &target)
    }

    fn found(&self) -> u32 {
        0
    }
}

impl<M, C> Guarded for Voting<M, C, N>
where
    M: Mechanism<N> + Clone,
    C: Controller<N> + Clone + PartialEq,
{
    fn tick(&mut self) -> Outcome<N> {
        self.run_on(&[read(), read(), read()])
    }

    fn found(&self) -> u32 {
        self.outvoted() | u32::from(self.lost()) << 16
    }
}

impl<P: Guarded + Processor<N, Error = Infallible>> Guarded for Swept<'_, P, N> {
    fn tick(&mut self) -> Outcome<N> {
        let Ok(outcome) = self.tick(|processor| Ok(processor.tick()));
        outcome
    }

    fn found(&self) -> u32 {
        self.processor().found() | u32::from(self.damage().is_some()) << 17
    }
}

/// Order of a run.
struct Order {
    guards: u32,
    /// Tick in which the bit flips.
    tick: u32,
    flip: Flip,
    /// Ticks within which damaged weights are found.
    within: u32,
}

fn order() -> Order {
    let [guards, tick, counts, turns, place, byte, bit, within] = host::hear();
    Order { guards, tick, flip: Flip { counts, turns, place, byte, bit }, within }
}

/// Runs ticks until the world has seen enough.
fn serve<P: Guarded>(controller: Option<&'static mut P>, used: usize, order: &Order) -> Option<Infallible> {
    let controller = controller?;
    let file = black_box(&MODEL.0);
    let end = file.len().checked_sub(CHECKSUM)?;
    let weights = file.get(end.checked_sub(4 * PARAMETERS)?..end)?;
    stop::begin_ticks();
    injector::know((&raw const SPACE as usize, used), weights);
    host::say(&[host::STARTED, used as u32, order.tick, order.flip.byte, 0, 0]);
    loop {
        one_tick(controller, order)?;
    }
}

/// Waits for the samples of a tick, runs it and gives its command; `None` at the end. It is a function of its own, so that the loop keeps nothing
/// on the stack from tick to tick but its arguments: a damaged constant there, such as an address, would be damaged for good.
#[inline(never)]
fn one_tick<P: Guarded>(controller: &mut P, order: &Order) -> Option<()> {
    host::say(&[host::READY, 0, 0, 0, 0, 0]);
    // SAFETY: as in `read`.
    host::hear_into(unsafe { &mut *(&raw mut DEVICES) });
    let tick = number().checked_sub(1)?;
    stop::begin_tick();
    let begin = ticks(0);
    if tick == order.tick {
        injector::arm(order.flip);
    }
    let [u0, u1, mode, found] = run(controller);
    injector::disarm();
    let instructions = ticks(begin) * INSTRUCTIONS_PER_TICK;
    host::say(&[host::DONE | number() << 8, u0, u1, mode, found, instructions]);
    Some(())
}

/// Runs a tick; returns its command, mode, and what the guards have found.
#[inline(never)]
fn run(controller: &mut impl Guarded) -> [u32; 4] {
    let Command { u, mode } = controller.tick().command;
    let [u0, u1] = u.map(f32::to_bits);
    [u0, u1, mode as u32, controller.found()]
}

/// Starts a controller with the ordered guards.
fn guarded<M, C>(model: M, firmware: Firmware<C, N>, order: &Order) -> Option<Infallible>
where
    M: Mechanism<N> + Clone + 'static,
    C: Controller<N> + Clone + PartialEq + 'static,
{
    let mut used = 0;
    let file = black_box(&MODEL.0).as_slice();
    if order.guards & STATE != 0 {
        let voting = Voting::new(model, firmware);
        if order.guards & WEIGHTS != 0 {
            let processor = place(&mut used, Swept::new(voting, file, order.within));
            return serve(processor, used, order);
        }
        let processor = place(&mut used, voting);
        return serve(processor, used, order);
    }
    let model = place(&mut used, model)?;
    let alone = InPlace { model: &*model, firmware };
    if order.guards & WEIGHTS != 0 {
        let processor = place(&mut used, Swept::new(alone, file, order.within));
        return serve(processor, used, order);
    }
    let processor = place(&mut used, alone);
    serve(processor, used, order)
}

/// Clears the stack below, in which an earlier run has left its numbers.
#[inline(never)]
fn clear_stack() {
    let top = stack_pointer();
    for address in (top - (32 << 10)..top - 128).step_by(4) {
        // SAFETY: memory below the stack pointer, where nothing lives.
        unsafe { (address as *mut u32).write_volatile(0) };
    }
}

/// Follows orders, until the world has seen enough or the model is refused.
fn controlled() -> Option<Infallible> {
    let order = order();
    let file: &'static [u8] = black_box(&MODEL.0);
    let model = SmallCartpole::load(file).ok()?;
    let trained = Trained { system: &model.system, step: model.trained_step };
    let mut config = TrackConfig::cartpole();
    // The model was learned with longer steps.
    config.setup.observer.other_step = OtherStep::Accepted;
    let firmware = config.program().follow(&trained).ok()?;
    guarded(model.system, firmware, &order)
}

#[cortex_m_rt::entry]
fn main() -> ! {
    stop::begin_program();
    clear_stack();
    host::open();
    start();
    memory::protect();
    host::say(&[host::BEGUN, 0, 0, 0, 0, 0]);
    controlled();
    stop::end()
}
