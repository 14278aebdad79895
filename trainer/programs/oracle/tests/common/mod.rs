//! Comparison of a family's programs with core in f64: value, derivatives, and gradients with respect to the weights.
#![allow(dead_code, reason = "each test binary uses its own part")]

mod gradients;
pub mod losses;
pub mod on_rods;

pub use gradients::{Dual, Motion};

use leastaction_core::forces::{self, Forces, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::scalar::Scalar;
use leastaction_programs::dynamics::{Accelerations, OneSampleAccelerations};
use leastaction_programs::energies::Energies;
use leastaction_programs::{Program, Row, System, WIDTH, Workspace};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Tolerance for rounding errors, relative to numbers of size 1.
const TOLERANCE: f64 = 1e-12;

/// Random weights, |w| < 0.8.
pub fn random_weights(count: usize, seed: u64) -> Vec<f64> {
    let mut stream = Pcg64::seed_from_u64(seed);
    (0..count).map(|_| stream.random_range(-0.8..0.8)).collect()
}

/// Weights, and random numbers for every sample: q, v, τ, a, then two vectors per direction.
pub struct Numbers<const N: usize> {
    pub weights: Vec<f64>,
    vectors: Vec<Vec<Row>>,
}

impl<const N: usize> Numbers<N> {
    /// Numbers of at most `reach`.
    pub fn new(weights: Vec<f64>, reach: f64, seed: u64) -> Self {
        // The random stream differs from that of the weights.
        let mut stream = Pcg64::seed_from_u64(!seed);
        let mut row = || Row(std::array::from_fn(|_| stream.random_range(-reach..reach)));
        let vectors = (0..4 + 2 * N).map(|_| (0..N).map(|_| row()).collect()).collect();
        Self { weights, vectors }
    }

    pub fn of(&self, vector: usize, sample: usize) -> [f64; N] {
        std::array::from_fn(|i| self.vectors[vector][i].0[sample])
    }

    pub fn run(&self, program: &Program, inputs: &[usize]) -> (Workspace, Vec<Vec<Row>>) {
        let inputs: Vec<&[Row]> = inputs.iter().map(|i| &self.vectors[*i][..]).collect();
        let mut rows = vec![vec![Row::default(); self.weights.len()]; program.rows()];
        let mut workspace = program.workspace();
        // The program runs twice, because a run must not depend on what the previous run has left in the workspace.
        program.run(&self.weights, &inputs, &mut workspace, &mut rows);
        rows.iter_mut().for_each(|row| row.fill(Row::default()));
        program.run(&self.weights, &inputs, &mut workspace, &mut rows);
        (workspace, rows)
    }
}

/// Size of the changes of weights for difference quotients.
const STEP: f64 = 1e-5;

/// Checks the rows ∂/∂θ y·(L_q − L_vq v − M a) of a system against differences of its equation of motion, for each
/// number. Numbers that are not read must have zero derivatives.
pub fn check_gradients_of_motion<const N: usize>(
    (system, weights): (&System, &[f64]),
    seed: u64,
    is_read: impl Fn(usize) -> bool,
) {
    let numbers = Numbers::<N>::new(weights.to_vec(), 1.5, seed);
    let (_, rows) = numbers.run(&system.residual(1), &[0, 1, 2, 3, 4]);
    let (program, pattern) = system.equation_of_motion();
    // This is y·(right side − M a); τ cancels in the differences.
    let work = |at: usize, step: f64, sample: usize| -> f64 {
        let mut weights = weights.to_vec();
        weights[at] += step;
        let (motion, _) = Numbers::<N>::new(weights, 1.5, seed).run(&program, &[0, 1, 2]);
        let of = |output: usize, i: usize| motion.output(output)[i].0[sample];
        let [a, y] = [3, 4].map(|vector| numbers.of(vector, sample));
        let inertial = |i: usize| -> f64 {
            (0..N).filter_map(|j| Some(of(1 + pattern.direction(i, j)?, i) * a[j])).sum()
        };
        (0..N).map(|i| y[i] * (of(0, i) - inertial(i))).sum()
    };
    for (at, row) in rows[0].iter().enumerate() {
        for sample in [0, WIDTH - 1] {
            let difference = (work(at, STEP, sample) - work(at, -STEP, sample)) / (2.0 * STEP);
            let expected = if is_read(at) { difference } else { 0.0 };
            let error = (row.0[sample] - expected).abs() / (1.0 + expected.abs());
            assert!(error < 1e-8, "number {at}: {} instead of {expected}", row.0[sample]);
        }
    }
}

/// Viscous damping with its coefficients at these positions of the weight block; `None` means no damping.
pub fn damping<S: Scalar, const N: usize>(weights: &[S], positions: Option<[usize; N]>) -> Viscous<S, N> {
    positions.map_or(Viscous::none(), |positions| Viscous { coefficients: positions.map(|at| weights[at]) })
}

#[track_caller]
fn close(found: f64, expected: f64, size: f64) {
    let error = (found - expected).abs();
    let bound = TOLERANCE * (1.0 + size.max(expected.abs()));
    assert!(error <= bound, "{found} instead of {expected}, off by {error:e}");
}

/// Checks everything that a [`System`] gives against core's model over the same weights. `motion` evaluates core's
/// model over arbitrary weights; `size` is the size of the terms that cancel in first derivatives.
pub fn check<L: Lagrangian<f64, N>, F: Forces<f64, N>, const N: usize>(
    model: &dyn Energies,
    core: &forces::System<L, F>,
    motion: impl Fn(&[Dual], [&[Dual; N]; 3]) -> Motion<Dual, N>,
    numbers: &Numbers<N>,
    size: f64,
) {
    assert_eq!((model.n(), model.parameters()), (N, numbers.weights.len()), "n and the numbers of the model");
    let system = System::new(model);
    check_values(&system, core, numbers, size);
    check_one_sample(&system, numbers);
    gradients::check(&system, motion, numbers, size);
}

pub fn check_values<L: Lagrangian<f64, N>, F: Forces<f64, N>, const N: usize>(
    system: &System,
    forces::System { lagrangian: core, forces }: &forces::System<L, F>,
    numbers: &Numbers<N>,
    size: f64,
) {
    let (energies, _) = numbers.run(&system.energies(), &[0, 1]);
    let (gradient, _) = numbers.run(&system.gradient(), &[0, 1]);
    let (program, pattern) = system.equation_of_motion();
    let (motion, _) = numbers.run(&program, &[0, 1, 2]);
    let (program, at) = system.derivatives();
    let (derivatives, _) = numbers.run(&program, &[0, 1, 2]);
    let second = 10.0 * size;
    for sample in 0..WIDTH {
        let [q, v, tau] = [0, 1, 2].map(|vector| numbers.of(vector, sample));
        let of = |workspace: &Workspace, output: usize, i: usize| workspace.output(output)[i].0[sample];
        let expected = core.energies(&q, &v);
        close(of(&energies, 0, 0), expected.kinetic, size);
        close(of(&energies, 1, 0), expected.potential, size);
        let (hessian, dynamics) = (core.hessian(&q, &v), core.dynamics(&q, &v));
        let (force, (force_q, force_v)) = (forces.force(&q, &v, &tau), forces.derivatives(&q, &v, &tau));
        for i in 0..N {
            close(of(&gradient, 0, i), hessian.l_q[i], size);
            close(of(&gradient, 1, i), hessian.l_v[i], size);
            close(of(&motion, 0, i), dynamics.l_q[i] - dynamics.l_vq_v[i] + force[i] + tau[i], second);
            close(of(&derivatives, 0, i), hessian.l_q[i] + force[i], size);
            close(of(&derivatives, 1, i), hessian.l_v[i], size);
            for j in 0..N {
                let mass = pattern.direction(i, j).map_or(0.0, |direction| of(&motion, 1 + direction, i));
                close(mass, hessian.l_vv[i][j], second);
                close(of(&derivatives, at.force_q(j), i), hessian.l_qq[i][j] + force_q[i][j], second);
                close(of(&derivatives, at.momentum_q(j), i), hessian.l_vq[i][j], second);
                close(of(&derivatives, at.force_v(j), i), hessian.l_vq[j][i] + force_v[i][j], second);
                close(of(&derivatives, at.mass(j), i), hessian.l_vv[i][j], second);
            }
        }
    }
}

/// Checks that accelerations of a single sample, whose columns lie side by side, equal those of several samples side by
/// side, if M is not singular.
fn check_one_sample<const N: usize>(system: &System, numbers: &Numbers<N>) {
    let inputs = [0, 1, 2].map(|vector| &numbers.vectors[vector][..]);
    let mut expected = vec![Row::default(); N];
    let failures = Accelerations::new(system).evaluate(&numbers.weights, inputs, &mut expected, None);
    let mut alone = OneSampleAccelerations::new(system);
    for sample in [0, 9] {
        let [q, v, tau] = [0, 1, 2].map(|vector| numbers.of(vector, sample));
        let mut found = [0.0; N];
        let solved = alone.evaluate(&numbers.weights, [&q, &v, &tau], &mut found);
        assert_eq!(solved, !failures.0[sample]);
        for (found, expected) in found.iter().zip(&expected).filter(|_| solved) {
            let expected = expected.0[sample];
            assert!((found - expected).abs() <= 1e-7 * (1.0 + expected.abs()), "{found} {expected}");
        }
    }
}
