//! Laws of axes in a model file: friction by direction, friction that sticks, and end stops.

use crate::common::file::{self, AXES, AXES_HEADER, Aligned};
use crate::common::sections::{Cartpole, refusal};
use leastaction_core::forces::{Directional, Sticking, Stop, Stops, Viscous};
use leastaction_core::model::{Header, InertiaNetworkModel, Law, ModelError};
use leastaction_core::scalar::f16;

type Axes<S, const N: usize> = (Viscous<S, N>, (Directional<S, N>, (Sticking<S, N>, Stops<S, N>)));
type AxesCartpole<'a> = InertiaNetworkModel<'a, 2, 8, 2, f32, Axes<f32, 2>>;
/// The first number of a law of the golden file, and their count in a group.
const PLACES: [(Law, usize, usize); 3] =
    [(Law::Directional, 0, 5), (Law::Sticking, 10, 6), (Law::Stops, 22, 3)];

/// The golden file with other numbers at some places.
fn with(changes: &[(usize, f32)]) -> Aligned {
    let mut numbers = AXES;
    changes.iter().for_each(|(index, value)| numbers[*index] = *value);
    Aligned::new(&file::with_axes(&numbers))
}

fn stops_of(file: &Aligned) -> [Stop<f32>; 2] {
    AxesCartpole::load(file.bytes()).unwrap().system.forces.1.1.1.coordinates
}

#[test]
fn laws_of_axes_are_what_was_written() {
    let whole = with(&[]);
    let (viscous, (directional, (sticking, _))) = AxesCartpole::load(whole.bytes()).unwrap().system.forces;
    assert_eq!(viscous.coefficients, [0.125; 2]);
    let by_direction = directional
        .coordinates
        .map(|of| [of.viscous, of.viscous_asymmetry, of.constant, of.asymmetry, of.width]);
    assert_eq!(by_direction.as_flattened(), &AXES[..10]);
    let at_rest = sticking
        .coordinates
        .map(|of| [of.constant, of.asymmetry, of.load, of.smoothing, of.breakaway, of.width]);
    assert_eq!(at_rest.as_flattened(), &AXES[10..22]);
    // Centre and half distance: 0.5 ± 0.75 and −0.25 ± 2.
    let first = Stop { lower: -0.25, upper: 1.25, restitution: 0.5 };
    assert_eq!(stops_of(&whole), [first, Stop { lower: -2.25, upper: 1.75, restitution: 1.0 }]);
}

#[test]
fn a_program_refuses_laws_of_axes_that_it_does_not_know() {
    type Sticky<'a> = InertiaNetworkModel<'a, 2, 8, 2, f32, (Viscous<f32, 2>, Sticking<f32, 2>)>;
    type Falling<'a> = InertiaNetworkModel<'a, 2, 8, 2, f32, (Viscous<f32, 2>, Stops<f32, 2>)>;
    let whole = with(&[]);
    assert_eq!(Cartpole::load(whole.bytes()).map(|_| ()), Err(ModelError::Law { number: 5 }));
    assert_eq!(Sticky::load(whole.bytes()).map(|_| ()), Err(ModelError::Law { number: 5 }));
    let header = Header { laws: file::HEADER.laws.with(Law::Stops), ..file::HEADER };
    let numbers = [&file::weights(&file::CARTPOLE), &AXES[22..]].concat();
    let stopped = Aligned::new(&file::write(header, &numbers));
    let refused = Sticky::load(stopped.bytes()).map(|_| ()).unwrap_err();
    assert_eq!(refused, ModelError::Law { number: 7 });
    assert!(refused.to_string().contains("the law stops is not"), "{refused}");
    let stops = Falling::load(stopped.bytes()).unwrap().system.forces.1;
    assert_eq!(stops.coordinates, stops_of(&whole));
    // A file without stops loads with none.
    let damped = Aligned::new(&file::golden());
    assert_eq!(Falling::load(damped.bytes()).unwrap().system.forces.1, Stops::none());
}

#[test]
fn numbers_of_axes_out_of_range_are_refused() {
    let wrong = [
        (2, &[-0.5][..]),
        (3, &[-1.5]),
        (9, &[0.0]),
        (11, &[1.25]),
        (12, &[1.0]),
        (14, &[0.75]),
        (20, &[0.5]),
        (21, &[0.0]),
        (23, &[0.0, -0.0, -2.0]),
        (24, &[-0.0625, 1.0625, f32::MAX]),
        (26, &[0.0, -f32::MAX]),
        (27, &[-1e-30, 2.0]),
    ];
    for (index, values) in wrong {
        for value in values.iter().copied() {
            let file = with(&[(index, value)]);
            let refused = AxesCartpole::load(file.bytes()).map(|_| ()).unwrap_err();
            let of = PLACES.into_iter().rev().find(|(_, first, _)| *first <= index);
            let (law, first, each) = of.unwrap();
            let (number, group) = (((index - first) % each) as u8, ((index - first) / each) as u16);
            assert_eq!(refused, ModelError::LawNumber { law, number, group, value });
            assert_eq!(refusal(file.bytes()), refused);
        }
    }
    let refused = refusal(with(&[(26, 0.0)]).bytes());
    assert_eq!(refused.to_string(), "half of the law stops of group 1 is 0: it must be above 0");
    let refused = refusal(with(&[(24, 1.5)]).bytes());
    assert_eq!(refused.to_string(), "e of the law stops of group 0 is 1.5: it must be between 0 and 1");
    let first = file::weights(&file::CARTPOLE).len();
    for index in 0..AXES.len() {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let refused = refusal(with(&[(index, value)]).bytes());
            assert_eq!(refused, ModelError::NotFinite { index: first + index });
        }
    }
    for length in [0, 21, 22, 25, 27] {
        let refused = refusal(&file::with_axes(&AXES[..length]));
        assert_eq!(refused, ModelError::WeightCount { found: first + length, needed: first + AXES.len() });
    }
}

/// The largest number as half the distance puts stops out of reach, or at infinity; with any centre they are no NaN.
#[test]
fn stops_may_be_out_of_reach() {
    for centre in [0.0, -0.0, 3.5, -1e30, f32::MAX, -f32::MAX] {
        let [_, of] = stops_of(&with(&[(25, centre), (26, f32::MAX)]));
        assert!(of.lower <= -f32::MAX || centre > 1e29, "{of:?}");
        assert!(of.upper >= f32::MAX || centre < -1e29, "{of:?}");
        assert!(of.lower < of.upper, "{of:?}");
    }
    let [_, none] = stops_of(&with(&[(25, 0.0), (26, f32::MAX)]));
    assert_eq!([none.lower, none.upper], [-f32::MAX, f32::MAX]);
}

#[test]
fn stops_in_half_precision() {
    type Half<'a> = InertiaNetworkModel<'a, 2, 8, 2, f16, Axes<f32, 2>>;
    let weights = [&file::weights(&file::CARTPOLE), &AXES[..]].concat();
    let whole = Aligned::new(&file::write_half(AXES_HEADER, &weights));
    let stops = Half::load(whole.bytes()).unwrap().system.forces.1.1.1;
    assert_eq!(stops.coordinates, stops_of(&with(&[])));
}
