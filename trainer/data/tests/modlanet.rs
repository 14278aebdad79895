//! Files in the layout of the ModLaNet authors: round trips, and error messages.

#[path = "common/npy.rs"]
mod npy;

use std::fs::File;
use std::io::Write;

use leastaction_data::modlanet::{self, ModlanetRows, ModlanetSet};
use leastaction_data::{Place, Rows};
use npy::f8;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

fn table(rows: usize, n: usize, from: f64) -> Rows {
    Rows::from_flat(n, (0..rows * n).map(|k| from + k as f64 / 3.0).collect()).unwrap()
}

/// The given number of rows of a motion with two coordinates.
fn part(rows: usize) -> ModlanetRows {
    let column = |from| table(rows, 1, from).as_flat().to_vec();
    ModlanetRows {
        q: table(rows, 2, 0.0),
        v: table(rows, 2, 1.0),
        a: table(rows, 2, -5.0),
        t: Some(column(0.0)),
        energy: Some(column(2.0)),
    }
}

fn small() -> ModlanetSet {
    ModlanetSet { train: part(77), test: part(7) }
}

#[test]
fn written_and_read_it_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("set.npz");
    let mut set = small();
    modlanet::write(&path, &set).unwrap();
    assert_eq!(modlanet::read(&path).unwrap(), set);
    (set.train.t, set.test.energy) = (None, None);
    modlanet::write(&path, &set).unwrap();
    assert_eq!(modlanet::read(&path).unwrap(), set);
}

/// The error of reading or writing a small set after a change.
fn refused(change: impl FnOnce(&mut ModlanetSet)) -> String {
    let folder = tempfile::tempdir().unwrap();
    let mut set = small();
    change(&mut set);
    modlanet::write(folder.path().join("set.npz"), &set).unwrap_err().to_string()
}

#[test]
fn sets_that_could_not_be_read_are_not_written() {
    let wide = || table(2, 3, 0.5);
    let width = refused(|set| {
        set.test = ModlanetRows { q: wide(), v: wide(), a: wide(), t: None, energy: None };
    });
    assert!(width.contains("key test_x: q has 3 columns where 2 are needed"), "{width}");
    let rows = refused(|set| set.train.v = table(5, 2, 0.5));
    assert!(rows.contains("key v: v has 5 samples where 77 are needed"), "{rows}");
    let nan = refused(|set| set.test.energy.as_mut().unwrap()[2] = f64::NAN);
    assert!(nan.contains("key test_E: NaN is not finite"), "{nan}");
}

/// The error of reading these arrays.
fn unreadable(arrays: &[(&str, &[usize], Vec<f64>)]) -> (Place, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("set.npz");
    let mut zip = ZipWriter::new(File::create(&path).unwrap());
    for (key, shape, values) in arrays {
        zip.start_file(format!("{key}.npy"), SimpleFileOptions::default()).unwrap();
        let axes: String = shape.iter().map(|axis| format!("{axis}, ")).collect();
        zip.write_all(&f8(&format!("({axes})"), values)).unwrap();
    }
    zip.finish().unwrap();
    let error = modlanet::read(path).unwrap_err();
    (error.place.clone(), error.to_string())
}

#[test]
fn errors_name_the_key_and_the_row() {
    let three = || vec![0.5; 6];
    let (place, text) = unreadable(&[("x", &[3, 2], three()), ("v", &[3, 2], three())]);
    assert!(place == Place::File && text.ends_with("ac is missing"), "{text}");
    let (place, text) = unreadable(&[("x", &[6], three())]);
    assert!(place == Place::Key("x".to_owned()) && text.contains("[6] where [rows, n]"), "{text}");
    let (place, text) = unreadable(&[("x", &[3, 2], three()), ("v", &[2, 3], three())]);
    assert!(place == Place::Key("v".to_owned()) && text.contains("[2, 3] where [3, 2] as of x"), "{text}");
    let mut broken = three();
    broken[3] = f64::NAN;
    let (place, _) = unreadable(&[("x", &[3, 2], three()), ("v", &[3, 2], broken)]);
    assert_eq!(place, Place::Row { key: "v".to_owned(), row: 1 });
    let part = |t: &'static [usize]| {
        let times = vec![0.0; t.iter().product()];
        [("x", &[3usize, 2][..], three()), ("v", &[3, 2], three()), ("ac", &[3, 2], three()), ("t", t, times)]
    };
    let (place, text) = unreadable(&part(&[2, 1]));
    assert!(place == Place::Key("t".to_owned()) && text.contains("[3, 1]"), "{text}");
    let (_, text) = unreadable(&part(&[3]));
    assert!(text.ends_with("test_x is missing"), "{text}");
}
