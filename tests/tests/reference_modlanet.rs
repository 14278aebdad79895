//! A double pendulum that was trained with the ModLaNet authors' program against arrays exported from it. The data is not ours
//! to ship: these tests run where `LEASTACTION_REFERENCE` names its folder.

#[path = "common/reference.rs"]
mod reference;

use leastaction_core::continuous::acceleration;
use leastaction_core::energy::modular::{ELEMENT_PARAMETERS, MAX_TYPES};
use leastaction_core::forces::{Forces, System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::Laws;
use leastaction_core::scalar::Real;
use leastaction_ground_truth::ManyBody;
use leastaction_learning::data::modlanet as layout;
use leastaction_learning::import::{Imported, modlanet};
use leastaction_learning::training::{LossKind, Objective, Samples, objective};
use leastaction_models::{Architecture, ModularArchitecture};
use reference::{Arrays, EXACT, assert_close, assert_within, data, in_single, scale};
use std::fs;
use std::path::PathBuf;

/// Number of coordinates.
const N: usize = 2;
/// Maximum number of units in a hidden layer.
const WIDTH: usize = 50;
/// Agreement in single precision: tens of units in the last place, since velocities and angles are rounded to it too.
const SINGLE: f64 = 3e-6;
/// Count of the numbers after the networks: those of the only type, then c₁ and c₂, then the damping of the type.
const TAIL: usize = ELEMENT_PARAMETERS + 2 + 1;

fn path(name: &str) -> PathBuf {
    data("modlanet").join(name)
}

fn network(name: &str) -> Imported {
    let weights = fs::read(path(name)).expect("weights");
    modlanet(&weights, ManyBody::Pendulum(N), None).expect("import")
}

/// Gradient under this prefix in the order of our weight block, with their derivatives in co2 and in the mass.
fn gradient(arrays: &Arrays, prefix: &str) -> Vec<f64> {
    let imported = modlanet(&arrays.as_weights(prefix), ManyBody::Pendulum(N), Some(1.0));
    let mut gradient = imported.expect("gradient as weights").weights;
    let start = gradient.len() - TAIL;
    gradient[start..start + ELEMENT_PARAMETERS].fill(0.0);
    gradient[start] = arrays.get(&format!("{prefix}mass.weight"))[0];
    gradient
}

/// Results of a model at the states.
#[derive(Default)]
struct Values {
    kinetic: Vec<f64>,
    potential: Vec<f64>,
    l_q: Vec<f64>,
    l_v: Vec<f64>,
    mass: Vec<f64>,
    l_vq: Vec<f64>,
    acceleration: Vec<f64>,
}

fn values<R, L, F>(system: &System<L, F>, (q, v): (&[f64], &[f64]), real: fn(f64) -> R) -> Values
where
    R: Real,
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    let mut out = Values::default();
    for (q, v) in q.as_chunks::<N>().0.iter().zip(v.as_chunks::<N>().0) {
        let (q, v) = (q.map(real), v.map(real));
        let energies = system.lagrangian.energies(&q, &v);
        out.kinetic.push(energies.kinetic.to_f64());
        out.potential.push(energies.potential.to_f64());
        let gradient = system.lagrangian.gradient(&q, &v);
        out.l_q.extend(gradient.l_q.map(R::to_f64));
        out.l_v.extend(gradient.l_v.map(R::to_f64));
        out.mass.extend(system.lagrangian.dynamics(&q, &v).mass.as_flattened().iter().map(|x| x.to_f64()));
        out.l_vq.extend(system.lagrangian.hessian(&q, &v).l_vq.as_flattened().iter().map(|x| x.to_f64()));
        let a = acceleration(system, &q, &v, &[real(0.0); N]).expect("mass");
        out.acceleration.extend(a.map(R::to_f64));
    }
    out
}

fn evaluate<R: Real>(
    modular: &ModularArchitecture,
    weights: &[R::Weight],
    states: (&[f64], &[f64]),
    real: fn(f64) -> R,
) -> Values {
    let system = modular.header().system::<_, R, Viscous<R, N>, N, MAX_TYPES, WIDTH, 2>(
        &modular.tree_header(),
        Laws::VISCOUS,
        weights,
    );
    values(&system.expect("shape"), states, real)
}

