//! An unsuitable model is refused, with the reason, before anything moves.

use leastaction_core::discrete::{Newton, Order};
use leastaction_core::energy::trigonometric::{CARTPOLE, PENDULUM, Trigonometric};
use leastaction_core::forces::{ControlKind, Forces, System, Viscous};
use leastaction_core::lagrangian::{Dynamics, Energies, Gradient, Hessian, Lagrangian};
use leastaction_core::linear::Matrix;
use leastaction_core::model::TrainedStep;
use leastaction_firmware_sim::control::{CartPump, Listen, Mpc, Regulator, TaskController, Tolerance};
use leastaction_firmware_sim::link::{Answer, Broken, Frame, Receiver, Refusal, Request};
use leastaction_firmware_sim::observer::{Observer, ObserverConfig, OtherStep};
use leastaction_firmware_sim::scenario::{
    Predict, RunError, SwingUpConfig, TrackConfig, predict, swing_up_cartpole, swing_up_pendulum, track,
};
use leastaction_firmware_sim::{
    Firmware, InPlace, Mode, Outcome, Program, SetupError, Summary, Tick, Trained, require_quadratic,
};

/// A pendulum whose kinetic energy grows faster than v²: T = v²/6 + cv⁴/4, as a network might learn it.
struct Quartic {
    c: f32,
}

impl Lagrangian<f32, 1> for Quartic {
    fn energies(&self, q: &[f32; 1], v: &[f32; 1]) -> Energies<f32> {
        let Energies { kinetic, potential } = PENDULUM.energies(q, v);
        Energies { kinetic: kinetic + 0.25 * self.c * v[0].powi(4), potential }
    }
    fn gradient(&self, q: &[f32; 1], v: &[f32; 1]) -> Gradient<f32, 1> {
        let Gradient { l_q, l_v } = PENDULUM.gradient(q, v);
        Gradient { l_q, l_v: [l_v[0] + self.c * v[0].powi(3)] }
    }
    fn dynamics(&self, q: &[f32; 1], v: &[f32; 1]) -> Dynamics<f32, 1> {
        let Hessian { l_q, l_v, l_vv, .. } = self.hessian(q, v);
        Dynamics { mass: l_vv, l_q, l_v, l_vq_v: [0.0] }
    }
    fn hessian(&self, q: &[f32; 1], v: &[f32; 1]) -> Hessian<f32, 1> {
        let h: Hessian<f32, 1> = PENDULUM.hessian(q, v);
        let Gradient { l_v, .. } = self.gradient(q, v);
        Hessian { l_v, l_vv: [[h.l_vv[0][0] + 3.0 * self.c * v[0] * v[0]]], ..h }
    }
}

