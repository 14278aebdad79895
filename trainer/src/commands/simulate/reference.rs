//! Motions for `track`: a Fourier series or a log, from a file.

use super::Request;
use super::course::Course;
use crate::commands::motion::MotionFile;
use leastaction::cli::{Failure, Output};
use leastaction::notes;
use leastaction_core::model::CoordinateRange;
use leastaction_firmware_sim::SetupError;
use leastaction_firmware_sim::control::{HARMONICS, Reference, Setpoint, Trajectory};
use leastaction_learning::config::{Config, DataConfig};
use leastaction_learning::data::Dataset;
use std::path::Path;

/// Begin of a motion, s: before it the observer needs a few samples.
const BEGIN: f32 = 0.1;
/// Time in which a logged motion that does not begin at rest is entered, s.
const RAMP: f32 = 2.0;

/// A motion of N coordinates.
pub enum Followed<const N: usize> {
    /// A Fourier series, which repeats.
    Series(Reference<N>),
    /// A log, which ends.
    Samples(Course<N>),
}

impl<const N: usize> Trajectory<N> for Followed<N> {
    fn at(&self, t: f32) -> Setpoint<N> {
        match self {
            Self::Series(series) => series.at(t),
            Self::Samples(samples) => samples.at(t),
        }
    }

    fn validate(&self) -> Result<(), SetupError> {
        match self {
            Self::Series(series) => series.validate(),
            // The numbers of the log were checked when the log was read.
            Self::Samples(_) => Ok(()),
        }
    }
}

impl<const N: usize> Followed<N> {
    /// The motion in a file, and the largest forces of the drives, N m or N.
    ///
    /// # Errors
    /// [`Failure`] for a file that cannot be read, has other coordinates, or has gaps, and if neither file nor options give limits.
    pub fn read(request: &Request, path: &Path) -> Result<(Self, [f32; N]), Failure> {
        if is_series(path) {
            let (series, limit) = series(path)?;
            return Ok((Self::Series(series), limit));
        }
        let limit = request.world.limit()?.or_else(|| strongest(&request.model.facts.range));
        let limit = limit.ok_or_else(|| {
            let reason = "neither a log nor this model's file says how strong the drives are; name the largest forces with --limit";
            Failure::Input(reason.to_owned())
        })?;
        Ok((Self::Samples(logged(request, path)?), limit))
    }

    /// Duration of the motion, s; a series has no end.
    pub fn end(&self) -> Option<f32> {
        match self {
            Self::Series(_) => None,
            Self::Samples(samples) => Some(samples.end()),
        }
    }
}

/// Whether the file's name is that of a series.
pub fn is_series(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "toml")
}

/// The largest forces of the training data, if the model's file gives them.
pub fn strongest<const N: usize>(range: &[CoordinateRange]) -> Option<[f32; N]> {
    let range: &[CoordinateRange; N] = range.try_into().ok()?;
    Some(std::array::from_fn(|i| range[i].u.least.abs().max(range[i].u.most.abs())))
}

fn series<const N: usize>(path: &Path) -> Result<(Reference<N>, [f32; N]), Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| Failure::file(path, error))?;
    let file: MotionFile = toml::from_str(&text).map_err(|error| Failure::input(path, error))?;
    let wrong = |what: &str, found: usize| {
        Failure::input(path, format!("{what} has {found} entries; the model has {N} coordinates"))
    };
    let all = |what: &str, list: &[f64]| {
        let single: Vec<f32> = list.iter().map(|x| *x as f32).collect();
        <[f32; N]>::try_from(single).map_err(|_| wrong(what, list.len()))
    };
    let mut waves = [[[0.0; 2]; HARMONICS]; N];
    for (part, (what, rows)) in [("cosine", &file.cosine), ("sine", &file.sine)].into_iter().enumerate() {
        if rows.len() != N {
            return Err(wrong(what, rows.len()));
        }
        for (wave, row) in waves.iter_mut().zip(rows) {
            if row.len() > HARMONICS {
                let found = row.len();
                let message =
                    format!("{what} has a row of {found} harmonics; at most {HARMONICS} are followed");
                return Err(Failure::input(path, message));
            }
            wave.iter_mut().zip(row).for_each(|(pair, x)| pair[part] = *x as f32);
        }
    }
    let centre = all("centre", &file.centre)?;
    let limit = all("limit", &file.limit)?;
    let (ramp, frequency) = (file.ramp as f32, [file.frequency as f32; N]);
    Ok((Reference { begin: BEGIN, ramp, centre, frequency, waves }, limit))
}

/// The only motion of a log, read as the configuration says.
fn logged<const N: usize>(request: &Request, path: &Path) -> Result<Course<N>, Failure> {
    let config = request.config.map(Config::read).transpose()?.map(|config| config.data);
    let config = DataConfig { file: path.into(), ..config.unwrap_or_else(|| DataConfig::new(path)) };
    let (mut log, read) = config.read().map_err(|error| Failure::Input(error.to_string()))?;
    let output = Output::default();
    output.notes(&notes::sentences(&read));
    if log.n != N {
        let n = log.n;
        return Err(Failure::input(path, format!("the motion has {n} coordinates, the model {N}")));
    }
    let seams = log.unwrap_angles(&request.model.architecture.coordinates());
    seams.iter().for_each(|seam| output.note(&format!("note: {seam}")));
    let Dataset { h, trajectories, .. } = log;
    match &trajectories[..] {
        [one] => Ok(Course::through(one, h, (BEGIN, RAMP))),
        several => {
            let count = several.len();
            let reason = format!(
                "{count} motions, or one with gaps; a file with one motion without gaps can be followed ([data] leave_out of a --config leaves \
                 the others out)"
            );
            Err(Failure::input(path, reason))
        }
    }
}