fn modular(architecture: &Architecture) -> &ModularArchitecture {
    architecture.family.modular().expect("modular")
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn energies_and_derivatives_agree() {
    let Imported { architecture, weights, discrete } = network("2_pend_network.safetensors");
    assert!(!discrete);
    let reference = Arrays::open(&path("2_pend_reference.npz"));
    let (q, v) = (reference.get("q"), reference.get("qdot"));
    let modular = modular(&architecture);
    let double = evaluate(modular, &weights, (&q, &v), |x| x);
    let single = evaluate(modular, &in_single(&weights), (&q, &v), |x| x as f32);
    for (ours, what, bound) in [(double, "f64", EXACT), (single, "f32", SINGLE)] {
        let check = |key: &str, ours: &[f64]| {
            assert_close(&format!("{key} {what}"), ours, &reference.get(key), bound)
        };
        check("T", &ours.kinetic);
        check("U", &ours.potential);
        check("dLdq", &ours.l_q);
        check("dLdqdot", &ours.l_v);
        check("M", &ours.mass);
        check("C", &ours.l_vq);
        check("qddot", &ours.acceleration);
        let difference: Vec<f64> = ours.kinetic.iter().zip(&ours.potential).map(|(t, u)| t - u).collect();
        check("L", &difference);
    }
}

/// Converts our gradient of the mean square to theirs: their pair potential has co2 where ours has m c₂, and no network has a bias in its
/// last layer.
fn in_their_terms(modular: &ModularArchitecture, weights: &[f64], ours: &[f64]) -> Vec<f64> {
    let mut gradient = ours.to_vec();
    for (end, outputs) in blocks(modular) {
        gradient[end - outputs..end].fill(0.0);
    }
    let (mass, c2) = (weights.len() - TAIL, weights.len() - 2);
    gradient[mass] -= weights[c2] / weights[mass] * ours[c2];
    gradient[c2] /= weights[mass];
    gradient
}

/// End of each network in the weight block, and its number of outputs.
fn blocks(modular: &ModularArchitecture) -> Vec<(usize, usize)> {
    let networks =
        modular.shape.networks.iter().map(|n| (n.parameters().expect("size"), usize::from(n.outputs)));
    networks
        .scan(0, |end, (parameters, outputs)| {
            *end += parameters;
            Some((*end, outputs))
        })
        .collect()
}

/// The rows of a set, all or some.
fn samples(rows: &layout::ModlanetRows, some: Option<&[usize]>) -> Samples {
    let all = Samples::modlanet(rows);
    let Some(some) = some else { return all };
    let pick = |x: &Vec<f64>| some.iter().flat_map(|k| &x[N * k..N * (k + 1)]).copied().collect();
    Samples { states: all.states.each_ref().map(pick), controls: all.controls.each_ref().map(pick), ..all }
}

fn acceleration_loss(architecture: &Architecture, samples: Samples) -> Box<dyn Objective> {
    objective(architecture, samples, LossKind::Acceleration, 2).expect("shape")
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn losses_and_parameter_gradients_agree() {
    let set = layout::read(path("2_pend_modlanet.npz")).expect("data");
    let training = Arrays::open(&path("2_pend_training.npz"));
    let rows: Vec<usize> = training.get("rows").iter().map(|k| *k as usize).collect();
    for (name, what) in [("2_pend_initial_network", "init"), ("2_pend_network", "trained")] {
        let Imported { architecture, weights, .. } = network(&format!("{name}.safetensors"));
        let modular = modular(&architecture);
        let some = acceleration_loss(&architecture, samples(&set.train, Some(&rows)));
        let check = |key: String, loss: f64| assert_close(&key, &[loss], &training.get(&key), EXACT);
        check(format!("loss_{what}"), some.loss(&weights));
        for (part, rows) in [("train", &set.train), ("test", &set.test)] {
            let all = acceleration_loss(&architecture, samples(rows, None));
            check(format!("full_{part}_loss_{what}"), all.loss(&weights));
        }
        let equations = some.gradient(&weights, 0..some.samples()).expect("finite");
        let factor = 2.0 / equations.rows as f64;
        let ours: Vec<f64> = equations.gradient.iter().map(|g| factor * g).collect();
        let ours = in_their_terms(modular, &weights, &ours);
        let theirs = gradient(&training, &format!("grad_{what}/"));
        let mut start = 0;
        for (k, (end, _)) in blocks(modular).into_iter().enumerate() {
            assert_close(
                &format!("{what}: gradient, network {k}"),
                &ours[start..end],
                &theirs[start..end],
                EXACT,
            );
            start = end;
        }
        let mass = start;
        assert_close(
            &format!("{what}: gradient, c1 and c2"),
            &ours[mass + ELEMENT_PARAMETERS..],
            &theirs[mass + ELEMENT_PARAMETERS..],
            EXACT,
        );
        // The mass multiplies all of L: its gradient is 0, in both programs up to rounding.
        let numbers = mass..mass + ELEMENT_PARAMETERS;
        assert_within(
            &format!("{what}: gradient, mass"),
            &ours[numbers.clone()],
            &theirs[numbers],
            scale(&theirs),
            EXACT,
        );
    }
}
