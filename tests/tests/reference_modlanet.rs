//! A double pendulum that was trained with the ModLaNet authors' program against arrays exported from it. The data is not ours
//! to ship: these tests run where `LEASTACTION_REFERENCE` names its folder.

use leastaction::architecture::{Architecture, Family, ModularArchitecture, Visitor};
use leastaction::data::modlanet as layout;
use leastaction::ground_truth::ManyBody;
use leastaction::import::{Imported, modlanet};
use leastaction::training::{LossKind, Objective, Samples, objective};
use leastaction_core::continuous::acceleration;
use leastaction_core::energy::modular::{MAX_TYPES, NUMBERS};
use leastaction_core::forces::System;
use leastaction_core::lagrangian::{DenseMass, Lagrangian};
use leastaction_core::scalar::Real;
use ndarray::ArrayD;
use ndarray_npy::{NpzReader, ReadableElement};
use safetensors::tensor::{Dtype, TensorView};
use std::fs::{self, File};
use std::path::PathBuf;

/// Coordinates.
const N: usize = 2;
/// Units of a hidden layer at most.
const WIDTH: usize = 50;
/// Agreement in double precision, relative to the largest entry.
const EXACT: f64 = 1e-10;
/// Agreement of single precision: tens of units in the last place, for velocities and angles are rounded to it too.
const SINGLE: f64 = 3e-6;
/// The numbers after the networks: those of the one type, then c₁ and c₂.
const TAIL: usize = NUMBERS + 2;

fn path(name: &str) -> PathBuf {
    let folder =
        std::env::var("LEASTACTION_REFERENCE").expect("LEASTACTION_REFERENCE names the reference data");
    let folder = PathBuf::from(folder);
    let base = if folder.is_absolute() {
        folder
    } else {
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").join(folder)
    };
    base.join("modlanet").join(name)
}

fn network(name: &str) -> Imported {
    let weights = fs::read(path(name)).expect("weights");
    modlanet(&weights, ManyBody::Pendulum(N), None).expect("import")
}

struct Arrays(NpzReader<File>);

impl Arrays {
    fn open(name: &str) -> Self {
        Self(NpzReader::new(File::open(path(name)).expect("arrays")).expect("npz"))
    }

    fn array<T: ReadableElement>(&mut self, key: &str) -> ArrayD<T> {
        self.0.by_name(key).unwrap_or_else(|error| panic!("{key}: {error}"))
    }

    fn get(&mut self, key: &str) -> Vec<f64> {
        self.array(key).iter().copied().collect()
    }

    /// The gradient under this prefix in the order of our weight block, with their derivatives in co2 and in the mass:
    /// importing it as if it were weights, of mass 1, puts it there.
    fn gradient(&mut self, prefix: &str) -> Vec<f64> {
        let names = self.0.names().expect("names");
        let names = names.iter().filter_map(|name| name.trim_end_matches(".npy").strip_prefix(prefix));
        let names: Vec<String> = names.map(str::to_owned).collect();
        let tensors: Vec<(String, Vec<usize>, Vec<u8>)> = names
            .into_iter()
            .map(|name| {
                let array = self.array::<f64>(&format!("{prefix}{name}"));
                let bytes = array.iter().flat_map(|x| x.to_le_bytes()).collect();
                (name, array.shape().to_vec(), bytes)
            })
            .collect();
        let views = tensors.iter().map(|(name, shape, bytes)| {
            (name.clone(), TensorView::new(Dtype::F64, shape.clone(), bytes).expect("tensor"))
        });
        let file = safetensors::serialize(views, None).expect("safetensors");
        let imported = modlanet(&file, ManyBody::Pendulum(N), Some(1.0)).expect("gradient as weights");
        let mut gradient = imported.weights;
        let start = gradient.len() - TAIL;
        gradient[start..start + NUMBERS].fill(0.0);
        gradient[start] = self.get(&format!("{prefix}mass.weight"))[0];
        gradient
    }
}

/// The largest entry.
fn scale(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// The largest difference, relative to `scale`.
fn assert_within(what: &str, ours: &[f64], theirs: &[f64], scale: f64, bound: f64) {
    assert_eq!(ours.len(), theirs.len());
    let difference = ours.iter().zip(theirs).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / scale;
    println!("{what}: {difference:.1e}");
    assert!(difference <= bound, "{what}: {difference:e} > {bound:e}");
}

fn assert_close(what: &str, ours: &[f64], theirs: &[f64], bound: f64) {
    assert_within(what, ours, theirs, scale(theirs), bound);
}

/// Everything a model gives at the states.
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

fn values<R, L, F, const M: usize>(
    system: &System<L, F>,
    (q, v): (&[f64], &[f64]),
    real: fn(f64) -> R,
) -> Values
where
    R: Real,
    L: Lagrangian<R, M, Mass = DenseMass<R, M>>,
    F: leastaction_core::forces::Forces<R, M>,
{
    let mut out = Values::default();
    for (q, v) in q.as_chunks::<M>().0.iter().zip(v.as_chunks::<M>().0) {
        let (q, v) = (q.map(real), v.map(real));
        let energies = system.lagrangian.energies(&q, &v);
        out.kinetic.push(energies.kinetic.to_f64());
        out.potential.push(energies.potential.to_f64());
        let gradient = system.lagrangian.gradient(&q, &v);
        out.l_q.extend(gradient.l_q.map(R::to_f64));
        out.l_v.extend(gradient.l_v.map(R::to_f64));
        out.mass.extend(system.lagrangian.dynamics(&q, &v).mass.0.as_flattened().iter().map(|x| x.to_f64()));
        out.l_vq.extend(system.lagrangian.hessian(&q, &v).l_vq.as_flattened().iter().map(|x| x.to_f64()));
        let a = acceleration(system, &q, &v, &[real(0.0); M]).expect("mass");
        out.acceleration.extend(a.map(R::to_f64));
    }
    out
}

struct Double<'a> {
    weights: &'a [f64],
    states: (&'a [f64], &'a [f64]),
}

