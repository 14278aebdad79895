//! `leastaction simulate --replay`: the firmware along a log.

use super::adapting::{Adaptive, AdaptiveReport};
use super::drift::{Comparison, DriftReport, Reference};
use super::recorded::Recorded;
use super::remote::{Ran, Target};
use super::scenario::misused;
use super::world::known_actuator;
use super::{Trace, median_and_most};
use leastaction::cli::{Failure, Output};
use leastaction::evaluation::LogReading;
use leastaction::models::{chip_file, meant};
use leastaction_adaptation::drift::{Moment, Windows};
use leastaction_firmware_sim::control::Listen;
use leastaction_firmware_sim::devices::Drive;
use leastaction_firmware_sim::observer::{LearnZeros, ObserverConfig, OtherStep};
use leastaction_firmware_sim::scenario::{Logged, replay};
use leastaction_firmware_sim::{InPlace, Mode, Outcome, Program, SetupError, Summary, Tick, wrap};
use leastaction_learning::data::{Dataset, Rows};
use leastaction_models::Model;
use leastaction_replica::{OfSize, ParticleSystem, Replica, SystemOf, Visitor};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// A model to run along a log, with its settings.
pub struct Replay<'a> {
    /// The model.
    pub model: &'a Model,
    /// File of the model, or folder of its run.
    pub file: &'a Path,
    /// The log.
    pub log: &'a Path,
    /// The configuration whose `[data]` says how to read the log, if it needs one; that of the run, if there is one.
    pub config: Option<&'a Path>,
    /// Comparison with the machine as it was.
    pub drift: &'a Comparison,
    /// Step of the observer, s, if other than the model's.
    pub tick: Option<f32>,
    /// Standard deviation of the encoders' zero offsets, if they are to be learned.
    pub learn_zeros: Option<f32>,
    /// Processor that runs the firmware; `None`: this machine.
    pub on: Option<&'a Target>,
    /// Numbers that follow along the log; `None`: the model stays what it is.
    pub adaptive: Option<&'a Adaptive<'a>>,
}

/// Result of a replay. Lists have one entry per coordinate; statistics cover the ticks at which the estimate was
/// already trusted.
#[derive(Debug, Serialize)]
pub struct ReplayReport {
    /// The model file.
    pub model: PathBuf,
    /// The log.
    pub log: PathBuf,
    /// Processor that ran the firmware.
    pub processor: String,
    /// Median and largest number of instructions in a tick, if they are counted.
    pub tick_instructions: Option<[u32; 2]>,
    /// Number of recordings.
    pub trajectories: usize,
    /// Number of ticks in all recordings.
    pub ticks: u32,
    /// Time between ticks, s.
    pub h: f64,
    /// Innovations (reading minus the model's prediction one tick before): root mean square, rad or m.
    pub innovation_rms: Vec<f64>,
    /// Mean of the innovations.
    pub innovation_mean: Vec<f64>,
    /// Largest innovation.
    pub innovation_max: Vec<f64>,
    /// Correlation of consecutive innovations: near 0 if the model leaves only noise.
    pub innovation_correlation: Vec<f64>,
    /// Prediction error from the two previous readings alone, y_k − 2y_{k−1} + y_{k−2}: root mean square, rad or m.
    pub constant_velocity_rms: Vec<f64>,
    /// Zero offsets of the encoders at the end, as far as learned, rad or m.
    pub zeros: Vec<f32>,
    /// Number of errors of the model.
    pub model_errors: u32,
    /// Largest number of Newton updates in a step.
    pub newton_iterations: u8,
    /// Fingerprint of the trace.
    pub trace_hash: String,
    /// File of the trace.
    pub trace: PathBuf,
    /// Comparison of the errors with those along the reference, if there is one.
    pub drift: Option<DriftReport>,
    /// Findings of the firmware, if numbers of its model follow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adapted: Option<AdaptiveReport>,
}

