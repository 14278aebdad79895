//! A log, as an adapter sees it.

use crate::ticks::Ticks;
use crate::{AdaptationError, Choice};
use leastaction_core::adapt::{Agreement, Difference};
use leastaction_data::Dataset;
use leastaction_models::Model;
use leastaction_replica::{Findings, Replica};

/// Course of an adapter along a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// The estimates at the end of every window.
    pub entries: Vec<Entry>,
    /// Time of the announcement, s from the beginning of the log, and what was announced then.
    pub announced: Option<(f64, Difference<f32>)>,
    /// Time in motion before the announcement, s.
    pub moving: f64,
}

/// Estimates at the end of a window.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Time since the log began, s; trajectories follow each other.
    pub t: f64,
    /// Time in motion since then, s: some coordinate moved faster than a twentieth of the fastest.
    pub moving: f64,
    /// Estimated distance of every number from the model, with its standard error.
    pub estimates: Vec<Difference<f32>>,
    /// Distances in use.
    pub applied: Vec<f32>,
    /// Balance of the model without any adaptation over the window, N or N m for every coordinate.
    pub residuals: Vec<f32>,
    /// Squared innovations over their variances, mean over the rows.
    pub agreement: f32,
    /// Whether something changed at once.
    pub changed: bool,
    /// Whether something is announced as attached.
    pub announced: bool,
    /// Whether no choice of the numbers explains the machine.
    pub unlike: bool,
}

impl Course {
    /// Records what is found at the end of a window: at time t, after some time in motion, s.
    pub fn record(
        &mut self,
        choice: &Choice,
        [t, moving]: [f64; 2],
        (found, agreement): (&dyn Findings, &Agreement<f32>),
    ) {
        let announced = choice.announcement.as_ref().and_then(|test| found.announced(test));
        if let (Some(difference), None) = (announced, self.announced) {
            (self.announced, self.moving) = (Some((t, difference)), moving);
        }
        let numbers = 0..choice.settings.numbers.len();
        self.entries.push(Entry {
            t,
            moving,
            estimates: numbers.clone().filter_map(|j| found.estimate(j)).collect(),
            applied: numbers.filter_map(|j| found.applied(j)).collect(),
            residuals: found.residuals().to_vec(),
            agreement: agreement.squares / f32::from(agreement.rows.max(1)),
            changed: agreement.changed,
            announced: announced.is_some(),
            unlike: found.unlike(),
        });
    }

    /// Attached mass at the end, kg; `None` for a model without bodies.
    pub fn mass(&self, choice: &Choice) -> Option<Difference<f32>> {
        self.entries.last()?.estimates.get(usize::from(choice.announcement?.number)).copied()
    }

    /// Times at which something changed at once, s.
    pub fn changes(&self) -> Vec<f64> {
        self.entries.iter().filter(|entry| entry.changed).map(|entry| entry.t).collect()
    }

    /// Whether no choice of the numbers explains the machine, at the end.
    pub fn unlike(&self) -> bool {
        self.entries.last().is_some_and(|entry| entry.unlike)
    }
}

/// Runs an adapter along a log.
///
/// # Errors
/// [`AdaptationError`].
pub fn along(
    (model, chip): (&Model, &Replica),
    choice: &Choice,
    data: &Dataset,
) -> Result<Course, AdaptationError> {
    let mut adaptation = chip.adaptation(&choice.settings)?;
    let mut course = Course::default();
    let (mut t, mut moving) = (0.0, 0.0);
    let fastest = fastest(data);
    for trajectory in &data.trajectories {
        adaptation.skip();
        let ticks = Ticks::new((model, chip), data, trajectory)?;
        for k in 0..ticks.len() {
            let instant = ticks.at(k);
            t += data.h;
            moving += if moves(instant.v, &fastest) { data.h } else { 0.0 };
            let Some(agreement) = adaptation.take(instant)? else { continue };
            course.record(choice, [t, moving], (adaptation.findings(), &agreement));
        }
    }
    Ok(course)
}

/// Greatest speed of every coordinate.
fn fastest(data: &Dataset) -> Vec<f32> {
    let mut fastest = vec![0.0_f32; data.n];
    for trajectory in &data.trajectories {
        for speeds in crate::ticks::speeds(trajectory, data.h) {
            fastest.iter_mut().zip(speeds).for_each(|(most, v)| *most = most.max(v.abs()));
        }
    }
    fastest
}

/// Part of the greatest speed at which a coordinate counts as moving.
const MOVING: f32 = 0.05;

fn moves(v: &[f32], fastest: &[f32]) -> bool {
    v.iter().zip(fastest).any(|(v, fastest)| v.abs() > MOVING * fastest)
}
