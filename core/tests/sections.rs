//! The sections of a model file: their order, their lengths, and what each of them says.

mod common;

use common::file::{self, Aligned, CARTPOLE, HEADER, arm, arm_header, golden_whole, web, web_header};
use leastaction_core::discrete::{Galerkin, Midpoint};
use leastaction_core::forces::{Actuator, ControlKind, Forces, Viscous};
use leastaction_core::linear::Matrix;
use leastaction_core::model::{
    ActuatorBytes, CATALOGUE, CoordinateRange, Family, GraphModel, Header, Interval, LawNumbers, LoadForces,
    ModelError, ModularModel, Outside, RigidModel, Section, TrainedStep, TrainingRange, WriteError, parse,
    write,
};
use leastaction_core::scalar::{Scalar, Stored};
use proptest::prelude::*;

type Cartpole<'a> = RigidModel<'a, 2, 8, 2>;
type CartpoleUnder<'a, F> = RigidModel<'a, 2, 8, 2, f32, F>;

fn refusal(file: &[u8]) -> ModelError {
    parse(Aligned::new(file).bytes()).map(|_| ()).expect_err("the file must be refused")
}

/// The sections of a file, numbers and contents.
fn split(file: &[u8]) -> Vec<(u8, Vec<u8>)> {
    let (mut sections, mut start) = (Vec::new(), 5);
    while start < file.len() - 4 {
        let length = u32::from_le_bytes(file[start + 1..start + 5].try_into().unwrap()) as usize;
        sections.push((file[start], file[start + 5..start + 5 + length].to_vec()));
        start += 5 + length;
    }
    sections
}

/// A file of sections, its weights aligned anew.
fn join(sections: &[(u8, Vec<u8>)]) -> Vec<u8> {
    let mut file = file::golden()[..5].to_vec();
    for (number, content) in sections {
        let mut content = content.clone();
        if *number == Section::Weights as u8 && !content.is_empty() {
            let (padding, numbers) = (usize::from(content[0]), content.split_off(1));
            let zeros = (4 - (file.len() + 6) % 4) % 4;
            content = [&[zeros as u8], &vec![0; zeros][..], &numbers[padding..]].concat();
        }
        file.push(*number);
        file.extend((content.len() as u32).to_le_bytes());
        file.extend(content);
    }
    file::sealed(&file)
}

/// The file with another content of a section, its weights aligned anew.
fn with_content(file: &[u8], section: Section, content: &[u8]) -> Vec<u8> {
    let mut sections = split(file);
    sections.iter_mut().filter(|(n, _)| *n == section as u8).for_each(|(_, c)| *c = content.to_vec());
    join(&sections)
}

fn out_of_range(what: &'static str) -> ModelError {
    ModelError::OutOfRange { what }
}

#[test]
fn every_section_is_read() {
    let file = Aligned::new(&golden_whole());
    let header = parse(file.bytes()).unwrap().header;
    assert_eq!((header.units, header.provenance), ("m,rad", HEADER.provenance));
    assert_eq!(header.trained_step, Some(file::STEP));
    assert_eq!(header.actuator.unwrap().bytes(), file::actuator(&file::ACTUATOR));
    let range: Result<Vec<_>, _> = header.range.unwrap().coordinates().collect();
    assert_eq!(range.unwrap(), file::RANGE);
    let model = Cartpole::load(file.bytes()).unwrap();
    assert_eq!((model.actuator(), model.range()), (Ok(header.actuator), Ok(header.range)));
    assert_eq!(join(&split(file.bytes())), file.bytes(), "the tests split and join exactly");
    file::assert_truncations_are_refused(file.bytes());
    file::assert_changes_are_refused(file.bytes());
}

#[test]
fn sections_rise() {
    let sections = split(&golden_whole());
    for i in 1..sections.len() {
        let mut swapped = sections.clone();
        swapped.swap(i - 1, i);
        assert_eq!(refusal(&join(&swapped)), ModelError::Malformed, "sections {} and {i}", i - 1);
        let mut twice = sections.clone();
        twice.insert(i, sections[i].clone());
        assert_eq!(refusal(&join(&twice)), ModelError::Malformed, "section {i} twice");
    }
}

