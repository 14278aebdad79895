//! Checks on a simulated Panda that intervals have their nominal coverage and that a load is found. Long:
//!
//!     LEASTACTION_SEEDS=100 cargo test -p leastaction-learning --test fit panda -- --ignored --nocapture

use super::panda;
use leastaction_learning::torque::fit::{Alone, Learned, Shown, alone, fit};
use leastaction_models::tree::Inertia;
use nalgebra::{Matrix3, Vector3};

/// Length of the log for coverage, and period of its motion, s: as in the real arm's log.
const LOG: [f64; 2] = [21.0, 13.32];
/// Length of the log with a load, s.
const LOADED: f64 = 10.0;
/// Mass of the load, kg.
const LOAD: f64 = 1.0;

/// Error of a number, and its standard error.
type Error = [f64; 2];

/// Fraction of errors within the interval, and ratio of the reported to the empirical standard deviation.
fn coverage(errors: &[Error], interval: f64) -> [f64; 2] {
    let mean = |f: &dyn Fn(&Error) -> f64| errors.iter().map(f).sum::<f64>() / errors.len() as f64;
    let covered = mean(&|[error, own]| f64::from(u8::from(error.abs() <= interval * own)));
    [covered, (mean(&|of| of[1] * of[1]) / mean(&|of| of[0] * of[0])).sqrt()]
}

/// A number from the environment variable `LEASTACTION_<name>`.
fn setting(name: &str, usual: f64) -> f64 {
    std::env::var(format!("LEASTACTION_{name}")).ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
}

fn noise() -> panda::Noise {
    let panda::Noise { encoder, torque, drift } = panda::Noise::default();
    let (encoder, torque) = (setting("ENCODER", encoder), setting("TORQUE", torque));
    panda::Noise { encoder, torque, drift: setting("DRIFT", drift) }
}

fn seeds(usual: f64) -> u64 {
    setting("SEEDS", usual) as u64
}

#[test]
#[ignore = "minutes"]
fn intervals_of_a_panda_cover_the_truth() {
    let (truth, noise) = (panda::arm(None), noise());
    let exact = panda::exact(&truth, &panda::motion(LOG[1]), LOG[0]);
    let of_seed = |seed: u64| {
        let samples = panda::logged(&exact, &noise, seed);
        alone(&panda::guessed(), &samples, &Learned::default()).unwrap()
    };
    let all: Vec<Alone> = (0..seeds(4.0)).map(of_seed).collect();
    let first = &all[0];
    let numbers = first.of_model(&truth.tree.parameters(), &truth.joints);
    let errors = |k: usize| -> Vec<Error> {
        let own = |of: &Alone| match of.estimates[k].shown {
            Shown::Within(error) => Some([of.estimates[k].value - numbers[k], error]),
            _ => None,
        };
        all.iter().filter_map(own).collect()
    };
    let base = first.base.count();
    for (what, numbers) in [("base parameters", 0..base), ("friction", base..numbers.len())] {
        let each: Vec<Vec<Error>> = numbers.map(errors).collect();
        let scaled = |of: &Error| [of[0] / of[1], 1.0];
        let pooled: Vec<Error> = each.iter().flatten().map(scaled).collect();
        let [covered, ratio] = coverage(&pooled, first.interval());
        let least = each.iter().map(|of| coverage(of, first.interval())[0]).fold(1.0, f64::min);
        println!(
            "{what}: {} of {} logs, {:.1}% covered (the least of one number {:.0}%), reported over empirical error {ratio:.2}",
            each.len(),
            all.len(),
            100.0 * covered,
            100.0 * least
        );
        let range = if all.len() < 20 { 0.85..=1.0 } else { 0.92..=0.98 };
        assert!(what == "friction" || range.contains(&covered), "{covered}");
    }
}

/// The last body's extra mass with a load in the hand is the load's mass.
#[test]
#[ignore = "minutes"]
fn a_load_of_a_panda_is_found() {
    let noise = noise();
    let load = Inertia::of_centre(LOAD, Vector3::new(0.03, -0.02, 0.15), Matrix3::identity() * 0.003);
    let [empty, loaded] = [(None, LOG), (Some(load), [LOADED; 2])]
        .map(|(load, [seconds, period])| panda::exact(&panda::arm(load), &panda::motion(period), seconds));
    let last = Learned { known: (0..6).collect(), ..Learned::default() };
    let of_seed = |seed: u64| -> Error {
        let before =
            fit(&panda::guessed(), &panda::logged(&empty, &noise, 2 * seed), &Learned::default(), 1.0)
                .unwrap();
        let samples = panda::logged(&loaded, &noise, 2 * seed + 1);
        let after = fit(&before.arm.tree, &samples, &last, 1.0).unwrap();
        let by_log = alone(&before.arm.tree, &samples, &last).unwrap();
        let mass = |arm: &leastaction_learning::torque::fit::Arm| arm.tree.bodies()[6].inertia.mass();
        let found = mass(&after.arm) - mass(&before.arm);
        println!("{seed}: {found:.4} kg, by the log alone {:?}", by_log.estimates[0]);
        [found - LOAD, 0.0]
    };
    let mut errors: Vec<f64> = (0..seeds(2.0)).map(|seed| of_seed(seed)[0]).collect();
    errors.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let squares = errors.iter().map(|x| x * x).sum::<f64>() / errors.len() as f64;
    println!(
        "of {} loads: root mean square {:.4} kg, largest {:.4} kg",
        errors.len(),
        squares.sqrt(),
        errors[errors.len() - 1]
    );
    assert!(errors.iter().all(|error| error.abs() < 0.02 * LOAD), "{errors:?}");
}
