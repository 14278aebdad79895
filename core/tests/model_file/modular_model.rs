//! The model file of the modular family: a valid file loads, and everything else is a typed error.

use crate::common::assert_close;
use crate::common::file::{self, ARM_DAMPING, ARM_NUMBERS, Aligned, arm, arm_header, arm_weights};
use crate::common::oracle::Learned;
use crate::common::trees::{self, network, node};
use leastaction_core::continuous::acceleration;
use leastaction_core::energy::List;
use leastaction_core::energy::modular::{
    ELEMENT_PARAMETERS, ModularShape, PairInput, PairShape, TransformShape, TreeElement, TreeError, TypeShape,
};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::{
    FORMAT_VERSION, Family, Header, InertiaNetworkModel, Law, Laws, MAX_TREES, ModelError, ModularHeader,
    ModularModel, Section, TreeHeader, parse,
};
use leastaction_core::network::Activation;
use leastaction_core::scalar::Weights;
use proptest::prelude::*;

/// The arm, compiled with the sizes that just fit it.
type Arm<'a> = ModularModel<'a, 3, 3, 5, 2>;

fn refusal(file: &[u8]) -> ModelError {
    Arm::load(Aligned::new(file).bytes(), "arm").map(|_| ()).expect_err("the file must be refused")
}

/// Reason why loading refuses a header with the right number of weights.
fn header_refusal(header: ModularHeader<'static>) -> ModelError {
    let count = header.parameters().unwrap();
    let mut weights = arm_weights(ARM_NUMBERS);
    weights.truncate(weights.len() - ARM_DAMPING.len());
    let (kinds, numbers) =
        (header.shape.types.len(), weights.split_off(weights.len() - ELEMENT_PARAMETERS * 3 - 2));
    let networks = count.saturating_sub(ELEMENT_PARAMETERS * kinds + 2);
    weights.resize(networks, 0.5);
    weights.extend(numbers.into_iter().chain([1.0; 64]).take(count - networks));
    weights.extend(vec![0.25; kinds]);
    refusal(&file::write(arm_header(header), &weights))
}

fn with_shape(change: impl FnOnce(&mut ModularShape)) -> ModularHeader<'static> {
    let mut header = arm();
    change(&mut header.shape);
    header
}

