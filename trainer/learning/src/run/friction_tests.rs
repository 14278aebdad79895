use super::tests::{Warned, config, data};
use super::*;
use crate::config::Config;
use crate::data::Rows;
use leastaction_core::model::Law;

/// A configuration of the pendulum with these friction keys.
fn rubbing(friction: &str) -> Config {
    let mut config = config();
    let text = format!("[data]\nfile = \"a\"\n[model]\ncoordinates = \"a\"\nhidden = [5]\n{friction}");
    config.model = Config::parse(&text, Path::new("c.toml")).unwrap().model;
    config
}

#[test]
fn a_known_friction_shows_the_scale_and_a_learned_one_does_not() {
    let notices = |friction: &str| Plan::new(rubbing(friction), &data(4, false)).unwrap().notices().to_vec();
    assert_eq!(notices("friction = { viscous = 0.1 }\n"), []);
    assert_eq!(notices("friction = { coulomb = 0.1 }\n"), []);
    for friction in ["friction = \"learned\"\n", "friction = { viscous = 0.0 }\n"] {
        assert_eq!(notices(friction), [Notice::UnknownScale, Notice::NoWarmUp]);
    }
}

/// Starts and bounds follow the logs that are trained on, and not those that are held back.
#[test]
fn what_is_held_back_does_not_matter_to_the_start() {
    let mut config = rubbing("friction = \"learned\"\n");
    config.data.validation = 0.25;
    let with = |log: usize| {
        let mut data = data(4, true);
        let own = &mut data.trajectories[log];
        for rows in std::iter::once(&mut own.q).chain(&mut own.u) {
            *rows = Rows::from_flat(1, rows.as_flat().iter().map(|x| 1.5 * x).collect()).unwrap();
        }
        let plan = Plan::new(config.clone(), &data).unwrap();
        let start = plan.initial[plan.architecture.laws_start()..].to_vec();
        (start, plan.architecture.group_laws.widths(Law::Coulomb, 0))
    };
    let [first, last, other] = [0, 3, 1].map(with);
    let plain = Plan::new(config.clone(), &data(4, true)).unwrap();
    assert_eq!(
        last,
        (
            plain.initial[plain.architecture.laws_start()..].to_vec(),
            plain.architecture.group_laws.widths(Law::Coulomb, 0)
        )
    );
    assert!(first != last && other != last, "{first:?}");
    assert!(plain.initial == plain.given, "what is not shown stays there");
}

/// Stops after `rows` rows.
struct StopsAfter<'s> {
    rows: usize,
    stop: &'s AtomicBool,
}

impl Monitor for StopsAfter<'_> {
    fn row(&mut self, _: &Row) {
        self.rows = self.rows.saturating_sub(1);
        self.stop.store(self.rows == 0, Ordering::Relaxed);
    }

    fn warning(&mut self, _: &str) {}
}

/// Numbers with ranges are optimised in other variables, but a checkpoint holds everything that is needed to resume.
#[test]
fn a_run_with_ranges_goes_on_bit_for_bit() {
    for optimiser in [crate::config::OptimiserKind::LevenbergMarquardt, crate::config::OptimiserKind::Adam] {
        let mut config = rubbing("friction = \"learned\"\n");
        (config.training.optimiser, config.training.iterations) = (optimiser, 8);
        config.training.adam.learning_rate = 0.05;
        let plan = || Plan::new(config.clone(), &data(8, true)).unwrap();
        let folders = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let [whole, parts] = folders.each_ref().map(|folder| folder.path());
        let mut straight = Run::begin(plan(), whole, false).unwrap();
        straight.train(&mut Warned::default(), &AtomicBool::new(false)).unwrap();
        let stop = AtomicBool::new(false);
        let mut first = Run::begin(plan(), parts, false).unwrap();
        let ending = first.train(&mut StopsAfter { rows: 6, stop: &stop }, &stop).unwrap();
        assert_eq!((ending, first.iteration()), (Ending::Interrupted, 6));
        drop(first);
        let mut second = Run::resume(plan(), parts).unwrap();
        second.train(&mut Warned::default(), &AtomicBool::new(false)).unwrap();
        assert_eq!((second.iteration(), straight.iteration()), (10, 10));
        assert_eq!(second.state.optimiser, straight.state.optimiser);
        assert_eq!(second.best(), straight.best());
        let friction = plan().architecture.friction_of_coordinates(&straight.best().weights)[0];
        let width = friction.dry.unwrap().width;
        assert!(
            friction.viscous > 0.0
                && friction.viscous != 0.01
                && (0.02..1.0).contains(&width)
                && width != 0.1
        );
    }
}

#[test]
fn a_step_that_rings_is_said() {
    let said = |friction: &str| {
        let folder = tempfile::tempdir().unwrap();
        let plan = Plan::new(rubbing(friction), &data(8, true)).unwrap();
        let mut run = Run::begin(plan, folder.path(), false).unwrap();
        let mut monitor = Warned::default();
        run.train(&mut monitor, &AtomicBool::new(false)).unwrap();
        monitor.warnings.iter().any(|warning| warning.contains("stiff for this step: a = h c/(2 m ε)"))
    };
    assert!(said("friction = { coulomb = 1.0, width = 0.001 }\n"));
    assert!(!said("friction = { coulomb = 0.001, width = 0.5 }\n") && !said(""));
}
