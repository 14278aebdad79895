use super::rods::take_out;
use super::{Cholesky, Failures, Lu, Rods, dot};
use crate::program::{Program, Workspace};
use crate::row::{Row, WIDTH};
use crate::sparsity::Pattern;
use crate::system::System;

/// Accelerations v̇ of M v̇ = L_q − L_vq v + Q + τ + Aᵀλ, A v̇ = −Ȧv, with the workspace to compute them.
#[derive(Clone, Debug)]
pub struct Accelerations {
    program: Program,
    workspace: Workspace,
    solver: MotionSolver,
}

/// Solver of the equation of motion that a program has evaluated.
#[derive(Clone, Debug)]
pub(crate) struct MotionSolver {
    pattern: Pattern,
    cholesky: Cholesky,
    lu: Lu,
    rods: Rods,
    definite: bool,
    /// Compliance of systems with rods, used if the caller does not pass a buffer for it.
    compliance: Vec<Row>,
    /// Right-hand sides of a block of M and their solutions, column by column.
    right: Vec<Row>,
    solutions: Vec<Row>,
}

impl Accelerations {
    /// Creates the accelerations of a system without constraints.
    pub fn new(system: &System) -> Self {
        Self::with_rods(system, Rods::default(), true)
    }

    /// Creates the accelerations of a system with rods. `definite` says whether A M⁻¹Aᵀ must be positive definite; if
    /// it must, a sample in which it is not positive definite fails.
    pub fn with_rods(system: &System, rods: Rods, definite: bool) -> Self {
        let (program, pattern) = system.equation_of_motion();
        Self { workspace: program.workspace(), program, solver: MotionSolver::new(pattern, rods, definite) }
    }

    /// Writes v̇(q, v, τ), n rows, and on request the derivative of v̇ with respect to the forces, row by row: Π = M⁻¹
    /// − M⁻¹Aᵀ(A M⁻¹Aᵀ)⁻¹A M⁻¹, which is symmetric. If M or A M⁻¹Aᵀ is singular, both are NaN.
    pub fn evaluate(
        &mut self,
        weights: &[f64],
        [q, v, tau]: [&[Row]; 3],
        a: &mut [Row],
        compliance: Option<&mut [Row]>,
    ) -> Failures {
        self.program.run_outputs(weights, &[q, v, tau], &mut self.workspace);
        self.solver.solve(&self.workspace, [q, v], a, compliance)
    }

    /// Entry (i, j) of M in the last evaluation, for every sample.
    pub fn mass(&self, i: usize, j: usize) -> Row {
        mass(&self.solver.pattern, &self.workspace, i, j)
    }
}

impl MotionSolver {
    /// Creates the solver for a mass matrix of this pattern, with rods; `definite` as in [`Accelerations::with_rods`].
    pub fn new(pattern: Pattern, rods: Rods, definite: bool) -> Self {
        let n = pattern.size();
        let compliance = vec![Row::default(); if rods.count() > 0 { n * n } else { 0 }];
        let (cholesky, lu) = (Cholesky::default(), Lu::default());
        let (right, solutions) = (Vec::new(), Vec::new());
        Self { pattern, cholesky, lu, rods, definite, compliance, right, solutions }
    }

    /// Does the same as [`Accelerations::evaluate`], from the outputs of [`System::equation_of_motion`] in a workspace.
    pub fn solve(
        &mut self,
        motion: &Workspace,
        [q, v]: [&[Row]; 2],
        a: &mut [Row],
        compliance: Option<&mut [Row]>,
    ) -> Failures {
        let mut own = std::mem::take(&mut self.compliance);
        let compliance = compliance.or(if own.is_empty() { None } else { Some(&mut own) });
        let failures = match compliance {
            None => self.free(motion, a, None),
            Some(compliance) => {
                let free = self.free(motion, a, Some(compliance));
                self.constrain([q, v], a, compliance, free)
            }
        };
        self.compliance = own;
        failures
    }

    /// Computes v̇ and M⁻¹ without constraints, block by block of M.
    fn free(&mut self, motion: &Workspace, a: &mut [Row], mut compliance: Option<&mut [Row]>) -> Failures {
        let mut failures = Failures::default();
        a.copy_from_slice(motion.output(0));
        if let Some(compliance) = compliance.as_deref_mut() {
            compliance.fill(Row::default());
        }
        for block in 0..self.pattern.blocks().len() {
            self.solve_block(block, motion, a, compliance.as_deref_mut(), &mut failures);
        }
        failures.add_not_finite(a);
        spoil(&failures, a);
        failures
    }

    /// Computes v̇ and M⁻¹ of one block: positive definite samples side by side, the rest one by one.
    fn solve_block(
        &mut self,
        block: usize,
        motion: &Workspace,
        a: &mut [Row],
        compliance: Option<&mut [Row]>,
        failures: &mut Failures,
    ) {
        let block = &self.pattern.blocks()[block];
        let (m, n) = (block.len(), a.len());
        let entry = |i: usize, j: usize| mass(&self.pattern, motion, block[i], block[j]);
        let positive = self.cholesky.factor(m, entry);
        self.right.clear();
        self.right.extend(block.iter().map(|i| a[*i]));
        if compliance.is_some() {
            let unit = |k: usize| Row::splat(f64::from(u8::from(k / m == k % m)));
            self.right.extend((0..m * m).map(unit));
        }
        self.solutions.clone_from(&self.right);
        self.solutions.chunks_exact_mut(m).for_each(|column| self.cholesky.solve(column));
        for sample in (0..WIDTH).filter(|sample| !positive[*sample]) {
            failures.0[sample] |= !self.lu.factor(m, |i, j| entry(i, j).0[sample]);
            for (column, right) in self.solutions.chunks_exact_mut(m).zip(self.right.chunks_exact(m)) {
                let x = self.lu.solve(|i| right[i].0[sample]);
                column.iter_mut().zip(x).for_each(|(place, x)| place.0[sample] = *x);
            }
        }
        let (x, inverse) = self.solutions.split_at(m);
        block.iter().zip(x).for_each(|(i, x)| a[*i] = *x);
        let Some(compliance) = compliance else { return };
        for (j, column) in block.iter().zip(inverse.chunks_exact(m)) {
            block.iter().zip(column).for_each(|(i, x)| compliance[j * n + i] = *x);
        }
    }

    /// Imposes one constraint after the other: each removes its own direction from Π.
    fn constrain(
        &self,
        [q, v]: [&[Row]; 2],
        a: &mut [Row],
        compliance: &mut [Row],
        mut failures: Failures,
    ) -> Failures {
        for k in 0..self.rods.count() {
            let (row, bend) = (self.rods.gradient(k, q), dot(v, &self.rods.gradient(k, v)));
            let missing = dot(&row, a).zip(&bend, |rate, bend| -(rate + bend));
            let lever = take_out(compliance, &row, self.definite, &mut failures);
            a.iter_mut().zip(&lever).for_each(|(a, lever)| a.add_product(&missing, lever));
        }
        failures.add_not_finite(a);
        spoil(&failures, a);
        failures
    }
}

/// Entry (i, j) of M in the equation of motion.
fn mass(pattern: &Pattern, motion: &Workspace, i: usize, j: usize) -> Row {
    pattern.direction(i, j).map_or(Row::default(), |direction| motion.output(1 + direction)[i])
}

/// Sets failed samples to NaN.
fn spoil(failures: &Failures, rows: &mut [Row]) {
    for (sample, _) in failures.0.iter().enumerate().filter(|(_, failed)| **failed) {
        rows.iter_mut().for_each(|row| row.0[sample] = f64::NAN);
    }
}