/// One that may change the physics is refused, one that may not is skipped.
#[test]
fn unknown_sections() {
    let sections = split(&golden_whole());
    let with = |number: u8| {
        let mut sections = sections.clone();
        sections.push((number, vec![1, 2, 3]));
        sections.sort_by_key(|(number, _)| *number);
        join(&sections)
    };
    let known = |number| Section::ALL.iter().any(|section| *section as u8 == number);
    let expected = parse(Aligned::new(&golden_whole()).bytes()).unwrap().header.trained_step;
    for number in (0..=255).filter(|number| !known(*number)) {
        let file = Aligned::new(&with(number));
        match number {
            0 => assert_eq!(refusal(file.bytes()), ModelError::Malformed),
            1..128 => assert_eq!(refusal(file.bytes()), ModelError::Section { number }),
            _ => assert_eq!(parse(file.bytes()).unwrap().header.trained_step, expected),
        }
        assert_eq!(Cartpole::load(file.bytes()).is_ok(), number >= Section::OPTIONAL);
    }
}

#[test]
fn sections_may_be_missing() {
    let sections = split(&golden_whole());
    for section in Section::ALL {
        let rest: Vec<_> = sections.iter().filter(|(number, _)| *number != section as u8).cloned().collect();
        let file = Aligned::new(&join(&rest));
        let parsed = parse(file.bytes());
        match section {
            Section::Energies | Section::Weights => {
                assert_eq!(parsed, Err(ModelError::MissingSection { what: section.name() }));
            }
            // Their numbers are in the weight block.
            Section::Forces => assert!(matches!(parsed, Err(ModelError::WeightCount { .. }))),
            _ => assert!(parsed.is_ok(), "{}", section.name()),
        }
    }
    let nothing = join(&[]);
    assert_eq!(refusal(&nothing), ModelError::MissingSection { what: "energies" });
}

#[test]
fn lengths_that_lie_are_refused() {
    let file = golden_whole();
    let body = &file[..file.len() - 4];
    for section in Section::ALL {
        let [start, end] = file::place(&file, section);
        let length = (end - start) as u32;
        for wrong in [0, length - 1, length + 1, length + 5, 1 << 30, 1 << 31, u32::MAX - 4, u32::MAX] {
            let mut changed = body.to_vec();
            changed[start - 4..start].copy_from_slice(&wrong.to_le_bytes());
            let changed = file::sealed(&changed);
            assert!(parse(Aligned::new(&changed).bytes()).is_err(), "{}: {wrong}", section.name());
        }
    }
}

/// Of a section whose content is cut off or has one more byte, the length being right.
#[test]
fn contents_of_a_wrong_length_are_refused() {
    let whole = golden_whole();
    let change = |section, longer: bool| {
        let [start, end] = file::place(&whole, section);
        let mut content = whole[start..end].to_vec();
        if longer {
            content.push(0)
        } else {
            content.truncate(content.len() - 1)
        }
        refusal(&with_content(&whole, section, &content))
    };
    for (section, shorter, longer) in [
        (Section::Energies, ModelError::Malformed, ModelError::TrailingBytes { bytes: 1 }),
        (Section::Actuator, out_of_range("length of the actuator"), out_of_range("length of the actuator")),
        (Section::Step, ModelError::Malformed, ModelError::Malformed),
        (Section::Weights, ModelError::Malformed, ModelError::Malformed),
        (
            Section::Range,
            out_of_range("length of the training range"),
            out_of_range("length of the training range"),
        ),
    ] {
        assert_eq!((change(section, false), change(section, true)), (shorter, longer), "{}", section.name());
    }
}

#[test]
fn text_is_text() {
    for section in [Section::Units, Section::Provenance] {
        let file = with_content(&golden_whole(), section, &[b'm', 0xff]);
        assert_eq!(refusal(&file), ModelError::Malformed, "{}", section.name());
        // A program does not read it.
        assert!(Cartpole::load(Aligned::new(&file).bytes()).is_ok());
    }
}

