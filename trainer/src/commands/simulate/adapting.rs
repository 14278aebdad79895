//! Runs in which numbers of the firmware's model follow the mechanism.

use super::{Request, Trace, scenario};
use leastaction::adaptation::{NumberReport, numbers};
use leastaction::cli::Failure;
use leastaction::models::chip_file;
use leastaction_adaptation::{AdaptationError, Choice, Course, Request as Wishes, of_windows};
use leastaction_firmware_sim::control::{Controller, Trajectory};
use leastaction_firmware_sim::scenario::{Run, Setup};
use leastaction_firmware_sim::{self as firmware_sim, Adapting, Firmware, Summary, Tick, Timeline};
use leastaction_models::Model;
use leastaction_replica::{ModelFile, ReplicaError, TunedOf};
use serde::Serialize;
use std::cell::RefCell;
use std::convert::Infallible;

/// A model whose numbers follow: chosen and measured in a first run, in which the mechanism is as it was learned, and let loose in a second.
pub struct Adaptive<'a> {
    model: &'a Model,
    file: ModelFile,
    choice: RefCell<Option<Choice>>,
    course: RefCell<Course>,
}

/// Longest first run, s: a minute has hundreds of windows.
const COMMISSIONED: f32 = 60.0;
/// Deviation in the first run: nothing that is seen counts beside it, N or N m.
const NOTHING_COUNTS: f32 = 1e6;

impl<'a> Adaptive<'a> {
    /// Creates a model of which nothing is known.
    ///
    /// # Errors
    /// [`Failure::Input`] for a model that no chip can have.
    pub fn new(model: &'a Model) -> Result<Self, Failure> {
        let file = chip_file(model).map_err(Failure::Input)?;
        Ok(Self { model, file, choice: RefCell::default(), course: RefCell::default() })
    }

    /// Runs the mechanism as it was learned, with other noise, and measures how well the model explains it.
    pub(super) fn commission(&self, request: &Request) -> Result<(), Failure> {
        let world = request.world.unchanged();
        let seed = request.seed.wrapping_add(1);
        let seconds = request.seconds.map(|seconds| seconds.min(COMMISSIONED));
        let request = Request { world: &world, seed, seconds, adaptive: Some(self), ..*request };
        scenario::run(&request, &mut Trace::default()).map(|_| ())
    }

    /// Runs a firmware: the first run measures, the second adapts.
    pub(super) fn run<P, C, const N: usize>(
        &self,
        plant: Timeline<P>,
        (setup, trajectory): (&Setup<N>, impl Trajectory<N>),
        firmware: Firmware<C, N>,
        mut sink: impl FnMut(&Tick<N>),
    ) -> Result<Summary<N>, Failure>
    where
        P: firmware_sim::Mechanism<N>,
        C: Controller<N>,
    {
        let (is_first, choice) = self.chosen(setup.tick, N)?;
        let tuned = TunedOf::<N>::new(&self.file).map_err(|error| refused(error.into()))?;
        let tuning =
            choice.settings.tuning().map_err(|error| refused(ReplicaError::Settings(error).into()))?;
        let processor = Adapting::new(tuned, firmware, (choice.blocks(), &tuning));
        let processor = processor.map_err(|error| refused(ReplicaError::Unfit(error).into()))?;
        let mut run = Run::new(plant, processor, setup, trajectory).map_err(scenario::misused)?;
        let mut residuals = Vec::new();
        for _ in 0..setup.ticks() {
            let Ok(tick) = run.tick() as Result<Tick<N>, Infallible>;
            sink(&tick);
            let processor = run.processor();
            if let Some(agreement) = processor.agreement() {
                let adapter = processor.adapter();
                residuals.push(adapter.residuals().to_vec());
                let time = [tick.time.into(); 2];
                self.course.borrow_mut().record(&choice, time, (adapter, &agreement));
            }
        }
        if is_first {
            self.measure(choice, residuals, N)?;
        }
        Ok(run.summary())
    }

    /// The choice of the numbers, and whether it is made only now.
    fn chosen(&self, tick: f32, n: usize) -> Result<(bool, Choice), Failure> {
        if let Some(choice) = self.choice.borrow().as_ref() {
            return Ok((false, choice.clone()));
        }
        let mut choice = Choice::of_loop(self.model, tick.into(), &Wishes::default()).map_err(refused)?;
        choice.settings.deviation = vec![NOTHING_COUNTS; n];
        Ok((true, choice))
    }

    fn measure(&self, mut choice: Choice, residuals: Vec<Vec<f32>>, n: usize) -> Result<(), Failure> {
        if residuals.is_empty() {
            let longest = 0.0;
            return Err(refused(AdaptationError::TooShort { window: choice.window(), longest }));
        }
        choice.settings.deviation = of_windows(&[residuals], n);
        *self.choice.borrow_mut() = Some(choice);
        *self.course.borrow_mut() = Course::default();
        Ok(())
    }

    /// Findings of the second run.
    pub(super) fn report(&self) -> Option<AdaptiveReport> {
        let (choice, course) = (self.choice.borrow(), self.course.borrow());
        let choice = choice.as_ref()?;
        let mass = course.mass(choice);
        Some(AdaptiveReport {
            mass: mass.map(|mass| mass.estimate),
            standard_error: mass.map(|mass| mass.error),
            announced_at: course.announced.map(|(t, _)| t),
            numbers: numbers((self.model, choice), &course),
            changes: course.changes(),
            unlike: course.unlike(),
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
