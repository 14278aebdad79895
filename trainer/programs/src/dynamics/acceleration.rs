use super::rods::take_out;
use super::{Failures, Lu, Rods, dot};
use crate::program::{Program, Workspace};
use crate::row::{Row, WIDTH};
use crate::system::System;

/// Accelerations v̇ of M v̇ = L_q − L_vq v + Q + τ + Aᵀλ, A v̇ = −Ȧv, with the workspace to compute them in.
#[derive(Clone, Debug)]
pub struct Accelerations {
    n: usize,
    program: Program,
    workspace: Workspace,
    lu: Lu,
    rods: Rods,
    definite: bool,
    /// Of systems on rods, where the caller does not ask for it.
    compliance: Vec<Row>,
}

impl Accelerations {
    /// Those of a system without constraints.
    pub fn new(system: &System) -> Self {
        Self::with_rods(system, Rods::default(), true)
    }

    /// Those of a system on rods. `definite`: whether M must be positive along what they allow; where it is not, a sample fails.
    pub fn with_rods(system: &System, rods: Rods, definite: bool) -> Self {
        let (n, program) = (system.n(), system.equation_of_motion());
        let compliance = vec![Row::default(); if rods.count() > 0 { n * n } else { 0 }];
        Self { n, workspace: program.workspace(), program, lu: Lu::default(), rods, definite, compliance }
    }

    /// Writes v̇(q, v, τ), n rows, and, where it is asked for, row by row how v̇ moves with the forces:
    /// Π = M⁻¹ − M⁻¹Aᵀ(A M⁻¹Aᵀ)⁻¹A M⁻¹, symmetric. Where M or A M⁻¹Aᵀ is singular they are not numbers.
    pub fn evaluate(
        &mut self,
        weights: &[f64],
        [q, v, tau]: [&[Row]; 3],
        a: &mut [Row],
        compliance: Option<&mut [Row]>,
    ) -> Failures {
        self.program.run(weights, &[q, v, tau], &mut self.workspace, &mut []);
        let mut own = std::mem::take(&mut self.compliance);
        let compliance = compliance.or(if own.is_empty() { None } else { Some(&mut own) });
        let failures = match compliance {
            None => self.free(a, None),
            Some(compliance) => {
                let free = self.free(a, Some(compliance));
                self.constrain([q, v], a, compliance, free)
            }
        };
        self.compliance = own;
        failures
    }

    /// v̇ and M⁻¹ without constraints.
    fn free(&mut self, a: &mut [Row], mut compliance: Option<&mut [Row]>) -> Failures {
        let (n, mut failures) = (self.n, Failures::default());
        for sample in 0..WIDTH {
            let of = |output: usize, i: usize| self.workspace.output(output)[i].0[sample];
            failures.0[sample] = !self.lu.factor(n, |i, j| of(1 + j, i));
            let solved = !failures.0[sample];
            let x = self.lu.solve(|i| of(0, i));
            for i in 0..n {
                a[i].0[sample] = if solved { x[i] } else { f64::NAN };
            }
            failures.0[sample] |= a.iter().any(|a| !a.0[sample].is_finite());
            let Some(compliance) = compliance.as_deref_mut() else { continue };
            for (j, row) in compliance.chunks_exact_mut(n).enumerate() {
                let column = self.lu.solve(|i| f64::from(u8::from(i == j)));
                row.iter_mut().zip(column).for_each(|(place, x)| place.0[sample] = *x);
            }
        }
        failures
    }

    /// One constraint after the other, as if the rest were not there: each takes its own direction out of Π.
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
        for sample in 0..WIDTH {
            failures.0[sample] |= a.iter().any(|a| !a.0[sample].is_finite());
            if failures.0[sample] {
                a.iter_mut().for_each(|a| a.0[sample] = f64::NAN);
            }
        }
        failures
    }

    /// M of the last evaluation, entry (i, j), of every sample.
    pub fn mass(&self, i: usize, j: usize) -> &Row {
        &self.workspace.output(1 + j)[i]
    }
}