#[test]
fn version_1_is_refused_with_its_number() {
    let mut file = file::golden();
    file[4] = 1;
    let error = refusal(&file);
    assert_eq!(error, ModelError::Version { found: 1 });
    assert!(error.to_string().contains("leastaction convert"), "{error}");
}

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

impl<S: Scalar, const N: usize> LoadForces<S, N> for Frictionless {
    fn take<W: Stored<Wide = S::Weight>>(_: &mut LawNumbers<'_, '_, W>, _: &[u8; N]) -> Self {
        Self
    }
}

#[test]
fn laws_are_known_rising_and_compiled() {
    let file = file::golden();
    let with = |laws: &[u8]| with_content(&file, Section::Forces, laws);
    for number in [1, 7, 255] {
        assert_eq!(refusal(&with(&[number])), ModelError::Law { number });
        assert_eq!(refusal(&with(&[0, number])), ModelError::Law { number });
    }
    assert_eq!(refusal(&with(&[0, 0])), ModelError::Malformed);
    assert!(ModelError::Law { number: 7 }.to_string().contains("law of force 7 is not known"));
    let file = Aligned::new(&file);
    let refused = CartpoleUnder::<Frictionless>::load(file.bytes()).map(|_| ()).unwrap_err();
    assert_eq!(refused, ModelError::Law { number: 0 });
    assert!(refused.to_string().contains("viscous"), "{refused}");
    let first = CartpoleUnder::<(Viscous<f32, 2>, Frictionless)>::load(file.bytes()).unwrap();
    let second = CartpoleUnder::<(Frictionless, Viscous<f32, 2>)>::load(file.bytes()).unwrap();
    let coefficients = [first.system.forces.0.coefficients, second.system.forces.1.coefficients];
    assert_eq!(coefficients, [[0.125; 2]; 2]);
    // A model of no law loads in a program of any.
    let header = Header { laws: Default::default(), ..HEADER };
    let weights = file::weights(&CARTPOLE);
    let lawless = Aligned::new(&file::write(header, &weights[..weights.len() - 2]));
    assert!(CartpoleUnder::<Frictionless>::load(lawless.bytes()).is_ok());
    assert_eq!(Cartpole::load(lawless.bytes()).unwrap().system.forces, Viscous::none());
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
    use leastaction_core::discrete::Order;
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

/// A model is not stepped by an integrator of another order, nor with a step that it does not have.
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

// ---- Range ----

#[test]
fn ranges_out_of_range_are_refused() {
    let with = |range: &[CoordinateRange]| {
        refusal(&with_content(&golden_whole(), Section::Range, &file::range(range)))
    };
    let [first, second] = file::RANGE;
    let not_finite = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let falling = Interval { least: 1.0, most: 0.5 };
    let bad = not_finite
        .into_iter()
        .flat_map(|bad| [Interval { least: bad, most: 0.0 }, Interval { least: 0.0, most: bad }]);
    for interval in bad.chain([falling]) {
        for wrong in [
            CoordinateRange { q: interval, ..second },
            CoordinateRange { v: interval, ..second },
            CoordinateRange { u: interval, ..second },
        ] {
            assert_eq!(with(&[first, wrong]), out_of_range("range of the training data"), "{wrong:?}");
        }
    }
    for period in [&not_finite[..], &[-1.0]].concat() {
        assert_eq!(
            with(&[CoordinateRange { period, ..first }, second]),
            out_of_range("period of a coordinate")
        );
    }
}

fn outside(q: [f32; 2], v: [f32; 2], u: [f32; 2]) -> Option<(usize, char)> {
    let bytes = file::range(&file::RANGE);
    let found = TrainingRange::new(&bytes).unwrap().outside(&q, &v, &u).unwrap();
    found.map(|Outside { coordinate, quantity }| (coordinate, quantity))
}

#[test]
fn a_state_lies_inside_or_outside() {
    let zero = [0.0; 2];
    assert_eq!(outside(zero, zero, zero), None);
    assert_eq!(outside([2.0, 3.0], [3.5, 8.0], [10.0, 0.0]), None, "the ends are inside");
    assert_eq!(outside([-2.0, -2.5], [-4.0, -8.0], [-10.0, -0.0]), None, "the ends are inside");
    assert_eq!(outside([2.1, 0.0], zero, zero), Some((0, 'q')));
    assert_eq!(outside([2.1, 0.0], [9.0; 2], [99.0; 2]), Some((0, 'q')), "the first is named");
    assert_eq!(outside(zero, [-4.1, 0.0], zero), Some((0, 'v')));
    assert_eq!(outside(zero, zero, [0.0, 1e-30]), Some((1, 'u')));
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(outside([bad, 0.0], zero, zero), Some((0, 'q')));
        assert_eq!(outside([0.0, bad], zero, zero), Some((1, 'q')), "of a coordinate with a period");
        assert_eq!(outside(zero, [0.0, bad], zero), Some((1, 'v')));
        assert_eq!(outside(zero, zero, [bad, 0.0]), Some((0, 'u')));
    }
    let bytes = file::range(&file::RANGE);
    let of_three = TrainingRange::new(&bytes).unwrap().outside(&[0.0; 3], &[0.0; 3], &[0.0; 3]);
    let what = "coordinates of the training range";
    assert_eq!(of_three, Err(ModelError::Shape { what, found: 2, compiled: 3 }));
}

