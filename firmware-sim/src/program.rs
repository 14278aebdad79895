use crate::control::{
    CartPump, Catch, Controller, Float, Gains, JointPump, Law, Listen, NoPump, PumpConfig, Regulator,
    SwingUp, TaskController, Tolerance, Track,
};
use crate::devices::{ActuatorConfig, Drive};
use crate::error::{SetupError, require, require_finite};
use crate::firmware::Firmware;
use crate::mechanism::{Mechanism, require_quadratic};
use crate::observer::ObserverConfig;
use crate::wire::array;
use leastaction_core::lagrangian::Lagrangian;
use serde::{Deserialize, Serialize};

/// All that the firmware is told of a scenario, wherever it runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Program<const N: usize> {
    /// The tick h > 0, s.
    pub tick: f32,
    /// Which encoders measure angles, and wrap their readings.
    #[serde(with = "array")]
    pub angle: [bool; N],
    /// The limits of the actuators, and gain and offset as far as the firmware knows; their delay is the observer's to know.
    pub actuator: ActuatorConfig<N>,
    /// How the firmware steps its model and estimates the state.
    pub observer: ObserverConfig,
    /// What the controller is for.
    pub task: Task<N>,
}

/// What a controller is for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Task<const N: usize> {
    /// Following a motion.
    Track {
        /// Where the motion begins, rad or m; the targets come with the samples.
        #[serde(with = "array")]
        begin: [f32; N],
        /// The feedback.
        gains: Gains,
        /// How feed-forward and feedback are used.
        law: Law,
    },
    /// Bringing the last coordinate upright, θ = 0, by a force on the first, and holding it there.
    SwingUp {
        /// How energy is pumped in.
        pump: PumpConfig,
        /// What the regulator weighs.
        tolerance: Tolerance<N>,
        /// When the regulator takes over.
        catch: Catch,
    },
    /// Estimating the state under the commands of somebody else.
    Listen,
    /// Holding the mechanism against gravity wherever it is pushed.
    Float {
        /// Where it is at the beginning, rad or m.
        #[serde(with = "array")]
        begin: [f32; N],
        /// [`Float::drag`], 1/s.
        drag: f32,
    },
}

impl<const N: usize> Task<N> {
    /// Where the model's kinetic energy is checked.
    fn begin(&self) -> [f32; N] {
        match self {
            Self::Track { begin, .. } | Self::Float { begin, .. } => *begin,
            Self::SwingUp { .. } | Self::Listen => [0.0; N],
        }
    }

    fn validate(&self) -> Result<(), SetupError> {
        match self {
            Self::Track { begin, gains, .. } => {
                require_finite("begin of the motion", begin).and_then(|()| gains.validate())
            }
            Self::SwingUp { catch, .. } => catch.validate(),
            Self::Listen => Ok(()),
            Self::Float { begin, drag } => {
                require_finite("begin of the motion", begin).and_then(|()| Float { drag: *drag }.validate())
            }
        }
    }
}

