//! Robot descriptions: valid ones, and hostile ones.

use leastaction_models::tree::{INERTIAL, Joint, Tree};
use leastaction_models::urdf::{Inertias, MOST_BYTES, parse};
use nalgebra::Vector3;

mod choice;
mod inertias;
mod limits;
mod massless;
mod mjcf;
mod written;

const BODY: &str = "<inertial><origin xyz='0.1 0.2 0.3' rpy='0.3 0.2 0.1'/><mass value='2'/>\
    <inertia ixx='0.03' ixy='0.001' ixz='0.002' iyy='0.04' iyz='0.003' izz='0.05'/></inertial>";

fn link(name: &str) -> String {
    format!("<link name='{name}'>{BODY}</link>")
}

fn joint(name: &str, kind: &str, [parent, child]: [&str; 2], rest: &str) -> String {
    format!(
        "<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>{rest}</joint>"
    )
}

fn robot(parts: &[String]) -> String {
    format!("<?xml version='1.0'?><robot name='r'>{}</robot>", parts.concat())
}

fn error(text: &str) -> String {
    parse(text, Inertias::Required).unwrap_err().to_string()
}

fn chain(rest: &[String]) -> Vec<String> {
    let mut parts =
        vec![link("base"), link("a"), joint("j", "revolute", ["base", "a"], "<axis xyz='0 0 2'/>")];
    parts.extend_from_slice(rest);
    parts
}

fn torques(tree: &Tree, state: f64) -> Vec<f64> {
    let of =
        |phase: f64| (0..tree.coordinates()).map(|k| (state + phase + k as f64).sin()).collect::<Vec<_>>();
    tree.inverse_dynamics(&of(0.1), &of(0.5), &of(0.9))
}

#[test]
fn a_fixed_link_is_one_body_with_what_carries_it() {
    let placed = "<origin xyz='0.4 -0.1 0.2' rpy='1 -2 0.5'/>";
    let tip = joint("k", "fixed", ["a", "tip"], placed);
    let lumped = parse(&robot(&chain(&[link("tip"), tip])), Inertias::Required).unwrap();
    // A joint that never moves gives the same mechanism.
    let tip = joint("k", "prismatic", ["a", "tip"], &format!("{placed}<axis xyz='1 0 0'/>"));
    let apart = parse(&robot(&chain(&[link("tip"), tip])), Inertias::Required).unwrap();
    assert_eq!((lumped.coordinates(), apart.coordinates()), (1, 2));
    let [found] = lumped.inverse_dynamics(&[0.3], &[0.7], &[-0.4])[..] else { panic!() };
    let expected = apart.inverse_dynamics(&[0.3, 0.0], &[0.7, 0.0], &[-0.4, 0.0])[0];
    assert!((found - expected).abs() < 1e-13, "{found} {expected}");
    let mass: f64 = lumped.bodies().iter().map(|body| body.inertia.mass()).sum();
    assert_eq!(mass, 4.0, "the base does not count");
}

#[test]
fn axes_limits_and_names_are_read_and_the_rest_is_passed_over() {
    let rest =
        "<axis xyz='0 3 4'/><limit lower='-1' upper='2' velocity='3' effort='4'/><dynamics damping='x'/>";
    let parts =
        chain(&[link("b"), joint("k", "prismatic", ["a", "b"], rest), "<gazebo><x/></gazebo>".to_owned()]);
    let tree = parse(&robot(&parts), Inertias::Required).unwrap();
    let [first, second] = tree.bodies() else { panic!() };
    assert_eq!((&*first.name, &*first.joint_name, first.parent), ("a", "j", None));
    assert_eq!((second.parent, second.coordinate), (Some(0), 1));
    assert!(matches!(first.joint, Joint::Revolute(axis) if axis.into_inner() == Vector3::z()));
    let Joint::Prismatic(axis) = second.joint else { panic!() };
    assert!((axis.into_inner() - Vector3::new(0.0, 0.6, 0.8)).norm() < 1e-15);
    assert_eq!(second.limits.position, [-1.0, 2.0]);
    assert_eq!((second.limits.velocity, second.limits.effort), (3.0, 4.0));
    assert_eq!(tree.parameters().len(), 2 * INERTIAL + 2);
    assert_eq!(tree.parameter_names()[11], "b mx");
}

