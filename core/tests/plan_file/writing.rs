//! The writer of plans.

use crate::common::file::Aligned;
use crate::sample::{MODEL, Sample};
use leastaction_core::model::WriteError;
use leastaction_core::plan::{self, PlanFile, Record};
use proptest::prelude::*;

#[test]
fn a_plan_that_does_not_fit_is_not_written() {
    let sample = Sample::golden();
    let whole = sample.bytes().len();
    let written =
        |length: usize| plan::write(&sample.header(), &sample.records, &mut vec![0; length]).map(<[u8]>::len);
    for length in 0..whole {
        assert_eq!(written(length), Err(WriteError::TooShort), "{length} bytes");
    }
    assert_eq!(written(whole), Ok(whole));
}

/// Any finite number: small, large, of either sign.
fn number() -> impl Strategy<Value = f32> {
    use prop::num::f32::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO
}

prop_compose! {
    /// Which coordinates are angles, and which are driven; one at least.
    fn coordinates()(marks in prop::collection::vec((0_u8..2, any::<bool>()), 1..8), always in any::<prop::sample::Index>())
        -> (Vec<u8>, Vec<u8>) {
        let always = always.index(marks.len());
        let driven = (0..marks.len()).filter(|i| marks[*i].1 || *i == always).map(|i| i as u8);
        (marks.iter().map(|(angle, _)| *angle).collect(), driven.collect())
    }
}

prop_compose! {
    fn sized()((angles, driven) in coordinates(), nodes in 1_u32..6)
        (numbers in prop::collection::vec(number(), (nodes as usize + 1) * record_length(angles.len(), driven.len())),
         limits in prop::collection::vec((number(), number()), driven.len()),
         h in 1e-6_f32..1e3, ticks_per_node in 1_u32..300,
         angles in Just(angles), driven in Just(driven), nodes in Just(nodes)) -> Sample {
        let limits = limits.into_iter().map(|(a, b)| [a.min(b), a.max(b)]).collect();
        Sample { driven, angles, h, ticks_per_node, nodes, limits, records: numbers }
    }
}

fn record_length(n: usize, m: usize) -> usize {
    n + n + m + m * (n + n)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    #[test]
    fn plans_are_what_was_written(sample in sized(), model in any::<u32>()) {
        let header = plan::PlanHeader { model, ..sample.header() };
        let mut memory = vec![0xaa; 1 << 14];
        let file = Aligned::new(plan::write(&header, &sample.records, &mut memory).unwrap());
        let parsed = PlanFile::parse(file.bytes()).unwrap();
        prop_assert_eq!(parsed.header(), &header);
        prop_assert_eq!(parsed.records(), &sample.records[..]);
        prop_assert_eq!(parsed.check_model(model), Ok(()));
        prop_assert!(parsed.check_model(model ^ MODEL).is_err());
        let (n, m) = (sample.angles.len(), sample.driven.len());
        let records = sample.records.chunks(record_length(n, m));
        for (node, x) in records.enumerate() {
            let (state, rest) = x.split_at(2 * n);
            let record = Record { q: &state[..n], v: &state[n..], u: &rest[..m], gain: &rest[m..] };
            prop_assert_eq!(parsed.record(node as u32), Some(record));
        }
        prop_assert_eq!(parsed.record(sample.nodes + 1), None);
        prop_assert_eq!(parsed.record(u32::MAX), None);
    }
}