impl Replay<'_> {
    /// Runs along the log, records the trace, and compares the errors with those of the reference.
    pub fn run(&self, output: Output, trace: &mut Trace) -> Result<ReplayReport, Failure> {
        let tell = &mut |sentence: String| output.note(&format!("note: {sentence}"));
        let reading = LogReading::new(self.config, Some(self.log.into()), self.file)?;
        let data = reading.at_step(self.step()).read((None, None), tell)?;
        let chip_file = chip_file(self.model).map_err(Failure::Input)?;
        let chip = meant(&chip_file, self.model).map_err(Failure::Input)?;
        if data.n != chip.n() {
            let (n, own) = (data.n, chip.n());
            return Err(Failure::input(self.log, format!("the log has {n} coordinates, the model {own}")));
        }
        // A model that follows does not drift from the machine.
        let reference = match self.adaptive {
            Some(_) => None,
            None => self.drift.reference(self, &data, tell)?,
        };
        let along = |data, on, windows, trace| chip.visit(Along { replay: self, data, on, windows, trace });
        let windows = windows(reference.as_ref().map_or(&data, |reference| &reference.data));
        let (mut report, log) = along(&data, self.on, windows.emptied(), trace)?;
        if let Some(Reference { file, data }) = reference {
            let (before, windows) = along(&data, None, windows, &mut Trace::default())?;
            report.drift = self.drift.compare((file, before.model_errors), (&windows, &log), tell);
        }
        Ok(report)
    }

    /// Step of the observer, s, if the model or the user says it.
    fn step(&self) -> Option<f64> {
        let own = self.model.facts.trained_step.map(|step| step.h);
        // This is the shortest decimal notation of the model's single-precision step.
        self.tick.or(own).and_then(|step| step.to_string().parse().ok())
    }

    fn program<const N: usize>(&self, h: f32) -> Result<Program<N>, Failure> {
        let mut observer = ObserverConfig { other_step: OtherStep::Accepted, ..ObserverConfig::new() };
        let facts = &self.model.facts;
        observer.order = facts.trained_step.map_or(observer.order, |step| step.order);
        let known = known_actuator(self.model, h)?;
        [observer.delay, observer.lag] = known.map_or([0.0; 2], |known| [known.delay, known.lag]);
        observer.zeros = self.learn_zeros.map(|deviation| LearnZeros { deviation, innovation: INNOVATION });
        let coordinates = self.model.architecture.coordinates();
        let mut angles = coordinates.chars().map(|letter| letter == 'a');
        let angle = std::array::from_fn(|_| angles.next().unwrap_or(false));
        let drive = known.map_or(Drive::ideal(), |known| known.drive);
        Ok(Program::listening(h, angle, drive, observer))
    }
}

/// Standard deviation of an innovation while zeros are learned, rad or m.
const INNOVATION: f32 = 3e-3;

/// Dispatches the run along a log by the number of coordinates.
struct Along<'r, 'a> {
    replay: &'r Replay<'a>,
    data: &'r Dataset,
    on: Option<&'r Target>,
    /// Windows for the errors, empty.
    windows: Windows,
    trace: &'r mut Trace,
}

impl<'c> Visitor<'c> for Along<'_, '_> {
    type Output = Result<(ReplayReport, Windows), Failure>;

