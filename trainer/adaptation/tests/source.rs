//! Settings of an adapter as Rust source have the bits of this machine, and compile. Regenerate `settings/arm.rs` with `LEASTACTION_REGENERATE=1`.

mod common;

#[path = "settings/arm.rs"]
mod written;

use common::{N, model};
use leastaction_adaptation::{Choice, Request};
use leastaction_core::adapt::Number;
use leastaction_replica::TuningOf;

#[test]
fn the_source_has_every_bit() {
    let mut choice = Choice::of_loop(&model(), 1e-3, &Request::default()).expect("a choice");
    choice.settings.deviation = vec![0.1, 0.3, 0.7];
    let source = choice.source(N);
    if std::env::var_os("LEASTACTION_REGENERATE").is_some() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/settings/arm.rs");
        std::fs::write(file, &source).expect("the file can be written");
        return;
    }
    assert_eq!(source, include_str!("settings/arm.rs"));
    let (of_host, of_chip): (TuningOf<N>, _) = (choice.settings.tuning().expect("a tuning"), written::TUNING);
    assert_eq!(
        (written::N, written::BLOCK, written::T),
        (N, choice.block, written::P * (written::P - 1) / 2)
    );
    assert_eq!((of_host.half, of_host.h, of_host.deviation), (of_chip.half, of_chip.h, of_chip.deviation));
    assert_eq!(
        (of_host.forgotten, of_host.change, of_host.dry),
        (of_chip.forgotten, of_chip.change, of_chip.dry)
    );
    assert_eq!(of_host.limits.kept, of_chip.limits.kept);
    assert_eq!(of_host.numbers[..written::P], of_chip.numbers);
    assert!(of_host.numbers[written::P..].iter().all(|number| *number == Number::None));
    let lists = [
        (of_host.prior, of_chip.prior),
        (of_host.walk, of_chip.walk),
        (of_host.limits.model, of_chip.limits.model),
        (of_host.limits.lower, of_chip.limits.lower),
        (of_host.limits.upper, of_chip.limits.upper),
    ];
    lists.iter().for_each(|(host, chip)| assert_eq!(host[..written::P], *chip));
}
