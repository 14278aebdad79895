//! Networks that were trained with the SyMo authors' program against arrays exported from it. The data is not ours to ship:
//! these tests run where `LEASTACTION_REFERENCE` names its folder.

#[path = "common/reference.rs"]
mod reference;

use leastaction_core::continuous::acceleration;
use leastaction_core::discrete::{Control, Del, Interval, Midpoint};
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::forces::{ControlKind, Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::scalar::Real;
use leastaction_learning::import::{Imported, symo};
use leastaction_learning::training::{LossKind, Samples, objective};
use leastaction_models::{InertiaNetworkArchitecture, MAX_WIDTH};
use reference::{Arrays, EXACT, assert_close, data, in_single};
use std::fs;

const CASES: [(&str, &[Coordinate], f64); 2] = [
    ("pendulum", &[Coordinate::Angle], 0.1),
    ("cartpole", &[Coordinate::Translation, Coordinate::Angle], 0.05),
];

/// Agreement in single precision, relative to the largest entry: tens of units in the last place, since the sums have 256 terms and the
/// acceleration divides by an inertia of 1/30.
const SINGLE: f64 = 3e-6;

struct Reference {
    arrays: Arrays,
    imported: Imported,
    h: f64,
}

impl Reference {
    fn open(name: &str, coordinates: &[Coordinate], h: f64) -> Self {
        let file = |extension| data("symo").join(format!("{name}.{extension}"));
        let weights = fs::read(file("safetensors")).expect("weights");
        let imported = symo(&weights, coordinates).expect("import");
        Self { arrays: Arrays::open(&file("npz")), imported, h }
    }

    fn inertia_network(&self) -> &InertiaNetworkArchitecture {
        self.imported.architecture.family.inertia_network().expect("inertia-network")
    }

    fn samples(&mut self) -> Samples {
        let n = self.imported.architecture.n();
        let states = ["q_prev", "q", "q_next"].map(|key| self.arrays.get(key));
        let controls = ["u_prev", "u", "u_next"].map(|key| self.arrays.get(key));
        // The authors' equation takes the mean of the controls at both ends of a step.
        let control = ControlKind::Linear;
        Samples { n, h: self.h, states, controls, control, ..Samples::default() }
    }

    /// Gradient that the file has under this prefix, in the order of our weight block.
    fn gradient(&mut self, prefix: &str, coordinates: &[Coordinate]) -> Vec<f64> {
        symo(&self.arrays.as_weights(prefix), coordinates).expect("gradient as weights").weights
    }
}

/// Results of a discrete model at the samples, in f64 and in f32.
#[derive(Default)]
struct Values {
    inertia: Vec<f64>,
    potential: Vec<f64>,
    residual: Vec<f64>,
    jacobian: Vec<f64>,
    next: Vec<f64>,
}

fn values<R, L, F, const N: usize>(system: &System<L, F>, samples: &Samples, real: fn(f64) -> R) -> Values
where
    R: Real,
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    let h = real(samples.h);
    let del = Del::<R, Midpoint>::new(h);
    let mut out = Values::default();
    for k in 0..samples.len() {
        let row = |x: &[f64]| -> [R; N] { std::array::from_fn(|i| real(x[k * N + i])) };
        let [q0, q1, q2] = samples.states.each_ref().map(|x| row(x));
        let [u0, u1, u2] = samples.controls.each_ref().map(|x| row(x));
        let zero = [R::zero(); N];
        let mass = system.lagrangian.dynamics(&q1, &zero).mass;
        out.inertia.extend(mass.as_flattened().iter().map(|x| x.to_f64()));
        out.potential.push(system.lagrangian.energies(&q1, &zero).potential.to_f64());
        let before = Control { start: u0, end: u1 };
        let after = Control { start: u1, end: u2 };
        let mut state = del.start(system, &q0, &q1, &before).expect("start");
        let w: [R; N] = std::array::from_fn(|i| (q2[i] - q1[i]) / h);
        let ahead = Interval::<R, Midpoint, N>::new(q1, w, h, after).linearise(system);
        let p = state.p();
        out.residual.extend((0..N).map(|i| (p[i] + ahead.balance.d1_ld[i]).to_f64()));
        // Our derivative is with respect to w = (q₊ − q)/h.
        out.jacobian.extend(ahead.momentum_w.as_flattened().iter().map(|x| (*x / h).to_f64()));
        del.step(system, &mut state, &after).expect("step");
        out.next.extend(state.q().iter().map(|x| x.to_f64()));
    }
    out
}

fn evaluate<const N: usize>(reference: &Reference, samples: &Samples, single: bool) -> Values {
    let (inertia_network, weights) = (reference.inertia_network(), &reference.imported.weights);
    if single {
        let weights = in_single(weights);
        let system = inertia_network.system::<f32, N, MAX_WIDTH>(&weights).expect("shape");
        values(&system, samples, |x| x as f32)
    } else {
        let system = inertia_network.system::<f64, N, MAX_WIDTH>(weights).expect("shape");
        values(&system, samples, |x| x)
    }
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
                let ours = match samples.n {
                    1 => evaluate::<1>(&reference, &samples, single),
                    _ => evaluate::<2>(&reference, &samples, single),
                };
                let check = |key: &str, ours: &[f64]| {
                    assert_close(
                        &format!("{name} {key} single={single}"),
                        ours,
                        &reference.arrays.get(key),
                        bound,
                    );
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
            let (theirs, loss) = (reference.gradient(prefix, coordinates), reference.arrays.get(key));
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

fn accelerations<R, L, F, const N: usize>(
    system: &System<L, F>,
    [q, v, u]: &[Vec<f64>; 3],
    real: fn(f64) -> R,
) -> Vec<f64>
where
    R: Real,
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    let rows = |x: &[f64]| -> Vec<[R; N]> { x.as_chunks().0.iter().map(|row| row.map(real)).collect() };
    let states = rows(q).into_iter().zip(rows(v)).zip(rows(u));
    states.flat_map(|((q, v), u)| acceleration(system, &q, &v, &u).expect("mass").map(R::to_f64)).collect()
}

fn check_accelerations<const N: usize>(name: &str, coordinates: &[Coordinate], h: f64) {
    let reference = Reference::open(name, coordinates, h);
    assert!(!reference.imported.discrete);
    let states = ["q", "qdot", "tau"].map(|key| reference.arrays.get(key));
    let theirs = reference.arrays.get("qddot");
    let (inertia_network, weights) = (reference.inertia_network(), &reference.imported.weights);
    let system = inertia_network.system::<f64, N, MAX_WIDTH>(weights).expect("shape");
    assert_close(&format!("{name} qddot"), &accelerations(&system, &states, |x| x), &theirs, EXACT);
    let weights = in_single(weights);
    let system = inertia_network.system::<f32, N, MAX_WIDTH>(&weights).expect("shape");
    let single = accelerations(&system, &states, |x| x as f32);
    assert_close(&format!("{name} qddot single"), &single, &theirs, SINGLE);
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn accelerations_agree() {
    for (system, coordinates, h) in CASES {
        let name = format!("{system}-L-NODE-rk4-32");
        match coordinates.len() {
            1 => check_accelerations::<1>(&name, coordinates, h),
            _ => check_accelerations::<2>(&name, coordinates, h),
        }
    }
}
