//! Choice of the window length.

use super::held_back::{HeldBack, Learned, Trial};
use super::plan::PlanError;
use crate::config::Config;
use crate::data::{Dataset, Trajectory};
use std::fmt;

/// Shortest length that is tried, s, unless [`FEWEST_STEPS`] steps are longer.
const SHORTEST: f64 = 0.25;
/// Least number of steps in a window of the shortest length.
const FEWEST_STEPS: f64 = 5.0;
/// Ratios of the lengths that are tried to the shortest length.
const FACTORS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
/// Index of the length that is taken if the logs do not favour another one.
const USUAL: usize = 1;
/// Ratio to the error with the usual length below which another length is taken: even logs of one machine differ by a
/// few percent.
const WORTH: f64 = 0.9;
/// Fraction of the samples that must lie in logs at least as long as a window.
const MOST: f64 = 0.9;

/// Position errors of held-back logs for several window lengths.
#[derive(Clone, Debug, PartialEq)]
pub struct Lengths {
    /// Window lengths, s, each with the position error of held-back logs, m or rad.
    pub errors: Vec<(f64, f64)>,
    /// The chosen length, s.
    pub chosen: f64,
}

impl fmt::Display for Lengths {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("positions of held-back logs are")?;
        for (k, (length, error)) in self.errors.iter().enumerate() {
            let comma = if k > 0 { "," } else { "" };
            write!(f, "{comma} {error:.2e} off with windows of {length} s")?;
        }
        write!(f, " (m, rad): windows of {} s", self.chosen)
    }
}

/// Number of steps in a window, at least one.
pub(super) fn steps(window: f64, h: f64) -> usize {
    ((window / h).round() as usize).max(1)
}

/// All candidate lengths for a step `h`, s.
fn all(h: f64) -> [f64; 4] {
    FACTORS.map(|factor| factor * SHORTEST.max(FEWEST_STEPS * h))
}

/// Candidate lengths that nearly all logs reach, s, in ascending order.
pub(super) fn candidates(data: &Dataset) -> Vec<f64> {
    let samples: usize = data.trajectories.iter().map(Trajectory::samples).sum();
    let in_logs_of = |steps: usize| -> usize {
        let long = data.trajectories.iter().map(Trajectory::samples).filter(|samples| *samples > steps);
        long.sum()
    };
    let fits = |window: &f64| in_logs_of(steps(*window, data.h)) as f64 >= MOST * samples as f64;
    all(data.h).into_iter().filter(fits).collect()
}

/// The length taken if the logs do not favour another one, s: half a second for most logs, less for shorter ones.
pub(super) fn usual(data: &Dataset) -> f64 {
    let candidates = candidates(data);
    let longest = candidates.last().copied();
    candidates.get(USUAL).copied().or(longest).unwrap_or(all(data.h)[0])
}

/// The window length that predicts held-back logs best, with the result learned with it. It is the usual length, unless
/// the error with another length is clearly smaller, and smaller by more than the standard error of the difference.
/// `None` if there is no choice.
///
/// All lengths continue from the result of the usual length. Longer ones are tried as long as the error does not rise: those of a chaotic
/// mechanism take the most time and show the least.
///
/// # Errors
/// See [`Trial::learn`].
pub(super) fn chosen(
    config: &Config,
    trial: &Trial,
    before: &Learned,
) -> Result<Option<(Lengths, Learned)>, PlanError> {
    let mut found = Vec::new();
    for window in trial.lengths.iter().copied().filter(|_| trial.lengths.len() > 1) {
        if found.len() > USUAL + 1 && rises(&found) {
            break;
        }
        let mut own = config.clone();
        own.training.window = Some(window);
        found.push(trial.learn(&own, Some(before))?.map(|learned| (window, learned)));
    }
    let Some(usual) = found.get_mut(USUAL).and_then(Option::take) else { return Ok(None) };
    let errors = |(window, learned): &(f64, Learned)| (*window, learned.held_back.error());
    let mut others: Vec<(f64, Learned)> = found.into_iter().flatten().collect();
    let mut all: Vec<(f64, f64)> = others.iter().chain([&usual]).map(errors).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let of_usual = &usual.1.held_back;
    let is_worth = |own: &HeldBack| own.error() < WORTH * of_usual.error() && own.is_less_than(of_usual);
    others.retain(|(_, learned)| is_worth(&learned.held_back));
    // The longest of lengths that are as good shows small forces best, which add up over a long motion.
    let least = others.iter().map(|own| errors(own).1).fold(f64::INFINITY, f64::min);
    others.retain(|own| WORTH * errors(own).1 < least);
    let best = others.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let (chosen, learned) = best.unwrap_or(usual);
    Ok(Some((Lengths { errors: all, chosen }, learned)))
}

