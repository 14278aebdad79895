//! What a chain of RATTLE steps asks of a system.

use crate::dynamics::{Lu, Rods};
use crate::program::{Program, Workspace};
use crate::row::Row;
use crate::system::System;

/// Newton updates at most.
pub(super) const MAX_ITERATIONS: usize = 12;
/// An update of this relative size is the last: the next would be of the size of its square.
pub(super) const SETTLED: f64 = 1e-9;

/// L = T(v) − V(q) with drag Q(v), on rods.
pub(super) struct RodModel {
    pub n: usize,
    pub rods: Rods,
    /// L_q(q), N.
    pub force: Gradient,
    /// L_v(v), kg m/s.
    pub momentum: Gradient,
    /// Q(v), N, where there is any.
    pub drag: Option<Gradient>,
    pub lu: Lu,
}

impl RodModel {
    /// `None` where the Lagrangian or the drag is of another form.
    pub fn new(system: &System, rods: Rods) -> Option<Self> {
        let parts = system.separable()?;
        Some(Self {
            n: system.n(),
            rods,
            force: Gradient::new(parts.force),
            momentum: Gradient::new(parts.momentum),
            drag: parts.drag.map(Gradient::new),
            lu: Lu::default(),
        })
    }

    /// Unknowns of a point: x and λ.
    pub fn size(&self) -> usize {
        self.n + self.rods.count()
    }
}

/// A vector of q or of v alone, to be evaluated.
pub(super) struct Gradient {
    program: Program,
    workspace: Workspace,
}

/// Its value, n rows, and its Jacobian, n × n rows.
#[derive(Clone, Default)]
pub(super) struct Expansion {
    pub value: Vec<Row>,
    pub slope: Vec<Row>,
}

impl Gradient {
    fn new(program: Program) -> Self {
        Self { workspace: program.workspace(), program }
    }

    pub fn at(&mut self, weights: &[f64], x: &[Row]) -> Expansion {
        // Inputs q, v and τ, of which one is read.
        self.program.run(weights, &[x; 3], &mut self.workspace, &mut []);
        let n = x.len();
        let slope = (0..n * n).map(|k| self.workspace.output(1 + k % n)[k / n]).collect();
        Expansion { value: self.workspace.output(0).to_vec(), slope }
    }
}

/// Whether each of these is at most `bound`, and a number.
pub(super) fn settled(mut x: impl Iterator<Item = f64>, bound: f64) -> bool {
    x.all(|x| x.abs() <= bound)
}
