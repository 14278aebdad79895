//! Networks that were trained with the SyMo authors' program against arrays exported from it. The data is not ours to ship:
//! these tests run where `LEASTACTION_REFERENCE` names its folder.

use leastaction::architecture::{Architecture, Family, MAX_WIDTH, Visitor};
use leastaction::import::{Imported, symo};
use leastaction::training::{LossKind, Samples, objective};
use leastaction_core::continuous::acceleration;
use leastaction_core::discrete::{Control, Del, Interval, Midpoint};
use leastaction_core::energy::rigid::Coordinate;
use leastaction_core::forces::System;
use leastaction_core::lagrangian::Lagrangian;
use ndarray_npy::NpzReader;
use safetensors::tensor::{Dtype, TensorView};
use std::fs::{self, File};
use std::path::PathBuf;

const CASES: [(&str, &[Coordinate], f64); 2] = [
    ("pendulum", &[Coordinate::Angle], 0.1),
    ("cartpole", &[Coordinate::Translation, Coordinate::Angle], 0.05),
];

/// Relative agreement in double precision.
const EXACT: f64 = 1e-10;
/// Agreement of single precision, relative to the largest entry: tens of units in the last place, for the sums run over
/// 256 terms and the acceleration divides by an inertia of 1/30.
const SINGLE: f64 = 3e-6;

fn folder() -> PathBuf {
    let folder =
        std::env::var("LEASTACTION_REFERENCE").expect("LEASTACTION_REFERENCE names the reference data");
    let folder = PathBuf::from(folder);
    let base = if folder.is_absolute() {
        folder
    } else {
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").join(folder)
    };
    base.join("symo")
}

struct Reference {
    arrays: NpzReader<File>,
    imported: Imported,
    h: f64,
}

impl Reference {
    fn open(name: &str, coordinates: &[Coordinate], h: f64) -> Self {
        let file = |extension| folder().join(format!("{name}.{extension}"));
        let weights = fs::read(file("safetensors")).expect("weights");
        let arrays = NpzReader::new(File::open(file("npz")).expect("arrays")).expect("npz");
        Self { arrays, imported: symo(&weights, coordinates).expect("import"), h }
    }

    fn get(&mut self, key: &str) -> Vec<f64> {
        let array: ndarray::ArrayD<f64> = self.arrays.by_name(key).unwrap_or_else(|e| panic!("{key}: {e}"));
        array.iter().copied().collect()
    }

    fn samples(&mut self) -> Samples {
        let n = self.imported.architecture.n();
        let states = ["q_prev", "q", "q_next"].map(|key| self.get(key));
        let controls = ["u_prev", "u", "u_next"].map(|key| self.get(key));
        Samples { n, h: self.h, states, controls }
    }

    /// The gradient that the file has under this prefix, in the order of our weight block: importing it as if it were weights
    /// puts it there.
    fn gradient(&mut self, prefix: &str, coordinates: &[Coordinate]) -> Vec<f64> {
        let names = self.arrays.names().expect("names");
        let names =
            names.iter().filter_map(|name| name.strip_suffix(".npy").unwrap_or(name).strip_prefix(prefix));
        let names: Vec<String> = names.map(str::to_owned).collect();
        let tensors: Vec<(String, Vec<usize>, Vec<u8>)> = names
            .into_iter()
            .map(|name| {
                let array: ndarray::ArrayD<f64> =
                    self.arrays.by_name(&format!("{prefix}{name}")).expect("gradient");
                let bytes = array.iter().flat_map(|x| x.to_le_bytes()).collect();
                (name, array.shape().to_vec(), bytes)
            })
            .collect();
        let views = tensors.iter().map(|(name, shape, bytes)| {
            (name.clone(), TensorView::new(Dtype::F64, shape.clone(), bytes).expect("tensor"))
        });
        let file = safetensors::serialize(views, None).expect("safetensors");
        symo(&file, coordinates).expect("gradient as weights").weights
    }
}