#[test]
fn only_the_first_tree_or_graph_is_covered() {
    let range = file::range(&file::RANGE[1..]);
    let header = Header { range: Some(TrainingRange::new(&range).unwrap()), ..arm_header(arm()) };
    let file = Aligned::new(&file::write(header, &file::arm_weights(file::ARM_NUMBERS)));
    let link = ModularModel::<1, 3, 5, 2>::load(file.bytes(), "link").unwrap();
    assert_eq!(link.range().unwrap().map(|range| range.n()), Some(1));
    let arm = ModularModel::<3, 3, 5, 2>::load(file.bytes(), "arm").unwrap();
    assert_eq!(arm.range(), Ok(None));
}

// ---- Writing ----

/// What core writes of a header and a weight block.
fn written(header: &Header, weights: &[f32]) -> Vec<u8> {
    let mut memory = vec![0xaa; 8192];
    write(header, bytemuck::cast_slice(weights), &mut memory).unwrap().to_vec()
}

#[test]
fn core_writes_what_the_tests_write() {
    let (actuator, range) = (file::actuator(&file::ACTUATOR), file::range(&file::RANGE));
    let rigid = file::weights(&CARTPOLE);
    let cases = [
        (HEADER, rigid.clone()),
        (arm_header(arm()), file::arm_weights(file::ARM_NUMBERS)),
        (web_header(web()), file::web_weights(file::WEB_NUMBERS)),
    ];
    for (header, weights) in cases {
        for units in ["", "m", "m,", "m,r", "m,rad"] {
            for whole in [false, true] {
                let header = Header {
                    units,
                    actuator: whole.then(|| ActuatorBytes::new(&actuator).unwrap()),
                    range: whole.then(|| TrainingRange::new(&range).unwrap()),
                    trained_step: whole.then_some(file::STEP),
                    ..header
                };
                let file = written(&header, &weights);
                assert_eq!(file, file::write(header, &weights));
                assert_eq!(parse(Aligned::new(&file).bytes()).unwrap().header, header);
            }
        }
    }
}

#[test]
fn a_file_that_does_not_fit_is_not_written() {
    let weights = file::weights(&CARTPOLE);
    let whole = written(&HEADER, &weights).len();
    for length in 0..whole {
        let found = write(&HEADER, bytemuck::cast_slice(&weights), &mut vec![0; length]).map(<[u8]>::len);
        assert_eq!(found, Err(WriteError::TooShort), "{length} bytes");
    }
    assert!(write(&HEADER, bytemuck::cast_slice(&weights), &mut vec![0; whole]).is_ok());
}

// ---- Errors ----

