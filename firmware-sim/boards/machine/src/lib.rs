//! The machine that every template of this folder controls: what is yours is marked CHANGE.
//!
//! A template adds a board: a hardware timer, encoders, a drive, a watchdog, and a handler of faults. In every period it calls [`Control::tick`] with the
//! counts of the encoders and gives the duty that comes back to the drive. Here a pole is brought upright by its cart and held there, by a model
//! that was learned from logs of the machine.
//!
//! The loop runs with the same bits on a desk: `tests/hash.rs` runs it around a simulated machine, and the image `board_loop` of
//! `firmware-sim/chip` on emulated boards.
#![no_std]

mod counted;
mod counter;

pub use counted::Counted;
pub use counter::{Counter, ticks};

use core::array::from_fn;
use core::convert::Infallible;
use leastaction_core::forces::{Coulomb, Viscous};
use leastaction_core::model::{BodiesModel, ModelError};
use leastaction_firmware_sim::control::Target;
use leastaction_firmware_sim::scenario::SwingUpConfig;
use leastaction_firmware_sim::{Mode, Outcome, Processor, Program, SetupError, Swept, Trained, Voting};

/// Coordinates: the cart, m, and the pole, rad, which is upright at 0.
pub const N: usize = 2;

/// The model file, in flash.
// CHANGE 1: your model. `leastaction export RUN -o m.postcard --rust learned.rs`, put learned.rs beside this file, and write
// `#[allow(dead_code)] mod learned; pub use learned::{Model, N, load as model};` in place of N, FILE, Aligned, Model and `model()` here. The arrays below
// then have your number of coordinates.
static FILE: &Aligned<{ include_bytes!("../../../chip/models/cartpole-dry.postcard").len() }> =
    &Aligned(*include_bytes!("../../../chip/models/cartpole-dry.postcard"));
/// The model: two rigid bodies with damping and dry friction.
pub type Model = BodiesModel<'static, N, f32, (Viscous<f32, N>, Coulomb<f32, N>)>;

/// The task, and what is known of the machine.
// CHANGE 2: tick, limits and task. `GravityConfig`, `TrackConfig`, `FollowConfig` and `MpcConfig` beside `SwingUpConfig` float, follow a motion,
// follow a plan, and decide at every tick; their `new` takes encoders, limits and the start of any number of coordinates.
pub fn program() -> Program<N> {
    let mut config = SwingUpConfig::cartpole();
    config.setup.tick = 0.01;
    config.setup.devices.actuator.limit = [10.0, 0.0];
    config.program()
}

/// Encoders: counts at q = 0, and m or rad of one count.
// CHANGE 3: your encoders. `tick` commands the first coordinate's drive; where others have drives, let it give a duty for each.
pub const ENCODERS: [Encoder; N] =
    [Encoder { zero: 0, unit: 1.0 / 20_000.0 }, Encoder { zero: 0, unit: core::f32::consts::TAU / 4096.0 }];

/// Drive: command at full duty, N; its sign is that of the drive's direction.
// CHANGE 4: your drive. CHANGE 5 is in the template: its pins.
pub const FULL: f32 = 12.0;

/// An encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    /// Reading at q = 0, counts.
    pub zero: i32,
    /// Length or angle of a count, m or rad; negative if the encoder counts backwards.
    pub unit: f32,
}

impl Encoder {
    /// Position of a reading, m or rad.
    pub fn position(&self, counts: i32) -> f32 {
        counts.wrapping_sub(self.zero) as f32 * self.unit
    }

    /// Reading at a position, counts.
    pub fn counts(&self, q: f32) -> i32 {
        (libm::roundf(q / self.unit) as i32).wrapping_add(self.zero)
    }
}

/// Files are read in place, at a multiple of 4.
#[repr(align(4))]
struct Aligned<const BYTES: usize>([u8; BYTES]);

/// Loads the model.
///
/// # Errors
/// A file that is not whole, or of another type.
pub fn model() -> Result<Model, ModelError> {
    Model::load(&FILE.0)
}

/// The control loop between encoders and drive.
#[derive(Debug)]
pub struct Control<P> {
    processor: P,
    period: f32,
}

/// Starts the control loop of the program over a model, with guards of its memory: three copies of the controller vote, and the model's file is
/// compared with its checksum, a slice a tick. A tick so takes twice its time. Where there is none to spare, or for decisions at every tick,
/// `InPlace { model, firmware }` takes the place of `Voting`.
///
/// # Errors
/// See [`Program::start`].
pub fn control(model: &Model) -> Result<Control<impl Processor<N, Error = Infallible>>, SetupError> {
    let program = program();
    let firmware = program.start(&Trained { system: &model.system, step: model.trained_step })?;
    let voting = Voting::new(model.system, firmware);
    let processor = Swept::new(voting, &FILE.0, program.observer.settling());
    Ok(Control { processor, period: program.tick })
}

impl<P: Processor<N, Error = Infallible>> Control<P> {
    /// Length of a tick, µs.
    pub fn period(&self) -> u32 {
        libm::roundf(1e6 * self.period) as u32
    }

    /// Runs `elapsed` ticks after the last run on the encoders' counts, `None` for an encoder that did not answer. Returns the drive's duty, from
    /// −1 to 1: 0 until the estimate is trusted, and whenever the model fails.
    pub fn tick(&mut self, elapsed: u32, counts: &[Option<i32>; N]) -> f32 {
        let measured = from_fn(|i| counts[i].map(|counts| ENCODERS[i].position(counts)));
        let target = Target::of(&[0.0; N], 0.0, self.period);
        let Ok(outcome) = self.processor.run(elapsed, &measured, &target);
        (outcome.command.u[0] / FULL).clamp(-1.0, 1.0)
    }

    /// The outcome of the last tick: estimate, force, mode.
    pub fn last(&self) -> &Outcome<N> {
        self.processor.last()
    }

    /// Whether the last tick could trust its estimate and its model; lights and enable lines follow it.
    pub fn is_well(&self) -> bool {
        !matches!(self.last().command.mode, Mode::Wait | Mode::Safe)
    }
}
