//! Comparison of the modular family, for any size, with core in f64: value, derivatives, and gradients with respect to
//! the weights.

mod common;

use common::{Dual, Motion, Numbers, damping, random_weights};
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::modular::{
    ELEMENT_PARAMETERS, Input, MAX_TYPES, Modular, ModularShape, PairInput, PairShape, TransformShape,
    TreeElement, TreeError, TypeShape,
};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::model::ModelError;
use leastaction_core::network::Activation;
use leastaction_core::scalar::{Scalar, WeightFormat};
use leastaction_programs::energies::{Energies, ModularEnergies};

/// The networks of every test; their widths are not multiples of a panel.
fn networks(pair: Option<PairInput>) -> Vec<NetworkShape> {
    let network =
        |inputs, widths: &[u16], outputs, kind| NetworkShape::new(inputs, widths, outputs, kind).unwrap();
    let pair_inputs = pair.map_or(1, PairInput::features) as u8;
    vec![
        network(1, &[7, 5], 2, Activation::Tanh),
        network(2, &[13], 2, Activation::Isru),
        network(1, &[3], 2, Activation::Squareplus),
        network(2, &[6, 9], 2, Activation::Tanh),
        network(2, &[9], 1, Activation::Softplus),
        network(2, &[5, 3, 4, 6], 1, Activation::Tanh),
        network(pair_inputs, &[6, 11], 1, Activation::Squareplus),
        network(2, &[], 2, Activation::Identity),
    ]
}

const fn learned(position: u8, velocity: Option<u8>, input: Input) -> TransformShape {
    TransformShape::Network { position, velocity, input }
}

const fn kind(transform: TransformShape, potential: Option<u8>) -> TypeShape {
    TypeShape { transform, potential }
}

const TRANSLATION: TypeShape = kind(learned(0, None, Input::Translation), Some(4));
const ANGLE: TypeShape = kind(learned(1, None, Input::Angle), Some(5));
const WRAPPED: TypeShape = kind(learned(0, None, Input::WrappedAngle), None);
const LINEAR: TypeShape = kind(learned(7, None, Input::Angle), None);
const TRANSLATION_AND_VELOCITY: TypeShape = kind(learned(0, Some(2), Input::Translation), None);
const ANGLE_AND_VELOCITY: TypeShape = kind(learned(1, Some(3), Input::Angle), Some(4));
const WRAPPED_AND_VELOCITY: TypeShape = kind(learned(0, Some(2), Input::WrappedAngle), Some(5));
const ROD: TypeShape = kind(TransformShape::Rod, Some(4));
const LIGHT_ROD: TypeShape = kind(TransformShape::Rod, None);
const SLIDE: TypeShape = kind(TransformShape::Slide, Some(5));
const FREE: TypeShape = kind(TransformShape::Free, Some(4));
const LOOSE: TypeShape = kind(TransformShape::Free, None);

/// Elements of these types with these parents: 0 is the ground, k is element k − 1.
fn nodes(elements: &[(u8, u8)]) -> Vec<TreeElement> {
    elements.iter().map(|(kind, on)| TreeElement { kind: *kind, parent: on.checked_sub(1) }).collect()
}

struct Case {
    types: Vec<TypeShape>,
    pair: Option<PairInput>,
    elements: Vec<(u8, u8)>,
    damped: bool,
}

impl Case {
    fn shape(&self) -> ModularShape {
        let pair = self.pair.map(|input| PairShape { network: 6, input });
        ModularShape::new(&networks(self.pair), &self.types, pair).unwrap()
    }

    /// Random networks, coefficients and damping; masses, moments of inertia, centres and lengths around 1.
    fn weights(&self, model: &ModularEnergies, seed: u64) -> Vec<f64> {
        let shape = self.shape();
        let mut weights = random_weights(model.parameters(), seed);
        let start = shape.networks.parameters().unwrap();
        let end = start + ELEMENT_PARAMETERS * self.types.len();
        weights[start..end].iter_mut().for_each(|w| *w = 1.0 + 0.5 * *w);
        weights[end + 2..].iter_mut().for_each(|c| *c = c.abs());
        weights
    }