/// Whether the error with the last length is clearly larger than with the one before.
fn rises(found: &[Option<(f64, Learned)>]) -> bool {
    let error = |of: &Option<(f64, Learned)>| of.as_ref().map(|(_, learned)| learned.held_back.error());
    let [.., before, last] = found else { return false };
    error(before).zip(error(last)).is_none_or(|(before, last)| WORTH * last > before)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Rows;
    use crate::run::robots::pendulums;
    use leastaction_models::parallel;
    use std::path::Path;

    fn data(samples: &[usize], h: f64) -> Dataset {
        let trajectory = |samples: &usize| {
            let q = Rows::from_arrays(&vec![[0.0]; *samples]);
            Trajectory { id: 0, t0: 0.0, q, v: None, a: None, u: None }
        };
        Dataset { n: 1, h, control: None, trajectories: samples.iter().map(trajectory).collect() }
    }

    #[test]
    fn lengths_are_of_seconds_or_steps_and_nearly_all_logs_have_them() {
        assert_eq!(candidates(&data(&[400; 3], 0.01)), [0.25, 0.5, 1.0, 2.0]);
        assert_eq!(candidates(&data(&[400; 3], 0.1)), [0.5, 1.0, 2.0, 4.0]);
        assert_eq!(candidates(&data(&[101, 70, 5], 0.01)), [0.25, 0.5]);
        assert_eq!(candidates(&data(&[101, 9], 0.01)), [0.25, 0.5, 1.0]);
        let usual = [&[400, 400][..], &[40, 40], &[4, 4]].map(|samples| usual(&data(samples, 0.01)));
        assert_eq!(usual, [0.5, 0.25, 0.25]);
    }

    fn chosen_of_pendulums(training: &str) -> Option<Lengths> {
        let text = format!(
            "[data]\nfile = \"logs.csv\"\n[model]\nfamily = \"bodies\"\nchain = 1\nfriction = {{ viscous = \"learned\", coulomb = \
             \"learned\" }}\n[training]\nloss = \"windows\"\nwarm_up = 0\niterations = 1\n{training}"
        );
        let config = Config::parse(&text, Path::new("c.toml")).unwrap();
        let trial = Trial::new(&config, &pendulums(4));
        let before = trial.learn(&config, None).unwrap().unwrap();
        chosen(&config, &trial, &before).unwrap().map(|(lengths, _)| lengths)
    }

    #[test]
    fn what_is_chosen_is_the_same_on_any_number_of_threads() {
        let on =
            |threads: usize| parallel::threads(threads).unwrap().install(|| chosen_of_pendulums("").unwrap());
        let one = on(1);
        assert_eq!(one, on(3));
        let lengths: Vec<f64> = one.errors.iter().map(|(length, _)| *length).collect();
        assert_eq!(lengths, [0.25, 0.5, 1.0]);
        // The errors are at most a few times the noise.
        assert!(one.errors.iter().all(|(_, error)| (5e-4..5e-3).contains(error)), "{one}");
        assert!(one.to_string().ends_with(&format!(": windows of {} s", one.chosen)), "{one}");
    }

    #[test]
    fn a_length_that_is_given_is_kept() {
        assert_eq!(chosen_of_pendulums("window = 0.3"), None);
    }
}
