//! The section of a model file with the range of the training data.

use crate::common::file::{self, Aligned, arm, arm_header, golden_whole};
use crate::common::sections::{out_of_range, refusal, with_content};
use leastaction_core::model::{
    CoordinateRange, Header, Interval, ModelError, ModularModel, Outside, Section, TrainingRange,
};
use proptest::prelude::*;

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

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    /// q, and q plus a whole number of periods, count as the same position.
    #[test]
    fn a_period_does_not_matter(q in -3.0_f32..3.2, turns in -3_i32..4) {
        let inside = (-2.5..=3.0).contains(&q);
        prop_assume!((q + 2.5).abs() > 1e-4 && (q - 3.0).abs() > 1e-4);
        // 3.2 − 2π is below the range as well.
        let found = outside([0.0, q + turns as f32 * std::f32::consts::TAU], [0.0; 2], [0.0; 2]);
        prop_assert_eq!(found.is_none(), inside, "{}", q);
    }

    /// Any range of positions with a period: a point is inside if some whole number of periods brings it into the
    /// range.
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
}
