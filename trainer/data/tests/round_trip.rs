//! Round trips: written data is read back bit for bit.

use leastaction_core::forces::ControlKind;
use leastaction_data::symo::{self, SymoSet};
use leastaction_data::{self as data, CONTROL_KINDS, Dataset, Place, Problem, Rows, Trajectory};
use proptest::prelude::*;

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![proptest::num::f64::NORMAL, proptest::num::f64::SUBNORMAL, -10.0..10.0, Just(0.0), Just(-0.0)]
}

fn rows(n: usize, samples: usize) -> impl Strategy<Value = Rows> {
    prop::collection::vec(number(), n * samples).prop_map(move |values| Rows::from_flat(n, values).unwrap())
}

fn field(given: bool, n: usize, samples: usize) -> BoxedStrategy<Option<Rows>> {
    if given { rows(n, samples).prop_map(Some).boxed() } else { Just(None).boxed() }
}

fn trajectory(n: usize, given: [bool; 3]) -> impl Strategy<Value = Trajectory> {
    (3..9_usize, -1e3..1e3).prop_flat_map(move |(samples, t0)| {
        let fields = (field(given[0], n, samples), field(given[1], n, samples), field(given[2], n, samples));
        (rows(n, samples), fields).prop_map(move |(q, (v, a, u))| Trajectory { id: 0, t0, q, v, a, u })
    })
}

fn dataset() -> impl Strategy<Value = Dataset> {
    let kinds = prop::option::of(prop::sample::select(CONTROL_KINDS.to_vec()));
    let sizes = (1..4_usize, any::<[bool; 3]>(), 1e-3..1e3, any::<i64>(), kinds);
    sizes.prop_flat_map(|(n, given, h, first, kind)| {
        prop::collection::vec(trajectory(n, given), 1..5).prop_map(move |mut trajectories| {
            for (motion, i) in trajectories.iter_mut().zip(0..) {
                motion.id = first.wrapping_add(i);
            }
            Dataset { n, h, control: kind.map(|(_, kind)| kind), trajectories }
        })
    })
}

fn symo_part(trajectories: usize, samples: usize) -> impl Strategy<Value = Dataset> {
    let n = 2;
    let motion = (rows(n, samples), rows(n, samples), prop::collection::vec(number(), samples));
    prop::collection::vec(motion, trajectories).prop_map(move |motions| {
        let motions = (0..).zip(motions);
        let trajectories = motions.map(|(id, (q, v, u))| {
            let u = Rows::from_rows(n, u.iter().map(|&u| [0.0, u])).unwrap();
            Trajectory { id, t0: 0.0, q, v: Some(v), a: None, u: Some(u) }
        });
        Dataset { n, h: 0.05, control: Some(ControlKind::Linear), trajectories: trajectories.collect() }
    })
}

/// The bits of all numbers, so that −0 and 0 differ.
fn bits(data: &Dataset) -> Vec<u64> {
    let fields = |t: &Trajectory| [Some(t.q.clone()), t.v.clone(), t.a.clone(), t.u.clone()];
    let values = data.trajectories.iter().flat_map(fields).flatten().flat_map(|rows| rows.as_flat().to_vec());
    let times = data.trajectories.iter().map(|t| t.t0);
    [data.h].into_iter().chain(times).chain(values).map(f64::to_bits).collect()
}

fn same(data: &Dataset, name: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    data::write(&path, data).unwrap();
    let (back, notes) = data::read(&path).unwrap();
    assert_eq!((&back, &notes[..]), (data, &[][..]));
    assert_eq!(bits(&back), bits(data));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn npz(data in dataset()) {
        same(&data, "a.npz");
    }

    #[test]
    fn csv(data in dataset()) {
        same(&data, "a.csv");
    }

    #[test]
    fn symo_layout(train in symo_part(3, 5), test in symo_part(2, 5), integration in symo_part(1, 8)) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("set.npz");
        let set = SymoSet { train, test, integration };
        symo::write(&path, &set, 1).unwrap();
        let back = symo::read(&path, 0.05, 1).unwrap();
        prop_assert_eq!(bits(&back.train), bits(&set.train));
        prop_assert_eq!(back, set);
    }
}

fn motion(id: i64) -> Trajectory {
    let q = Rows::from_flat(2, vec![0.0; 6]).unwrap();
    Trajectory { id, t0: 0.0, v: Some(q.clone()), a: None, u: Some(q.clone()), q }
}

fn pair() -> Dataset {
    Dataset { n: 2, h: 0.1, control: None, trajectories: vec![motion(0), motion(1)] }
}

#[test]
fn the_same_data_give_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let written = |name: &str| {
        let path = folder.path().join(name);
        data::write(&path, &pair()).unwrap();
        std::fs::read(path).unwrap()
    };
    assert_eq!(written("a.npz"), written("b.npz"));
}

/// A change that spoils the data of [`pair`], and the error message.
type Spoiled<'a> = (fn(&mut Dataset), &'a str);

