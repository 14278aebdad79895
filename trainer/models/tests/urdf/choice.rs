//! Choice of the joints that are coordinates; the others are held still.

use super::{BODY, chain, joint, link, robot, torques};
use leastaction_models::tree::Tree;
use leastaction_models::urdf::{Described, DescriptionNote, Followers, Options, parse_with};

/// Two branches on the base: j, k, l one after the other, and m, n, which slides.
fn tree_text() -> String {
    let at = |axis: &str, limits: &str| {
        format!("<origin xyz='0.1 0.3 0.2' rpy='0.2 0.5 1'/><axis xyz='{axis}'/><limit {limits}/>")
    };
    robot(&chain(&[
        ["b", "c", "d", "e"].map(link).concat(),
        joint("k", "revolute", ["a", "b"], &at("1 2 0", "lower='-1' upper='1'")),
        joint("l", "continuous", ["b", "c"], &at("0 1 1", "lower='0' upper='0'")),
        joint("m", "revolute", ["base", "d"], &at("0 1 0", "lower='0.25' upper='1'")),
        joint("n", "prismatic", ["d", "e"], &at("1 0 1", "lower='-2' upper='-0.5'")),
    ]))
}

fn chosen(joints: Option<&[&str]>, lock: &[(&str, f64)]) -> Options {
    let joints = joints.map(|joints| joints.iter().map(ToString::to_string).collect());
    let lock = lock.iter().map(|(joint, at)| ((*joint).to_owned(), *at)).collect();
    Options { joints, lock, followers: Followers::Held, ..Options::default() }
}

fn described(text: &str, options: &Options) -> Described {
    parse_with(text, options).unwrap()
}

fn names(tree: &Tree) -> Vec<&str> {
    (0..tree.coordinates()).map(|k| tree.coordinate_name(k)).collect()
}

/// Torques of the chosen joints are those of the whole robot whose other joints rest where they are held.
fn same_as_held(options: &Options, moving: &[&str], held: &[(&str, f64)]) {
    let whole = described(&tree_text(), &Options::default()).tree;
    let Described { tree, .. } = described(&tree_text(), options);
    assert_eq!(names(&tree), moving);
    let state = |phase: f64| (0..moving.len()).map(|k| (phase + k as f64).sin()).collect::<Vec<_>>();
    let [q, v, a] = [0.3, 0.7, 1.9].map(state);
    let full = |part: &[f64], rest: bool| -> Vec<f64> {
        let of = |name: &str| match moving.iter().position(|moving| *moving == name) {
            Some(k) => part[k],
            None if rest => held.iter().find(|(held, _)| *held == name).unwrap().1,
            None => 0.0,
        };
        names(&whole).into_iter().map(of).collect()
    };
    let expected = whole.inverse_dynamics(&full(&q, true), &full(&v, false), &full(&a, false));
    let found = tree.inverse_dynamics(&q, &v, &a);
    for (name, found) in moving.iter().zip(&found) {
        let k = names(&whole).iter().position(|other| other == name).unwrap();
        assert!((found - expected[k]).abs() < 1e-13 * (1.0 + found.abs()), "{name}: {found} {expected:?}");
    }
}

#[test]
fn joints_that_are_not_chosen_are_held_still() {
    let at_limits = [("k", 0.0), ("m", 0.25), ("n", -0.5)];
    same_as_held(&chosen(Some(&["l", "j"]), &[]), &["j", "l"], &at_limits);
    let locked = [("k", 0.4), ("m", 0.25), ("n", -1.25)];
    same_as_held(&chosen(Some(&["j", "l"]), &[("k", 0.4), ("n", -1.25)]), &["j", "l"], &locked);
    same_as_held(&chosen(None, &[("j", -0.6), ("m", 0.5)]), &["k", "n", "l"], &[("j", -0.6), ("m", 0.5)]);
}

/// The order of the coordinates does not depend on what is held.
#[test]
fn the_order_is_that_of_the_description() {
    let all = described(&tree_text(), &chosen(None, &[])).tree;
    assert_eq!(names(&all), ["j", "m", "k", "n", "l"]);
    for held in ["j", "m", "k", "n", "l"] {
        let rest: Vec<&str> = names(&all).into_iter().filter(|name| *name != held).collect();
        let some = described(&tree_text(), &chosen(Some(&rest), &[])).tree;
        assert_eq!(names(&some), rest);
        assert!(torques(&some, 0.3).iter().all(|x| x.is_finite()));
    }
}

#[test]
fn held_positions_beside_the_limits_are_noted() {
    let Described { notes, .. } = described(&tree_text(), &chosen(Some(&["j"]), &[("k", 1.5)]));
    let at = |joint: &str, at| DescriptionNote::AtLimit { joint: joint.to_owned(), at };
    let outside = DescriptionNote::OutsideLimits { joint: "k".to_owned(), at: 1.5, limits: [-1.0, 1.0] };
    assert_eq!(notes, [outside, at("m", 0.25), at("n", -0.5)]);
    assert!(notes[1].to_string().contains("joint m is held still at 0.25"), "{}", notes[1]);
}

