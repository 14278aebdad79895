//! Models of MuJoCo, compared with MuJoCo's own numbers, and hostile ones.

use leastaction_models::tree::Tree;
use leastaction_models::urdf::{Described, DescriptionNote, Followers, Inertias, Options, parse, parse_with};

mod oracle;
mod refused;

/// Reads a description with all followers held.
fn held(text: &str) -> Described {
    parse_with(text, &Options { followers: Followers::Held, ..Options::default() }).unwrap()
}

fn names(tree: &Tree) -> Vec<&str> {
    (0..tree.coordinates()).map(|k| tree.coordinate_name(k)).collect()
}

/// A model with these elements in its world.
pub(super) fn world(inside: &str) -> String {
    format!("<mujoco><compiler angle='radian'/><worldbody>{inside}</worldbody></mujoco>")
}

pub(super) const MASS: &str = "<inertial pos='0.1 0.2 0.3' mass='2' diaginertia='0.03 0.04 0.05'/>";

#[test]
fn a_model_and_its_urdf_are_the_same_tree() {
    let mjcf = world(&format!(
        "<body name='a' pos='0.4 0 0.1'>{MASS}<joint name='j' axis='0 1 0' range='-1 2'/>\
         <body name='b' pos='0 0.2 0.5'>{MASS}<joint name='k' type='slide' axis='1 0 0'/></body></body>"
    ));
    let body = "<inertial><origin xyz='0.1 0.2 0.3'/><mass value='2'/>\
                <inertia ixx='0.03' ixy='0' ixz='0' iyy='0.04' iyz='0' izz='0.05'/></inertial>";
    let urdf = format!(
        "<robot name='r'><link name='world'/><link name='a'>{body}</link><link name='b'>{body}</link>\
         <joint name='j' type='revolute'><parent link='world'/><child link='a'/><origin xyz='0.4 0 0.1'/>\
         <axis xyz='0 1 0'/><limit lower='-1' upper='2'/></joint>\
         <joint name='k' type='prismatic'><parent link='a'/><child link='b'/><origin xyz='0 0.2 0.5'/></joint></robot>"
    );
    assert_eq!(parse(&mjcf, Inertias::Required).unwrap(), parse(&urdf, Inertias::Required).unwrap());
}

#[test]
fn coordinates_stand_in_the_order_of_mujoco() {
    let body =
        |name: &str, inside: &str| format!("<body name='{name}'>{MASS}<joint name='{name}'/>{inside}</body>");
    let text = world(&(body("a", &(body("b", &body("c", "")) + &body("d", ""))) + &body("e", "")));
    assert_eq!(names(&held(&text).tree), ["a", "b", "c", "d", "e"]);
    let nameless = ["c", "d"].iter().fold(text, |text, name| text.replace(&format!("name='{name}'"), ""));
    assert_eq!(names(&held(&nameless).tree), ["a", "b", "joint 2", "joint 3", "e"], "numbers of MuJoCo");
}

#[test]
fn equality_constraints_are_followers() {
    let text = |constraint: &str| {
        let bodies = world(&format!(
            "<body name='a'>{MASS}<joint name='j' axis='0 1 0' ref='0.2'/><body name='b' pos='1 0 0'>{MASS}\
             <joint name='k' axis='0 1 0' ref='0.1'/></body></body>"
        ));
        bodies.replace("</mujoco>", &format!("<equality>{constraint}</equality></mujoco>"))
    };
    let followed = text("<joint joint1='k' joint2='j' polycoef='0.3 -2'/>");
    let tree = parse(&followed, Inertias::Required).unwrap();
    let follower = &tree.bodies()[1];
    assert_eq!((names(&tree), follower.coordinate, follower.ratio), (vec!["j"], 0, -2.0));
    assert!((follower.offset - 0.8).abs() < 1e-15, "y = 0.1 + 0.3 − 2 (x − 0.2): {}", follower.offset);
    let Described { tree, notes } = held(&followed);
    assert!(
        tree.bodies().len() == 1 && matches!(&notes[..], [DescriptionNote::Followers { .. }]),
        "{notes:?}"
    );
    let alone = held(&text("<joint joint1='k' polycoef='0.3'/>")).tree;
    assert_eq!(names(&alone), ["j"]);
    assert_eq!(held(&text("<joint joint1='k' joint2='j' active='false'/>")).tree.coordinates(), 2);
    let Described { tree, notes } = held(&text("<connect body1='a' body2='b' anchor='0 0 0'/>"));
    assert_eq!(tree.coordinates(), 2);
    assert!(notes[0].to_string().contains("<connect> of line 1"), "{notes:?}");
}

#[test]
fn free_and_ball_joints_are_held_with_a_note() {
    let text = world(&format!(
        "<body name='trunk' pos='0 0 1'>{MASS}<freejoint name='root'/><body name='leg'>{MASS}<joint name='hip'/>\
         <body name='foot'>{MASS}<joint type='ball' name='ankle' pos='0 0 1'/></body></body></body>"
    ));
    let Described { tree, notes } = held(&text);
    assert_eq!(names(&tree), ["hip"]);
    assert_eq!(tree.bodies()[0].inertia.mass(), 4.0);
    let [root, ankle] = [0, 1].map(|k| notes[k].to_string());
    assert!(root.contains("root") && root.contains("fixed to the base"), "{root}");
    assert!(ankle.contains("ankle is ball") && ankle.contains("HELD"), "{ankle}");
}

#[test]
fn springs_and_tendons_are_noted() {
    let text = world(&format!("<body name='a'>{MASS}<joint name='j' stiffness='3'/></body>"))
        .replace("</mujoco>", "<tendon><fixed><joint joint='j' coef='1'/></fixed></tendon></mujoco>");
    let notes: Vec<String> = held(&text).notes.iter().map(ToString::to_string).collect();
    assert!(notes.iter().any(|note| note.contains("<tendon>")), "{notes:?}");
    assert!(notes.iter().any(|note| note.contains("springs (stiffness) of the joints j")), "{notes:?}");
}
