use crate::control::{
    Catch, Coordinates, Float, Follow, Gains, Law, Listen, Mpc, MpcSettings, NoMpc, NoPump, Nodes, Plans,
    PumpConfig, Regulator, States, SwingUp, SwungUp, TaskController, Tolerance, Track, collected,
};
use crate::devices::{ActuatorConfig, Drive};
use crate::error::{SetupError, require, require_finite};
use crate::firmware::Firmware;
use crate::mechanism::{Mechanism, require_quadratic};
use crate::observer::ObserverConfig;
use crate::wire::array;
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::plan::Plan;
use serde::{Deserialize, Serialize};

/// Everything that the firmware knows about a scenario, wherever the firmware runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Program<const N: usize> {
    /// The tick h > 0, s.
    pub tick: f32,
    /// Flags of the encoders that measure angles and therefore wrap their readings.
    #[serde(with = "array")]
    pub angle: [bool; N],
    /// Limits of the actuators, and their gain and offset as far as the firmware knows; `observer` has their delay.
    pub actuator: ActuatorConfig<N>,
    /// Configuration of the model's steps and of the state estimate.
    pub observer: ObserverConfig,
    /// Task of the controller.
    pub task: Task<N>,
}

/// Task of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Task<const N: usize> {
    /// Following a motion.
    Track {
        /// Position where the motion begins, rad or m; the targets come with the samples.
        #[serde(with = "array")]
        begin: [f32; N],
        /// Feedback gains.
        gains: Gains,
        /// Use of feed-forward and feedback.
        law: Law,
    },
    /// Bringing the last coordinate upright, θ = 0, by a force on the first, and holding it there.
    SwingUp {
        /// Settings of the energy pump.
        pump: PumpConfig,
        /// Tolerances of the regulator.
        tolerance: Tolerance<N>,
        /// Conditions under which the regulator takes over.
        catch: Catch,
    },
    /// Estimating the state under commands from elsewhere.
    Listen,
    /// Holding the mechanism against gravity wherever it is pushed.
    Float {
        /// Position at the beginning, rad or m.
        #[serde(with = "array")]
        begin: [f32; N],
        /// Drag as in [`Float::drag`], 1/s.
        drag: f32,
    },
    /// Following a plan, which comes from elsewhere.
    Follow {
        /// Conversion between the plan's commands and forces.
        drive: Drive<N>,
    },
    /// Deciding at every tick over a receding horizon.
    Mpc(MpcSettings<N>),
}

impl<const N: usize> Task<N> {
    /// Position at which the model's kinetic energy is checked, unless a plan says where the motion starts.
    fn begin(&self) -> [f32; N] {
        match self {
            Self::Track { begin, .. } | Self::Float { begin, .. } => *begin,
            Self::Mpc(settings) => settings.goal,
            Self::SwingUp { .. } | Self::Listen | Self::Follow { .. } => [0.0; N],
        }
    }

    fn validate(&self) -> Result<(), SetupError> {
        match self {
            Self::Track { begin, gains, .. } => {
                require_finite("begin of the motion", begin).and_then(|()| gains.validate())
            }
            Self::SwingUp { catch, .. } => catch.validate(),
            Self::Listen => Ok(()),
            Self::Follow { drive } => drive.validate(),
            Self::Mpc(settings) => settings.validate(),
            Self::Float { begin, drag } => {
                require_finite("begin of the motion", begin).and_then(|()| Float { drag: *drag }.validate())
            }
        }
    }
}

/// Firmware that is begun by a program, with the pump P and the decisions R.
type Begun<'p, P, R, const N: usize> = Firmware<TaskController<'p, P, R, N>, N>;
/// Pump for a model of N coordinates.
type PumpOf<const N: usize> = <Coordinates<N> as SwungUp<N>>::Pump;

