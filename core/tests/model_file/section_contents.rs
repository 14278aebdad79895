//! Contents of a model file's sections: laws of force, the step, the actuator.

use crate::common::file::{
    self, Aligned, CARTPOLE, FRICTION, FRICTION_HEADER, HEADER, arm, arm_header, golden_whole, web,
    web_header,
};
use crate::common::forces::Dry;
use crate::common::sections::{Cartpole, out_of_range, refusal, with_content};
use leastaction_core::discrete::{Galerkin, Midpoint, Order};
use leastaction_core::forces::{Actuator, ControlKind, Coulomb, DryFriction, Forces, Lag, Servo, Viscous};
use leastaction_core::linear::Matrix;
use leastaction_core::model::{
    ActuatorBytes, FrictionNumber, GraphModel, Header, InertiaNetworkModel, Law, LawNumbers, Laws,
    LoadForces, ModelError, ModularModel, Section, TrainedStep, parse,
};
use leastaction_core::scalar::{Scalar, WeightFormat, f16};

type CartpoleUnder<'a, F> = InertiaNetworkModel<'a, 2, 8, 2, f32, F>;

// ---- Laws ----

/// A program that knows no law.
#[derive(Clone, Copy, Debug)]
struct Frictionless;

impl<S: Scalar, const N: usize> Forces<S, N> for Frictionless {
    fn force(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> [S; N] {
        [S::zero(); N]
    }

    fn derivatives(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        ([[S::zero(); N]; N], [[S::zero(); N]; N])
    }

    fn load_derivative(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> Matrix<S, N> {
        [[S::zero(); N]; N]
    }
}

impl<'w, W: WeightFormat<Wide = S::Weight>, S: Scalar, const N: usize> LoadForces<'w, W, S, N>
    for Frictionless
{
    fn knows(_: Law) -> bool {
        false
    }

    fn take(_: &mut LawNumbers<'_, 'w, W>, _: &[u8; N]) -> Result<Self, ModelError> {
        Ok(Self)
    }
}

#[test]
fn laws_are_known_rising_and_compiled() {
    let file = file::golden();
    let with = |laws: &[u8]| with_content(&file, Section::Forces, laws);
    for number in [8, 9, 255] {
        assert_eq!(refusal(&with(&[number])), ModelError::Law { number });
        assert_eq!(refusal(&with(&[0, number])), ModelError::Law { number });
    }
    assert_eq!(refusal(&with(&[0, 0])), ModelError::Malformed);
    assert!(ModelError::Law { number: 8 }.to_string().contains("law of force 8 is not known"));
    let file = Aligned::new(&file);
    let refused = CartpoleUnder::<Frictionless>::load(file.bytes()).map(|_| ()).unwrap_err();
    assert_eq!(refused, ModelError::Law { number: 0 });
    assert!(refused.to_string().contains("viscous"), "{refused}");
    let first = CartpoleUnder::<(Viscous<f32, 2>, Frictionless)>::load(file.bytes()).unwrap();
    let second = CartpoleUnder::<(Frictionless, Viscous<f32, 2>)>::load(file.bytes()).unwrap();
    let coefficients = [first.system.forces.0.coefficients, second.system.forces.1.coefficients];
    assert_eq!(coefficients, [[0.125; 2]; 2]);
    // A model without laws loads in a program with any.
    let header = Header { laws: Default::default(), ..HEADER };
    let weights = file::weights(&CARTPOLE);
    let lawless = Aligned::new(&file::write(header, &weights[..weights.len() - 2]));
    assert!(CartpoleUnder::<Frictionless>::load(lawless.bytes()).is_ok());
    assert_eq!(Cartpole::load(lawless.bytes()).unwrap().system.forces, Viscous::none());
}

/// The cart-pole of the file with dry friction.
type DryCartpole<'a> = CartpoleUnder<'a, Dry<f32, 2>>;

#[test]
fn dry_friction_is_what_was_written() {
    let whole = Aligned::new(&file::with_friction(FRICTION.as_flattened()));
    let model = DryCartpole::load(whole.bytes()).unwrap();
    let (viscous, Coulomb { coordinates }) = model.system.forces;
    let found = coordinates.map(|of| [of.constant, of.load, of.smoothing, of.width]);
    assert_eq!((viscous.coefficients, found), ([0.125; 2], FRICTION));
    assert_eq!(parse(whole.bytes()).unwrap().header, FRICTION_HEADER);
    // The program has to be compiled for dry friction, and the laws of its pair have to ascend.
    let refused = ModelError::Law { number: 1 };
    assert_eq!(Cartpole::load(whole.bytes()).map(|_| ()).unwrap_err(), refused);
    assert_eq!(
        CartpoleUnder::<(Coulomb<f32, 2>, Viscous<f32, 2>)>::load(whole.bytes()).map(|_| ()),
        Err(refused)
    );
    assert!(refused.to_string().contains("coulomb"), "{refused}");
    // A file without dry friction loads with none.
    let damped = Aligned::new(&file::golden());
    assert_eq!(DryCartpole::load(damped.bytes()).unwrap().system.forces.1, Coulomb::none());
    // A file with dry friction alone has no damping.
    let alone = Header { laws: Laws::COULOMB, ..HEADER };
    let weights = file::weights(&CARTPOLE);
    let weights = [&weights[..weights.len() - 2], FRICTION.as_flattened()].concat();
    let alone = Aligned::new(&file::write(alone, &weights));
    assert_eq!(
        DryCartpole::load(alone.bytes()).unwrap().system.forces,
        (Viscous::none(), model.system.forces.1)
    );
}

/// Servos follow every other law in the file; a program without them refuses it.
#[test]
fn servos_are_what_was_written() {
    let header = Header { laws: HEADER.laws.with(Law::Servo), ..HEADER };
    let write =
        |k: [f32; 2]| Aligned::new(&file::write(header, &[&file::weights(&CARTPOLE), &k[..]].concat()));
    type Driven<'a> = CartpoleUnder<'a, (Viscous<f32, 2>, Servo<f32, 2>)>;
    let whole = write([17.0, 3.5]);
    let model = Driven::load(whole.bytes()).unwrap();
    assert_eq!(model.system.forces.1.stiffness, Some([17.0, 3.5]));
    assert_eq!(model.system.forces.0.coefficients, [0.125; 2]);
    assert_eq!(Cartpole::load(whole.bytes()).map(|_| ()), Err(ModelError::Law { number: 4 }));
    assert!(ModelError::Law { number: 4 }.to_string().contains("servo"));
    let damped = Aligned::new(&file::golden());
    assert_eq!(Driven::load(damped.bytes()).unwrap().system.forces.1, Servo::none());
    for wrong in [-1.0, -1e-30] {
        let refused = Driven::load(write([2.0, wrong]).bytes()).map(|_| ());
        assert_eq!(
            refused,
            Err(ModelError::LawNumber { law: Law::Servo, number: 0, group: 1, value: wrong })
        );
    }
}

#[test]
fn numbers_of_laws_have_symbols_and_ranges() {
    for law in Law::ALL {
        assert_eq!(law.symbols().len(), law.ranges().len(), "{law:?}");
    }
    assert_eq!(Law::Coulomb.ranges().len(), FrictionNumber::ALL.len());
}

/// Dry friction of the modular family has its numbers per element type.
#[test]
fn dry_friction_of_a_tree_is_that_of_its_types() {
    let friction: Vec<f32> = (1..=12).map(|k| k as f32 / 16.0).collect();
    let header = Header { laws: Laws::FRICTION, ..arm_header(arm()) };
    let weights = [file::arm_weights(file::ARM_NUMBERS), friction].concat();
    let whole = Aligned::new(&file::write(header, &weights));
    let model = ModularModel::<3, 3, 5, 2, f32, Dry<f32, 3>>::load(whole.bytes(), "arm").unwrap();
    let numbers = |of: DryFriction<f32>| [of.constant, of.load, of.smoothing, of.width].map(|x| 16.0 * x);
    let found = model.system.forces.1.coordinates.map(numbers);
    assert_eq!(found, [[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0], [9.0, 10.0, 11.0, 12.0]]);
    let link = ModularModel::<1, 3, 5, 2, f32, Dry<f32, 1>>::load(whole.bytes(), "link").unwrap();
    assert_eq!(link.system.forces.1.coordinates.map(numbers), [[5.0, 6.0, 7.0, 8.0]]);
}

#[test]
fn dry_friction_out_of_range_is_refused_with_its_numbers() {
    use FrictionNumber::{Constant, Load, Smoothing, Width};
    let wrong = [
        (Constant, &[-1.0, -1e-30][..]),
        (Load, &[-0.5, 1.0, 7.0][..]),
        (Smoothing, &[0.0, -0.0, -0.1][..]),
        (Width, &[0.0, -0.0, -0.1][..]),
    ];
    for (number, values) in wrong {
        for (group, value) in (0..2).flat_map(|group| values.iter().map(move |value| (group, *value))) {
            let mut friction = FRICTION;
            friction[usize::from(group)][number as usize] = value;
            let file = file::with_friction(friction.as_flattened());
            let error = ModelError::LawNumber { law: Law::Coulomb, number: number as u8, group, value };
            assert_eq!(refusal(&file), error);
            let file = Aligned::new(&file);
            assert_eq!(DryCartpole::load(file.bytes()).map(|_| ()), Err(error));
            let numbers = [group.into(), number as usize, value.to_bits() as usize];
            assert_eq!((error.coded().code, error.coded().numbers), (46, numbers));
            let says = format!("of the law coulomb of group {group} is {value}: it must be");
            assert!(error.to_string().contains(&says), "{error}");
            // A program without the law refuses the file.
            assert_eq!(Cartpole::load(file.bytes()).map(|_| ()).unwrap_err(), ModelError::Law { number: 1 });
        }
    }
    let first = file::weights(&CARTPOLE).len();
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for index in 0..8 {
            let mut friction = FRICTION.concat();
            friction[index] = value;
            let refused = refusal(&file::with_friction(&friction));
            assert_eq!(refused, ModelError::NotFinite { index: first + index });
        }
    }
    for length in [0, 1, 4, 7, 9, 12] {
        let refused = refusal(&file::with_friction(&[0.5; 12][..length]));
        assert_eq!(refused, ModelError::WeightCount { found: first + length, needed: first + 8 });
    }
    let error = ModelError::LawNumber { law: Law::Coulomb, number: Load as u8, group: 1, value: 1.5 };
    assert_eq!(
        error.to_string(),
        "c_load of the law coulomb of group 1 is 1.5: it must be 0 or more and below 1"
    );
}

/// Numbers that half precision rounds out of their range are refused as such.
#[test]
fn dry_friction_in_half_precision() {
    type Half<'a> = InertiaNetworkModel<'a, 2, 8, 2, f16, Dry<f32, 2>>;
    let written = |friction: [[f32; 4]; 2]| {
        let weights = [file::weights(&CARTPOLE), friction.concat()].concat();
        Aligned::new(&file::write_half(FRICTION_HEADER, &weights))
    };
    let file = written(FRICTION);
    let found = Half::load(file.bytes()).unwrap().system.forces.1.coordinates;
    assert_eq!(found.map(|of| [of.constant, of.load, of.smoothing, of.width]), FRICTION);
    let rounded = written([[0.5, 0.9999, 0.75, 0.0625], FRICTION[1]]);
    let (number, group, value) = (FrictionNumber::Load as u8, 0, 1.0);
    let refused = ModelError::LawNumber { law: Law::Coulomb, number, group, value };
    assert_eq!(Half::load(rounded.bytes()).map(|_| ()), Err(refused));
}

/// Graphs have their drag in their node types.
#[test]
fn a_graph_has_no_laws_yet() {
    let header = Header { laws: HEADER.laws, ..web_header(web()) };
    let weights = [file::web_weights(file::WEB_NUMBERS), vec![0.5; 2]].concat();
    let file = Aligned::new(&file::write(header, &weights));
    assert!(parse(file.bytes()).is_ok(), "the format allows it");
    let refused = GraphModel::<2, 6, 5, 1>::load(file.bytes(), "pair", &mut [], &mut []).map(|_| ());
    assert_eq!(refused, Err(ModelError::Law { number: 0 }));
}

// ---- Step ----

#[test]
fn steps_out_of_range_are_refused() {
    let bytes = |order: u8, h: f32, control: u8| [&[order], &h.to_le_bytes()[..], &[control]].concat();
    let with = |step: &[u8]| refusal(&with_content(&file::golden(), Section::Step, step));
    for order in [0, 1, 3, 5, 6, 255] {
        assert_eq!(with(&bytes(order, 0.05, 0)), out_of_range("order"));
    }
    for h in [0.0, -0.0, -0.1, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(with(&bytes(2, h, 0)), out_of_range("step h"));
    }
    for control in 2..=255 {
        assert_eq!(with(&bytes(4, 0.05, control)), out_of_range("kind of control"));
    }
    for length in [0, 1, 5, 7, 12] {
        let long = [bytes(4, 0.05, 0), bytes(4, 0.05, 0)].concat();
        assert_eq!(with(&long[..length]), ModelError::Malformed);
    }
}

#[test]
fn steps_are_what_was_written() {
    for order in [Order::Two, Order::Four] {
        for control in [ControlKind::Held, ControlKind::Linear] {
            let step = TrainedStep { order, h: 0.015625, control };
            assert_eq!(TrainedStep::from_bytes(&step.to_bytes()), Ok(step));
            let header = Header { trained_step: Some(step), ..HEADER };
            let file = Aligned::new(&file::write(header, &file::weights(&CARTPOLE)));
            assert_eq!(Cartpole::load(file.bytes()).unwrap().step(), Ok(step));
        }
    }
}

/// An integrator is refused if its order is not that of the model's file, or if the file states no step.
#[test]
fn the_integrator_is_that_of_the_file() {
    let file = Aligned::new(&file::golden());
    let model = Cartpole::load(file.bytes()).unwrap();
    assert_eq!(model.del::<f32, Galerkin>().unwrap().h(), 0.05);
    assert_eq!(model.del::<f64, Galerkin>().unwrap().h(), f64::from(0.05_f32));
    let error = model.del::<f32, Midpoint>().map(|_| ()).unwrap_err();
    assert_eq!(error, ModelError::Order { found: 4, compiled: 2 });
    assert!(error.to_string().contains("steps of order 4"), "{error}");
    let stepless =
        Aligned::new(&file::write(Header { trained_step: None, ..HEADER }, &file::weights(&CARTPOLE)));
    let model = Cartpole::load(stepless.bytes()).unwrap();
    assert_eq!(model.del::<f32, Galerkin>().map(|_| ()), Err(ModelError::NoStep));
}

// ---- Actuator ----

#[test]
fn actuators_out_of_range_are_refused() {
    let with = |numbers: &[f32]| {
        refusal(&with_content(&golden_whole(), Section::Actuator, &file::actuator(numbers)))
    };
    let not_finite = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for delay in [&not_finite[..], &[-0.1]].concat() {
        assert_eq!(with(&[delay, 1.0, 0.0]), out_of_range("delay of the actuator"));
    }
    for gain in [&not_finite[..], &[0.0, -0.0]].concat() {
        assert_eq!(with(&[0.0, 1.0, 0.0, gain, 0.0]), out_of_range("gain of the actuator"));
    }
    for offset in not_finite {
        assert_eq!(with(&[0.0, 1.0, offset]), out_of_range("offset of the actuator"));
    }
    assert_eq!(with(&[0.0, 1.0]), out_of_range("length of the actuator"));
    for lag in [0.0, -0.005, f32::NAN, f32::INFINITY] {
        assert_eq!(with(&[0.0, 1.0, 0.0, lag]), out_of_range("lag of the actuator"), "{lag}");
    }
    assert_eq!(ActuatorBytes::new(&[0; 3]), Err(ModelError::Malformed));
    assert_eq!(ActuatorBytes::new(&[]), Err(ModelError::Malformed));
}

#[test]
fn an_actuator_is_taken_for_a_step() {
    let bytes = file::actuator(&file::ACTUATOR);
    let actuator = ActuatorBytes::new(&bytes).unwrap();
    assert_eq!((actuator.n(), actuator.delay()), (2, 0.125));
    let (gain, offset) = ([2.0, 0.25], [-0.5, 0.0]);
    for (h, whole, delay) in [(0.5, 0, 0.25), (0.125, 1, 0.0), (0.0625, 2, 0.0), (0.05, 2, 0.5)] {
        let (steps, taken) = actuator.at_step::<2>(h).unwrap();
        assert_eq!((steps, taken.gain, taken.offset), (whole, gain, offset));
        assert!((taken.delay - delay).abs() < 1e-6, "{h}: {}", taken.delay);
    }
    let other = ModelError::Shape { what: "coordinates of the actuator", found: 2, compiled: 3 };
    assert_eq!(actuator.at_step::<3>(0.1), Err(other));
    for h in [0.0, -0.0, -0.1, f32::NAN, 1e-7] {
        assert_eq!(actuator.at_step::<2>(h), Err(out_of_range("delay of the actuator")), "{h}");
    }
    let none = file::actuator(&[0.0, 1.0, 0.0]);
    assert_eq!(ActuatorBytes::new(&none).unwrap().at_step::<1>(0.1), Ok((0, Actuator::ideal())));
}

#[test]
fn a_lag_is_taken_for_a_step_by_those_who_know_it() {
    let bytes = file::actuator(&[&file::ACTUATOR[..], &[0.008]].concat());
    let actuator = ActuatorBytes::new(&bytes).unwrap();
    assert_eq!((actuator.n(), actuator.delay(), actuator.lag()), (2, 0.125, 0.008));
    let (plain, h) = (file::actuator(&file::ACTUATOR), 0.1_f32);
    let plain = ActuatorBytes::new(&plain).unwrap();
    let (steps, taken, lag) = actuator.at_step_with_lag::<2>(h).unwrap();
    assert_eq!(plain.at_step::<2>(h), Ok((steps, taken)), "all but the lag");
    assert_eq!(lag, Lag::new(0.008 / h, taken.delay));
    assert!(actuator.pairs().eq(plain.pairs()));
    assert_eq!(actuator.at_step::<2>(h), Err(ModelError::Lag { found: true }));
    assert_eq!(plain.at_step_with_lag::<2>(h).map(drop), Err(ModelError::Lag { found: false }));
    let other = ModelError::Shape { what: "coordinates of the actuator", found: 2, compiled: 3 };
    assert_eq!(actuator.at_step_with_lag::<3>(h).map(drop), Err(other));
    for part in [1, 2, 3] {
        let cut = ActuatorBytes::new(&bytes[..bytes.len() - part]);
        assert_eq!(cut, Err(out_of_range("length of the actuator")), "{part} bytes short");
    }
}