fn with_tree(elements: &'static [u8]) -> ModularHeader<'static> {
    let mut header = arm();
    header.trees[1] = TreeHeader { name: "arm", elements };
    header
}

#[test]
fn a_valid_file_loads_and_is_what_was_written() {
    let file = Aligned::new(&file::golden_arm());
    let parsed = parse(file.bytes()).unwrap();
    assert_eq!(parsed.header, arm_header(arm()));
    let Weights::Single(weights) = parsed.weights else { panic!("single precision") };
    assert_eq!(weights, arm_weights(ARM_NUMBERS));
    assert!(file.bytes().as_ptr_range().contains(&weights.as_ptr().cast()), "borrowed in place");
    let model = Arm::load(file.bytes(), "arm").unwrap();
    assert_eq!(model.trained_step, parsed.header.trained_step);
    assert_eq!(model.system.forces.coefficients, ARM_DAMPING);
    assert_eq!(model.system.lagrangian.coefficients, file::ARM_COEFFICIENTS);
    let masses = model.system.lagrangian.types.slots.map(|t| t.unwrap().numbers.mass);
    assert_eq!(masses, [2.0, 1.0, 0.75]);
}

#[test]
fn a_loaded_tree_is_the_one_of_its_weights() {
    let file = Aligned::new(&file::golden_arm());
    let nodes = [node(0, None), node(1, Some(0)), node(2, Some(1))];
    let mut twin = trees::Tree::<3>::new(file::arm_shape(), &nodes, 0);
    twin.weights = arm_weights(ARM_NUMBERS).into_iter().map(f64::from).collect();
    twin.weights.truncate(twin.weights.len() - ARM_DAMPING.len());
    let model = Arm::load(file.bytes(), "arm").unwrap();
    for (q, v) in [([0.3_f32, 1.25, -0.5], [0.5_f32, -2.0, 1.0]), ([-1.5, -3.0, 2.0], [0.0, 1.0, 0.25])] {
        let found = model.system.lagrangian.energies(&q, &v);
        let (kinetic, potential) = twin.naive_energies(&q.map(f64::from), &v.map(f64::from));
        assert_close("T", found.kinetic.into(), kinetic, 3e-6);
        assert_close("V", found.potential.into(), potential, 3e-6);
        assert!(acceleration(&model.system, &q, &v, &[1.0, 0.0, 0.5]).unwrap().iter().all(|a| a.is_finite()));
    }
}

#[test]
fn one_file_serves_all_its_trees() {
    let file = Aligned::new(&file::golden_arm());
    assert!(ModularModel::<1, 3, 5, 2>::load(file.bytes(), "link").is_ok());
    assert!(ModularModel::<3, 6, 16, 4>::load(file.bytes(), "arm").is_ok());
    let error = Arm::load(file.bytes(), "leg").unwrap_err();
    assert_eq!(error, ModelError::NoSuchTree { trees: 2 });
    assert_eq!(error.to_string(), "none of the 2 trees in the file has that name");
    assert_eq!(Arm::load(file.bytes(), "").unwrap_err(), ModelError::NoSuchTree { trees: 2 });
}

#[test]
fn every_truncation_and_every_change_of_a_byte_is_an_error() {
    file::assert_truncations_are_refused(&file::golden_arm());
    file::assert_changes_are_refused(&file::golden_arm());
}

#[test]
fn families_are_not_mistaken_for_each_other() {
    let (inertia_network, modular) = (Aligned::new(&file::golden()), Aligned::new(&file::golden_arm()));
    let error = Arm::load(inertia_network.bytes(), "arm").unwrap_err();
    assert_eq!(error, ModelError::OtherFamily { found: "inertia-network" });
    let error = InertiaNetworkModel::<2, 8, 2>::load(modular.bytes()).unwrap_err();
    assert_eq!(error, ModelError::OtherFamily { found: "modular" });
}

#[test]
fn the_tree_must_fit_the_compiled_sizes() {
    let file = Aligned::new(&file::golden_arm());
    fn load<const N: usize, const K: usize, const H: usize, const D: usize>(file: &Aligned) -> ModelError {
        ModularModel::<N, K, H, D>::load(file.bytes(), "arm").map(|_| ()).unwrap_err()
    }
    let coordinates = |compiled| ModelError::Tree(TreeError::Coordinates { found: 3, compiled });
    assert_eq!(load::<2, 3, 5, 2>(&file), coordinates(2));
    assert_eq!(load::<4, 3, 5, 2>(&file), coordinates(4));
    let shape = |what, found, compiled| ModelError::Shape { what, found, compiled };
    assert_eq!(load::<3, 2, 5, 2>(&file), shape("element types", 3, 2));
    assert_eq!(load::<3, 3, 4, 2>(&file), shape("units in a hidden layer", 5, 4));
    assert_eq!(load::<3, 3, 5, 1>(&file), shape("hidden layers", 2, 1));
    let text = load::<2, 3, 5, 2>(&file).to_string();
    assert_eq!(text, "a tree of 3 coordinates, but this program was compiled for 2");
}

#[test]
fn what_is_no_tree_is_an_error() {
    let cases = [
        (&[0, 0, 1, 1, 7, 2][..], TreeError::Kind { element: 2, kind: 7, kinds: 3 }),
        (&[0, 0, 1, 3, 2, 2], TreeError::Parent { element: 1, parent: 2 }),
        (&[0, 0, 1, 2, 2, 2], TreeError::Parent { element: 1, parent: 1 }),
        (&[0, 3, 1, 1, 2, 2], TreeError::Parent { element: 0, parent: 2 }),
        (&[0, 0, 1, 255, 2, 2], TreeError::Parent { element: 1, parent: 254 }),
    ];
    for (elements, error) in cases {
        assert_eq!(header_refusal(with_tree(elements)), ModelError::Tree(error), "{elements:?}");
    }
    assert!(header_refusal(with_tree(&[1, 1])).to_string().contains("list parents first"));
    let odd = ModelError::OutOfRange { what: "length of a tree" };
    assert_eq!(header_refusal(with_tree(&[0, 0, 1])), odd);
    assert_eq!(header_refusal(with_tree(&[0])), odd);
}

#[test]
fn a_tree_has_at_most_64_coordinates() {
    // Pairs of a type and the ground.
    static LONG: [u8; 130] = [0; 130];
    assert!(matches!(
        header_refusal(with_tree(&LONG[..128])),
        ModelError::Tree(TreeError::Coordinates { found: 64, compiled: 3 })
    ));
    let error = ModelError::OutOfRange { what: "number of coordinates of a tree" };
    assert_eq!(header_refusal(with_tree(&LONG)), error);
}

#[test]
fn names_are_there_and_different() {
    for names in ["", "cart,link", "cart,link,rod,arm", "cart,,rod", "cart,link,", "cart,link,cart"] {
        let error = header_refusal(ModularHeader { names, ..arm() });
        assert_eq!(error, ModelError::Names { of: "element types" }, "{names}");
    }
    for name in ["", "arm"] {
        let mut header = arm();
        header.trees[0].name = name;
        assert_eq!(header_refusal(header), ModelError::Names { of: "trees" }, "{name}");
    }
    let text = ModelError::Names { of: "trees" }.to_string();
    assert_eq!(text, "the trees must each have a name of its own, and not an empty one");
}

#[test]
fn lists_have_no_gap() {
    let no_tree = ModularHeader { trees: [TreeHeader::default(); MAX_TREES], ..arm() };
    assert_eq!(header_refusal(no_tree), ModelError::OutOfRange { what: "number of trees" });
    let mut gap = arm();
    gap.trees.swap(1, 2);
    assert_eq!(header_refusal(gap), ModelError::OutOfRange { what: "list of trees" });
    let mut named = arm();
    named.trees[2].name = "nothing";
    assert_eq!(header_refusal(named), ModelError::OutOfRange { what: "list of trees" });
    let cases = [
        (with_shape(|shape| shape.types = List::default()), "number of element types"),
        (with_shape(|shape| shape.types.slots.swap(2, 3)), "list of element types"),
        (with_shape(|shape| shape.networks.slots.swap(2, 3)), "list of networks"),
    ];
    for (header, what) in cases {
        assert_eq!(header_refusal(header), ModelError::OutOfRange { what });
    }
}

#[test]
fn networks_must_have_the_arity_of_their_use() {
    let tanh = |inputs, widths, outputs| Some(network(inputs, widths, outputs, Activation::Tanh));
    let set = |i: usize, network| with_shape(|shape| shape.networks.slots[i] = network);
    let velocity = |velocity| {
        with_shape(|shape| {
            if let Some(TypeShape { transform: TransformShape::Network { velocity: slot, .. }, .. }) =
                &mut shape.types.slots[1]
            {
                *slot = Some(velocity);
            }
        })
    };
    let pair = |network, input| with_shape(|shape| shape.pair = Some(PairShape { network, input }));
    let mut gap = network(2, &[4, 3], 2, Activation::Tanh);
    gap.widths = [4, 0, 3, 0];
    let (transform, potential) = ("network of a transform", "network of a potential");
    let cases = [
        (set(0, tanh(1, &[4, 3], 2)), transform),
        (set(0, tanh(2, &[4, 3], 1)), transform),
        (set(0, tanh(0, &[4, 3], 2)), transform),
        (set(0, Some(gap)), "hidden width"),
        (velocity(1), transform),
        (velocity(3), transform),
        (velocity(255), transform),
        (set(1, tanh(3, &[5], 1)), potential),
        (set(1, tanh(2, &[5], 2)), potential),
        (with_shape(|shape| shape.types.slots[2].as_mut().unwrap().potential = Some(9)), potential),
        (pair(2, PairInput::Difference), "network of the pair potential"),
        (pair(1, PairInput::Distance), "network of the pair potential"),
        (pair(3, PairInput::Distance), "network of the pair potential"),
    ];
    for (header, what) in cases {
        assert_eq!(header_refusal(header), ModelError::OutOfRange { what });
    }
}

#[test]
fn numbers_of_a_type_are_in_range() {
    let with = |kind: usize, number: usize, value| {
        let mut numbers = ARM_NUMBERS;
        numbers[kind][number] = value;
        file::write(arm_header(arm()), &arm_weights(numbers))
    };
    for kind in 0..3 {
        for (number, value, what) in [
            (0, 0.0, "mass of an element type"),
            (0, -1.0, "mass of an element type"),
            (1, -0.1, "moment of inertia of an element type"),
        ] {
            assert_eq!(refusal(&with(kind, number, value)), ModelError::OutOfRange { what });
        }
        for number in 0..ELEMENT_PARAMETERS {
            let error = refusal(&with(kind, number, f32::NAN));
            assert!(matches!(error, ModelError::NotFinite { .. }), "{error:?}");
        }
        let mut weights = arm_weights(ARM_NUMBERS);
        let damping = weights.len() - ARM_DAMPING.len();
        weights[damping + kind] = -0.5;
        let error = refusal(&file::write(arm_header(arm()), &weights));
        let group = kind as u16;
        assert_eq!(error, ModelError::LawNumber { law: Law::Viscous, number: 0, group, value: -0.5 });
    }
}

/// Damping belongs to element types: elements of one type share its number, and the numbers come in the order of the
/// tree's coordinates.
#[test]
fn damping_is_that_of_the_element_types() {
    let with_damping = file::write(arm_header(with_tree(&[2, 0, 1, 1, 2, 2])), &arm_weights(ARM_NUMBERS));
    let file = Aligned::new(&with_damping);
    let [_, link, rod] = ARM_DAMPING;
    assert_eq!(Arm::load(file.bytes(), "arm").unwrap().system.forces.coefficients, [rod, link, rod]);
    let weights = arm_weights(ARM_NUMBERS);
    let (undamped, _) = weights.split_at(weights.len() - ARM_DAMPING.len());
    let header = Header { laws: Laws::NONE, ..arm_header(arm()) };
    let file = Aligned::new(&file::write(header, undamped));
    assert_eq!(Arm::load(file.bytes(), "arm").unwrap().system.forces.coefficients, [0.0; 3]);
}

#[test]
fn weights_are_as_many_as_the_shape_says() {
    let weights = arm_weights(ARM_NUMBERS);
    let needed = weights.len();
    assert_eq!(needed, (3 * 4 + 5 * 3 + 4 * 2) + (3 * 5 + 6) + 2 + 3 * ELEMENT_PARAMETERS + 2 + 3);
    let error = refusal(&file::write(arm_header(arm()), &weights[1..]));
    assert_eq!(error, ModelError::WeightCount { found: needed - 1, needed });
    // Every network as wide as possible: more numbers than any file has, and no overflow.
    let wide = with_shape(|shape| {
        shape.networks.slots = [Some(network(255, &[u16::MAX; 4], 255, Activation::Tanh)); 8];
    });
    let error = refusal(&file::write(arm_header(wide), &weights));
    assert!(matches!(error, ModelError::WeightCount { found, .. } if found == needed), "{error:?}");
}

#[test]
fn impossible_encodings_are_malformed() {
    let file = file::golden_arm();
    let body = &file[..file.len() - 4];
    // Family 5; an option 2; activation 5; transform 4; input 3; pair input 4; a name that is not UTF-8.
    for (position, value) in [(10, 5), (11, 2), (18, 5), (41, 4), (47, 3), (59, 4), (61, 0xff)] {
        let mut changed = body.to_vec();
        changed[position] = value;
        assert_eq!(refusal(&file::with_checksum(&changed)), ModelError::Malformed, "byte {position}");
    }
}

/// Evaluates whatever loads.
fn evaluate<const N: usize>(file: &Aligned, name: &str) {
    if let Ok(model) = ModularModel::<N, 6, 8, 3>::load(file.bytes(), name) {
        let (q, v) = ([0.2; N], [0.4; N]);
        let _ = acceleration(&model.system, &q, &v, &[0.5; N]);
        let _ = model.system.lagrangian.hessian(&q, &v);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    /// Random bytes behind a valid beginning and before a valid checksum, so that they reach the decoder.
    #[test]
    fn random_headers_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..160)) {
        let energies = file::section_of(Section::Energies, &[&[1], &bytes[..]].concat());
        let file = file::with_checksum(&[&b"LACT"[..], &[FORMAT_VERSION], &energies[..]].concat());
        let _ = parse(Aligned::new(&file).bytes());
    }

    /// Several bytes of a valid file changed and the checksum corrected: whatever loads can be evaluated.
    #[test]
    fn changes_under_a_right_checksum_never_panic(changes in prop::collection::vec((5usize..170, 0u8..12), 1..4)) {
        let file = file::golden_arm();
        let mut body = file[..file.len() - 4].to_vec();
        for (position, value) in changes {
            body[position] = value;
        }
        let file = Aligned::new(&file::with_checksum(&body));
        for name in ["arm", "link"] {
            evaluate::<1>(&file, name);
            evaluate::<2>(&file, name);
            evaluate::<3>(&file, name);
            evaluate::<4>(&file, name);
        }
    }

    /// Any two bytes per element: they are a tree if every parent comes first, and an error otherwise.
    #[test]
    fn random_trees_load_or_are_refused(elements in prop::collection::vec((0u8..4, 0u8..6), 1..6)) {
        let bytes: Vec<u8> = elements.iter().flat_map(|(kind, parent)| [*kind, *parent]).collect();
        let mut trees = [TreeHeader::default(); MAX_TREES];
        trees[0] = TreeHeader { name: "random", elements: &bytes };
        let family = Family::Modular(ModularHeader { trees, ..arm() });
        let header = Header { laws: Laws::VISCOUS, ..Header::new(family) };
        let nodes: Vec<TreeElement> = trees[0].nodes().collect();
        let valid = elements.iter().zip(0u8..).all(|((kind, parent), e)| *kind < 3 && *parent <= e);
        let file = Aligned::new(&file::write(header, &arm_weights(ARM_NUMBERS)));
        prop_assert_eq!(parse(file.bytes()).is_ok(), valid, "{:?}", nodes);
    }
}