fn out_of_range<const N: usize>(run: Result<Summary<N>, SetupError>) -> (&'static str, String) {
    match run {
        Err(error @ SetupError::OutOfRange { what, .. }) => (what, error.to_string()),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_kinetic_energy_that_is_not_quadratic_is_refused() {
    let plant = System::conservative(PENDULUM);
    let model = System::conservative(Quartic { c: 0.05 });
    let runs = [
        track(&plant, &model, &TrackConfig::<1>::pendulum(), |_| {}),
        predict(&plant, &model, &Predict::<1>::pendulum(), |_| {}),
        swing_up_pendulum(&plant, &model, &SwingUpConfig::<1>::pendulum(), |_| {}),
    ];
    for run in runs {
        let (what, message) = out_of_range(run);
        assert!(what.contains("momentum") && message.contains("quadratic in v"), "{message}");
    }
    // A deviation smaller than that of any of our models is accepted, and so is a plant with any kinetic energy.
    assert_eq!(require_quadratic(&System::conservative(Quartic { c: 1e-6 }), &[0.3]), Ok(()));
    assert!(track(&model, &plant, &TrackConfig::<1>::pendulum(), |_| {}).is_ok());
}

type Cartpole = System<Trigonometric<'static, 2>, Viscous<f32, 2>>;

fn trained(system: &Cartpole) -> Trained<'_, Trigonometric<'static, 2>, Viscous<f32, 2>> {
    Trained { system, step: Some(TrainedStep { order: Order::Four, h: 0.01, control: ControlKind::Held }) }
}

#[test]
fn a_tick_that_the_model_was_not_trained_for_is_refused_or_accepted_in_so_many_words() {
    let system = System::conservative(CARTPOLE);
    let model = trained(&system);
    let mut config = TrackConfig::<2>::cartpole();
    (config.setup.tick, config.setup.observer.order) = (0.02, Order::Four);
    let (what, message) = out_of_range(track(&system, &model, &config, |_| {}));
    assert_eq!(what, "tick");
    assert_eq!(message, "tick is 0.02, but must be 0.01, which the model was trained for");
    config.setup.observer.other_step = OtherStep::Accepted;
    let accepted = track(&system, &model, &config, |_| {}).unwrap();
    assert!(config.setup.observer.require_step(0.02, model.step).is_err());
    // A model that names no step accepts any.
    config.setup.observer.other_step = OtherStep::Refused;
    assert_eq!(track(&system, &system, &config, |_| {}), Ok(accepted));
    // Rounding does not count as another step.
    config.setup.tick = 0.01_f32.next_up();
    assert!(track(&system, &model, &config, |_| {}).is_ok());
}

#[test]
fn an_order_that_the_model_was_not_trained_for_is_refused_in_every_scenario() {
    let system = System::conservative(CARTPOLE);
    let model = trained(&system);
    let mut prediction = Predict::<2>::cartpole();
    prediction.setup.observer.order = Order::Two;
    let runs = [
        track(&system, &model, &TrackConfig::<2>::cartpole(), |_| {}),
        swing_up_cartpole(&system, &model, &SwingUpConfig::<2>::cartpole(), |_| {}),
        predict(&system, &model, &prediction, |_| {}),
    ];
    for run in runs {
        let (what, message) = out_of_range(run);
        assert!(what.contains("order") && message.contains("but must be 4"), "{message}");
    }
}

/// A cart whose brake takes up the whole force between 0.1 m and 0.2 m, where no force gives an acceleration.
struct Brake;

impl Forces<f32, 2> for Brake {
    fn force(&self, q: &[f32; 2], _: &[f32; 2], tau: &[f32; 2]) -> [f32; 2] {
        [if (0.1..0.2).contains(&q[0]) { -tau[0] } else { 0.0 }, 0.0]
    }
    fn derivatives(&self, _: &[f32; 2], _: &[f32; 2], _: &[f32; 2]) -> (Matrix<f32, 2>, Matrix<f32, 2>) {
        ([[0.0; 2]; 2], [[0.0; 2]; 2])
    }
    fn load_derivative(&self, q: &[f32; 2], _: &[f32; 2], _: &[f32; 2]) -> Matrix<f32, 2> {
        [[if (0.1..0.2).contains(&q[0]) { -1.0 } else { 0.0 }, 0.0], [0.0; 2]]
    }
}

/// The inverse dynamics of both controllers are singular at the brake: no force is commanded, the error is counted, and the loop goes on.
#[test]
fn where_a_controller_fails_the_firmware_is_safe_and_counts_it() {
    let plant = System::conservative(CARTPOLE);
    let model = System { lagrangian: CARTPOLE, forces: Brake };
    let mut ticks: Vec<Tick<2>> = Vec::new();
    let following = track(&plant, &model, &TrackConfig::<2>::cartpole(), |tick| ticks.push(*tick)).unwrap();
    let mut config = SwingUpConfig::<2>::cartpole();
    config.setup.start.q[0] = 0.15;
    config.setup.start.q_spread = [0.0; 2];
    let swinging = swing_up_cartpole(&plant, &model, &config, |tick| ticks.push(*tick)).unwrap();
    for summary in [following, swinging] {
        assert!(
            summary.incidents.safe > 0 && summary.incidents.model >= summary.incidents.safe,
            "{summary:?}"
        );
    }
    let safe: Vec<_> = ticks.iter().filter(|tick| tick.mode == Mode::Safe).collect();
    assert_eq!(safe.len() as u32, following.incidents.safe + swinging.incidents.safe);
    assert!(safe.iter().all(|tick| tick.commanded == [0.0; 2]));
    assert!(ticks.iter().any(|tick| tick.mode == Mode::Track));
}

#[test]
fn a_regulator_of_no_coordinate_is_refused() {
    let system = System::conservative(CARTPOLE);
    let tolerance = Tolerance { q: [0.3, 0.2], v: [0.6; 2], u: 1.2 };
    let step = ObserverConfig::new().integrator(0.01);
    let error = Regulator::design::<_, 4>(&system, [0.0; 2], 2, &tolerance, &step).unwrap_err();
    assert!(error.to_string().starts_with("actuated coordinate of the regulator is 2"), "{error}");
}

#[test]
fn the_constant_configuration_has_newtons_default_residuals() {
    const CONFIG: ObserverConfig = ObserverConfig::new();
    let bounds = Newton { max_iterations: CONFIG.newton.max_iterations, ..Newton::default() };
    assert_eq!((CONFIG.newton, CONFIG), (bounds, ObserverConfig::default()));
    const SWING_UP: SwingUpConfig<2> = SwingUpConfig::<2>::cartpole();
    assert_eq!(SWING_UP.setup.observer, CONFIG);
}

/// Values of these types can be handed from one task to another, even if they borrow plans or the model.
#[test]
fn what_moves_between_tasks_can_be_sent() {
    fn send<T: Send>() {}
    type Model = System<Trigonometric<'static, 2>, Viscous<f32, 2>>;
    type Begun = Firmware<TaskController<'static, CartPump, Mpc<'static, 2, 4>, 2>, 2>;
    send::<(Model, Begun, InPlace<'static, Model, Listen, 2>)>();
    send::<Observer<f32, 2>>();
    send::<(Program<2>, Outcome<2>, Tick<2>, Summary<2>, SwingUpConfig<2>)>();
    send::<(Request<2>, Answer<'static, 2>, Frame, Receiver)>();
    send::<(SetupError, RunError<Broken>, Refusal)>();
}

#[test]
fn errors_say_what_and_where() {
    let error: &dyn std::error::Error = &RunError::Processor { tick: 7, error: Broken };
    assert!(error.to_string().starts_with("tick 7 was not run: a frame is damaged"), "{error}");
    let setup: RunError<Broken> = RunError::Setup(SetupError::NotStabilisable);
    assert_eq!(setup.to_string(), SetupError::NotStabilisable.to_string());
}