    fn coordinates<const N: usize>(self, model: &'c SystemOf<'c, N>) -> Self::Output
    where
        for<'f> Replica<'f>: OfSize<N>,
    {
        let Self { replay: this, data, on, windows, trace } = self;
        let program = this.program::<N>(data.h as f32)?;
        let (log, mut innovations) = (ticks(data), Innovations::new(program.angle, windows));
        let mut sink = |tick: &Tick<N>, outcome: &Outcome<N>| {
            trace.push(tick);
            innovations.take(tick, outcome, log[tick.index as usize].elapsed);
        };
        let rows = log.iter().copied();
        let ran = match (this.adaptive, on) {
            (Some(adaptive), on) => {
                let run = |recorded: &mut Recorded<Listen, N>| replay(recorded, &program, rows, &mut sink);
                adaptive.run((&program, program.listen(model).map_err(misused)?), on, run)?
            }
            (None, None) => {
                let firmware = InPlace { model, firmware: program.listen(model).map_err(misused)? };
                let summary = replay(firmware, &program, rows, &mut sink).map_err(SetupError::from);
                Ran { summary: summary.map_err(misused)?, instructions: Vec::new() }
            }
            (None, Some(target)) => {
                target.with(&program, |remote| replay(remote, &program, rows, &mut sink))?
            }
        };
        let on = on.map_or("host", |target| target.board.name());
        let mut report = innovations.report(on, &ran, data);
        report.adapted = this.adaptive.and_then(Adaptive::report);
        Ok((report, innovations.windows))
    }

    fn particles<const D: usize>(self, _: &'c ParticleSystem<'c, D>) -> Self::Output {
        Err(super::plant::no_graphs())
    }
}

/// Windows for the errors along logs like this one.
fn windows(data: &Dataset) -> Windows {
    let longest = data.trajectories.iter().map(|trajectory| trajectory.samples()).max();
    Windows::new(data.h, longest.unwrap_or(0))
}

/// The recordings of a log, one after another.
fn ticks<const N: usize>(data: &Dataset) -> Vec<Logged<N>> {
    let row = |rows: &Rows, k: usize| {
        let row = rows.get(k).unwrap_or_default();
        std::array::from_fn(|i| row.get(i).map_or(0.0, |x| *x as f32))
    };
    let mut log = Vec::with_capacity(data.samples());
    for trajectory in &data.trajectories {
        for (k, time) in data.times(trajectory).enumerate() {
            let elapsed = if k == 0 { Logged::<N>::FIRST } else { 1 };
            let measured = row(&trajectory.q, k).map(Some);
            let command = trajectory.u.as_ref().map_or([0.0; N], |u| row(u, k));
            log.push(Logged { elapsed, time: time as f32, measured, command });
        }
    }
    log
}

/// Statistics of the innovations, over the ticks at which the estimate was already trusted.
struct Innovations<const N: usize> {
    angle: [bool; N],
    /// The last two readings, newest first.
    before: [Option<[f64; N]>; 2],
    last: Option<[f64; N]>,
    trusted: bool,
    zeros: [f32; N],
    each: [Sums; N],
    windows: Windows,
}

fn moment<const N: usize>(tick: &Tick<N>, i: usize) -> Moment {
    let [error, velocity, command] = [tick.error[i], tick.v_estimate[i], tick.commanded[i]].map(f64::from);
    Moment { error, velocity, command }
}

#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    sum: f64,
    squares: f64,
    products: f64,
    most: f64,
    constant_velocity: f64,
}

impl<const N: usize> Innovations<N> {
    fn new(angle: [bool; N], windows: Windows) -> Self {
        let (before, last, zeros) = ([None; 2], None, [0.0; N]);
        Self { angle, before, last, trusted: false, zeros, each: [Sums::default(); N], windows }
    }

    fn take(&mut self, tick: &Tick<N>, outcome: &Outcome<N>, elapsed: u32) {
        if elapsed == Logged::<N>::FIRST {
            (self.before, self.last, self.trusted) = ([None; 2], None, false);
        }
        let (reading, innovation) = (tick.q.map(f64::from), tick.error.map(f64::from));
        if let (true, [Some(one), Some(two)]) = (self.trusted, self.before) {
            for i in 0..N {
                let straight = reading[i] - 2.0 * one[i] + two[i];
                let straight = if self.angle[i] { f64::from(wrap(straight as f32)) } else { straight };
                self.each[i].take(innovation[i], self.last.map(|last| last[i]), straight);
            }
            self.last = Some(innovation);
            self.windows.take((0..N).map(|i| moment(tick, i)));
        } else {
            self.windows.interrupt();
        }
        self.before = [Some(reading), self.before[0]];
        (self.trusted, self.zeros) = (tick.mode == Mode::Open, outcome.zeros);
    }