    /// Core's model, with one damping coefficient per element type after the numbers of the energies.
    fn core<'w, S, const N: usize>(
        &self,
        weights: &'w [S],
    ) -> System<Modular<'w, S, N, MAX_TYPES, 64, 4>, Viscous<S, N>>
    where
        S: Scalar<Weight = S> + WeightFormat<Wide = S>,
    {
        let (shape, mut block) = (self.shape(), weights);
        let tree = shape.tree(nodes(&self.elements)).unwrap();
        let lagrangian = Modular::take(&mut block, &shape, tree).unwrap();
        assert_eq!(block.len(), if self.damped { self.types.len() } else { 0 });
        let start = weights.len() - block.len();
        let positions = self.damped.then(|| tree.kinds().map(|kind| start + usize::from(kind)));
        System { lagrangian, forces: damping(weights, positions) }
    }

    fn check<const N: usize>(&self, seed: u64) {
        let model = ModularEnergies::new(&self.shape(), &nodes(&self.elements), self.damped).unwrap();
        let weights = self.weights(&model, seed);
        let motion = |weights: &[Dual], at: [&[Dual; N]; 3]| Motion::new(&self.core(weights), at);
        let numbers = Numbers::<N>::new(weights.clone(), 1.5, seed);
        common::check(&model, &self.core(&weights), motion, &numbers, 1.0);
    }
}

/// Makes a test for every tree: its coordinates, types, pair potential, elements, and whether it is damped.
macro_rules! trees {
    ($($name:ident: $n:literal, $types:expr, $pair:expr, $elements:expr, $damped:literal;)*) => {
        $(
            #[test]
            fn $name() {
                let case = Case {
                    types: $types.to_vec(),
                    pair: $pair,
                    elements: $elements.to_vec(),
                    damped: $damped,
                };
                case.check::<$n>($n);
            }
        )*
    };
}

const CONCAT: Option<PairInput> = Some(PairInput::Concat);
const DIFFERENCE: Option<PairInput> = Some(PairInput::Difference);
const DISTANCE: Option<PairInput> = Some(PairInput::Distance);
const INVERSE: Option<PairInput> = Some(PairInput::InverseDistance);

