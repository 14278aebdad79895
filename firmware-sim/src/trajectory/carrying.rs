//! An arm of seven joints that carries a load of which its firmware knows nothing, while numbers of the firmware's model follow.

use super::Motion;
use super::reference::newton;
use crate::Program;
use crate::control::{NoMpc, NoPump, Reference, Target, TaskController, Trajectory};
use crate::devices::EncoderConfig;
use crate::scenario::TrackConfig;
use crate::{Adapting, InPlace, Mechanism, Outcome, Processor};
use core::convert::Infallible;
use leastaction_core::adapt::{
    Announcement, Blocks, Following, Limits, Number, Settings, SettingsFile, StoredSettings, Tunable, Tuning,
};
use leastaction_core::discrete::{Control, Del, Midpoint, Report, State, StepError};
use leastaction_core::energy::arm::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, INERTIAL_PARAMETERS};
use leastaction_core::forces::{Coefficient, Viscous};
use leastaction_core::model::{ArmHeader, ModelError, Tuned, fingerprint, parse_as};

/// Number of joints.
const N: usize = 7;
/// Numbers that follow: those of the last body, and the friction of every joint.
const P: usize = INERTIAL_PARAMETERS + N;
const PAIRS: usize = P * (P - 1) / 2;
/// Numbers of the model.
const NUMBERS: usize = ARM_GRAVITY_PARAMETERS + N * ARM_PARAMETERS + N;

/// The model of the arm, whose numbers may be changed.
pub type TunedArm<'f> = Tuned<'f, Viscous<f32, N>, ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, N, NUMBERS>;
/// The controller, which follows a motion by computed torques.
pub type ArmController = TaskController<'static, NoPump, NoMpc, N>;
/// Settings of the adapter.
pub type ArmTuning = Tuning<f32, N, P>;
/// The firmware whose model follows.
pub type AdaptingArm<'f> = Adapting<'f, TunedArm<'f>, ArmController, N, P, PAIRS>;
/// The firmware whose model stays what it is.
pub type PlainArm<'m, M> = InPlace<'m, M, ArmController, N>;

/// Tick, s.
const TICK: f32 = 4e-3;
/// Ticks of a block, and blocks of half a window.
const BLOCK: u16 = 2;
const HALF: u16 = 12;

/// A load of 1.5 kg a hand's breadth before the flange.
const LOAD: [f32; INERTIAL_PARAMETERS] = [1.5, 0.0, 0.0, 0.1875, 0.03125, 0.0, 0.03125, 0.0, 0.0, 0.0078125];

/// Number j of those that follow.
fn number(j: usize) -> Number {
    match j {
        0..INERTIAL_PARAMETERS => Number::Inertia { body: N as u8 - 1, index: j as u8 },
        _ => Number::Friction(Coefficient::Viscous, (j - INERTIAL_PARAMETERS) as u8),
    }
}

/// How a number may follow.
struct Room {
    prior: f32,
    lower: f32,
    upper: f32,
    walk: f32,
}

impl Room {
    /// Room of number j, which is `own` in the model: for loads of some kilograms within half a metre of the joint, and for friction within a
    /// factor of 4, which changes by a quarter in a minute.
    fn of(j: usize, own: f32) -> Self {
        let load = match j {
            0 => 4.0,
            1..4 => 1.0,
            _ => 0.25,
        };
        if j < INERTIAL_PARAMETERS {
            return Self { prior: load, lower: -4.0 * load, upper: 4.0 * load, walk: 0.0 };
        }
        let prior = 0.25 * own;
        Self { prior, lower: -own, upper: 3.0 * own, walk: prior * prior / 64.0 }
    }
}

/// Settings of the adapter of the arm in a file.
///
/// # Errors
/// [`NoArm::Model`].
pub fn tuning(file: &[u8]) -> Result<ArmTuning, NoArm> {
    let model = tuned(file)?;
    let own = |j| model.value(number(j)).unwrap_or_default();
    let each = |of: fn(Room) -> f32| core::array::from_fn(|j| of(Room::of(j, own(j))));
    Ok(Tuning {
        numbers: core::array::from_fn(number),
        half: HALF,
        h: f32::from(BLOCK) * TICK,
        deviation: [0.5, 0.5, 0.25, 0.25, 0.125, 0.125, 0.0625],
        prior: each(|room| room.prior),
        forgotten: 0.005,
        walk: each(|room| room.walk),
        change: 50.0,
        limits: Limits {
            model: core::array::from_fn(own),
            lower: each(|room| room.lower),
            upper: each(|room| room.upper),
            kept: 0.125,
        },
        dry: None,
    })
}

/// The settings as a file, of the arm in a file.
///
/// # Errors
/// [`NoArm::Model`].
pub fn settings(file: &[u8]) -> Result<StoredSettings<N, P>, NoArm> {
    let tuning = tuning(file)?;
    let following = |j| Following {
        number: tuning.numbers[j],
        model: tuning.limits.model[j],
        prior: tuning.prior[j],
        walk: tuning.walk[j],
        limits: [tuning.limits.lower[j], tuning.limits.upper[j]],
    };
    let settings = Settings {
        half: tuning.half,
        h: tuning.h,
        deviation: tuning.deviation.into_iter().collect(),
        forgotten: tuning.forgotten,
        change: tuning.change,
        dry: None,
        kept: tuning.limits.kept,
        numbers: (0..P).map(following).collect(),
    };
    let announcement = Announcement { number: 0, threshold: 20.0, least: 0.1, prior: 16.0 };
    Ok(SettingsFile { model: fingerprint(file)?, block: BLOCK, settings, announcement: Some(announcement) })
}

