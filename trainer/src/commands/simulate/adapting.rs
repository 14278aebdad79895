//! Runs in which numbers of the firmware's model follow the mechanism.

use super::recorded::Recorded;
use super::remote::{Ran, Target};
use super::{Request, Trace, scenario};
use leastaction::adaptation::{NumberReport, numbers};
use leastaction::cli::{Failure, FileKind, replaceable};
use leastaction::models::{chip_file, fingerprint_of};
use leastaction::processor::{Emulator, LinkError, Remote};
use leastaction_adaptation::{AdaptationError, Choice, Course, Request as Wishes, of_windows, patch_file};
use leastaction_firmware_sim::control::Controller;
use leastaction_firmware_sim::scenario::RunError;
use leastaction_firmware_sim::{Adapting, Firmware, Program, Summary};
use leastaction_learning::atomic;
use leastaction_models::Model;
use leastaction_replica::{ModelFile, ReplicaError, TunedOf};
use serde::Serialize;
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// A model whose numbers follow, by settings that are given, or that a first run measures, in which the mechanism is as it was learned.
pub struct Adaptive<'a> {
    model: &'a Model,
    file: ModelFile,
    /// Fingerprint of the user's file, which may have other bytes.
    fingerprint: u32,
    /// File of the settings.
    settings: PathBuf,
    /// Whether that file is there already.
    given: bool,
    /// File for the numbers in use at the end.
    patch: PathBuf,
    found: RefCell<Option<(Choice, Course)>>,
    /// Whether this is the run that measures.
    measures: bool,
}

/// Longest first run, s: a minute has hundreds of windows.
const COMMISSIONED: f32 = 60.0;
/// Deviation in the first run: nothing that is seen counts beside it, N or N m.
const NOTHING_COUNTS: f32 = 1e6;

