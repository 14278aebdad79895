//! Laws with networks in a model file.

use crate::common::crane;
use crate::common::file::{
    self, Aligned, CARTPOLE, DISSIPATION, FRICTION, HEADER, NETWORKS_HEADER, POTENTIAL, arm, arm_header,
    of_networks, web, web_header, with_networks,
};
use crate::common::forces::Dry;
use crate::common::sections::{Cartpole, out_of_range, refusal, with_content};
use leastaction_core::forces::{Dissipation, Forces, PotentialCorrection, Viscous};
use leastaction_core::linear::dot;
use leastaction_core::model::{
    BodiesModel, GraphModel, Header, InertiaNetworkModel, Law, LawNetwork, Laws, ModelError, ModularModel,
    Section, parse,
};
use leastaction_core::scalar::f16;

type Networks<'a, W, const N: usize> = (Dissipation<'a, W, N, 4, 1>, PotentialCorrection<'a, W, N, 4, 1>);
type CartpoleUnder<'a, F, W = f32> = InertiaNetworkModel<'a, 2, 8, 2, W, F>;
type All<'a> = CartpoleUnder<'a, (Dry<f32, 2>, Networks<'a, f32, 2>)>;

const WHAT: &str = "coordinates of a law's network";

#[test]
fn networks_are_what_was_written() {
    let whole = Aligned::new(&with_networks(NETWORKS_HEADER, &of_networks()));
    assert_eq!(parse(whole.bytes()).unwrap().header, NETWORKS_HEADER);
    let ((viscous, coulomb), networks) = All::load(whole.bytes()).unwrap().system.forces;
    assert_eq!(viscous.coefficients, [0.125; 2]);
    assert_eq!(coulomb.coordinates[1].width, FRICTION[1][3]);
    let numbers = of_networks();
    let (mut first, mut second) = numbers.split_at(2 + 27);
    let dissipation = Dissipation::<f32, 2, 4, 1>::take(
        &mut first,
        DISSIPATION.seen().unwrap(),
        &DISSIPATION.network(Law::Dissipation).unwrap(),
    );
    let potential = PotentialCorrection::<f32, 2, 4, 1>::take(
        &mut second,
        POTENTIAL.seen().unwrap(),
        &POTENTIAL.network(Law::Potential).unwrap(),
    );
    let (dissipation, potential) = (dissipation.unwrap().unwrap(), potential.unwrap().unwrap());
    let (q, v) = ([0.3_f32, -1.2], [0.7_f32, 2.5]);
    assert_eq!(networks.0.force(&q, &v, &q), dissipation.force(&q, &v, &q));
    assert_eq!(networks.1.force(&q, &v, &q), potential.force(&q, &v, &q));
    assert!(dot(&dissipation.force(&q, &v, &q), &v) < 0.0 && potential.potential(&q) != 0.0_f32);
    assert_eq!((first.len(), second.len()), (0, 0));
}

/// A program must be compiled for the laws of a file, in their order, and for their sizes. A file need not have all
/// laws of the program.
#[test]
fn a_program_has_the_laws_and_sizes_that_it_is_compiled_for() {
    let whole = Aligned::new(&with_networks(NETWORKS_HEADER, &of_networks()));
    assert_eq!(Cartpole::load(whole.bytes()).map(|_| ()), Err(ModelError::Law { number: 1 }));
    type Half<'a> = CartpoleUnder<'a, (Dry<f32, 2>, Dissipation<'a, f32, 2, 4, 1>)>;
    let refused = ModelError::Law { number: 3 };
    assert_eq!(Half::load(whole.bytes()).map(|_| ()), Err(refused));
    assert!(refused.to_string().contains("potential"), "{refused}");
    type Turned<'a> = CartpoleUnder<'a, (Networks<'a, f32, 2>, Dry<f32, 2>)>;
    assert_eq!(Turned::load(whole.bytes()).map(|_| ()), Err(ModelError::Law { number: 2 }));
    type Narrow<'a> = CartpoleUnder<
        'a,
        (Dry<f32, 2>, (Dissipation<'a, f32, 2, 3, 1>, PotentialCorrection<'a, f32, 2, 3, 1>)),
    >;
    let refused = ModelError::Shape { what: "units in a hidden layer", found: 4, compiled: 3 };
    assert_eq!(Narrow::load(whole.bytes()).map(|_| ()), Err(refused));
    let plain = Aligned::new(&file::golden());
    let ((viscous, _), networks) = All::load(plain.bytes()).unwrap().system.forces;
    assert_eq!(viscous, Viscous { coefficients: [0.125; 2] });
    assert_eq!(networks.force(&[1.0_f32; 2], &[1.0; 2], &[1.0; 2]), [0.0; 2]);
}

#[test]
fn networks_in_half_precision() {
    let weights = [file::weights(&CARTPOLE), FRICTION.concat(), of_networks()].concat();
    let half = Aligned::new(&file::write_half(NETWORKS_HEADER, &weights));
    type Half<'a> = CartpoleUnder<'a, (Dry<f32, 2>, Networks<'a, f16, 2>), f16>;
    let halves = Half::load(half.bytes()).unwrap().system.forces;
    let whole = Aligned::new(&with_networks(NETWORKS_HEADER, &of_networks()));
    let singles = All::load(whole.bytes()).unwrap().system.forces;
    let (q, v) = ([0.3_f32, -1.2], [0.7_f32, 2.5]);
    assert_eq!(halves.force(&q, &v, &v), singles.force(&q, &v, &v), "numbers that both hold");
}

/// Trees and bodies have network laws too, with coordinates given by number.
#[test]
fn every_family_of_coordinates_has_them() {
    let network = LawNetwork { coordinates: "a", ..DISSIPATION };
    let numbers = of_networks()[..1 + 12 + 4].to_vec();
    let laws = Laws::VISCOUS.with_dissipation(network);
    type Of<'a, const N: usize> = (Viscous<f32, N>, Dissipation<'a, f32, N, 3, 1>);
    let arm = file::write(
        Header { laws, ..arm_header(arm()) },
        &[file::arm_weights(file::ARM_NUMBERS), numbers.clone()].concat(),
    );
    let arm = Aligned::new(&arm);
    let tree = ModularModel::<3, 3, 5, 2, f32, Of<3>>::load(arm.bytes(), "arm").unwrap();
    let link = ModularModel::<1, 3, 5, 2, f32, Of<1>>::load(arm.bytes(), "link").unwrap();
    let crane =
        file::write(Header { laws, ..crane::HEADER }, &[crane::weights(crane::NUMBERS), numbers].concat());
    let crane = Aligned::new(&crane);
    let bodies = BodiesModel::<3, f32, Of<3>>::load(crane.bytes()).unwrap();
    let forces = [&tree.system.forces.1, &bodies.system.forces.1];
    let [alone, _, _] = forces[0].force(&[0.4_f32, 1.0, 2.0], &[0.5, 1.0, 2.0], &[0.0; 3]);
    assert!(alone < 0.0);
    assert_eq!(forces.map(|law| law.force(&[0.4_f32; 3], &[0.5; 3], &[0.0; 3])), [[alone, 0.0, 0.0]; 2]);
    assert_eq!(link.system.forces.1.force(&[0.4_f32], &[0.5], &[0.0]), [alone]);
}

#[test]
fn a_graph_has_none() {
    let header = Header { laws: Laws::NONE.with_dissipation(DISSIPATION), ..web_header(web()) };
    let file = file::write(header, &[file::web_weights(file::WEB_NUMBERS), of_networks()].concat());
    assert_eq!(refusal(&file), out_of_range(WHAT));
    let file = Aligned::new(&file);
    let refused = GraphModel::<2, 6, 5, 1>::load(file.bytes(), "pair", &mut [], &mut []).map(|_| ());
    assert_eq!(refused, Err(ModelError::Law { number: 2 }));
}

#[test]
fn coordinates_that_cannot_be_are_refused() {
    let refused = |coordinates, of: fn(LawNetwork<'static>) -> Laws<'static>| {
        let laws = of(LawNetwork { coordinates, ..DISSIPATION });
        refusal(&file::write(Header { laws, ..HEADER }, &[0.5; 200]))
    };
    let dissipation = |network| Laws::VISCOUS.with_dissipation(network);
    let potential = |network| Laws::VISCOUS.with_potential(network);
    for of in [dissipation, potential] {
        for coordinates in ["", "-", "--", "a-", "tta", "-ta", "--a"] {
            assert_eq!(refused(coordinates, of), out_of_range(WHAT), "{coordinates}");
        }
        for coordinates in ["x", "tA", "é", "-\0"] {
            let error = refused(coordinates, of);
            assert!(
                [out_of_range(WHAT), out_of_range("coordinate of a law's network")].contains(&error),
                "{error}"
            );
        }
    }
    assert_eq!(refused("ca", potential), out_of_range(WHAT));
    // 17 coordinates of 17 bodies are more than a network may see.
    let bodies = [1, 0].repeat(17);
    let family =
        leastaction_core::model::Family::Bodies(leastaction_core::model::BodiesHeader::planar(&bodies));
    let of = |coordinates: &str| {
        let laws = Laws::NONE.with_dissipation(LawNetwork { coordinates, ..DISSIPATION });
        let header = Header { laws, ..Header::new(family) };
        let file = file::write(header, &vec![0.5; header.parameters().unwrap_or(0)]);
        parse(Aligned::new(&file).bytes()).map(|parsed| parsed.weights.len())
    };
    assert_eq!(of(&"c".repeat(16)), Ok(2 + 17 * 9 + 16 + 3 * 17 + 136 * 4));
    assert_eq!(of(&"c".repeat(17)), Err(out_of_range(WHAT)));
    assert_eq!(of(&"ca".repeat(8)), Ok(2 + 17 * 9 + 16 + 3 * (16 + 16 + 1) + 136 * 4));
}

#[test]
fn hidden_layers_and_scales_that_cannot_be_are_refused() {
    let with = |network| {
        let laws = Laws::VISCOUS.with_dissipation(network);
        refusal(&file::write(Header { laws, ..HEADER }, &[0.5; 200]))
    };
    assert_eq!(with(LawNetwork { widths: [3, 0, 2, 0], ..DISSIPATION }), out_of_range("hidden width"));
    for scale in [0.0, -0.0, -1.0] {
        for place in 0..2 {
            let mut numbers = of_networks();
            numbers[place] = scale;
            let refused = refusal(&with_networks(NETWORKS_HEADER, &numbers));
            assert_eq!(refused, out_of_range("scale of a velocity"));
        }
    }
    let needed = file::weights(&CARTPOLE).len() + 8 + of_networks().len();
    for missing in [1, 17, 40] {
        let numbers = &of_networks()[missing..];
        let refused = refusal(&with_networks(NETWORKS_HEADER, numbers));
        assert_eq!(refused, ModelError::WeightCount { found: needed - missing, needed });
    }
}

/// Every truncation of the section and every change of one of its bytes is refused or gives another valid shape,
/// without a panic.
#[test]
fn damaged_shapes_are_refused() {
    let file = with_networks(NETWORKS_HEADER, &of_networks());
    let [start, end] = file::place(&file, Section::Forces);
    let section = file[start..end].to_vec();
    assert_eq!(section.len(), 2 + 9 + 9);
    for cut in 0..section.len() {
        let refused = refusal(&with_content(&file, Section::Forces, &section[..cut]));
        let expected = if [0, 1, 2, 11].contains(&cut) {
            "weights where the shape needs"
        } else {
            "the header is malformed"
        };
        assert!(refused.to_string().contains(expected), "{cut}: {refused}");
    }
    for place in 0..section.len() {
        for value in 0..=255 {
            let mut damaged = section.clone();
            damaged[place] = value;
            let bytes = Aligned::new(&with_content(&file, Section::Forces, &damaged));
            if parse(bytes.bytes()).is_ok() {
                assert!(All::load(bytes.bytes()).is_ok_and(|model| {
                    model.system.forces.force(&[0.1; 2], &[0.2; 2], &[0.3; 2]).iter().all(|x| x.is_finite())
                }));
            }
        }
    }
    for wrong in [&[2][..], &[3], &[0, 2, 1], &[2, 2], &[0, 2, 255, 255, 255, 255, 15]] {
        assert_eq!(refusal(&with_content(&file, Section::Forces, wrong)), ModelError::Malformed, "{wrong:?}");
    }
    let turned = [&section[11..], &section[2..11]].concat();
    assert_eq!(refusal(&with_content(&file, Section::Forces, &turned)), ModelError::Malformed);
}
