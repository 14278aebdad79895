//! Boxes and what it costs to leave them.

use crate::common::assert_close;
use leastaction_core::control::{Limits, Penalty};

#[test]
fn the_nearest_point_of_a_box() {
    let limits = Limits { least: [-1.0, 0.5, f64::NEG_INFINITY], most: [2.0, 0.5, 3.0] };
    assert_eq!(limits.clamped(&[-4.0, 7.0, -1e9]), [-1.0, 0.5, -1e9]);
    assert_eq!(limits.clamped(&[f64::NAN, f64::NAN, 8.0]), [-1.0, 0.5, 3.0]);
    assert_eq!(limits.excess(&[2.5, 0.25, 3.0]), [0.5, -0.25, 0.0]);
    assert_eq!(Limits::<f64, 2>::none().excess(&[1e300, -1e300]), [0.0; 2]);
}

#[test]
fn violations_are_counted_in_deviations_of_weight_1() {
    let limits = Limits { least: [0.0, 0.0], most: [1.0, 1.0] };
    let penalty = Penalty { limits, weights: [100.0, 1.0] };
    assert_close("tenths", penalty.violation(&[1.2, 0.5]), 2.0, 1e-15);
    assert_eq!(penalty.violation(&[0.2, -3.0]), 3.0);
    assert_eq!(Penalty::<f64, 2>::none().violation(&[1e9, 0.0]), 0.0);
}
