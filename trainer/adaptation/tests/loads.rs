//! Loads on simulated machines: how they are found, announced, and given to the model.

mod common;

use common::{AS_LEARNED, H, Machine, N, model};
use leastaction_adaptation::{
    AdaptationError, Choice, Course, Followed, Request, along, deviations, on_chip, remaining,
};
use leastaction_data::Dataset;
use leastaction_models::Model;

fn choice(request: &Request) -> Choice {
    let model = model();
    let mut choice = Choice::new(&model, H, request).expect("a choice");
    let log = AS_LEARNED.log(30.0, 1);
    let found = on_chip(&model, |chip| deviations((&model, chip), &choice, &log)).expect("deviations");
    choice.settings.deviation = found;
    choice
}

fn follow(choice: &Choice, log: &Dataset) -> Course {
    let model = model();
    on_chip(&model, |chip| along((&model, chip), choice, log)).expect("a course")
}

#[test]
fn a_load_is_found_and_announced() {
    let choice = choice(&Request::default());
    let course = follow(&choice, &Machine { mass: 1.0, ..AS_LEARNED }.log(20.0, 2));
    let mass = course.entries.last().expect("windows").estimates[0];
    assert!((mass.estimate - 1.0).abs() < 0.03, "{mass:?}");
    assert!(mass.error < 0.01 && (mass.estimate - 1.0).abs() < 4.0 * mass.error, "{mass:?}");
    let (_, announced) = course.announced.expect("an announcement");
    assert!(course.moving < 3.0, "after {} s: {announced:?}", course.moving);
    assert!(course.entries.iter().all(|entry| !entry.unlike));
}

#[test]
fn the_adapted_model_carries_the_load() {
    let (choice, model, loaded) = (choice(&Request::default()), model(), Machine { mass: 1.0, ..AS_LEARNED });
    let course = follow(&choice, &loaded.log(20.0, 2));
    let applied = &course.entries.last().expect("windows").applied;
    let adapted = choice.adapted(&model, applied).expect("a model");
    let log = loaded.log(10.0, 7);
    let unexplained =
        |model: &Model| on_chip(model, |chip| deviations((model, chip), &choice, &log)).expect("deviations");
    for (before, after) in unexplained(&model).into_iter().zip(unexplained(&adapted)) {
        assert!(after < 0.03 * before, "{after} N m of {before} N m");
    }
}

/// Sum of the squares of all residuals.
fn squares(of: &[Vec<f32>]) -> f32 {
    of.iter().flatten().map(|x| x * x).sum()
}

#[test]
fn numbers_in_use_leave_less_unexplained() {
    let (model, loaded) = (model(), Machine { mass: 1.0, ..AS_LEARNED });
    // A second trajectory, after one that does not end with a window.
    let mut log = loaded.log(10.3, 2);
    log.trajectories.extend(loaded.log(10.0, 7).trajectories);
    let followed = Followed::new(&model, &log, Some(&AS_LEARNED.log(30.0, 1)), &Request::default());
    let Followed { choice, mut course, .. } = followed.expect("numbers");
    let residuals: Vec<_> = course.entries.iter().map(|entry| entry.residuals.clone()).collect();
    let left = remaining(&model, &choice, &log, &course).expect("a balance");
    assert_eq!(left.len(), residuals.len());
    let late = residuals.len() / 2;
    let (before, after) = (squares(&residuals[late..]), squares(&left[late..]));
    assert!(after < 0.01 * before, "{after} of {before}");
    // With the numbers of the file, the balance is that which the adapter saw.
    course.entries.iter_mut().for_each(|entry| entry.applied.fill(0.0));
    let same = remaining(&model, &choice, &log, &course).expect("a balance");
    for (same, seen) in same.iter().flatten().zip(residuals.iter().flatten()) {
        assert!((same - seen).abs() < 1e-4 * before.sqrt(), "{same} instead of {seen}");
    }
}

#[test]
fn nothing_is_announced_where_nothing_is_attached() {
    let choice = choice(&Request::default());
    for seed in 3..6 {
        let course = follow(&choice, &AS_LEARNED.log(30.0, seed));
        assert_eq!(course.announced, None);
        let mass = course.entries.last().expect("windows").estimates[0];
        assert!(mass.estimate.abs() < 4.0 * mass.error, "{mass:?}");
        assert!(course.entries.iter().all(|entry| !entry.changed));
    }
}

#[test]
fn friction_that_grew_is_followed() {
    let choice = choice(&Request::default());
    let course = follow(&choice, &Machine { mass: 0.0, friction: 1.5 }.log(30.0, 9));
    let last = course.entries.last().expect("windows");
    let friction = choice.settings.numbers.iter().zip(&last.estimates).skip(10 + N);
    for (number, found) in friction {
        let grown = f64::from(found.estimate / number.model);
        assert!((grown - 0.5).abs() < 0.15, "{:?}: {grown}", number.number);
    }
    assert_eq!(course.announced, None);
}

#[test]
fn friction_that_grows_for_a_minute_is_followed() {
    let choice = choice(&Request::default());
    let course = follow(&choice, &AS_LEARNED.wearing(60.0, 11, 0.5));
    let last = course.entries.last().expect("windows");
    for (number, found) in choice.settings.numbers.iter().zip(&last.estimates).skip(10) {
        let grown = found.estimate / number.model;
        assert!((grown - 0.5).abs() < 0.05, "{:?}: {grown}", number.number);
    }
    assert_eq!((course.announced, course.changes()), (None, vec![]));
}

#[test]
fn wrong_requests_are_refused() {
    let (model, log) = (model(), AS_LEARNED.log(2.0, 1));
    let request = Request { body: Some(3), ..Request::default() };
    let expected = AdaptationError::NoSuchBody { found: 3, count: 3 };
    assert_eq!(Choice::new(&model, H, &request), Err(expected));
    let long = choice(&Request { window: Some(10.0), ..Request::default() });
    let short = on_chip(&model, |chip| deviations((&model, chip), &long, &log));
    assert!(matches!(short, Err(AdaptationError::TooShort { .. })), "{short:?}");
    let mut bare = log.clone();
    bare.trajectories[0].u = None;
    let bare = on_chip(&model, |chip| along((&model, chip), &long, &bare)).map(|_| ());
    assert_eq!(bare, Err(AdaptationError::NoCommands { id: 0 }));
}