/// The largest difference relative to the largest entry.
fn difference(ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let scale = theirs.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    ours.iter().zip(theirs).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / scale
}

fn assert_close(what: &str, ours: &[f64], theirs: &[f64], bound: f64) {
    let difference = difference(ours, theirs);
    println!("{what}: {difference:.1e}");
    assert!(difference <= bound, "{what}: {difference:e} > {bound:e}");
}

/// Everything a discrete model gives at the samples, in f64 and in f32.
#[derive(Default)]
struct Values {
    inertia: Vec<f64>,
    potential: Vec<f64>,
    residual: Vec<f64>,
    jacobian: Vec<f64>,
    next: Vec<f64>,
}

struct Evaluate<'a> {
    architecture: &'a Architecture,
    weights: &'a [f64],
    samples: &'a Samples,
    single: bool,
}

impl Visitor for Evaluate<'_> {
    type Output = Values;

    fn visit<F: Family<N>, const N: usize>(self, family: &F) -> Values {
        if self.single {
            let weights: Vec<f32> = self.weights.iter().map(|w| *w as f32).collect();
            let system =
                self.architecture.rigid().unwrap().system::<f32, N, MAX_WIDTH>(&weights).expect("shape");
            values(&system, self.samples, |x| x as f32)
        } else {
            let system = family.system::<f64>(self.weights).expect("shape");
            values(&system, self.samples, |x| x)
        }
    }
}

fn values<R, L, F, const N: usize>(system: &System<L, F>, samples: &Samples, real: fn(f64) -> R) -> Values
where
    R: leastaction_core::scalar::Real,
    L: Lagrangian<R, N>,
    L::Mass: leastaction_core::lagrangian::MassMatrix<R, N>,
    F: leastaction_core::forces::Forces<R, N>,
{
    use leastaction_core::lagrangian::MassMatrix;
    let h = real(samples.h);
    let del = Del::<R, Midpoint>::new(h);
    let mut out = Values::default();
    for k in 0..samples.len() {
        let row = |x: &[f64]| -> [R; N] { std::array::from_fn(|i| real(x[k * N + i])) };
        let [q0, q1, q2] = samples.states.each_ref().map(|x| row(x));
        let [u0, u1, u2] = samples.controls.each_ref().map(|x| row(x));
        let zero = [R::zero(); N];
        let mass = system.lagrangian.dynamics(&q1, &zero).mass.dense();
        out.inertia.extend(mass.as_flattened().iter().map(|x| x.to_f64()));
        out.potential.push(system.lagrangian.energies(&q1, &zero).potential.to_f64());
        let before = Control { start: u0, end: u1 };
        let after = Control { start: u1, end: u2 };
        let mut state = del.start(system, &q0, &q1, &before).expect("start");
        let w: [R; N] = std::array::from_fn(|i| (q2[i] - q1[i]) / h);
        let ahead = Interval::<R, Midpoint, N>::new(q1, w, h, after).linearise(system);
        let p = state.p();
        out.residual.extend((0..N).map(|i| (p[i] + ahead.balance.d1_ld[i]).to_f64()));
        // Ours is the derivative in w = (q₊ − q)/h.
        out.jacobian.extend(ahead.momentum_w.as_flattened().iter().map(|x| (*x / h).to_f64()));
        del.step(system, &mut state, &after).expect("step");
        out.next.extend(state.q().iter().map(|x| x.to_f64()));
    }
    out
}

