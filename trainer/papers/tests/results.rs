//! Tasks, their results in a folder, and the tables and pages made from them.

use leastaction_papers::folder::{FolderError, Results};
use leastaction_papers::record::{Finished, Measure, Record};
use leastaction_papers::task::{Shard, Task, run_all};
use leastaction_papers::{MODLANET, Overview, table};
use proptest::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const PAPER: &str = "paper";

fn record(model: &str, seed: u64, ours: f64) -> Record {
    Record {
        table: "Table 1".to_owned(),
        subject: vec![("system".to_owned(), "2-pendulum".to_owned())],
        model: model.to_owned(),
        is_ours: model == "ours",
        parameters: 7,
        paper_parameters: Some(70),
        seed,
        train_seconds: 1.5,
        measures: vec![
            Measure::error("test", ours, Some(0.5)),
            Measure::error("energy", 2.0, None).over(1.5),
        ],
        note: None,
        pictures: vec!["drawn.svg".to_owned()],
        details: serde_json::json!({ "test": ours }),
        is_summary: false,
    }
}

/// Creates a task that gives a record of its seed, or fails; it counts how often it is run.
fn counted(seed: u64, settings: &'static str, fails: bool, runs: Arc<AtomicUsize>) -> Task {
    Task {
        name: format!("counted-{seed}"),
        command: format!("leastaction count --seed {seed}"),
        data: "none".to_owned(),
        settings: settings.to_owned(),
        options: format!(" --of {settings}"),
        expected_seconds: 1.0,
        is_timed: seed == 1,
        run: Box::new(move |folder, tell| {
            runs.fetch_add(1, Ordering::Relaxed);
            tell("counting");
            if let Some(folder) = folder {
                std::fs::write(folder.join("drawn.svg"), "<svg><text>drawn</text></svg>")?;
            }
            if fails { Err("it cannot".into()) } else { Ok(vec![record("ours", seed, seed as f64)]) }
        }),
    }
}

fn tasks(count: u64, settings: &'static str, failing: Option<u64>) -> (Vec<Task>, Arc<AtomicUsize>) {
    let runs = Arc::new(AtomicUsize::new(0));
    let one = |seed| counted(seed, settings, failing == Some(seed), runs.clone());
    ((0..count).map(one).collect(), runs)
}

fn run(tasks: &[Task], results: &Results, jobs: usize) -> Result<Vec<Finished>, FolderError> {
    let tasks: Vec<&Task> = tasks.iter().collect();
    run_all(PAPER, &tasks, Some(results), jobs, &|_| ())
}

#[test]
fn what_is_done_is_not_done_again_and_what_failed_is() {
    let folder = tempfile::tempdir().unwrap();
    let results = Results::open(folder.path(), PAPER).unwrap();
    let (few, runs) = tasks(2, "one", None);
    run(&few, &results, 1).unwrap();
    let (all, later) = tasks(4, "one", Some(3));
    let finished = run(&all, &results, 3).unwrap();
    assert_eq!((runs.load(Ordering::Relaxed), later.load(Ordering::Relaxed)), (2, 2));
    let names: Vec<&str> = finished.iter().map(|task| task.task.as_str()).collect();
    assert_eq!(names, ["counted-0", "counted-1", "counted-2", "counted-3"]);
    assert_eq!(finished[3].failure.as_deref(), Some("it cannot"));
    assert!(finished[..3].iter().all(|task| task.failure.is_none() && task.records.len() == 1));
    let (mended, again) = tasks(4, "one", None);
    assert!(run(&mended, &results, 2).unwrap()[3].failure.is_none());
    assert_eq!(again.load(Ordering::Relaxed), 1);
    assert_eq!(results.all().unwrap(), run(&mended, &results, 1).unwrap());
}

