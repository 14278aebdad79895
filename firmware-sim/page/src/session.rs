//! A run of a mechanism with the firmware's program over a model.

use crate::arena::Arena;
use crate::machine::{Machine, Plant, know};
use crate::timed::Timed;
use crate::view::{View, pair};
use core::convert::Infallible;
use core::fmt;
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::{Energies, Lagrangian};
use leastaction_core::model::{Model, ModelError};
use leastaction_firmware_sim::control::{Coordinates, Mpc, States, blank_nodes};
use leastaction_firmware_sim::scenario::{MpcConfig, Run};
use leastaction_firmware_sim::{InPlace, Mechanism, Mode, SetupError, Tick, Trained};

/// Reason why a run does not begin.
pub enum Refused {
    /// The model file is refused.
    Model(ModelError),
    /// The model has another number of coordinates than the mechanism.
    Coordinates {
        /// Number of the model's coordinates.
        found: usize,
        /// Name of the mechanism.
        mechanism: &'static str,
        /// Number of the mechanism's coordinates.
        needed: usize,
    },
    /// The firmware's program cannot run over the model.
    Setup(SetupError),
    /// The file is larger than the page's memory.
    Large,
    /// There is no mechanism with this number.
    Mechanism,
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Model(error) => error.fmt(f),
            Self::Coordinates { found, mechanism, needed } => {
                write!(
                    f,
                    "the model has {found} coordinate(s), the {mechanism} has {needed}: choose another mechanism"
                )
            }
            Self::Setup(error) => error.fmt(f),
            Self::Large => f.write_str("the file is larger than the page's memory for models"),
            Self::Mechanism => f.write_str("there is no such mechanism"),
        }
    }
}

impl From<ModelError> for Refused {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}

impl From<SetupError> for Refused {
    fn from(error: SetupError) -> Self {
        Self::Setup(error)
    }
}

/// A run of any types.
pub trait Live {
    /// Takes a tick and shows its state.
    fn tick(&mut self, view: &mut View);
    /// Pushes a coordinate for some ticks, N or N m.
    fn push(&mut self, coordinate: usize, force: f32, ticks: u32);
    /// Number of ticks of the scenario.
    fn length(&self) -> u32;
    /// Hash of the trace so far, and whether the goal is reached.
    fn outcome(&self) -> (u64, bool);
}

/// Firmware that decides at every tick, timed.
type Deciding<M, const N: usize, const D: usize> = Timed<InPlace<'static, M, Mpc<'static, N, D>, N>>;

/// A run with what the page asks about it; D is 2N.
struct Session<M: Mechanism<N> + 'static, const N: usize, const D: usize> {
    run: Run<'static, Plant<N>, Deciding<M, N, D>, [f32; N], N>,
    plant: &'static Plant<N>,
    model: &'static M,
    config: MpcConfig<N>,
    /// Forces of pushes, and the number of ticks that each still lasts.
    pushes: [(f32, u32); N],
    decisions: u32,
}

/// Begins a run over a loaded model, in the arena.
pub fn begin<L, F, const N: usize, const D: usize>(
    arena: &mut Arena,
    machine: Machine<N>,
    model: Model<'static, System<L, F>>,
    seed: u32,
) -> Result<&'static mut dyn Live, Refused>
where
    L: Lagrangian<f32, N> + 'static,
    F: Forces<f32, N> + 'static,
    Coordinates<N>: States<D>,
{
    let Machine { plant, config, .. } = machine;
    let (actuator, step) = (model.actuator()?, model.trained_step);
    let mut config = config.with_trained(step);
    config.setup.seed = seed.into();
    know(&mut config.setup, actuator)?;
    let plant = &*arena.put(plant).ok_or(Refused::Large)?;
    let system = &arena.put(model).ok_or(Refused::Large)?.system;
    let model = &*arena.put(Trained { system, step }).ok_or(Refused::Large)?;
    let nodes = arena.put(blank_nodes()).ok_or(Refused::Large)?;
    let firmware = Timed::new(InPlace { model, firmware: config.program().mpc(model, &[], nodes)? });
    let run = Run::new(plant, firmware, &config.setup, config.settings.goal)?;
    let session = Session { run, plant, model, config, pushes: [(0.0, 0); N], decisions: 0 };
    Ok(arena.put(session).ok_or(Refused::Large)?)
}

impl<M: Mechanism<N>, const N: usize, const D: usize> Session<M, N, D> {
    /// Lets the pushes of the next tick act.
    fn act(&mut self) {
        self.run.push(self.pushes.map(|(force, ticks)| if ticks > 0 { force } else { 0.0 }));
        self.pushes = self.pushes.map(|(force, ticks)| (force, ticks.saturating_sub(1)));
    }

    /// Shows a tick.
    fn show(&self, tick: &Tick<N>, view: &mut View) {
        let setup = &self.config.setup;
        let energy = |Energies { kinetic, potential }: Energies<f32>| [kinetic, potential];
        let firmware = self.run.processor();
        let motion = firmware.of().firmware.controller().motion();
        let mut ticks = setup.observer.delay;
        for (shown, node) in view.motion.iter_mut().zip(motion) {
            let second = if N > 1 { node.x[1] } else { 0.0 };
            *shown = [node.x[0], second, ticks * setup.tick];
            ticks += f32::from(node.ticks);
        }
        *view = View {
            coordinates: N as f32,
            tick: setup.tick,
            limit: pair(&setup.devices.actuator.limit),
            time: tick.time,
            q: pair(&tick.q),
            v: pair(&tick.v),
            q_estimate: pair(&tick.q_estimate),
            v_estimate: pair(&tick.v_estimate),
            command: pair(&tick.commanded),
            applied: pair(&tick.applied),
            mode: f32::from(tick.mode as u8),
            model_energy: energy(self.model.energies(&tick.q, &tick.v)),
            plant_energy: energy(self.plant.energies(&tick.q, &tick.v)),
            decisions: self.decisions as f32,
            milliseconds: firmware.milliseconds() as f32,
            nodes: motion.len() as f32,
            motion: view.motion,
        };
    }
}

impl<M: Mechanism<N>, const N: usize, const D: usize> Live for Session<M, N, D> {
    fn tick(&mut self, view: &mut View) {
        self.act();
        let Ok::<_, Infallible>(tick) = self.run.tick();
        self.decisions += u32::from(tick.mode == Mode::Mpc);
        self.show(&tick, view);
    }

    fn push(&mut self, coordinate: usize, force: f32, ticks: u32) {
        if let Some(push) = self.pushes.get_mut(coordinate).filter(|_| force.is_finite()) {
            *push = (force, ticks);
        }
    }

    fn length(&self) -> u32 {
        self.config.setup.ticks()
    }

    fn outcome(&self) -> (u64, bool) {
        let summary = self.run.summary();
        (summary.hash, summary.success)
    }
}
