//! Identified numbers, written into descriptions and read again.

use super::{BODY, chain, joint, link, robot};
use leastaction_models::tree::{Inertia, Tree};
use leastaction_models::urdf::{
    Described, Followers, Format, Identified, JointNumbers, MARK, Options, WriteNote, Written, parse_with,
    write_back,
};
use nalgebra::{Matrix3, Vector3};
use std::fs;
use std::path::PathBuf;

/// Two links on each other with a tip fixed to the first, what is on the base, and things that are not read.
fn urdf() -> String {
    let at = "<origin xyz='0.1 0.3 0.2' rpy='0.2 1.5707963267948966 1'/>";
    robot(&chain(&[
        "<link name='b'/>".to_owned(),
        link("tip"),
        link("camera"),
        "<link name='c'><visual><geometry><mesh filename='c.stl'/></geometry></visual></link>".to_owned(),
        format!("<link name='finger'>{BODY}</link>"),
        joint("fix", "fixed", ["a", "tip"], at),
        joint("see", "fixed", ["base", "camera"], at),
        joint(
            "k",
            "prismatic",
            ["a", "b"],
            &format!("{at}<axis xyz='1 2 0'/><limit lower='-1' upper='2' effort='9'/>"),
        ),
        joint("l", "revolute", ["b", "c"], &format!("{at}<axis xyz='0 1 1'/><dynamics damping='7'/>")),
        joint(
            "m",
            "revolute",
            ["a", "finger"],
            &format!("{at}<axis xyz='0 1 1'/><limit lower='-1' upper='1'/>"),
        ),
    ]))
    .replace("<link name='c'>", &format!("<link name='c'>{BODY}"))
}

const MJCF: &str = "<mujoco model='m'>
  <option gravity='0.5 0 -9'/>
  <default><joint armature='0.3' damping='1'/><geom density='700'/></default>
  <worldbody>
    <!-- the arm -->
    <body name='a' pos='0.1 0.2 0.3' euler='10 20 30'>
      <joint name='j' axis='0 1 0.5' pos='0.05 0.1 -0.2' ref='20' range='-90 80'/>
      <geom type='capsule' size='0.05 0.2'/>
      <body name='welded' pos='0 0 0.3'><geom type='box' size='0.1 0.2 0.05'/></body>
      <body name='b' pos='0.3 0 0.1' zaxis='1 0 1'>
        <inertial pos='0.1 0 0.2' mass='1.5' diaginertia='0.02 0.03 0.04'/>
        <joint name='k' axis='1 0 0'/>
        <joint name='l' type='slide' axis='0 1 0.2'/>
        <joint name='m' axis='0 0 1' pos='0.2 0.1 0' armature='0.1'/>
      </body>
    </body>
  </worldbody>
</mujoco>
";

fn options(joints: Option<&[&str]>) -> Options {
    let joints = joints.map(|joints| joints.iter().map(ToString::to_string).collect());
    let lock = if joints.is_some() { [("m".to_owned(), 0.4)].into() } else { [].into() };
    Options { joints, lock, followers: Followers::Held, ..Options::default() }
}

/// Other bodies with mass, rotors and friction for the joints of a tree.
fn identified(tree: &Tree) -> Identified {
    let mut tree = tree.clone();
    let mut numbers = tree.parameters();
    let (inertias, rotors) = numbers.split_at_mut(10 * tree.bodies().len());
    for (k, inertia) in
        inertias.as_chunks_mut().0.iter_mut().enumerate().filter(|(_, inertia)| inertia[0] > 0.0)
    {
        let k = k as f64;
        let spread = Matrix3::new(0.3, 0.01, 0.02, 0.01, 0.4, -0.03, 0.02, -0.03, 0.5);
        *inertia = Inertia::of_centre(3.1 + k, Vector3::new(0.1 * k, 0.21, -0.3), spread * (1.0 + k)).0;
    }
    rotors.iter_mut().enumerate().for_each(|(k, rotor)| *rotor = 0.17 + 0.01 * k as f64);
    tree = tree.with_parameters(&numbers);
    let joint = |k: usize| JointNumbers { damping: Some(0.5 + k as f64), friction: Some(0.25 + k as f64) };
    Identified { joints: (0..tree.coordinates()).map(joint).collect(), tree }
}

/// The written text, and the numbers that were written.
fn written(name: &str, text: &str, options: &Options, format: Format) -> (Written, Identified) {
    let path: PathBuf =
        std::env::temp_dir().join(format!("leastaction-written-{name}-{}", std::process::id()));
    fs::write(&path, text).unwrap();
    let identified = identified(&parse_with(text, options).unwrap().tree);
    let written = write_back(&path, options, &identified, format).unwrap();
    fs::remove_file(&path).unwrap();
    (written, identified)
}

fn forces(tree: &Tree, names: &[&str]) -> Vec<f64> {
    let n = tree.coordinates();
    let place = |k: usize| names.iter().position(|name| *name == tree.coordinate_name(k)).unwrap() as f64;
    let state = |f: fn(f64) -> f64| (0..n).map(|k| f(place(k))).collect::<Vec<f64>>();
    let [q, v, a] =
        [|k: f64| 0.3 + 0.7 * (k + 1.0).sin(), |k: f64| (1.3 * k).cos(), |k: f64| (2.0 * k).sin()].map(state);
    let found = tree.inverse_dynamics(&q, &v, &a);
    names
        .iter()
        .filter_map(|name| (0..n).find(|k| tree.coordinate_name(*k) == *name))
        .map(|k| found[k])
        .collect()
}