/// Program of the firmware.
pub fn program() -> Program<N> {
    config().program()
}

/// A motion of all joints.
fn reference() -> Reference<N> {
    let centre = [0.0, -0.75, 0.0, -2.25, 0.0, 1.5, 0.75];
    let frequency = [0.5, 0.375, 0.625, 0.4375, 0.75, 0.5625, 0.875];
    let amplitude = [0.5, 0.375, 0.5, 0.375, 0.5, 0.5, 0.5];
    let waves = amplitude.map(|b| {
        let mut wave = [[0.0; 2]; 5];
        if let Some(first) = wave.first_mut() {
            *first = [0.25 * b, b];
        }
        wave
    });
    Reference { begin: 0.2, ramp: 0.5, centre, frequency, waves }
}

fn config() -> TrackConfig<N> {
    let reference = reference();
    let start = reference.at(0.0).q;
    let mut config = TrackConfig::new([EncoderConfig::rotary(); N], [200.0; N], (start, reference));
    config.setup.tick = TICK;
    config
}

/// Reason why there is no such arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoArm {
    /// The model file is refused.
    Model(ModelError),
    /// The program, the adapter or the start is refused.
    Program,
}

impl From<ModelError> for NoArm {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}

/// The model of a file.
fn tuned(file: &[u8]) -> Result<TunedArm<'_>, ModelError> {
    let parsed = parse_as::<ArmHeader, f32>(file)?;
    Tuned::new(&parsed, parsed.shape.tree()?)
}

/// Creates the firmware whose model stays what it is.
///
/// # Errors
/// [`NoArm::Program`].
pub fn plain<M: Mechanism<N>>(model: &M) -> Result<PlainArm<'_, M>, NoArm> {
    let firmware = program().follow(model).map_err(|_| NoArm::Program)?;
    Ok(InPlace { model, firmware })
}

/// Creates the firmware whose model follows, over the model of a file.
///
/// # Errors
/// See [`NoArm`].
pub fn adapting<'f>(file: &'f [u8], tuning: &'f ArmTuning) -> Result<AdaptingArm<'f>, NoArm> {
    let model = tuned(file)?;
    let firmware = program().follow(model.of_file()).map_err(|_| NoArm::Program)?;
    Adapting::new(model, firmware, (Blocks::new(BLOCK, TICK), tuning)).map_err(|_| NoArm::Program)
}

/// The arm that carries a load, in a loop with its firmware.
#[derive(Debug)]
pub struct Carrying<'f, F> {
    /// The firmware.
    pub firmware: F,
    mechanism: TunedArm<'f>,
    del: Del<f32, Midpoint>,
    state: State<f32, N>,
    reference: Reference<N>,
}

impl<'f, F: Processor<N, Error = Infallible>> Carrying<'f, F> {
    /// Creates the arm of a model file, at rest.
    ///
    /// # Errors
    /// See [`NoArm`].
    pub fn new(file: &'f [u8], firmware: F) -> Result<Self, NoArm> {
        let (mut mechanism, reference) = (tuned(file)?, reference());
        mechanism.set(&core::array::from_fn::<_, INERTIAL_PARAMETERS, _>(number), &LOAD);
        let state = State::new(&mechanism.in_use().lagrangian, reference.at(0.0).q, [0.0; N]);
        let state = state.map_err(|_| NoArm::Program)?;
        Ok(Self { firmware, mechanism, del: Del::with_newton(TICK, newton()), state, reference })
    }

    /// Position of the joints, rad.
    pub fn position(&self) -> [f32; N] {
        self.state.q()
    }

    /// Takes a tick, whose number is `index`, from 0: `run` lets the firmware run on its readings towards its target. Returns what `run` returns
    /// beside the outcome.
    ///
    /// # Errors
    /// Errors of the arm's own step; it then stays where it is.
    pub fn tick<T>(
        &mut self,
        index: u32,
        run: impl FnOnce(&mut F, &[Option<f32>; N], &Target<N>) -> (Outcome<N>, T),
    ) -> Result<(Report<f32>, T), StepError<f32>> {
        let target = Target::of(&self.reference, (index + 1) as f32 * TICK, TICK);
        let (outcome, other) = run(&mut self.firmware, &self.state.q().map(Some), &target);
        let force = Control::held(outcome.command.u);
        Ok((self.del.step(&self.mechanism.in_use(), &mut self.state, &force)?, other))
    }
}

/// A tick of firmware and arm is a step; positions are those of the arm, then the distances in use.
impl Motion for Carrying<'_, AdaptingArm<'_>> {
    type Error = StepError<f32>;

    fn step(&mut self, index: u32) -> Result<Report<f32>, StepError<f32>> {
        let run = |firmware: &mut AdaptingArm, measured: &_, target: &_| {
            let Ok(outcome) = firmware.run(1, measured, target);
            (outcome, ())
        };
        self.tick(index, run).map(|(report, ())| report)
    }

    fn positions(&self, mut visit: impl FnMut(f32)) {
        self.state.q().into_iter().for_each(&mut visit);
        self.firmware.adapter().applied().iter().copied().for_each(visit);
    }
}
