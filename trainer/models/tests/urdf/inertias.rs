//! Bodies that no mass can make, and what becomes of them.

use super::{chain, error, joint, link, robot};
use leastaction_models::tree::Inertia;
use leastaction_models::urdf::{Described, DescriptionNote, GROSS, Inertias, Options, parse, parse_with};
use nalgebra::{Matrix3, Vector3};

/// A link of this mass, 0.2 m away from its joint, with these moments about its centre of mass.
fn body(name: &str, mass: f64, [xx, yy, zz]: [f64; 3]) -> String {
    format!(
        "<link name='{name}'><inertial><origin xyz='0.2 0 0'/><mass value='{mass}'/><inertia ixx='{xx}' iyy='{yy}' izz='{zz}' \
         ixy='0' ixz='0' iyz='0'/></inertial></link>"
    )
}

/// A robot whose only moving body has this mass and these moments.
fn of(mass: f64, moments: [f64; 3]) -> String {
    let j = joint("j", "revolute", ["base", "a"], "<axis xyz='0 0 1'/>");
    robot(&["<link name='base'/>".to_owned(), body("a", mass, moments), j])
}

fn described(text: &str) -> Described {
    parse_with(text, &Options::default()).unwrap()
}

#[test]
fn a_moment_that_is_a_little_too_large_becomes_the_nearest() {
    let Described { tree, notes } = described(&of(2.0, [0.002, 0.008, 0.0101]));
    let found = tree.bodies()[0].inertia;
    assert_eq!((found.mass(), found.centre()), (2.0, Vector3::new(0.2, 0.0, 0.0)));
    // Σ = (0.00805, 0.00205, −0.00005): the nearest has the third at its least, 1e-4 of the largest.
    let least = 1e-4 * 0.00805;
    let expected = [0.00205 + least, 0.00805 + least, 0.0101];
    for (found, expected) in found.principal_moments().into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
    assert!(found.consistency() > 0.0);
    let [DescriptionNote::Inertia { body, change, .. }] = &notes[..] else { panic!("{notes:?}") };
    assert_eq!((&*body.link, &*body.joint), ("a", "j"));
    let expected: f64 = (0.00005 + least) * 2f64.sqrt() / Vector3::<f64>::new(0.002, 0.008, 0.0101).norm();
    assert!((change - expected).abs() < 1e-9 && *change < GROSS, "{change} {expected}");
    let text = notes[0].to_string();
    assert!(text.contains("0.002, 0.008 and 0.0101 kg m²") && text.contains("0.55 %"), "{text}");
    assert!(!text.contains("GROSSLY"), "{text}");
}

/// No other body that is consistent is nearer in second moments.
#[test]
fn nothing_is_nearer() {
    let given = Inertia::of_centre(
        1.5,
        Vector3::new(0.1, -0.2, 0.3),
        Matrix3::new(1.0, 0.3, 0.1, 0.3, 0.2, -0.2, 0.1, -0.2, 0.4),
    );
    assert!(given.principal_spreads()[0] < -0.1, "{given:?}");
    let spread = |inertia: &Inertia| {
        let own = inertia.about_centre();
        Matrix3::identity() * (own.trace() / 2.0) - own
    };
    let nearest = given.nearest(1e-3);
    assert!((nearest.principal_spreads()[0] - 1e-3).abs() < 1e-12);
    let distance = |other: &Inertia| (spread(&given) - spread(other)).norm();
    for k in 0..200 {
        let noise = Matrix3::from_fn(|i, j| 0.05 * (f64::from(k) * 1.7 + (i * j + i + j) as f64 * 2.3).sin());
        let about = nearest.about_centre() + noise;
        let other = Inertia::of_centre(1.5, nearest.centre(), about).nearest(1e-3);
        assert!(distance(&other) >= distance(&nearest) - 1e-12, "{k}");
    }
}

#[test]
fn what_is_grossly_impossible_is_said_loudly() {
    for moments in [[0.03, 0.04, 0.5], [-0.03, 0.04, 0.05], [-1.0, -1.0, -1.0]] {
        let Described { tree, notes } = described(&of(2.0, moments));
        assert!(tree.bodies()[0].inertia.principal_spreads()[0] >= 0.0, "{tree:?}");
        let [DescriptionNote::Inertia { change, .. }] = notes[..] else { panic!("{notes:?}") };
        let text = notes[0].to_string();
        assert!(change > GROSS && text.contains("GROSSLY") && text.contains("correct"), "{change} {text}");
    }
}

#[test]
fn rounding_in_the_file_changes_nothing() {
    let Described { tree, notes } = described(&of(2.0, [0.03, 0.04, 0.07002]));
    assert_eq!(notes, []);
    assert!((tree.bodies()[0].inertia.about_centre()[(2, 2)] - 0.07002).abs() < 1e-15);
}

#[test]
fn only_what_moves_is_judged_and_as_one() {
    // An impossible body on the base, and one that is possible together with what it is fixed to.
    let antenna =
        [body("antenna", 1e-6, [1.0, 0.0, 0.0]), joint("f", "fixed", ["base", "antenna"], "")].concat();
    let wrong = [body("plate", 0.1, [1e-3, 1e-3, 4e-3]), joint("g", "fixed", ["a", "plate"], "")].concat();
    let Described { notes, .. } = described(&robot(&chain(&[antenna, wrong.clone()])));
    assert_eq!(notes, []);
    let alone = wrong.replace("fixed", "revolute");
    let Described { notes, .. } = described(&robot(&chain(&[alone])));
    assert!(
        matches!(&notes[..], [DescriptionNote::Inertia { body, .. }] if body.link == "plate"),
        "{notes:?}"
    );
    // A negative mass on the base does not matter; a part of a heavier body is noted.
    let less = [body("less", -0.5, [0.0; 3]), joint("f", "fixed", ["base", "less"], "")].concat();
    assert_eq!(described(&robot(&chain(std::slice::from_ref(&less)))).notes, []);
    let Described { tree, notes } = described(&robot(&chain(&[less.replace("'base'", "'a'")])));
    assert!(matches!(&notes[0], DescriptionNote::NegativeMass { link, .. } if link == "less"), "{notes:?}");
    assert_eq!(tree.bodies()[0].inertia.mass(), 1.5);
}

#[test]
fn all_bodies_without_mass_are_named_at_once() {
    let mut parts = chain(&[]);
    for k in 0..30 {
        let (link, mass) = (format!("l{k}"), if k % 2 == 0 { 0.0 } else { -1.0 - f64::from(k) });
        parts.extend([body(&link, mass, [0.0; 3]), joint(&format!("k{k}"), "revolute", ["a", &link], "")]);
    }
    parts.extend(["<link name='x'/>".to_owned(), joint("y", "revolute", ["a", "x"], "")]);
    let found = error(&robot(&parts));
    for words in [
        "31 faults",
        "link l0, moved by joint k0, has no mass (its <mass> is 0)",
        "link l1, moved by joint k1, has a mass of -2 kg",
        "and 11 more",
    ] {
        assert!(found.contains(words), "{words}: {found}");
    }
    // Guessed bodies replace those without mass only.
    let found = parse(&robot(&parts), Inertias::Optional).unwrap_err().to_string();
    assert!(found.contains("15 faults") && !found.contains("no mass"), "{found}");
    let alone = [link("base"), "<link name='x'/>".to_owned(), joint("y", "revolute", ["base", "x"], "")];
    assert!(error(&robot(&alone)).contains("link x, moved by joint y, has no mass (<inertial> is missing)"));
}