#[test]
fn choices_that_cannot_be_are_refused_at_their_key() {
    type Case<'c> = (Option<&'c [&'c str]>, &'c [(&'c str, f64)], &'c str, &'c str);
    let text = tree_text().replace(
        "</robot>",
        &[
            ["f", "g", "h"].map(link).concat(),
            joint("o", "floating", ["c", "f"], ""),
            joint("p", "fixed", ["c", "g"], ""),
            joint("q", "revolute", ["c", "h"], "<mimic joint='l'/>"),
            "</robot>".to_owned(),
        ]
        .concat(),
    );
    let cases: [Case; 9] = [
        (Some(&["j", "x"]), &[], "joints", "no joint is called \"x\"; there are: j, k, l, m, n, q"),
        (Some(&["j", "j"]), &[], "joints", "joint j stands in the list twice"),
        (Some(&["o"]), &[], "joints", "joint o is floating"),
        (Some(&["p"]), &[], "joints", "joint p is fixed"),
        (Some(&["q"]), &[], "joints", "joint q follows l (<mimic>)"),
        (None, &[("y", 0.0)], "lock", "no joint is called \"y\""),
        (None, &[("o", 0.0)], "lock", "joint o is floating"),
        (None, &[("k", f64::NAN)], "lock", "joint k cannot be held at NaN"),
        (Some(&["k"]), &[("k", 0.1)], "lock", "joint k stands among `joints` too"),
    ];
    for (joints, lock, key, words) in cases {
        let found = parse_with(&text, &chosen(joints, lock)).unwrap_err();
        assert_eq!(found.key(), Some(key), "{found}");
        assert!(found.to_string().contains(words), "{words}: {found}");
    }
    assert!(parse_with(&text, &chosen(Some(&[]), &[])).unwrap_err().to_string().contains("no body moves"));
}

/// A gripper: k and l follow j at once and by way of k.
fn gripper() -> String {
    let placed = "<origin xyz='0 0.3 0'/><axis xyz='1 0 0'/>";
    robot(&chain(&[
        ["b", "c"].map(link).concat(),
        joint(
            "k",
            "revolute",
            ["a", "b"],
            &format!("{placed}<mimic joint='j' multiplier='-2' offset='0.25'/>"),
        ),
        joint(
            "l",
            "revolute",
            ["b", "c"],
            &format!("{placed}<mimic joint='k' multiplier='3' offset='0.5'/>"),
        ),
    ]))
}

#[test]
fn followers_are_held_with_a_loud_note_or_move() {
    let Described { tree, notes } = described(&gripper(), &chosen(None, &[]));
    assert_eq!(names(&tree), ["j"]);
    let [DescriptionNote::Followers { leader, is_there: true, joints }] = &notes[..] else {
        panic!("{notes:?}")
    };
    assert_eq!((&**leader, &joints[..]), ("j", &[("k".to_owned(), 0.25), ("l".to_owned(), 1.25)][..]));
    assert!(notes[0].to_string().contains("HELD STILL"), "{}", notes[0]);
    // One that moves follows by the product of the ratios.
    let moving = Options { followers: Followers::Move, ..Options::default() };
    let Described { tree, notes } = described(&gripper(), &moving);
    let last = &tree.bodies()[2];
    assert_eq!((last.coordinate, last.ratio, last.offset, notes.len()), (0, -6.0, 1.25, 0));
    // One that is locked is held where it is said, and what follows it stays with it.
    let Described { tree, notes } =
        described(&gripper(), &Options { followers: Followers::Move, ..chosen(None, &[("k", 0.5)]) });
    assert_eq!((names(&tree), notes.len()), (vec!["j"], 0));
}

#[test]
fn followers_of_a_locked_joint_are_held_with_it() {
    let text = gripper()
        .replace("</robot>", &format!("{}{}</robot>", link("z"), joint("y", "revolute", ["c", "z"], "")));
    let free = text.replace("<mimic", "<other");
    let by_leader = described(&text, &chosen(Some(&["y"]), &[("j", 0.3)]));
    let by_hand = described(&free, &chosen(Some(&["y"]), &[("j", 0.3), ("k", -0.35), ("l", -0.55)]));
    assert_eq!(by_leader.notes, []);
    let [found, expected] = [by_leader, by_hand].map(|described| torques(&described.tree, 0.4)[0]);
    assert!((found - expected).abs() < 1e-13, "{found} {expected}");
}

#[test]
fn a_follower_of_nothing_is_held() {
    let text = gripper().replace("joint='j'", "joint='nowhere'");
    let Described { tree, notes } = described(&text, &Options::default());
    assert_eq!(names(&tree), ["j"]);
    assert!(notes[0].to_string().contains("joint nowhere does not exist"), "{}", notes[0]);
}

#[test]
fn joints_with_many_coordinates_are_held() {
    let world = [
        "<link name='world'/>".to_owned(),
        format!("<link name='foot'>{BODY}</link>"),
        joint("w", "floating", ["world", "base"], ""),
        joint("s", "planar", ["a", "foot"], "<origin xyz='0 0 0.1'/>"),
    ];
    let text = robot(&chain(&world));
    let Described { tree, notes } = described(&text, &chosen(None, &[]));
    assert_eq!((names(&tree), tree.bodies()[0].inertia.mass()), (vec!["j"], 4.0));
    let [base, foot] = &notes[..] else { panic!("{notes:?}") };
    assert!(
        base.to_string().contains("joint w is floating: what it carries is taken as fixed to the base"),
        "{base}"
    );
    assert!(
        foot.to_string().contains("joint s is planar") && foot.to_string().contains("HELD STILL"),
        "{foot}"
    );
}