#[test]
fn a_joint_that_follows_another_one_moves_with_its_coordinate() {
    let follower = |rest: &str| {
        let k =
            joint("k", "revolute", ["a", "b"], &format!("<origin xyz='0 0.3 0'/><axis xyz='1 0 0'/>{rest}"));
        parse(&robot(&chain(&[link("b"), k])), Inertias::Required).unwrap()
    };
    let (own, following) = (follower(""), follower("<mimic joint='j' multiplier='-2' offset='0.25'/>"));
    assert_eq!((own.coordinates(), following.coordinates()), (2, 1));
    // The principle of virtual work gives the force.
    let own = own.inverse_dynamics(&[0.3, -0.35], &[0.5, -1.0], &[0.7, -1.4]);
    let [found] = following.inverse_dynamics(&[0.3], &[0.5], &[0.7])[..] else { panic!() };
    assert!((found - (own[0] - 2.0 * own[1])).abs() < 1e-13);
}

#[test]
fn links_may_stand_in_any_order() {
    let parts = chain(&[link("b"), joint("k", "continuous", ["a", "b"], "<axis xyz='0 1 0'/>")]);
    let mut reversed = parts.clone();
    reversed.reverse();
    let [forward, backward] =
        [parts, reversed].map(|parts| parse(&robot(&parts), Inertias::Required).unwrap());
    assert_eq!(torques(&forward, 0.2), torques(&backward, 0.2));
}

#[test]
fn bodies_without_mass_are_refused_or_guessed() {
    let parts = chain(&[
        "<link name='b'/>".to_owned(),
        joint("k", "revolute", ["a", "b"], "<origin xyz='0 0 0.5'/>"),
    ]);
    assert!(error(&robot(&parts)).contains("link b, moved by joint k, has no mass"));
    let tree = parse(&robot(&parts), Inertias::Optional).unwrap().with_guessed_inertias(3.0, 0.1);
    let masses: Vec<f64> = tree.bodies().iter().map(|body| body.inertia.mass()).collect();
    assert!(masses[0] == 2.0 && (masses[1] - 3.0).abs() < 1e-12, "{masses:?}");
    assert!(tree.bodies().iter().all(|body| body.inertia.consistency() > 0.0), "{tree:?}");
}

#[test]
fn what_is_no_tree_is_refused_by_name() {
    let (b, c) = (link("b"), link("c"));
    let revolute = |name: &str, links| joint(name, "revolute", links, "");
    let cases: Vec<(Vec<String>, &[&str])> = vec![
        (vec![b.clone()], &["links base and b", "no joint"]),
        (
            vec![b.clone(), c.clone(), revolute("k", ["b", "c"]), revolute("l", ["c", "b"])],
            &["link b", "circle"],
        ),
        (vec![revolute("k", ["a", "base"])], &["circle", "no base"]),
        (vec![b.clone(), revolute("k", ["a", "b"]), revolute("l", ["base", "b"])], &["link b", "k and l"]),
        (vec![revolute("k", ["a", "nowhere"])], &["joint k", "no link nowhere"]),
        (vec![revolute("j", ["a", "base"])], &["joint j stands twice"]),
        (vec![link("a")], &["link a stands twice"]),
        (vec![b.clone(), joint("k", "hinge", ["a", "b"], "")], &["joint k", "hinge", "revolute"]),
        (
            vec![b.clone(), joint("k", "revolute", ["a", "b"], "<axis xyz='0 0 0'/>")],
            &["joint k", "axis is zero"],
        ),
        (
            vec![b.clone(), joint("k", "revolute", ["a", "b"], "<axis xyz='1 x 2 3'/>")],
            &["joint k", "xyz", "3 finite"],
        ),
        (
            vec![b.clone(), joint("k", "revolute", ["a", "b"], "<origin xyz='1 inf 2'/>")],
            &["joint k", "1 inf 2"],
        ),
        (
            vec![b.clone(), joint("k", "revolute", ["a", "b"], "<mimic joint='k'/>")],
            &["joint k", "follows itself"],
        ),
        (vec!["<joint name='k'/>".to_owned()], &["joint k", "type is missing"]),
        (vec!["<link/>".to_owned()], &["a link", "name is missing"]),
    ];
    for (rest, words) in cases {
        let found = error(&robot(&chain(&rest)));
        words.iter().for_each(|word| assert!(found.contains(word), "{word}: {found}"));
    }
    let only_base = error(&robot(&[link("base")]));
    assert!(only_base.contains("no body moves"), "{only_base}");
}

