//! Weights in half precision: the model equals, bit for bit, the model with the same numbers in single precision.

use crate::common::file::{
    self, ARM_NUMBERS, Aligned, CARTPOLE, HEADER, WEB_NUMBERS, arm, arm_header, arm_weights, web, web_header,
    web_weights,
};
use leastaction_core::constraints::Holonomic;
use leastaction_core::continuous::acceleration;
use leastaction_core::discrete::{Control, Del, Galerkin, State};
use leastaction_core::energy::graph::{Edge, Fixed, Graph};
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::{
    GraphModel, Header, InertiaNetworkModel, Law, ModelError, ModularModel, parse,
};
use leastaction_core::scalar::{WeightFormat, Weights, f16};
use proptest::prelude::*;

/// Both files of the same numbers.
fn files(header: Header, weights: &[f32]) -> [Aligned; 2] {
    [file::write(header, weights), file::write_half(header, weights)].map(|bytes| Aligned::new(&bytes))
}

/// Placeholder for a rod that is not read yet.
const UNUSED: Holonomic<f32, 2> = Holonomic::Anchor { node: 0, to: [0.0; 2], length: 1.0 };

/// An acceleration and a step of order 4, as bits.
fn motion<L, F, const N: usize>(system: &System<L, F>) -> Vec<u32>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    let (q, v) = (std::array::from_fn(|i| 0.3 + i as f32), std::array::from_fn(|i| 0.5 - i as f32));
    let a = acceleration(system, &q, &v, &[0.0; N]).unwrap();
    let mut state = State::new(&system.lagrangian, q, v).unwrap();
    let step = Del::<f32, Galerkin>::new(0.01).step(system, &mut state, &Control::none());
    assert!(step.is_ok(), "{step:?}");
    [a, state.q(), state.p()].concat().iter().map(|x| x.to_bits()).collect()
}

#[test]
fn a_inertia_network_model_has_the_bits_of_its_numbers() {
    let weights = file::weights(&CARTPOLE);
    let [single, half] = files(HEADER, &weights);
    assert!(half.bytes().len() + 2 * weights.len() <= single.bytes().len() + 4);
    let (single, half) = (
        InertiaNetworkModel::<2, 8, 2>::load(single.bytes()).unwrap(),
        InertiaNetworkModel::<2, 8, 2, f16>::load(half.bytes()),
    );
    assert_eq!(motion(&single.system), motion(&half.unwrap().system));
}

#[test]
fn a_tree_has_the_bits_of_its_numbers() {
    let [single, half] = files(arm_header(arm()), &arm_weights(ARM_NUMBERS));
    let single = ModularModel::<3, 3, 5, 2>::load(single.bytes(), "arm").unwrap();
    let half = ModularModel::<3, 3, 5, 2, f16>::load(half.bytes(), "arm").unwrap();
    assert_eq!(motion(&single.system), motion(&half.system));
}

#[test]
fn a_graph_has_the_bits_of_its_numbers() {
    fn system<W: WeightFormat<Wide = f32>>(graph: Graph<W, 2, 6, 5, 1>) -> Vec<u32> {
        let fixed = Fixed::<_, 2, 6, 5, 1, 6>::new(graph).unwrap();
        motion(&System { lagrangian: fixed, forces: fixed })
    }
    let [single, half] = files(web_header(web()), &web_weights(WEB_NUMBERS));
    let (mut edges, mut rods) = ([[Edge::default(); 3]; 2], [[UNUSED; 2]; 2]);
    let ([of_single, of_half], [rods_of_single, rods_of_half]) = (&mut edges, &mut rods);
    let single = GraphModel::<2, 6, 5, 1>::load(single.bytes(), "ring", of_single, rods_of_single).unwrap();
    let half = GraphModel::<2, 6, 5, 1, f16>::load(half.bytes(), "ring", of_half, rods_of_half).unwrap();
    assert_eq!(system(single.system.graph), system(half.system.graph));
    assert_eq!(single.system.rods, half.system.rods);
}

#[test]
fn every_file_says_its_precision() {
    for (header, weights) in [
        (HEADER, file::weights(&CARTPOLE)),
        (arm_header(arm()), arm_weights(ARM_NUMBERS)),
        (web_header(web()), web_weights(WEB_NUMBERS)),
    ] {
        let [single, half] = files(header, &weights);
        let (single, half) = (parse(single.bytes()).unwrap(), parse(half.bytes()).unwrap());
        assert!(matches!(single.weights, Weights::Single(_)) && matches!(half.weights, Weights::Half(_)));
        assert_eq!([single.weights.bits(), half.weights.bits()], [32, 16]);
        assert!(half.weights.iter().eq(weights.iter().copied()), "the numbers are exact in half precision");
        assert_eq!(single.header, half.header);
    }
}