impl<const N: usize> Program<N> {
    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        require("tick", self.tick, self.tick.is_finite() && self.tick > 0.0, "finite and positive, s")?;
        self.actuator.validate()?;
        self.observer.validate()?;
        self.task.validate()
    }

    /// Whether the program can be run over a model: its numbers, its step, and the model's kinetic energy where it begins.
    pub(crate) fn check<M: Mechanism<N>>(&self, model: &M) -> Result<(), SetupError> {
        self.validate()?;
        self.observer.check_step(self.tick, model.trained_step())?;
        require_quadratic(model, &self.task.begin())
    }

    /// A program that estimates the state under the commands of somebody else, as of a log, which become forces by `drive`.
    pub fn listening(tick: f32, angle: [bool; N], drive: Drive<N>, observer: ObserverConfig) -> Self {
        let actuator = ActuatorConfig { drive, ..ActuatorConfig::new([0.0; N]) };
        Self { tick, angle, actuator, observer, task: Task::Listen }
    }

    /// The firmware over a model without a controller, whatever the task is.
    ///
    /// # Errors
    /// Numbers out of range, a step that the model was not trained for, and a kinetic energy that is not quadratic in v.
    pub fn listen<'m, M: Mechanism<N>>(
        &self,
        model: &'m M,
    ) -> Result<Firmware<'m, M, Listen, N>, SetupError> {
        self.check(model)?;
        Ok(self.firmware(model, Listen))
    }

    pub(crate) fn firmware<'m, M: Mechanism<N>, C: Controller<M, N>>(
        &self,
        model: &'m M,
        controller: C,
    ) -> Firmware<'m, M, C, N> {
        Firmware::new(model, controller, self.tick, self.angle, &self.observer, self.actuator)
    }

    /// The firmware over a model of any coordinates, for every task but bringing it upright.
    ///
    /// # Errors
    /// Numbers out of range, a step that the model was not trained for, a kinetic energy that is not quadratic in v;
    /// [`SetupError::NoSwingUp`].
    pub fn follow<'m, M: Mechanism<N>>(
        &self,
        model: &'m M,
    ) -> Result<Firmware<'m, M, TaskController<NoPump, N>, N>, SetupError> {
        let controller = self.controller(model, |_, _, _, _| Err(SetupError::NoSwingUp))?;
        Ok(self.firmware(model, controller))
    }

    /// The controller over a model, of which `swing_up` brings it upright.
    fn controller<M: Mechanism<N>, P>(
        &self,
        model: &M,
        swing_up: impl FnOnce(&M, PumpConfig, Tolerance<N>, Catch) -> Result<SwingUp<P, N>, SetupError>,
    ) -> Result<TaskController<P, N>, SetupError> {
        self.check(model)?;
        match self.task {
            Task::Track { begin, gains, law } => {
                let inertia = diagonal(model, &begin);
                Ok(TaskController::Track(Track { gains, law, inertia, angle: self.angle }))
            }
            Task::Listen => Ok(TaskController::Listen(Listen)),
            Task::Float { drag, .. } => Ok(TaskController::Float(Float { drag })),
            Task::SwingUp { pump, tolerance, catch } => {
                Ok(TaskController::SwingUp(swing_up(model, pump, tolerance, catch)?))
            }
        }
    }

    /// The same, with a pump made by `pump` and a regulator; D is 2N.
    fn upright_controller<M: Mechanism<N>, P, const D: usize>(
        &self,
        model: &M,
        pump: impl FnOnce(&M, f32, PumpConfig) -> Result<P, SetupError>,
    ) -> Result<TaskController<P, N>, SetupError> {
        self.controller(model, |model, config, tolerance, catch| {
            let pump = pump(model, 0.0, config)?;
            let regulator = Regulator::design::<M, D>(model, [0.0; N], 0, &tolerance, self.tick)?;
            Ok(self.swing_up(pump, regulator, catch))
        })
    }

    fn swing_up<P>(&self, pump: P, regulator: Regulator<N>, catch: Catch) -> SwingUp<P, N> {
        const { assert!(N > 0, "the first coordinate is actuated, the last swings") };
        SwingUp {
            pump,
            regulator,
            catch,
            swinging: N - 1,
            angle: self.angle,
            limit: self.actuator.drive.gain[0].abs() * self.actuator.limit[0],
            holding: false,
        }
    }
}

/// Of the inertia matrix at a position.
pub(crate) fn diagonal<M: Mechanism<N>, const N: usize>(model: &M, q: &[f32; N]) -> [f32; N] {
    let mass = model.system().lagrangian.linearization(q, &[0.0; N]).l_vv;
    core::array::from_fn(|i| mass[i][i])
}

impl Program<1> {
    /// The firmware over a model of a pendulum, q = θ.
    ///
    /// # Errors
    /// Numbers out of range, a step that the model was not trained for, a kinetic energy that is not quadratic in v, and models
    /// that no feedback holds upright.
    pub fn start<'m, M: Mechanism<1>>(
        &self,
        model: &'m M,
    ) -> Result<Firmware<'m, M, TaskController<JointPump, 1>, 1>, SetupError> {
        Ok(self.firmware(model, self.upright_controller::<M, _, 2>(model, JointPump::new)?))
    }
}

impl Program<2> {
    /// The firmware over a model of a cart and its pole, q = (x, θ); of any two coordinates for another task.
    ///
    /// # Errors
    /// Numbers out of range, a step that the model was not trained for, a kinetic energy that is not quadratic in v, and models
    /// that no feedback holds upright.
    pub fn start<'m, M: Mechanism<2>>(
        &self,
        model: &'m M,
    ) -> Result<Firmware<'m, M, TaskController<CartPump, 2>, 2>, SetupError> {
        Ok(self.firmware(model, self.upright_controller::<M, _, 4>(model, CartPump::new)?))
    }
}