#[test]
fn a_page_has_all_that_runs_with_the_same_options_have_given() {
    let folder = tempfile::tempdir().unwrap();
    let results = Results::open(folder.path(), PAPER).unwrap();
    let names = |(page, others): (Vec<Finished>, usize)| {
        (page.into_iter().map(|task| task.task).collect::<Vec<_>>(), others)
    };
    let counted = |of: &[u64]| of.iter().map(|k| format!("counted-{k}")).collect::<Vec<_>>();
    run(&tasks(3, "one", Some(2)).0, &results, 1).unwrap();
    let mut narrow = tasks(2, "one", None).0;
    narrow.remove(0);
    run(&narrow, &results, 1).unwrap();
    // Results of the current run come first, in its order; failures are included.
    assert_eq!(names(results.page(&narrow).unwrap()), (counted(&[1, 0, 2]), 0));
    assert_eq!(names(results.page(&tasks(9, "one", None).0).unwrap()), (counted(&[0, 1, 2]), 0));
    let mut other = tasks(4, "two", None).0.split_off(3);
    run(&other, &results, 1).unwrap();
    assert_eq!(names(results.page(&other).unwrap()), (counted(&[3]), 3));
    other.extend(narrow);
    assert_eq!(names(results.page(&other).unwrap()), (counted(&[3, 1, 0, 2]), 0));
    // Results from before options were stored belong only to their own tasks.
    let old = Finished { options: String::new(), ..results.read("counted-0").unwrap().unwrap() };
    results.write(&old).unwrap();
    assert_eq!(names(results.page(&tasks(1, "one", None).0).unwrap()), (counted(&[0, 1, 2]), 1));
}

#[test]
fn results_of_other_options_and_damaged_ones_are_refused_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let results = Results::open(folder.path(), PAPER).unwrap();
    run(&tasks(1, "one", None).0, &results, 1).unwrap();
    let before = std::fs::read(results.file("counted-0")).unwrap();
    let (other, runs) = tasks(1, "two", None);
    assert!(matches!(run(&other, &results, 1), Err(FolderError::Settings { .. })));
    assert_eq!(
        (std::fs::read(results.file("counted-0")).unwrap(), runs.load(Ordering::Relaxed)),
        (before, 0)
    );
    std::fs::write(results.file("counted-0"), "{").unwrap();
    assert!(matches!(run(&other, &results, 1), Err(FolderError::Content { .. })));
    assert_eq!(std::fs::read(results.file("counted-0")).unwrap(), b"{");
}

#[test]
fn a_failure_of_other_options_stands_in_nobodys_way() {
    let folder = tempfile::tempdir().unwrap();
    let results = Results::open(folder.path(), PAPER).unwrap();
    assert!(run(&tasks(1, "one", Some(0)).0, &results, 1).unwrap()[0].failure.is_some());
    assert!(run(&tasks(1, "two", None).0, &results, 1).unwrap()[0].failure.is_none());
}

#[test]
fn shares_join_to_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let open = |name: &str| Results::open(&folder.path().join(name), PAPER).unwrap();
    let (whole, shares, joined) = (open("whole"), [open("one"), open("two")], open("joined"));
    run(&tasks(5, "one", None).0, &whole, 2).unwrap();
    for (share, results) in ["1/2", "2/2"].into_iter().zip(&shares) {
        let shard: Shard = share.parse().unwrap();
        run(&shard.of(tasks(5, "one", None).0), results, 1).unwrap();
        joined.join(results).unwrap();
    }
    let without_time = |results: &Results| {
        let all = results.all().unwrap().into_iter();
        all.map(|task| Finished { seconds: 0.0, ..task }).collect::<Vec<_>>()
    };
    assert_eq!(without_time(&joined), without_time(&whole));
    assert!(joined.folder().join("drawn.svg").is_file());
    joined.join(&whole).unwrap();
    let (other, strange) = (open("other"), tasks(1, "two", None).0);
    run(&strange, &other, 1).unwrap();
    assert!(matches!(joined.join(&other), Err(FolderError::Twice { .. })));
}

proptest! {
    #[test]
    fn every_task_is_in_one_share(count in 0_usize..40, of in 1_usize..9) {
        let share = |index: usize| format!("{index}/{of}").parse::<Shard>().unwrap().of((0..count).collect());
        let mut all: Vec<usize> = (1..=of).flat_map(share).collect();
        all.sort_unstable();
        prop_assert_eq!(all, (0..count).collect::<Vec<_>>());
    }
}

#[test]
fn shares_that_cannot_be_are_refused() {
    for text in ["", "1", "0/2", "3/2", "1/0", "a/2", "1/2/3", "-1/2"] {
        assert!(text.parse::<Shard>().is_err(), "{text}");
    }
}

fn finished(records: Vec<Record>) -> Finished {
    Finished {
        paper: PAPER.to_owned(),
        task: "task".to_owned(),
        command: "leastaction-papers \"a,b\"".to_owned(),
        data: "of <our> own".to_owned(),
        settings: String::new(),
        options: String::new(),
        seconds: 2.0,
        failure: None,
        records,
    }
}