trees! {
    one_learned_translation: 1, [TRANSLATION], None, [(0, 0)], true;
    one_learned_angle: 1, [ANGLE], None, [(0, 0)], false;
    one_wrapped_angle: 1, [WRAPPED], None, [(0, 0)], true;
    one_translation_with_a_velocity_network: 1, [TRANSLATION_AND_VELOCITY], None, [(0, 0)], true;
    one_angle_with_a_velocity_network: 1, [ANGLE_AND_VELOCITY], None, [(0, 0)], false;
    one_wrapped_angle_with_a_velocity_network: 1, [WRAPPED_AND_VELOCITY], None, [(0, 0)], true;
    one_rod: 1, [ROD], None, [(0, 0)], true;
    one_slide: 1, [SLIDE], None, [(0, 0)], true;
    one_free_point: 2, [FREE], None, [(0, 0)], true;
    no_potential: 2, [LIGHT_ROD], None, [(0, 0), (0, 1)], true;
    one_type_is_unused: 2, [SLIDE, FREE, ROD], None, [(0, 0), (2, 1)], true;
    three_on_a_cart: 3, [SLIDE, ROD, ANGLE], CONCAT, [(0, 0), (1, 1), (2, 2)], true;
    four_branched: 4, [WRAPPED, ANGLE_AND_VELOCITY], DIFFERENCE, [(0, 0), (1, 1), (0, 1), (1, 0)], false;
    five_with_a_free_point: 5, [FREE, ROD, TRANSLATION], DISTANCE, [(0, 0), (1, 1), (2, 2), (1, 1)], true;
    six_free_coordinates: 6, [FREE, LOOSE], INVERSE, [(0, 0), (1, 0), (0, 0)], true;
    six_that_are_free_and_see_both: 6, [FREE, LOOSE], CONCAT, [(1, 0), (0, 0), (0, 0)], false;
    six_that_are_free_and_see_differences: 6, [FREE, LOOSE], DIFFERENCE, [(1, 0), (0, 0), (1, 0)], true;
    seven_of_six_types: 7,
        [TRANSLATION, ANGLE, WRAPPED_AND_VELOCITY, ROD, SLIDE, LINEAR], DISTANCE,
        [(4, 0), (5, 1), (3, 2), (0, 3), (1, 2), (2, 0), (3, 6)], true;
    eight_in_line: 8, [ANGLE], None,
        [(0, 0), (0, 1), (0, 2), (0, 3), (0, 4), (0, 5), (0, 6), (0, 7)], true;
    eight_apart: 8, [LOOSE], DISTANCE, [(0, 0), (0, 0), (0, 0), (0, 0)], false;
    twelve_in_line: 12, [SLIDE, ROD, ANGLE_AND_VELOCITY], DIFFERENCE,
        [(0, 0), (1, 1), (2, 2), (1, 3), (2, 4), (1, 5), (2, 6), (1, 7), (2, 8), (1, 9), (2, 10), (1, 11)], true;
    twelve_elements_of_sixteen_coordinates: 16, [FREE, ROD, TRANSLATION, LOOSE], INVERSE,
        [(0, 0), (1, 1), (1, 2), (3, 0), (2, 4), (0, 0), (1, 1), (2, 5), (3, 0), (1, 6), (1, 4), (2, 8)], true;
}

#[test]
fn every_type_beside_every_pair_potential() {
    let seven = [(0, 0), (1, 1), (2, 2), (3, 0), (4, 4), (5, 2), (0, 6)];
    let types = [TRANSLATION, ANGLE, WRAPPED, LINEAR, LIGHT_ROD, SLIDE];
    let eight = [(0, 0), (1, 1), (2, 1), (3, 3), (4, 0), (5, 5), (3, 0)];
    let with_velocities =
        [TRANSLATION_AND_VELOCITY, ANGLE_AND_VELOCITY, WRAPPED_AND_VELOCITY, ROD, FREE, SLIDE];
    for (pair, seed) in [None, CONCAT, DIFFERENCE, DISTANCE, INVERSE].into_iter().zip(20..) {
        let case = |types: [TypeShape; 6], elements: [(u8, u8); 7]| Case {
            types: types.to_vec(),
            pair,
            elements: elements.to_vec(),
            damped: true,
        };
        case(types, seven).check::<7>(seed);
        case(with_velocities, eight).check::<8>(seed);
    }
}

#[test]
fn what_is_no_tree_is_refused() {
    let case = Case { types: vec![ROD], pair: None, elements: vec![(0, 0)], damped: false };
    let refusal = |shape: &ModularShape, elements: &[(u8, u8)]| {
        ModularEnergies::new(shape, &nodes(elements), false).unwrap_err()
    };
    let mut shape = case.shape();
    assert_eq!(refusal(&shape, &[]), ModelError::Tree(TreeError::Empty));
    let later = TreeError::Parent { element: 0, parent: 0 };
    assert_eq!(refusal(&shape, &[(0, 1)]), ModelError::Tree(later));
    let missing = TreeError::Kind { element: 1, kind: 2, kinds: 1 };
    assert_eq!(refusal(&shape, &[(0, 0), (2, 1)]), ModelError::Tree(missing));
    shape.pair = Some(PairShape { network: 6, input: PairInput::Concat });
    let unfit = ModelError::OutOfRange { what: "network of the pair potential" };
    assert_eq!(refusal(&shape, &[(0, 0)]), unfit);
}