#[test]
fn numbers_that_are_none_are_refused_by_name() {
    let of = |from: &str, to: &str| error(&robot(&chain(&[])).replace(from, to));
    let found = of("<mass value='2'/>", "");
    assert!(found.contains("2 faults: link base: mass is missing; link a: mass is missing"), "{found}");
    assert!(of("ixx='0.03'", "").contains("link base: ixx is missing"));
    assert!(of("ixx='0.03'", "ixx='nan'").contains("ixx = \"nan\""));
}

#[test]
fn a_file_that_xacro_has_not_expanded_is_known() {
    let cases = [
        "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>\n<xacro:include filename='a'/></robot>",
        "<robot name='r'>\n<xacro:arm prefix=''/></robot>",
        "<robot name='r'>\n<link name='${prefix}a'/></robot>",
        "<robot name='r'>\n<link name='a'><inertial><mass value='$(arg m)'/></inertial></link></robot>",
    ];
    for text in cases {
        let found = error(text);
        assert!(found.contains("line 2") && found.contains("xacro in.urdf.xacro > out.urdf"), "{found}");
    }
    let mesh = "<visual><geometry><mesh filename='$(find x)/a.stl'/></geometry></visual>";
    let text = robot(&chain(&[])).replace("<inertial>", &format!("{mesh}<inertial>"));
    assert_eq!(parse(&text, Inertias::Required).unwrap().coordinates(), 1);
    assert!(error("<robot name='r'/>").contains("no <link>"));
}

#[test]
fn hostile_text_is_refused_in_time() {
    let bomb = "<!DOCTYPE r [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;'>]><robot name='&b;'/>";
    assert!(error(bomb).contains("not XML"), "{}", error(bomb));
    assert!(error("<robot").contains("not XML"));
    assert!(error("").contains("not XML"));
    assert!(error("<sdf/>").contains("<sdf>"));
    // A million links make the file too large; 5000 links in a smaller file are still too many.
    let many: String = (0..1_000_000).map(|k| format!("<link name='{k}'/>")).collect();
    assert!(many.len() > MOST_BYTES);
    assert!(error(&robot(&[many])).contains("bytes"));
    let many: String = (0..5000).map(|k| format!("<link name='{k}'/>")).collect();
    assert!(error(&robot(&[many])).contains("5000 links"));
    // Nested unknown elements are skipped without recursion, so the stack does not overflow.
    let deep = format!("{}{}", "<x>".repeat(200_000), "</x>".repeat(200_000));
    let found = parse(&robot(&chain(&[deep])), Inertias::Required);
    assert_eq!(found.unwrap().coordinates(), 1);
}

#[test]
fn long_chains_are_walked_without_recursion() {
    let count = 4000;
    let links: String = (0..count).map(|k| link(&format!("l{k}"))).collect();
    let joints: String = (1..count)
        .map(|k| joint(&format!("j{k}"), "revolute", [&format!("l{}", k - 1), &format!("l{k}")], ""))
        .collect();
    let tree = parse(&robot(&[links, joints]), Inertias::Required).unwrap();
    assert_eq!(tree.coordinates(), count - 1);
    assert!(torques(&tree, 0.0).iter().all(|x| x.is_finite()));
}
