//! The firmware's loop as a module of WebAssembly: a mechanism, its devices, and the program that decides at every tick over a learned model,
//! from the same source as `leastaction simulate` and the images for chips, and with the same bits.
//!
//! The page puts a model file into [`buffer`], calls [`begin`], then [`tick`] as time passes, and reads the state from [`view`]. There is one run at a
//! time; a module may be instantiated several times. Nothing allocates.
#![no_std]

mod arena;
mod machine;
mod session;
mod text;
mod timed;
mod view;

use arena::Arena;
use core::ptr::addr_of_mut;
use leastaction_core::forces::{Dissipation, PotentialCorrection};
use leastaction_core::model::{BodiesModel, InertiaNetworkModel, ModelError};
use leastaction_firmware_sim::trajectory::reference::Friction;
use machine::{AnyMachine, Machine};
use session::{Live, Refused};
use text::Text;
use view::View;

/// Largest model file, bytes.
const MODEL: usize = 32 * 1024;
/// Maximum number of units of a hidden layer, and of hidden layers, as in the images for chips.
const UNITS: usize = 32;
/// See [`UNITS`].
const LAYERS: usize = 2;

/// Every law of force that a model may have.
type Laws<'a, const N: usize> =
    (Friction<N>, (Dissipation<'a, f32, N, UNITS, LAYERS>, PotentialCorrection<'a, f32, N, UNITS, LAYERS>));

/// Everything of the module.
struct State {
    buffer: [u8; MODEL],
    arena: Arena,
    run: Option<&'static mut dyn Live>,
    view: View,
    text: Text,
}

static mut STATE: State = State {
    buffer: [0; MODEL],
    // SAFETY: this is the only one.
    arena: unsafe { Arena::new() },
    run: None,
    view: View::new(),
    text: Text::new(),
};

/// The state of the module.
fn state() -> &'static mut State {
    // SAFETY: a module has one thread, and every exported function asks once and keeps nothing when it returns.
    unsafe { &mut *addr_of_mut!(STATE) }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    core::arch::wasm32::unreachable()
}

/// Begins a run over a model file of either family.
macro_rules! begin_over {
    ($n:literal, $arena:ident, $machine:ident, $file:ident, $seed:ident) => {{
        let machine: Machine<$n> = $machine;
        let name = machine.name;
        match InertiaNetworkModel::<$n, UNITS, LAYERS, f32, Laws<$n>>::load($file) {
            Err(ModelError::OtherFamily { .. }) => BodiesModel::<$n, f32, Laws<$n>>::load($file)
                .map_err(|error| refused(error, name))
                .and_then(|model| session::begin($arena, machine, model, $seed)),
            Ok(model) => session::begin($arena, machine, model, $seed),
            Err(error) => Err(refused(error, name)),
        }
    }};
}

/// The reason for refusing a file, with the mechanism's name if its number of coordinates is the reason.
fn refused(error: ModelError, mechanism: &'static str) -> Refused {
    match error {
        ModelError::Shape { what: "coordinates", found, compiled: needed } => {
            Refused::Coordinates { found, mechanism, needed }
        }
        error => Refused::Model(error),
    }
}

impl State {
    fn begin(&mut self, mechanism: u32, length: usize, seed: u32) -> Result<(), Refused> {
        self.run = None;
        // SAFETY: only the run uses what is in the arena.
        unsafe { self.arena.clear() };
        let file = self.buffer.get(..length).ok_or(Refused::Large)?;
        let (arena, machine) = (&mut self.arena, AnyMachine::numbered(mechanism).ok_or(Refused::Mechanism)?);
        let file = arena.put_bytes(file).ok_or(Refused::Large)?;
        self.run = Some(match machine {
            AnyMachine::One(machine) => begin_over!(1, arena, machine, file, seed)?,
            AnyMachine::Two(machine) => begin_over!(2, arena, machine, file, seed)?,
        });
        self.view = View::new();
        Ok(())
    }
}

/// Place for a model file, of [`capacity`] bytes.
#[unsafe(no_mangle)]
pub extern "C" fn buffer() -> *mut u8 {
    state().buffer.as_mut_ptr()
}

/// Largest model file, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn capacity() -> usize {
    MODEL
}

/// Begins a run of a mechanism by the first `length` bytes of the buffer: 0 pendulum, 1 cart-pole, 2 cart-pole with friction, 3 acrobot, 4
/// pendubot. Returns whether it was begun; if not, [`text`] says why, and there is no run.
#[unsafe(no_mangle)]
pub extern "C" fn begin(mechanism: u32, length: usize, seed: u32) -> bool {
    let state = state();
    let begun = state.begin(mechanism, length, seed);
    if let Err(reason) = &begun {
        state.text.set(reason);
    }
    begun.is_ok()
}

/// Takes some ticks of the run, if there is one.
#[unsafe(no_mangle)]
pub extern "C" fn tick(count: u32) {
    let State { run: Some(run), view, .. } = state() else { return };
    for _ in 0..count {
        run.tick(view);
    }
}

/// Pushes a coordinate by a force (N or N m) during the next ticks.
#[unsafe(no_mangle)]
pub extern "C" fn push(coordinate: usize, force: f32, ticks: u32) {
    if let Some(run) = &mut state().run {
        run.push(coordinate, force, ticks);
    }
}

/// State after the last tick.
#[unsafe(no_mangle)]
pub extern "C" fn view() -> *const View {
    &state().view
}

/// Number of ticks of the scenario; 0 without a run.
#[unsafe(no_mangle)]
pub extern "C" fn length() -> u32 {
    state().run.as_ref().map_or(0, |run| run.length())
}

/// Hash of the trace so far; 0 without a run.
#[unsafe(no_mangle)]
pub extern "C" fn hash() -> u64 {
    state().run.as_ref().map_or(0, |run| run.outcome().0)
}

/// Whether the mechanism has reached the goal, and kept it as long as the scenario asks.
#[unsafe(no_mangle)]
pub extern "C" fn success() -> bool {
    state().run.as_ref().is_some_and(|run| run.outcome().1)
}

/// Reason why the last run was not begun.
#[unsafe(no_mangle)]
pub extern "C" fn text() -> *const u8 {
    state().text.bytes().as_ptr()
}

/// Length of [`text`], bytes.
#[unsafe(no_mangle)]
pub extern "C" fn text_length() -> usize {
    state().text.bytes().len()
}