#[track_caller]
fn assert_not_written(cases: &[Spoiled]) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.npz");
    for (spoil, message) in cases {
        let mut data = pair();
        spoil(&mut data);
        let error = data::write(&path, &data).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
        assert!(!path.exists());
    }
}

#[test]
fn what_does_not_fit_together_is_not_written() {
    assert_not_written(&[
        (
            |d| d.trajectories[1].id = 0,
            "out.npz, trajectory 0: trajectory 0 is there twice; number the trajectories differently",
        ),
        (|d| d.n = 3, "out.npz, trajectory 0: q has 2 columns where 3 are needed"),
        (
            |d| d.trajectories[1].v = Rows::from_flat(2, vec![0.0; 8]),
            "out.npz, trajectory 1: v has 4 samples where 3 are needed",
        ),
        (
            |d| d.trajectories[1].u = Rows::from_flat(1, vec![0.0; 3]),
            "out.npz, trajectory 1: u has 1 columns where 2 are needed",
        ),
        (
            |d| d.trajectories[0].v = None,
            "out.npz: v is given for some trajectories only; give it for all or none",
        ),
        (
            |d| d.trajectories[0].a = Rows::from_flat(2, vec![0.0; 6]),
            "out.npz: a is given for some trajectories only; give it for all or none",
        ),
    ]);
}

#[test]
fn what_could_not_be_read_back_is_not_written() {
    assert_not_written(&[
        (|d| d.h = 0.0, "out.npz: the step h is 0 s; it must be positive and finite"),
        (|d| d.trajectories.clear(), "out.npz: no samples; at least 3 of them make a trajectory"),
        (
            |d| d.trajectories[1].q = Rows::from_flat(2, vec![0.0; 4]).unwrap(),
            "out.npz, trajectory 1: trajectory 1 has 2 samples; at least 3 are needed",
        ),
        (
            |d| d.trajectories[0].q = Rows::from_flat(2, vec![f64::NAN; 6]).unwrap(),
            "out.npz, trajectory 0: NaN is not finite; remove the sample (a gap in t splits the trajectory there)",
        ),
        (
            |d| d.trajectories[0].t0 = f64::INFINITY,
            "out.npz, trajectory 0: inf is not finite; remove the sample (a gap in t splits the trajectory there)",
        ),
        (|d| d.trajectories[0].t0 = 1e17, "out.npz, trajectory 0: the stamps are rounded by "),
    ]);
}

#[test]
fn a_failed_write_keeps_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    data::write(&path, &pair()).unwrap();
    let before = std::fs::read(&path).unwrap();
    let mut broken = pair();
    broken.h = f64::NAN;
    data::write(&path, &broken).unwrap_err();
    assert_eq!(std::fs::read(&path).unwrap(), before);
    let lost = data::write(folder.path().join("no/folder.csv"), &pair()).unwrap_err();
    assert!(matches!(&lost.problem, Problem::Io(e) if e.kind() == std::io::ErrorKind::NotFound), "{lost}");
}

#[test]
fn the_symo_layout_refuses_what_it_cannot_hold() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("set.npz");
    let attempt = |spoil: fn(&mut Dataset), actuated| {
        let mut set = SymoSet { train: pair(), test: pair(), integration: pair() };
        spoil(&mut set.test);
        symo::write(&path, &set, actuated).map_err(|error| (error.place, error.problem.to_string()))
    };
    attempt(|_| (), 0).unwrap();
    let second = attempt(|d| d.trajectories[1].u = Rows::from_flat(2, vec![0.0, 0.0, 1.0, 0.0, 0.0, 2.0]), 0);
    let message =
        "u is not 0 at coordinate 1; this layout stores the control of the actuated coordinate only";
    assert_eq!(second, Err((Place::Trajectory(1), message.to_owned())));
    let held = attempt(
        |d| {
            d.control = Some(ControlKind::Held);
            d.trajectories[1].u = Rows::from_flat(2, vec![0.0, 0.0, 1.0, 0.0, 2.0, 0.0]);
        },
        0,
    );
    let message =
        "u is held between samples; this layout stores a control that is linear between them, or constant";
    assert_eq!(held, Err((Place::Key("test_u".to_owned()), message.to_owned())));
    let absent = attempt(|d| d.trajectories.iter_mut().for_each(|t| t.v = None), 0);
    assert_eq!(absent, Err((Place::Trajectory(0), "v is missing".to_owned())));
    let longer = attempt(
        |d| {
            let q = Rows::from_flat(2, vec![0.0; 8]).unwrap();
            d.trajectories[1] = Trajectory { v: Some(q.clone()), u: Some(q.clone()), q, ..motion(1) };
        },
        0,
    );
    assert_eq!(longer, Err((Place::Trajectory(1), "q has 4 samples where 3 are needed".to_owned())));
    let beyond = attempt(|_| (), 2);
    assert_eq!(
        beyond,
        Err((
            Place::Trajectory(0),
            "coordinate 2 cannot be the actuated one of 2; it is counted from 0".to_owned()
        ))
    );
}