impl Visitor for Double<'_> {
    type Output = Values;

    fn visit<F: Family<M> + Clone + 'static, const M: usize>(self, family: &F) -> Values {
        values(&family.system::<f64>(self.weights).expect("shape"), self.states, |x| x)
    }
}

fn single(modular: &ModularArchitecture, weights: &[f64], states: (&[f64], &[f64])) -> Values {
    let weights: Vec<f32> = weights.iter().map(|w| *w as f32).collect();
    let system = modular
        .header()
        .system::<f32, N, MAX_TYPES, WIDTH, 2>(&modular.tree_header(), &weights)
        .expect("shape");
    values(&system, states, |x| x as f32)
}

fn modular(architecture: &Architecture) -> &ModularArchitecture {
    architecture.modular().expect("modular")
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn energies_and_derivatives_agree() {
    let Imported { architecture, weights, discrete } = network("2_pend_network.safetensors");
    assert!(!discrete);
    let mut reference = Arrays::open("2_pend_reference.npz");
    let (q, v) = (reference.get("q"), reference.get("qdot"));
    let double = architecture.dispatch(Double { weights: &weights, states: (&q, &v) }).expect("shape");
    let single = single(modular(&architecture), &weights, (&q, &v));
    for (ours, what, bound) in [(double, "f64", EXACT), (single, "f32", SINGLE)] {
        let mut check = |key: &str, ours: &[f64]| {
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

/// Their gradient of the mean square from ours: their pair potential has co2 where ours has m c₂, and no network has a
/// bias in its last layer.
fn in_their_terms(modular: &ModularArchitecture, weights: &[f64], ours: &[f64]) -> Vec<f64> {
    let mut gradient = ours.to_vec();
    for (end, outputs) in blocks(modular) {
        gradient[end - outputs..end].fill(0.0);
    }
    let (mass, c2) = (weights.len() - TAIL, weights.len() - 1);
    gradient[mass] -= weights[c2] / weights[mass] * ours[c2];
    gradient[c2] /= weights[mass];
    gradient
}

/// Where each network ends in the weight block, and how many outputs it has.
fn blocks(modular: &ModularArchitecture) -> Vec<(usize, usize)> {
    let networks = modular.shape.networks().map(|n| (n.parameters().expect("size"), usize::from(n.outputs)));
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
    let mut training = Arrays::open("2_pend_training.npz");
    let rows: Vec<usize> = training.array::<i64>("rows").iter().map(|k| *k as usize).collect();
    for (name, what) in [("2_pend_initial_network", "init"), ("2_pend_network", "trained")] {
        let Imported { architecture, weights, .. } = network(&format!("{name}.safetensors"));
        let modular = modular(&architecture);
        let some = acceleration_loss(&architecture, samples(&set.train, Some(&rows)));
        let mut check = |key: String, loss: f64| assert_close(&key, &[loss], &training.get(&key), EXACT);
        check(format!("loss_{what}"), some.loss(&weights));
        for (part, rows) in [("train", &set.train), ("test", &set.test)] {
            let all = acceleration_loss(&architecture, samples(rows, None));
            check(format!("full_{part}_loss_{what}"), all.loss(&weights));
        }
        let equations = some.gradient(&weights, 0..some.samples()).expect("finite");
        let factor = 2.0 / equations.rows as f64;
        let ours: Vec<f64> = equations.gradient.iter().map(|g| factor * g).collect();
        let ours = in_their_terms(modular, &weights, &ours);
        let theirs = training.gradient(&format!("grad_{what}/"));
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
            &ours[mass + NUMBERS..],
            &theirs[mass + NUMBERS..],
            EXACT,
        );
        // The mass multiplies all of L: its gradient is 0, in both programs up to rounding.
        let numbers = mass..mass + NUMBERS;
        assert_within(
            &format!("{what}: gradient, mass"),
            &ours[numbers.clone()],
            &theirs[numbers],
            scale(&theirs),
            EXACT,
        );
    }
}
