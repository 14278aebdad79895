//! Surveys of arbitrary columns: none panics, and the statistics are of the right size.

use leastaction_data::survey::{Clock, Guess, MotionSurvey, RawLog, Signal};
use proptest::prelude::*;

/// Small numbers, and any number that a file can hold.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -10.0..10.0_f64,
        2 => any::<f64>(),
        1 => prop::sample::select(vec![0.0, f64::NAN, f64::INFINITY, f64::MIN, f64::MAX, f64::MIN_POSITIVE, 360.0]),
    ]
}

proptest! {
    #[test]
    fn any_columns(t in prop::collection::vec(number(), 0..60), q in prop::collection::vec(number(), 0..60), even in any::<bool>()) {
        let stamps: Vec<f64> = if even { (0..q.len()).map(|k| 0.01 * k as f64).collect() } else { t.clone() };
        if let Some(motion) = MotionSurvey::of(&stamps, &q) {
            prop_assert!(motion.samples <= q.len() && motion.reversals < motion.samples && motion.outliers.len() < q.len());
            prop_assert!((0.0..=1.0).contains(&motion.moving));
            prop_assert!(motion.outliers.iter().all(|outlier| outlier.sample < q.len()));
        }
        prop_assert!(Signal::of(&q).is_none_or(|signal| signal.missing <= q.len()));
        prop_assert!(Clock::of(&t).is_none_or(|clock| clock.gaps <= t.len() && clock.median > 0.0));
        let names = ["time", "pos"].map(str::to_owned).to_vec();
        let columns = vec![stamps, q];
        let guess = Guess::of(&[RawLog { names, columns, ..RawLog::default() }]);
        prop_assert!(guess.q.len() <= 1);
    }
}