fn evaluate(reference: &Reference, samples: &Samples, single: bool) -> Values {
    let Imported { architecture, weights, .. } = &reference.imported;
    architecture.dispatch(Evaluate { architecture, weights, samples, single }).expect("shape")
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn discrete_models_agree() {
    for (system, coordinates, h) in CASES {
        for model in ["SyMo", "N-SyMo"] {
            let name = format!("{system}-{model}-32");
            let mut reference = Reference::open(&name, coordinates, h);
            let samples = reference.samples();
            for (single, bound) in [(false, EXACT), (true, SINGLE)] {
                let ours = evaluate(&reference, &samples, single);
                let mut check = |key: &str, ours: &[f64]| {
                    assert_close(&format!("{name} {key} single={single}"), ours, &reference.get(key), bound);
                };
                check("H_q", &ours.inertia);
                check("V_q", &ours.potential);
                check("J", &ours.jacobian);
                check("q_newton", &ours.next);
                if !single {
                    check("g", &ours.residual);
                }
            }
        }
    }
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn parameter_gradients_agree() {
    for (system, coordinates, h) in CASES {
        for (model, prefix, key, kind) in [
            ("SyMo", "grad_symo/", "symo_loss", LossKind::DelResidual),
            ("SyMo", "grad_e2e/", "e2e_loss", LossKind::NextPosition),
            ("N-SyMo", "grad_symo/", "symo_loss", LossKind::DelResidual),
            ("N-SyMo", "grad_e2e/", "e2e_loss", LossKind::NextPosition),
        ] {
            let name = format!("{system}-{model}-32");
            let mut reference = Reference::open(&name, coordinates, h);
            let samples = reference.samples();
            let (theirs, loss) = (reference.gradient(prefix, coordinates), reference.get(key));
            let Imported { architecture, weights, .. } = &reference.imported;
            let objective = objective(architecture, samples, kind, 2).expect("shape");
            let count = objective.samples();
            let equations = objective.gradient(weights, 0..count).expect("finite");
            let scale = 2.0 / equations.rows as f64;
            let ours: Vec<f64> = equations.gradient.iter().map(|g| g * scale).collect();
            assert_close(&format!("{name} {key}"), &[equations.mean_square()], &loss, EXACT);
            assert_close(&format!("{name} {prefix}"), &ours, &theirs, EXACT);
        }
    }
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn accelerations_agree() {
    for (system, coordinates, h) in CASES {
        let name = format!("{system}-L-NODE-rk4-32");
        let mut reference = Reference::open(&name, coordinates, h);
        let n = coordinates.len();
        // Here the three states are q, q̇ and τ.
        let states = ["q", "qdot", "tau"].map(|key| reference.get(key));
        let controls = std::array::from_fn(|_| vec![0.0; states[0].len()]);
        let samples = Samples { n, h, states, controls };
        let Imported { architecture, weights, discrete } = &reference.imported;
        assert!(!discrete);
        let acceleration = |single| {
            architecture
                .dispatch(Accelerations { architecture, weights, samples: &samples, single })
                .expect("shape")
        };
        let (exact, single) = (acceleration(false), acceleration(true));
        let theirs = reference.get("qddot");
        assert_close(&format!("{name} qddot"), &exact, &theirs, EXACT);
        assert_close(&format!("{name} qddot single"), &single, &theirs, SINGLE);
    }
}

struct Accelerations<'a> {
    architecture: &'a Architecture,
    weights: &'a [f64],
    samples: &'a Samples,
    single: bool,
}

impl Visitor for Accelerations<'_> {
    type Output = Vec<f64>;

    fn visit<F: Family<N>, const N: usize>(self, family: &F) -> Vec<f64> {
        let [q, v, u] = &self.samples.states;
        let rows = |x: &[f64]| -> Vec<[f64; N]> { x.as_chunks::<N>().0.to_vec() };
        let states = rows(q).into_iter().zip(rows(v)).zip(rows(u));
        if self.single {
            let weights: Vec<f32> = self.weights.iter().map(|w| *w as f32).collect();
            let system =
                self.architecture.rigid().unwrap().system::<f32, N, MAX_WIDTH>(&weights).expect("shape");
            let single = |x: [f64; N]| x.map(|x| x as f32);
            let a = states
                .map(|((q, v), u)| acceleration(&system, &single(q), &single(v), &single(u)).expect("mass"));
            a.flatten().map(f64::from).collect()
        } else {
            let system = family.system::<f64>(self.weights).expect("shape");
            states.flat_map(|((q, v), u)| acceleration(&system, &q, &v, &u).expect("mass")).collect()
        }
    }
}
