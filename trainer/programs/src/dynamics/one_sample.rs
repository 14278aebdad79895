use super::{Cholesky, Lu};
use crate::program::{Program, Workspace};
use crate::row::{Row, WIDTH};
use crate::system::System;

/// Accelerations v̇ of one sample without constraints, of many coordinates: nodes and edges lie side by side, and so do the blocks of
/// the mass matrix.
#[derive(Clone, Debug)]
pub struct OneSampleAccelerations {
    n: usize,
    program: Program,
    workspace: Workspace,
    inputs: [Vec<Row>; 3],
    groups: Vec<Group>,
    cholesky: Cholesky,
    lu: Lu,
}

/// Blocks of M of one size.
#[derive(Clone, Debug)]
struct Group {
    size: usize,
    /// Of each of their numbers where it is among the coordinates, of all blocks.
    places: Vec<Vec<usize>>,
    /// The first output of their equations.
    first: usize,
}

impl OneSampleAccelerations {
    /// Those of a system without constraints.
    pub fn new(system: &System) -> Self {
        let (n, (program, pattern)) = (system.n(), system.equation_of_motion_in_blocks());
        let mut end = 0;
        let groups = pattern.blocks_by_size().into_iter().map(|blocks| {
            let (size, first) = (blocks[0].len(), end);
            end += size * (1 + size);
            let places = (0..size).map(|i| blocks.iter().map(|block| block[i]).collect()).collect();
            Group { size, places, first }
        });
        Self {
            n,
            groups: groups.collect(),
            workspace: program.workspace(),
            program,
            inputs: [(); 3].map(|()| vec![Row::default(); n.div_ceil(WIDTH)]),
            cholesky: Cholesky::default(),
            lu: Lu::default(),
        }
    }

    /// Writes v̇(q, v, τ), m/s² or rad/s², n numbers each; `false` where M is singular or v̇ is not finite.
    ///
    /// # Panics
    /// Where a vector is shorter than n.
    pub fn evaluate(&mut self, weights: &[f64], [q, v, tau]: [&[f64]; 3], a: &mut [f64]) -> bool {
        for (rows, x) in self.inputs.iter_mut().zip([q, v, tau]) {
            let x = x[..self.n].chunks(WIDTH);
            rows.iter_mut().zip(x).for_each(|(row, x)| row.0[..x.len()].copy_from_slice(x));
        }
        let inputs = self.inputs.each_ref().map(Vec::as_slice);
        self.program.run_outputs(weights, &inputs, &mut self.workspace);
        let mut solved = true;
        for group in &self.groups {
            let mut x = vec![Row::default(); group.size];
            for (row, start) in (0..group.places[0].len()).step_by(WIDTH).enumerate() {
                let of = Equations { workspace: &self.workspace, group, row };
                let count = WIDTH.min(group.places[0].len() - start);
                solved &= of.solve((&mut self.cholesky, &mut self.lu), &mut x, count);
                for (places, x) in group.places.iter().zip(&x) {
                    places[start..].iter().zip(&x.0).for_each(|(i, x)| a[*i] = *x);
                }
            }
        }
        solved && a[..self.n].iter().all(|a| a.is_finite())
    }
}

/// The equations of some blocks side by side.
struct Equations<'w> {
    workspace: &'w Workspace,
    group: &'w Group,
    row: usize,
}

impl Equations<'_> {
    /// L_q − L_vq v + Q + τ.
    fn right(&self, i: usize) -> Row {
        self.workspace.output(self.group.first + i)[self.row]
    }

    fn mass(&self, i: usize, j: usize) -> Row {
        let Group { size, first, .. } = self.group;
        self.workspace.output(first + size * (1 + i) + j)[self.row]
    }

    /// v̇ of the first `count` blocks; `false` where one of them is singular.
    fn solve(&self, (cholesky, lu): (&mut Cholesky, &mut Lu), x: &mut [Row], count: usize) -> bool {
        let positive = cholesky.factor(x.len(), |i, j| self.mass(i, j));
        x.iter_mut().enumerate().for_each(|(i, x)| *x = self.right(i));
        cholesky.solve(x);
        (0..count).filter(|k| !positive[*k]).all(|k| {
            let solved = lu.factor(x.len(), |i, j| self.mass(i, j).0[k]);
            let own = lu.solve(|i| self.right(i).0[k]);
            x.iter_mut().zip(own).for_each(|(x, own)| x.0[k] = *own);
            solved
        })
    }
}
