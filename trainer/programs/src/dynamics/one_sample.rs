use super::{Cholesky, Lu};
use crate::picks::{NOWHERE, Picks};
use crate::program::{Program, Workspace};
use crate::row::{Row, WIDTH};
use crate::system::System;

/// Accelerations v̇ of a single sample with many coordinates and without constraints: nodes and edges lie side by side, and so do the
/// blocks of the mass matrix.
#[derive(Clone, Debug)]
pub struct OneSampleAccelerations {
    n: usize,
    program: Program,
    workspace: Workspace,
    inputs: [Vec<Row>; 3],
    groups: Vec<Group>,
    /// v̇ of all groups, and the positions of the coordinates in it.
    solved: Vec<Row>,
    coordinates: Picks,
    lu: Lu,
}

/// Blocks of M of one size, side by side.
#[derive(Clone, Debug)]
struct Group {
    size: usize,
    /// Ascending positions of the blocks in those rows that hold one number of all blocks.
    blocks: Vec<u32>,
    rows: usize,
    /// First output of the equations of these blocks.
    first: usize,
    cholesky: Cholesky,
}

impl OneSampleAccelerations {
    /// Creates the accelerations of a system without constraints.
    pub fn new(system: &System) -> Self {
        let (n, (program, pattern)) = (system.n(), system.equation_of_motion_in_blocks());
        let (mut groups, mut places) = (Vec::new(), vec![NOWHERE; n.next_multiple_of(WIDTH)]);
        let (mut first, mut rows) = (0, 0);
        for blocks in pattern.blocks_by_size() {
            let group = Group::new(&program, first, &blocks);
            for (block, place) in blocks.iter().zip(&group.blocks) {
                let of = |i: usize| (WIDTH * (rows + i * group.rows)) as u32 + place;
                block.iter().enumerate().for_each(|(i, coordinate)| places[*coordinate] = of(i));
            }
            (first, rows) = (first + group.size * (1 + group.size), rows + group.size * group.rows);
            groups.push(Group { blocks: group.sorted(), ..group });
        }
        Self {
            n,
            groups,
            workspace: program.workspace(),
            program,
            inputs: [(); 3].map(|()| vec![Row::default(); n.div_ceil(WIDTH)]),
            solved: vec![Row::default(); rows],
            coordinates: Picks::new(&places),
            lu: Lu::default(),
        }
    }

    /// Writes v̇(q, v, τ), m/s² or rad/s², n numbers each; returns `false` if M is singular or v̇ is not finite.
    ///
    /// # Panics
    /// If a vector is shorter than n.
    pub fn evaluate(&mut self, weights: &[f64], [q, v, tau]: [&[f64]; 3], a: &mut [f64]) -> bool {
        for (rows, x) in self.inputs.iter_mut().zip([q, v, tau]) {
            let (whole, rest) = x[..self.n].as_chunks();
            rows.iter_mut().zip(whole).for_each(|(row, x)| row.0 = *x);
            rows.iter_mut().skip(whole.len()).for_each(|row| row.0[..rest.len()].copy_from_slice(rest));
        }
        let inputs = self.inputs.each_ref().map(Vec::as_slice);
        self.program.run_outputs(weights, &inputs, &mut self.workspace);
        let (mut solved, mut rest) = (true, &mut self.solved[..]);
        for group in &mut self.groups {
            let (x, others) = rest.split_at_mut(group.size * group.rows);
            solved &= group.solve(&self.workspace, &mut self.lu, x);
            rest = others;
        }
        let mut own = Row::default();
        for (row, a) in a[..self.n].chunks_mut(WIDTH).enumerate() {
            self.coordinates.read(row, &self.solved, &mut own);
            a.copy_from_slice(&own.0[..a.len()]);
        }
        solved && a[..self.n].iter().fold(true, |finite, a| finite & a.is_finite())
    }
}

impl Group {
    /// Creates the group of these blocks, whose equations are the outputs from `first` on.
    fn new(program: &Program, first: usize, blocks: &[Vec<usize>]) -> Self {
        let (form, size) = (program.form(first), blocks[0].len());
        let places = (0..blocks.len()).map(|block| form.place(block) as u32).collect();
        Self { size, blocks: places, rows: form.rows(blocks.len()), first, cholesky: Cholesky::default() }
    }

    fn sorted(&self) -> Vec<u32> {
        let mut blocks = self.blocks.clone();
        blocks.sort_unstable();
        blocks
    }

    /// Row and lane of every block in this row.
    fn blocks_in(&self, row: usize) -> impl Iterator<Item = (usize, usize)> {
        let [start, end] =
            [row, row + 1].map(|row| self.blocks.partition_point(|b| (*b as usize) < WIDTH * row));
        self.blocks[start..end].iter().map(|place| (*place as usize / WIDTH, *place as usize % WIDTH))
    }

    /// Writes v̇ of all blocks; returns `false` if one of them is singular.
    fn solve(&mut self, motion: &Workspace, lu: &mut Lu, x: &mut [Row]) -> bool {
        let (size, first, rows) = (self.size, self.first, self.rows);
        // Outputs: L_q − L_vq v + Q + τ, then the entries of M row by row.
        let mass = |i: usize, j: usize| motion.output(first + size * (1 + i) + j);
        let right = |i: usize| motion.output(first + i);
        self.cholesky.factor_rows(size, rows, |i, j, place| place.copy_from_slice(mass(i, j)));
        x.chunks_mut(rows).enumerate().for_each(|(i, x)| x.copy_from_slice(right(i)));
        self.cholesky.solve(x);
        let others = (0..rows).filter(|row| !self.cholesky.are_positive(*row));
        let others = others.flat_map(|row| self.blocks_in(row));
        let mut solved = true;
        for (row, k) in others.filter(|(row, k)| !self.cholesky.is_positive(*row, *k)) {
            solved &= lu.factor(size, |i, j| mass(i, j)[row].0[k]);
            let own = lu.solve(|i| right(i)[row].0[k]);
            own.iter().enumerate().for_each(|(i, own)| x[i * rows + row].0[k] = *own);
        }
        solved
    }
}