impl<const N: usize> Program<N> {
    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        require("tick", self.tick, self.tick.is_finite() && self.tick > 0.0, "finite and positive, s")?;
        self.actuator.validate()?;
        self.observer.validate()?;
        self.task.validate()
    }

    /// Checks that the program can be run over a model: its numbers, its step, and the model's kinetic energy where it begins.
    pub(crate) fn check<M: Mechanism<N>>(&self, model: &M) -> Result<(), SetupError> {
        self.check_at(model, &self.task.begin())
    }

    fn check_at<M: Mechanism<N>>(&self, model: &M, begin: &[f32; N]) -> Result<(), SetupError> {
        self.validate()?;
        self.observer.check_step(self.tick, model.trained_step())?;
        require_quadratic(model, begin)
    }

    /// Creates a program that estimates the state under commands from elsewhere, such as a log, which `drive` converts to forces.
    pub fn listening(tick: f32, angle: [bool; N], drive: Drive<N>, observer: ObserverConfig) -> Self {
        let actuator = ActuatorConfig { drive, ..ActuatorConfig::new([0.0; N]) };
        Self { tick, angle, actuator, observer, task: Task::Listen }
    }

    /// Creates the firmware over a model without a controller, whatever the task is.
    ///
    /// # Errors
    /// Numbers out of range, a step that the model was not trained for, and a kinetic energy that is not quadratic in v.
    pub fn listen<M: Mechanism<N>>(&self, model: &M) -> Result<Firmware<Listen, N>, SetupError> {
        self.check(model)?;
        Ok(self.firmware(Listen))
    }

    pub(crate) fn firmware<C>(&self, controller: C) -> Firmware<C, N> {
        Firmware::new(controller, self.tick, self.angle, &self.observer, self.actuator)
    }

    /// Creates the firmware over a model of any coordinates, for every task except a swing-up, a plan and decisions.
    ///
    /// # Errors
    /// Numbers out of range, a step that the model was not trained for, a kinetic energy that is not quadratic in v;
    /// [`SetupError::NoSwingUp`], [`SetupError::NoMpc`] and [`SetupError::NoPlan`].
    pub fn follow<M: Mechanism<N>>(&self, model: &M) -> Result<Begun<'static, NoPump, NoMpc, N>, SetupError> {
        self.follow_with(model, || Err(SetupError::NoPlan))
    }

    /// Creates the firmware over a model of any coordinates, for every task except a swing-up and decisions; `plan` gives the plan, which was made for this
    /// model, if the task is to follow one.
    ///
    /// # Errors
    /// See [`Program::follow`]; also those of `plan`, [`SetupError::PlanTick`] and [`SetupError::PlanAngle`].
    pub fn follow_with<'p, M: Mechanism<N>, E: From<SetupError>>(
        &self,
        model: &M,
        plan: impl FnOnce() -> Result<Plan<'p, N, N>, E>,
    ) -> Result<Begun<'p, NoPump, NoMpc, N>, E> {
        let no_swing_up = |_, _, _| Err(SetupError::NoSwingUp);
        let plans = || collected([plan()].into_iter());
        let controller = self.controller(model, plans, no_swing_up, |_, _| Err(SetupError::NoMpc.into()))?;
        Ok(self.firmware(controller))
    }

    /// Creates the firmware over a model of a pendulum, q = θ, or of a cart and its pole, q = (x, θ), for every task except a plan and
    /// decisions. For tasks other than a swing-up, the model may have any one or two coordinates.
    ///
    /// # Errors
    /// Numbers out of range, a step that the model was not trained for, a kinetic energy that is not quadratic in v, and models
    /// that no feedback holds upright; [`SetupError::NoMpc`] and [`SetupError::NoPlan`].
    pub fn start<M: Mechanism<N>, const D: usize>(
        &self,
        model: &M,
    ) -> Result<Begun<'static, PumpOf<N>, NoMpc, N>, SetupError>
    where
        Coordinates<N>: SwungUp<N> + States<D>,
    {
        let swing_up = |pump, tolerance, catch| self.swing_up(model, pump, &tolerance, catch);
        let no_plan = || Err(SetupError::NoPlan);
        let controller = self.controller(model, no_plan, swing_up, |_, _| Err(SetupError::NoMpc))?;
        Ok(self.firmware(controller))
    }

    /// Creates the firmware as [`Program::start`] does, but for every task; `plans` gives the plans, which were made for this model, if the
    /// task is to follow one, or to decide with some; decisions work in `nodes`.
    ///
    /// # Errors
    /// See [`Program::start`]; also those of `plans` and of [`Mpc::new`], [`SetupError::PlanTick`] and [`SetupError::PlanAngle`].
    pub fn start_with<'p, M: Mechanism<N>, E: From<SetupError>, const D: usize>(
        &self,
        model: &M,
        plans: impl FnOnce() -> Result<Plans<'p, N>, E>,
        nodes: &'p mut Nodes<N, D>,
    ) -> Result<Begun<'p, PumpOf<N>, Mpc<'p, N, D>, N>, E>
    where
        Coordinates<N>: SwungUp<N> + States<D>,
    {
        let swing_up = |pump, tolerance, catch| self.swing_up(model, pump, &tolerance, catch);
        let controller = self.controller(model, plans, swing_up, |settings, plans| {
            let plans = settings.plan.map_or(Ok(Plans::new()), |_| plans())?;
            Ok(Mpc::new(model, settings, self, plans, nodes)?)
        })?;
        Ok(self.firmware(controller))
    }

    /// Creates the firmware over a model of any coordinates for the task [`Task::Mpc`], which works in `nodes`, with the plans that it
    /// may take.
    ///
    /// # Errors
    /// Numbers out of range, a step that the model was not trained for, a kinetic energy that is not quadratic in v;
    /// [`SetupError::NoMpc`] for another task; more than [`MAX_PLANS`](crate::control::MAX_PLANS) plans; those of [`Mpc::new`].
    pub fn mpc<'p, M: Mechanism<N>, const D: usize>(
        &self,
        model: &M,
        plans: &[Plan<'p, N, N>],
        nodes: &'p mut Nodes<N, D>,
    ) -> Result<Firmware<Mpc<'p, N, D>, N>, SetupError>
    where
        Coordinates<N>: States<D>,
    {
        let Task::Mpc(settings) = self.task else { return Err(SetupError::NoMpc) };
        self.check(model)?;
        let plans = collected(plans.iter().copied().map(Ok::<_, SetupError>))?;
        Ok(self.firmware(Mpc::new(model, settings, self, plans, nodes)?))
    }

    /// Creates the controller over a model; `swing_up` makes the one that brings the mechanism upright, `mpc` the one that decides, which may
    /// ask for the plans. Of several plans, the first is followed.
    fn controller<'p, M: Mechanism<N>, P, R, F, E: From<SetupError>>(
        &self,
        model: &M,
        plans: F,
        swing_up: impl FnOnce(PumpConfig, Tolerance<N>, Catch) -> Result<SwingUp<P, N>, SetupError>,
        mpc: impl FnOnce(MpcSettings<N>, F) -> Result<R, E>,
    ) -> Result<TaskController<'p, P, R, N>, E>
    where
        F: FnOnce() -> Result<Plans<'p, N>, E>,
    {
        // A plan says where the motion starts.
        if !matches!(self.task, Task::Follow { .. }) {
            self.check(model)?;
        }
        match self.task {
            Task::Track { begin, gains, law } => {
                let inertia = diagonal(model, &begin);
                Ok(TaskController::Track(Track { gains, law, inertia, angle: self.angle }))
            }
            Task::Float { drag, .. } => Ok(TaskController::Float(Float { drag })),
            Task::SwingUp { pump, tolerance, catch } => {
                Ok(TaskController::SwingUp(swing_up(pump, tolerance, catch)?))
            }
            Task::Listen => Ok(TaskController::Listen(Listen)),
            Task::Mpc(settings) => Ok(TaskController::Mpc(mpc(settings, plans)?)),
            Task::Follow { drive } => {
                let plan = plans()?.first().copied().ok_or(SetupError::NoPlan)?;
                self.check_at(model, &plan.reference(0).q)?;
                Ok(TaskController::Follow(Follow::new(plan, drive, self)?))
            }
        }
    }

    /// Creates the controller of a swing-up: a pump and a regulator.
    fn swing_up<M: Mechanism<N>, const D: usize>(
        &self,
        model: &M,
        pump: PumpConfig,
        tolerance: &Tolerance<N>,
        catch: Catch,
    ) -> Result<SwingUp<PumpOf<N>, N>, SetupError>
    where
        Coordinates<N>: SwungUp<N> + States<D>,
    {
        const { assert!(N > 0, "the first coordinate is actuated, the last swings") };
        let pump = Coordinates::<N>::pump(model, pump)?;
        let step = self.observer.integrator(self.tick);
        Ok(SwingUp {
            pump,
            regulator: Regulator::design::<M, D>(model, [0.0; N], 0, tolerance, &step)?,
            catch,
            swinging: N - 1,
            angle: self.angle,
            limit: self.actuator.drive.gain[0].abs() * self.actuator.limit[0],
            holding: false,
        })
    }
}

/// Diagonal of the inertia matrix at a position.
pub(crate) fn diagonal<M: Mechanism<N>, const N: usize>(model: &M, q: &[f32; N]) -> [f32; N] {
    let mass = model.system().lagrangian.linearization(q, &[0.0; N]).l_vv;
    core::array::from_fn(|i| mass[i][i])
}
