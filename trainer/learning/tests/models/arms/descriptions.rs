//! Descriptions with bodies that cannot be, and with joints that the log does not have.

use super::{H, LEARNED, N, config_of, data, description, motion, robot, write};
use leastaction_core::forces::ControlKind;
use leastaction_learning::config::Config;
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::run::{Notice, Plan};
use leastaction_learning::torques::torque_errors;
use leastaction_models::Model;
use leastaction_models::tree::Tree;
use leastaction_models::urdf::DescriptionNote;
use std::path::Path;

/// The last link of the description with other moments of inertia, at its joint or where it was.
fn with_last(moments: &str, on_axis: bool) -> String {
    let usual = description(2.0);
    let start = usual.find("<link name=\"link3\">").unwrap();
    let end = start + usual[start..].find("</link>").unwrap();
    let place = if on_axis { "0 0 0" } else { "0.05 0.02 0.1" };
    let last = format!(
        "<link name=\"link3\"><inertial><origin xyz=\"{place}\"/><mass value=\"1\"/><inertia {moments} ixy=\"0\" ixz=\"0\" \
         iyz=\"0\"/></inertial>"
    );
    let text = format!("{}{last}{}", &usual[..start], &usual[end..]);
    text.replace("prismatic", "revolute")
}

fn described(config: &Config) -> (Tree, Vec<DescriptionNote>) {
    let plan = Plan::new(config.clone(), &data()).unwrap();
    let notes = plan.notices().iter().filter_map(|notice| match notice {
        Notice::Described(note) => Some(note.clone()),
        _ => None,
    });
    let (architecture, weights) = config.beginning().unwrap();
    (architecture.family.arm().unwrap().host_tree(&weights).unwrap(), notes.collect())
}

fn tree_of(folder: &Path, text: &str, rest: &str) -> (Tree, Vec<DescriptionNote>) {
    write(folder, text);
    described(&config_of(folder, rest).unwrap())
}

const POINT: &str = "ixx=\"0\" iyy=\"0\" izz=\"0\"";

#[test]
fn a_mass_without_extent_becomes_a_ball_where_it_is_learned() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for on_axis in [false, true] {
        let (tree, notes) = tree_of(path, &with_last(POINT, on_axis), &format!("radius = 0.2\n{LEARNED}"));
        let [note @ DescriptionNote::Extent { body, radius: 0.2, .. }] = &notes[..] else {
            panic!("{notes:?}")
        };
        assert_eq!((&*body.link, &*body.joint), ("link3", "joint3"));
        assert!(note.to_string().contains("no extent") && note.to_string().contains("guessed"), "{note}");
        for moment in tree.bodies()[2].inertia.principal_moments() {
            assert!((moment - 0.4 * 0.2 * 0.2).abs() < 1e-12, "{moment}");
        }
    }
}

#[test]
fn a_known_mass_stays_a_point_unless_its_joint_moves_nothing_then() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let rest = format!("bodies = \"known\"\nrotors = \"known\"\n{LEARNED}");
    let (tree, notes) = tree_of(path, &with_last(POINT, false), &rest);
    assert!(notes.is_empty() && tree.bodies()[2].inertia.principal_moments()[2].abs() < 1e-15, "{notes:?}");
    let (tree, notes) = tree_of(path, &with_last(POINT, true), &rest);
    assert!(matches!(notes[..], [DescriptionNote::Extent { .. }]), "{notes:?}");
    assert!(tree.mass_matrix(&[0.1, 0.2, 0.3])[2][2] > 1e-4);
    let (_, notes) = tree_of(path, &with_last(POINT, true), &rest.replace("rotors = \"known\"", ""));
    assert_eq!(notes, []);
}

#[test]
fn a_known_point_may_be_beside_learned_bodies() {
    let folder = tempfile::tempdir().unwrap();
    for rotors in ["learned", "known"] {
        let rest = format!("bodies = [\"joint1\"]\nrotors = \"{rotors}\"\n{LEARNED}");
        let (tree, notes) = tree_of(folder.path(), &with_last(POINT, false), &rest);
        assert!(notes.is_empty(), "{notes:?}");
        assert!(tree.bodies()[2].inertia.principal_moments()[2].abs() < 1e-15, "{tree:?}");
    }
}

