//! Cases of a paper, each run with our model and with the models that the paper compares with.

use super::interrupted::Interrupted;
use super::option_name;
use super::task::TaskError;
use super::training::{Bounds, Limits};
use std::path::Path;

/// A case and, unless it is run with our model, a model that the paper compares with, trained within limits.
pub(crate) type Row<C, B> = (C, Option<(B, Limits)>);

/// Returns a case for our model, then for each model that it is compared with.
pub(crate) fn rows<C: Copy, B: Copy>(
    case: C,
    (baselines, limits): (&[B], Limits),
) -> impl Iterator<Item = Row<C, B>> {
    let baselines = baselines.iter().map(move |baseline| Some((*baseline, limits)));
    std::iter::once(None).chain(baselines).map(move |baseline| (case, baseline))
}

/// Returns the name and the command of a task: a case of a paper with one seed, for our model or the named one, and
/// with one additional option of the command line or none.
pub(crate) fn name_and_command(
    (paper, case): (&str, &impl clap::ValueEnum),
    (model, switch): (Option<&str>, Option<&str>),
    (seed, arguments): (u64, &str),
) -> (String, String) {
    let case = option_name(case);
    let suffix = |word: Option<&str>| word.map_or(String::new(), |word| format!("-{word}"));
    let name = format!("{case}{}{}-{seed}", suffix(model), suffix(switch));
    let only = model.map_or(String::new(), |_| format!(" --baselines --only {name}"));
    let switch = switch.map_or(String::new(), |switch| format!(" --{switch}"));
    let command = format!("leastaction-papers {paper} --case {case}{only}{switch} --seed {seed}{arguments}");
    (name, command)
}

/// Runs our model, or a baseline. If there is a folder for its state, the training of a baseline continues where it was
/// interrupted; `settings` are everything on which its weights depend.
pub(crate) fn run<B, T>(
    baseline: Option<(B, Limits)>,
    (folder, task, settings): (Option<&Path>, &str, &str),
    run: impl FnOnce(Option<(B, Bounds)>) -> Result<T, TaskError>,
) -> Result<T, TaskError> {
    let Some((baseline, limits)) = baseline else { return run(None) };
    Interrupted::resume(folder, task, settings.to_owned(), |interrupted| {
        run(Some((baseline, Bounds { limits, interrupted })))
    })
}