#[test]
fn a_program_of_one_precision_refuses_the_other() {
    let [single, half] = files(HEADER, &file::weights(&CARTPOLE));
    let refusal = InertiaNetworkModel::<2, 8, 2>::load(half.bytes()).unwrap_err();
    assert_eq!(refusal, ModelError::Precision { found: 16, compiled: 32 });
    let refusal = InertiaNetworkModel::<2, 8, 2, f16>::load(single.bytes()).unwrap_err();
    assert_eq!(refusal, ModelError::Precision { found: 32, compiled: 16 });
    assert!(refusal.to_string().contains("32 bits"), "{refusal}");
}

#[test]
fn halves_must_be_finite_as_many_as_needed_and_aligned() {
    let mut weights = file::weights(&CARTPOLE);
    let load =
        |file: &Aligned| InertiaNetworkModel::<2, 8, 2, f16>::load(file.bytes()).map(|_| ()).unwrap_err();
    let needed = weights.len();
    weights.push(0.5);
    let more = Aligned::new(&file::write_half(HEADER, &weights));
    assert_eq!(load(&more), ModelError::WeightCount { found: needed + 1, needed });
    weights.pop();
    weights[3] = 7e4;
    let infinite = Aligned::new(&file::write_half(HEADER, &weights));
    assert_eq!(load(&infinite), ModelError::NotFinite { index: 3 });
    weights[3] = 0.5;
    weights[needed - 1] = -0.5;
    let damping = Aligned::new(&file::write_half(HEADER, &weights));
    let refused = ModelError::LawNumber { law: Law::Viscous, number: 0, group: 1, value: -0.5 };
    assert_eq!(load(&damping), refused);
    let shifted = Aligned::shifted(&file::write_half(HEADER, &file::weights(&CARTPOLE)), 2);
    let refusal = InertiaNetworkModel::<2, 8, 2, f16>::load(&shifted.bytes()[2..]).unwrap_err();
    assert_eq!(refusal, ModelError::Unaligned { offset: 2 });
}

#[test]
fn damage_is_refused() {
    let file = file::write_half(HEADER, &file::weights(&CARTPOLE));
    file::assert_truncations_are_refused(&file);
    file::assert_changes_are_refused(&file);
}

#[test]
fn every_half_is_widened_exactly() {
    for bits in 0..=u16::MAX {
        let half = f16::from_bits(bits);
        // The number as the format defines it, except for NaN.
        let (sign, exponent, fraction) =
            (bits >> 15, i32::from(bits >> 10 & 31), f64::from(bits & 1023) / 1024.0);
        let size = match exponent {
            0 => fraction * 2_f64.powi(-14),
            31 if fraction == 0.0 => f64::INFINITY,
            31 => f64::NAN,
            _ => (1.0 + fraction) * 2_f64.powi(exponent - 15),
        };
        let expected = if sign == 0 { size } else { -size };
        let wide = f64::from(half.wide());
        assert!(wide.to_bits() == expected.to_bits() || (wide.is_nan() && expected.is_nan()), "{bits:04x}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Weights of any bits, subnormal ones too.
    #[test]
    fn any_weights_have_the_bits_of_their_numbers(bits in prop::collection::vec(any::<u16>(), 200)) {
        let mut weights = file::weights(&CARTPOLE);
        let bits = bits.into_iter().cycle().map(|b| f16::from_bits(b & 0xbbff).to_f32());
        let networks = weights.len() - 2;
        weights.iter_mut().take(networks).zip(bits).for_each(|(w, b)| *w = b);
        let [single, half] = files(HEADER, &weights);
        let single = InertiaNetworkModel::<2, 8, 2>::load(single.bytes()).unwrap().system.lagrangian;
        let half = InertiaNetworkModel::<2, 8, 2, f16>::load(half.bytes()).unwrap().system.lagrangian;
        let (q, v) = ([0.3, -1.5], [2.0, 0.5]);
        let (of_single, of_half) = (single.hessian(&q, &v), half.hessian(&q, &v));
        prop_assert_eq!(of_single.l_qq.map(|row| row.map(f32::to_bits)), of_half.l_qq.map(|row| row.map(f32::to_bits)));
        prop_assert_eq!(of_single.l_q.map(f32::to_bits), of_half.l_q.map(f32::to_bits));
    }
}