#[test]
fn codes_are_their_own_and_rise() {
    assert!(CATALOGUE.is_sorted_by(|a, b| a.code < b.code));
    let names: std::collections::BTreeSet<_> = CATALOGUE.iter().map(|entry| entry.name).collect();
    assert_eq!(names.len(), CATALOGUE.len());
    assert!(CATALOGUE.iter().all(|entry| entry.message.to_str().is_ok_and(|text| !text.is_empty())));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    /// Sections of any numbers and contents behind a valid shape: refused or evaluated, never a panic.
    #[test]
    fn random_sections_never_panic(sections in prop::collection::vec(
        (any::<u8>(), prop::collection::vec(any::<u8>(), 0..40)), 0..6)) {
        let whole = split(&golden_whole());
        let mut all = [whole, sections].concat();
        all.sort_by_key(|(number, _)| *number);
        all.dedup_by_key(|(number, _)| *number);
        let file = Aligned::new(&join(&all));
        let _ = parse(file.bytes());
        if let Ok(model) = Cartpole::load(file.bytes()) {
            let _ = (model.actuator(), model.range(), model.del::<f32, Galerkin>().is_ok());
        }
    }

    /// The contents of the small sections are any bytes.
    #[test]
    fn random_contents_never_panic(which in 0..4_usize, content in prop::collection::vec(any::<u8>(), 0..80)) {
        let section = [Section::Forces, Section::Actuator, Section::Step, Section::Range][which];
        let file = Aligned::new(&with_content(&golden_whole(), section, &content));
        let _ = parse(file.bytes());
        if let Ok(model) = Cartpole::load(file.bytes()) {
            if let Ok(Some(actuator)) = model.actuator() {
                let _ = actuator.at_step::<2>(0.01);
            }
            if let Ok(Some(range)) = model.range() {
                let _ = range.outside(&[0.0; 2], &[0.0; 2], &[0.0; 2]);
            }
        }
    }

    /// q and q + a whole number of periods are the same place.
    #[test]
    fn a_period_does_not_matter(q in -3.0_f32..3.2, turns in -3_i32..4) {
        let inside = (-2.5..=3.0).contains(&q);
        prop_assume!((q + 2.5).abs() > 1e-4 && (q - 3.0).abs() > 1e-4);
        // 3.2 − 2π is below the range as well.
        let found = outside([0.0, q + turns as f32 * std::f32::consts::TAU], [0.0; 2], [0.0; 2]);
        prop_assert_eq!(found.is_none(), inside, "{}", q);
    }

    /// Any range of positions, wrapped: a point is inside where some whole number of periods brings it in.
    #[test]
    fn ranges_with_periods(least in -9.0_f32..9.0, width in 0.0_f32..9.0, q in -20.0_f32..20.0) {
        let range = CoordinateRange { q: Interval { least, most: least + width }, ..file::RANGE[1] };
        let bytes = range.to_bytes();
        let found = TrainingRange::new(&bytes).unwrap().outside(&[q], &[0.0], &[0.0]).unwrap();
        let near = |x: f64| (-9..=9).map(f64::from).map(move |k| f64::from(q) + k * std::f64::consts::TAU - x);
        let [low, high] = [least, least + width].map(f64::from);
        prop_assume!(near(low).chain(near(high)).all(|gap| gap.abs() > 1e-4));
        let inside = near(0.0).any(|q| low <= q && q <= high);
        prop_assert_eq!(found.is_none(), inside);
    }

    #[test]
    fn families_and_texts_are_what_was_written(units in "[a-z,]{0,12}", provenance in ".{0,60}", h in 1e-6_f32..1e3) {
        let trained_step = Some(TrainedStep { h, ..file::STEP });
        let header = Header { units: &units, provenance: &provenance, trained_step, ..HEADER };
        let file = written(&header, &file::weights(&CARTPOLE));
        prop_assert_eq!(&file, &file::write(header, &file::weights(&CARTPOLE)));
        let parsed = Aligned::new(&file);
        prop_assert_eq!(parse(parsed.bytes()).unwrap().header, header);
        prop_assert!(matches!(header.family, Family::Rigid(_)));
    }
}