#[test]
fn seeds_become_medians_with_their_range() {
    let seeds = [3.0, 1.0, 2.0, f64::INFINITY].into_iter().zip(0..);
    let results = [finished(seeds.map(|(ours, seed)| record("ours", seed, ours)).collect())];
    let tables = table::tables(&results);
    let [row] = &tables[0].rows[..] else { panic!("one row") };
    let cell = row.cell(0);
    assert_eq!((cell.median, cell.range, row.seeds.len()), (Some(2.0), [1.0, 3.0], 4));
    let failed = [finished([f64::NAN, 1.0].map(|ours| record("ours", 0, ours)).to_vec())];
    assert_eq!(table::tables(&failed)[0].rows[0].cell(0).median, None);
}

#[test]
fn what_is_better_than_ours_is_said() {
    let of = |ours: f64, other: f64| {
        let results = [finished(vec![record("ours", 0, ours), record("MLP", 0, other)])];
        table::exceptions(&table::tables(&results))
    };
    assert!(of(0.1, 0.2).is_empty());
    let [paper] = &of(0.6, 0.7)[..] else { panic!("the paper is better") };
    assert!(paper.contains("the paper 0.500") && paper.contains("ours: test 0.600"), "{paper}");
    assert_eq!(of(0.3, 0.2).len(), 1);
    // There is one line per row, with everything that is better.
    let [both] = &of(f64::NAN, 0.2)[..] else { panic!("one row") };
    assert_eq!(both, "Table 1, system 2-pendulum, ours: test – (the paper 0.500, MLP 0.200)");
    let two = |ours: f64| Record {
        measures: vec![Measure::error("test", ours, Some(0.5)), Measure::error("energy", 2.0 * ours, None)],
        ..record(if ours > 1.0 { "ours" } else { "MLP" }, 0, ours)
    };
    let results = [finished(vec![two(2.0), two(0.25)])];
    let [both] = &table::exceptions(&table::tables(&results))[..] else { panic!("one row") };
    assert!(
        both.ends_with("ours: test 2.00 (the paper 0.500, MLP 0.250); energy 4.00 (MLP 0.500)"),
        "{both}"
    );
    // The energy, 2.0 with a floor of 1.5, counts as being at the floor.
    let better = Record {
        measures: vec![Measure::error("test", 1.0, None), Measure::error("energy", 0.1, None)],
        ..record("MLP", 0, 1.0)
    };
    let results = [finished(vec![record("ours", 0, 0.1), better])];
    assert!(table::exceptions(&table::tables(&results)).is_empty());
}

#[test]
fn pages_and_values_say_everything() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("drawn.svg"), "<?xml?><svg><text>drawn</text></svg>").unwrap();
    std::fs::write(folder.path().join("all.svg"), "<svg><text>overview</text></svg>").unwrap();
    let failed = Finished {
        task: "other".to_owned(),
        failure: Some("diverged".to_owned()),
        records: Vec::new(),
        ..finished(Vec::new())
    };
    let results = [finished(vec![record("ours", 0, 0.25), record("H<NN", 0, 3.5e-7)]), failed];
    let overviews = [Overview { table: "Table 1".to_owned(), file: "all.svg".to_owned() }];
    let page = table::page(&MODLANET, &results, folder.path(), &overviews);
    let said = [
        "paper 0.500",
        "ratio 0.500",
        "3.50e-7",
        "H&lt;NN",
        "of &lt;our&gt; own",
        "other: diverged",
        "floor 1.50",
    ];
    for text in
        said.into_iter().chain(["<svg><text>drawn</text></svg>", "overview", "<small>paper 70</small>"])
    {
        assert!(page.contains(text), "{text} is not in {page}");
    }
    assert!(!page.contains("<?xml") && !page.contains("http"), "{page}");
    assert_eq!(page.matches("<svg>").count(), 2, "each picture once");
    let values = table::csv(&results);
    let rows: Vec<csv::StringRecord> =
        csv::Reader::from_reader(values.as_bytes()).records().collect::<Result<_, _>>().unwrap();
    assert_eq!(rows.len(), 5);
    assert_eq!((&rows[0][2], &rows[0][7], &rows[0][12]), ("ours", "2.5e-1", "leastaction-papers \"a,b\""));
    assert_eq!(&rows[4][11], "failed: diverged");
    let text = table::text(&results);
    for words in ["Table 1", "2-pendulum", "  paper", "  floor", "other failed: diverged", "(H<NN 3.50e-7)"] {
        assert!(text.contains(words), "{words} is not in {text}");
    }
}
