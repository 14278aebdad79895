//! Encoders, actuators, clock and random streams, one by one.

use core::f32::consts::PI;
use leastaction_firmware_sim::devices::{
    Actuator, ActuatorConfig, Clock, ClockConfig, DelayLine, Device, EncoderConfig, Encoders, MAX_DELAY,
    Stream,
};
use leastaction_firmware_sim::wrap;
use proptest::prelude::*;

#[test]
fn normal_deviates_have_the_right_moments() {
    let mut stream = Stream::new(1, Device::Encoder);
    let n = 200_000;
    let draws: Vec<f64> = (0..n).map(|_| f64::from(stream.normal())).collect();
    let moment = |k: i32| draws.iter().map(|x| x.powi(k)).sum::<f64>() / f64::from(n);
    // Five standard errors: √(1/n), √(2/n), √(15/n), √(96/n).
    assert!(moment(1).abs() < 0.012 && (moment(2) - 1.0).abs() < 0.016);
    assert!(moment(3).abs() < 0.044 && (moment(4) - 3.0).abs() < 0.11);
    assert!(draws.iter().all(|x| x.abs() < 5.8));
}

#[test]
fn streams_of_seeds_and_devices_differ() {
    let first = |seed, device| {
        let mut stream = Stream::new(seed, device);
        [(); 8].map(|()| stream.uniform().to_bits())
    };
    let mut seen = Vec::new();
    for seed in 0..50 {
        for device in [Device::Start, Device::Encoder, Device::Clock] {
            assert_eq!(first(seed, device), first(seed, device));
            seen.push(first(seed, device));
        }
    }
    seen.sort_unstable();
    seen.dedup();
    assert_eq!(seen.len(), 150);
}

#[test]
fn an_encoder_counts() {
    let coarse = EncoderConfig { resolution: 0.5, noise: 0.0, ..EncoderConfig::linear() };
    let mut encoders = Encoders::new([coarse], 0);
    let readings = [0.1, 0.3, -0.74, 10.2].map(|x| encoders.sample(&[x]));
    assert_eq!(readings, [[Some(0.0)], [Some(0.5)], [Some(-0.5)], [Some(10.0)]]);
}

#[test]
fn an_absolute_encoder_forgets_whole_turns() {
    let mut encoders = Encoders::new([EncoderConfig::rotary().perfect()], 0);
    for turns in [-3.0, 0.0, 5.0] {
        let [reading] = encoders.sample(&[1.0 + turns * 2.0 * PI]);
        assert!((reading.unwrap() - 1.0).abs() < 1e-5);
    }
}

#[test]
fn noise_and_drops_have_their_rates() {
    let config = EncoderConfig { drop: 0.3, noise: 0.01, ..EncoderConfig::linear().perfect() };
    let mut encoders = Encoders::new([config], 3);
    let samples: Vec<f32> = (0..20_000).filter_map(|_| encoders.sample(&[2.0])[0]).collect();
    let rate = samples.len() as f32 / 20_000.0;
    let variance = samples.iter().map(|x| (x - 2.0) * (x - 2.0)).sum::<f32>() / samples.len() as f32;
    assert!((rate - 0.7).abs() < 0.017, "{rate}");
    assert!((variance.sqrt() - 0.01).abs() < 3e-4, "{variance}");
}

#[test]
fn a_position_that_is_not_finite_gives_no_reading() {
    let mut encoders = Encoders::new([EncoderConfig::rotary(), EncoderConfig::linear()], 0);
    assert_eq!(encoders.sample(&[f32::NAN, f32::INFINITY]), [None, None]);
}

#[test]
fn commands_come_out_after_the_delay() {
    for delay in 0..=MAX_DELAY {
        let mut line = DelayLine::new(delay);
        for tick in 0..30_u8 {
            let out = line.advance(Some([f32::from(tick)]));
            assert_eq!(out, [f32::from(tick.saturating_sub(delay))], "delay {delay}, tick {tick}");
            assert_eq!(line.decided().count(), usize::from(delay));
        }
    }
}

#[test]
fn a_missed_tick_repeats_the_last_command() {
    let mut line = DelayLine::new(1);
    let out = [Some([3.0]), None, None, Some([5.0]), None].map(|command| line.advance(command)[0]);
    assert_eq!(out, [0.0, 3.0, 3.0, 3.0, 5.0]);
}

#[test]
fn actuators_saturate() {
    let mut slow = Actuator::new(ActuatorConfig { delay: 0.0, lag: 2.0, ..ActuatorConfig::new([3.0]) });
    slow.advance(Some([5.0]));
    assert_eq!(slow.force(), [0.0]);
    let mean = slow.pass(1.0)[0];
    let (end, expected) = (slow.force()[0], 3.0 * (1.0 - (-0.5_f32).exp()));
    let expected_mean = 3.0 * (1.0 - 2.0 * (1.0 - (-0.5_f32).exp()));
    assert!((end - expected).abs() < 1e-6 && (mean - expected_mean).abs() < 1e-6, "{end} {mean}");
    let mut actuator = Actuator::new(ActuatorConfig { delay: 0.0, ..ActuatorConfig::new([2.0, 0.0]) });
    assert_eq!(actuator.advance(Some([5.0, 1.0])), [2.0, 0.0]);
    assert_eq!(actuator.advance(Some([-5.0, -1.0])), [-2.0, 0.0]);
    assert_eq!(actuator.advance(Some([1.5, 0.0])), actuator.force());
}

#[test]
fn a_clock_has_its_rates() {
    let mut clock = Clock::new(ClockConfig { late: 0.2, jitter: 0.5, missed: 0.1 }, 5);
    let ticks: Vec<_> = (0..20_000).map(|_| clock.tick()).collect();
    let rate = |n: usize| n as f32 / 20_000.0;
    assert!((rate(ticks.iter().filter(|t| t.lateness > 0.0).count()) - 0.2).abs() < 0.015);
    assert!((rate(ticks.iter().filter(|t| t.missed).count()) - 0.1).abs() < 0.011);
    assert!(ticks.iter().all(|t| (0.0..0.5).contains(&t.lateness)));
}

proptest! {
    #[test]
    fn wrapped_angles_are_the_same_angle(x in -1e3_f32..1e3) {
        let y = wrap(x);
        prop_assert!(y.abs() <= PI + 1e-4);
        prop_assert!((f64::from(x) - f64::from(y)).sin().abs() < 2e-4);
        prop_assert!((f64::from(x) - f64::from(y)).cos() > 0.99);
    }
}

#[test]
fn an_encoder_reads_its_zero_more() {
    let config = EncoderConfig { zero: 0.02, ..EncoderConfig::linear().perfect() };
    assert_eq!(Encoders::new([config], 1).sample(&[0.5]), [Some(0.52)]);
}