#[test]
fn a_learned_body_that_is_infinitely_thin_is_thickened() {
    let folder = tempfile::tempdir().unwrap();
    let text = with_last("ixx=\"0\" iyy=\"0.02\" izz=\"0.02\"", false);
    let (tree, notes) = tree_of(folder.path(), &text, LEARNED);
    let [DescriptionNote::Thin { change, .. }] = notes[..] else { panic!("{notes:?}") };
    assert!(change < 2e-4, "{change}");
    let text = notes[0].to_string();
    assert!(text.ends_with("which changes its moments of inertia by 0.02 %"), "{text}");
    assert!(tree.bodies().iter().all(|body| body.inertia.consistency() > 0.0));
    let text = with_last("ixx=\"0.02\" iyy=\"0.01000099\" izz=\"0.01000099\"", false);
    let (_, notes) = tree_of(folder.path(), &text, LEARNED);
    assert!(notes[0].to_string().ends_with("by less than 0.01 %"), "{notes:?}");
}

#[test]
fn an_impossible_body_is_noted_once_known_or_learned() {
    let folder = tempfile::tempdir().unwrap();
    for rest in [LEARNED.to_owned(), format!("bodies = \"known\"\n{LEARNED}")] {
        let text = with_last("ixx=\"0.02\" iyy=\"0.02\" izz=\"0.2\"", false);
        let (tree, notes) = tree_of(folder.path(), &text, &rest);
        let [note @ DescriptionNote::Inertia { .. }] = &notes[..] else { panic!("{notes:?}") };
        assert!(note.to_string().contains("GROSSLY"), "{note}");
        assert!(tree.bodies()[2].inertia.principal_spreads()[0] > 0.0);
    }
}

/// A log of the robot without rotors and friction, whose last joint rests at `at`, without that joint.
fn without_last(at: f64) -> Dataset {
    const LEFT: usize = N - 1;
    let mut tree = robot().tree;
    tree.rotors = vec![0.0; N];
    let states: Vec<[[f64; N]; 3]> = (0..400)
        .map(|k| motion(0, f64::from(k) * H))
        .map(|[[q1, q2, _], [v1, v2, _], [a1, a2, _]]| [[q1, q2, at], [v1, v2, 0.0], [a1, a2, 0.0]])
        .collect();
    let rows = |of: &dyn Fn(&[[f64; N]; 3]) -> Vec<f64>| {
        let numbers = states.iter().flat_map(|state| of(state)[..LEFT].to_vec());
        Rows::from_flat(LEFT, numbers.collect()).unwrap()
    };
    let (q, v) = (rows(&|state| state[0].to_vec()), rows(&|state| state[1].to_vec()));
    let u = rows(&|[q, v, a]| tree.inverse_dynamics(q, v, a));
    let log = Trajectory { id: 0, t0: 0.0, q, v: Some(v), a: None, u: Some(u) };
    Dataset { n: LEFT, h: H, control: Some(ControlKind::Linear), trajectories: vec![log] }
}

#[test]
fn a_locked_joint_gives_the_torques_of_the_others() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.6));
    let data = without_last(0.7);
    let error = |rest: &str| {
        let rest = format!("bodies = \"known\"\nrotors = \"known\"\n{rest}");
        let (architecture, weights) = config_of(folder.path(), &rest).unwrap().beginning().unwrap();
        torque_errors(&Model::new(architecture, weights), &data, 20.0).unwrap().nmse
    };
    let at = error("joints = [\"joint1\", \"joint2\"]\nlock = { joint3 = 0.7 }");
    let elsewhere = error("joints = [\"joint2\", \"joint1\"]");
    assert!(at < 1e-4 && elsewhere > 1e-2, "{at} {elsewhere}");
    let whole = Plan::new(config_of(folder.path(), "").unwrap(), &data).err().unwrap().to_string();
    assert!(whole.contains("[model] joints = "), "{whole}");
}

#[test]
fn a_choice_of_joints_is_written_and_read_again() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.6));
    let config = config_of(folder.path(), "joints = [\"joint1\"]\nlock = { joint3 = 0.7 }").unwrap();
    assert_eq!(Config::parse(&config.to_toml(), Path::new("c.toml")).unwrap(), config);
}