    fn report(&self, on: &str, ran: &Ran<N>, data: &Dataset) -> ReplayReport {
        let all = |of: fn(&Sums) -> f64| self.each.iter().map(of).collect();
        let Summary { ticks, incidents, newton, hash, .. } = ran.summary;
        ReplayReport {
            model: PathBuf::new(),
            log: PathBuf::new(),
            processor: on.to_owned(),
            tick_instructions: median_and_most(&ran.instructions),
            trajectories: data.trajectories.len(),
            ticks,
            h: data.h,
            innovation_rms: all(|sums| (sums.squares / sums.count).sqrt()),
            innovation_mean: all(|sums| sums.sum / sums.count),
            innovation_max: all(|sums| sums.most),
            innovation_correlation: all(|sums| sums.products / sums.squares.max(f64::MIN_POSITIVE)),
            constant_velocity_rms: all(|sums| (sums.constant_velocity / sums.count).sqrt()),
            zeros: self.zeros.to_vec(),
            model_errors: incidents.model,
            newton_iterations: newton.iterations,
            trace_hash: format!("{hash:016x}"),
            trace: PathBuf::new(),
            drift: None,
            adapted: None,
        }
    }
}

impl Sums {
    fn take(&mut self, innovation: f64, last: Option<f64>, straight: f64) {
        self.count += 1.0;
        self.sum += innovation;
        self.squares += innovation * innovation;
        self.products += innovation * last.unwrap_or(0.0);
        self.most = self.most.max(innovation.abs());
        self.constant_velocity += straight * straight;
    }
}

impl ReplayReport {
    /// Fails if the model failed.
    pub fn judge(&self) -> Result<(), Failure> {
        match self.model_errors {
            0 => Ok(()),
            errors => Err(Failure::Work(format!(
                "the model could not be stepped along {} {errors} times; see {}",
                self.log.display(),
                self.trace.display()
            ))),
        }
    }
}

impl fmt::Display for ReplayReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let list = |x: &[f64]| x.iter().map(|x| format!("{x:.3e}")).collect::<Vec<_>>().join(", ");
        let (log, trajectories, ticks, h) = (self.log.display(), self.trajectories, self.ticks, self.h);
        writeln!(f, "{log}: {trajectories} trajectories, {ticks} ticks of {h} s, on {}", self.processor)?;
        let line = |f: &mut fmt::Formatter, name: &str, value: &str| writeln!(f, "{name:<32} {value}");
        line(f, "innovation, rms (rad or m)", &list(&self.innovation_rms))?;
        line(f, "innovation, mean", &list(&self.innovation_mean))?;
        line(f, "innovation, largest", &list(&self.innovation_max))?;
        line(f, "innovation, tick to tick", &list(&self.innovation_correlation))?;
        line(f, "of constant velocity, rms", &list(&self.constant_velocity_rms))?;
        line(
            f,
            "zeros of the encoders",
            &list(&self.zeros.iter().map(|x| f64::from(*x)).collect::<Vec<_>>()),
        )?;
        line(f, "model errors", &self.model_errors.to_string())?;
        if let Some([median, most]) = self.tick_instructions {
            line(f, "instructions a tick", &format!("{median} (median), {most} at most"))?;
        }
        line(f, "trace", &format!("{} in {}", self.trace_hash, self.trace.display()))?;
        for (name, value) in self.adapted.iter().flat_map(AdaptiveReport::lines) {
            line(f, name, &value)?;
        }
        self.drift.as_ref().map_or(Ok(()), |drift| drift.fmt(f))
    }
}