impl<'a> Adaptive<'a> {
    /// Creates a model of which nothing is known beside the settings, if a file with some is given. Patch and settings are written to the folder.
    ///
    /// # Errors
    /// [`Failure::Input`] for a model that no chip can have, and for files of other kinds in the folder.
    pub fn new(
        (path, model): (&Path, &'a Model),
        settings: Option<&Path>,
        folder: &Path,
    ) -> Result<Self, Failure> {
        let file = chip_file(model).map_err(Failure::Input)?;
        let patch = folder.join("adapter.patch");
        replaceable(&patch, FileKind::Patch)?;
        let given = settings.is_some();
        let settings = settings.map_or_else(|| folder.join("adapter.settings"), Path::to_owned);
        if !given {
            replaceable(&settings, FileKind::Settings)?;
        }
        let (fingerprint, found) = (fingerprint_of(path)?, RefCell::default());
        Ok(Self { model, file, fingerprint, settings, given, patch, found, measures: false })
    }

    /// Runs the mechanism as it was learned, with other noise, and measures how well the model explains it, unless settings are given.
    pub(super) fn commission(&self, request: &Request) -> Result<(), Failure> {
        if self.given {
            return Ok(());
        }
        let world = request.world.unchanged();
        let seed = request.seed.wrapping_add(1);
        let seconds = request.seconds.map(|seconds| seconds.min(COMMISSIONED));
        let (file, patch) = (chip_file(self.model).map_err(Failure::Input)?, self.patch.clone());
        let (settings, found) = (self.settings.clone(), RefCell::default());
        let Self { model, fingerprint, .. } = *self;
        let measuring =
            Self { model, file, fingerprint, settings, given: false, patch, found, measures: true };
        let request =
            Request { world: &world, seed, seconds, on: None, adaptive: Some(&measuring), ..*request };
        scenario::run(&request, &mut Trace::default()).map(|_| ())
    }

    /// Runs a firmware, which was begun for a program: `run` takes it through its ticks, here and on the board, if there is one.
    pub(super) fn run<C, const N: usize>(
        &self,
        (program, firmware): (&Program<N>, Firmware<C, N>),
        on: Option<&Target>,
        run: impl FnOnce(&mut Recorded<C, N>) -> Result<Summary<N>, RunError<LinkError>>,
    ) -> Result<Ran<N>, Failure>
    where
        C: Controller<N>,
    {
        let choice = self.chosen::<N>(program.tick)?;
        let tuned = TunedOf::<N>::new(&self.file).map_err(|error| refused(error.into()))?;
        let tuning = choice.settings.tuning().map_err(|error| refused(error.into()))?;
        let firmware = Adapting::new(tuned, firmware, (choice.blocks(), &tuning));
        let firmware = firmware.map_err(|error| refused(ReplicaError::Unfit(error).into()))?;
        let mut found = None;
        let along = |board: Option<&mut Remote<Emulator, N>>| {
            let mut recorded = Recorded::new(firmware, board, &choice, program.tick);
            let summary = run(&mut recorded)?;
            let patch = recorded.patch(self.fingerprint);
            found = Some((patch, recorded.course));
            Ok(summary)
        };
        let (ran, on_board) = match on {
            None => (Ran::here(along(None))?, None),
            Some(target) => {
                let (ran, patch) = target.adapting(program, &self.settings, |board| along(Some(board)))?;
                (ran, Some((target.board.name(), patch)))
            }
        };
        let Some((patch, course)) = found else { return Ok(ran) };
        let patch = patch_file(&patch).map_err(refused)?;
        if let Some((name, _)) = on_board.filter(|(_, saved)| *saved != patch) {
            return Err(Failure::Work(format!(
                "{name}: the numbers that it saved do not have the bits of this machine"
            )));
        }
        self.keep((choice, course), &patch, N)?;
        Ok(ran)
    }

    /// The settings.
    fn chosen<const N: usize>(&self, tick: f32) -> Result<Choice, Failure> {
        if self.measures {
            let mut choice = Choice::of_loop(self.model, tick.into(), &Wishes::default()).map_err(refused)?;
            choice.settings.deviation = vec![NOTHING_COUNTS; N];
            return Ok(choice);
        }
        let bytes = std::fs::read(&self.settings).map_err(|error| Failure::input(&self.settings, error))?;
        let choice = Choice::read::<N>(&bytes, self.fingerprint, tick);
        choice.map_err(|error| Failure::input(&self.settings, error))
    }

    /// Keeps what was found, or, after the run that measures, writes the settings.
    fn keep(&self, (mut choice, course): (Choice, Course), patch: &[u8], n: usize) -> Result<(), Failure> {
        if self.measures {
            if course.entries.is_empty() {
                let longest = 0.0;
                return Err(refused(AdaptationError::TooShort { window: choice.window(), longest }));
            }
            let residuals = course.entries.into_iter().map(|entry| entry.residuals).collect();
            choice.settings.deviation = of_windows(&[residuals], n);
            let settings = choice.settings_file(self.fingerprint).map_err(refused)?;
            return atomic::write(&self.settings, &settings)
                .map_err(|error| Failure::file(&self.settings, error));
        }
        atomic::write(&self.patch, patch).map_err(|error| Failure::file(&self.patch, error))?;
        *self.found.borrow_mut() = Some((choice, course));
        Ok(())
    }

    /// Findings of the run.
    pub(super) fn report(&self) -> Option<AdaptiveReport> {
        let found = self.found.borrow();
        let (choice, course) = found.as_ref()?;
        let mass = course.mass(choice);
        Some(AdaptiveReport {
            mass: mass.map(|mass| mass.estimate),
            standard_error: mass.map(|mass| mass.error),
            announced_at: course.announced.map(|(t, _)| t),
            numbers: numbers((self.model, choice), course),
            changes: course.changes(),
            unlike: course.unlike(),
            settings: self.settings.clone(),
            patch: self.patch.clone(),
        })
    }
}

/// Findings of a firmware about its mechanism at the end of a run.
#[derive(Clone, Debug, Serialize)]
pub struct AdaptiveReport {
    /// Attached mass, kg.
    pub mass: Option<f32>,
    /// Standard error of it, kg.
    pub standard_error: Option<f32>,
    /// Time of the first announcement, s.
    pub announced_at: Option<f64>,
    /// Numbers that follow.
    pub numbers: Vec<NumberReport>,
    /// Times at which something changed at once, s.
    pub changes: Vec<f64>,
    /// Whether no choice of the numbers explains the mechanism.
    pub unlike: bool,
    /// File of the settings.
    pub settings: PathBuf,
    /// File of the numbers in use at the end.
    pub patch: PathBuf,
}

impl AdaptiveReport {
    /// The findings in words.
    pub(super) fn lines(&self) -> Vec<(&'static str, String)> {
        let mut lines = Vec::new();
        if let (Some(mass), Some(error)) = (self.mass, self.standard_error) {
            lines.push(("attached (kg)", format!("{mass:.3}, standard error {error:.3}")));
            let announced = self.announced_at.map_or("never".to_owned(), |t| format!("at {t:.2} s"));
            lines.push(("announced", announced));
        }
        if self.unlike {
            lines.push(("warning", "no choice of its numbers explains the mechanism".to_owned()));
        }
        lines
    }
}

fn refused(error: AdaptationError) -> Failure {
    Failure::Input(format!("--adapt: {error}"))
}