/// Reading what was written gives the dynamics that were written; `rotors` says whether rotors are read.
fn same(text: &str, options: &Options, identified: &Identified, rotors: bool) -> Described {
    let mut read = parse_with(text, options).unwrap();
    if !rotors {
        read.tree.rotors.clone_from(&identified.tree.rotors);
        read.tree.gravity = identified.tree.gravity;
    }
    let names: Vec<&str> =
        (0..identified.tree.coordinates()).map(|k| identified.tree.coordinate_name(k)).collect();
    let [found, expected] = [&read.tree, &identified.tree].map(|tree| forces(tree, &names));
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-11 * expected.abs().max(1.0), "{found:?} {expected:?}\n{text}");
    }
    read
}

#[test]
fn a_urdf_file_is_edited() {
    let choice = options(Some(&["j", "k", "l"]));
    let (Written { text, is_edited, notes }, identified) = written("edit", &urdf(), &choice, Format::Urdf);
    assert!(is_edited && text.trim_end().ends_with(MARK));
    same(&text, &choice, &identified, false);
    assert!(text.contains("<mesh filename='c.stl'/>"), "{text}");
    let camera = text.find("<link name='camera'>").unwrap();
    assert!(text[camera..].starts_with(&link("camera")), "on the base nothing changes: {text}");
    assert!(text.contains("<link name='tip'></link>"), "{text}");
    assert!(text.contains("<dynamics friction=\"2.25\" damping='2.5'/>"), "{text}");
    assert!(text.contains("<dynamics damping=\"0.5\" friction=\"0.25\"/>"), "{text}");
    assert!(text.contains("<!-- inertia of the rotor (armature): 0.17 -->"), "{text}");
    assert!(notes.contains(&WriteNote::Rotors), "{notes:?}");
    assert!(
        notes.iter().any(|note| matches!(note, WriteNote::Held { joints } if *joints == ["m"])),
        "{notes:?}"
    );
    let (again, _) = written("again", &text, &choice, Format::Urdf);
    assert_eq!(again.text, text, "writing the same numbers again changes nothing");
}

#[test]
fn a_urdf_file_becomes_an_mjcf_file() {
    for choice in [options(None), options(Some(&["j", "k", "l"]))] {
        let (Written { text, is_edited, notes }, identified) =
            written("to-mjcf", &urdf(), &choice, Format::Mjcf);
        assert!(!is_edited && notes.iter().any(|note| matches!(note, WriteNote::Fresh { .. })), "{notes:?}");
        let read = same(&text, &options(None), &identified, true);
        assert!(text.contains(" armature=\"0.17\" damping=\"0.5\" frictionloss=\"0.25\"/>"), "{text}");
        assert_eq!(read.tree.bodies()[1].limits.position, identified.tree.bodies()[1].limits.position);
    }
}

#[test]
fn an_mjcf_file_is_edited() {
    let choice = options(None);
    let (Written { text, is_edited, notes }, mut identified) = written("mjcf", MJCF, &choice, Format::Mjcf);
    assert!(is_edited && notes.is_empty(), "{notes:?}");
    same(&text, &choice, &identified, true);
    assert!(
        text.contains("<!-- the arm -->") && text.contains("<geom type='capsule' size='0.05 0.2'/>"),
        "{text}"
    );
    assert!(
        text.contains("<joint armature=\"0.17\" damping=\"0.5\" frictionloss=\"0.25\" name='j'"),
        "{text}"
    );
    assert!(text.contains("armature='0.2'"), "{text}");
    identified.tree.gravity = Vector3::new(0.0, 0.0, -1.6);
    let path = std::env::temp_dir().join(format!("leastaction-moon-{}", std::process::id()));
    fs::write(&path, MJCF).unwrap();
    let moon = write_back(&path, &choice, &identified, Format::Mjcf).unwrap().text;
    fs::remove_file(&path).unwrap();
    assert_eq!(parse_with(&moon, &choice).unwrap().tree.gravity, identified.tree.gravity);
}

#[test]
fn settings_that_would_change_the_numbers_again_are_left_behind() {
    let changed = MJCF.replace("<option", "<compiler settotalmass='9' angle='degree'/><option");
    let (Written { text, is_edited, .. }, identified) =
        written("total", &changed, &options(None), Format::Mjcf);
    assert!(!is_edited && !text.contains("settotalmass"), "{text}");
    same(&text, &options(None), &identified, true);
}

#[test]
fn an_mjcf_file_becomes_a_urdf_file() {
    let (Written { text, notes, .. }, identified) = written("to-urdf", MJCF, &options(None), Format::Urdf);
    same(&text, &options(None), &identified, false);
    assert!(notes.contains(&WriteNote::Gravity { gravity: [0.5, 0.0, -9.0] }), "{notes:?}");
    assert!(text.contains("<dynamics damping=\"0.5\" friction=\"0.25\"/>"), "{text}");
}

#[test]
fn a_description_with_other_joints_is_refused() {
    let path = std::env::temp_dir().join(format!("leastaction-other-{}", std::process::id()));
    let identified = identified(&parse_with(&urdf(), &options(None)).unwrap().tree);
    fs::write(&path, urdf().replace("0 1 1", "0 1 0.9")).unwrap();
    let error = write_back(&path, &options(None), &identified, Format::Urdf).unwrap_err().to_string();
    fs::remove_file(&path).unwrap();
    assert!(error.contains("no longer has the joints"), "{error}");
}
