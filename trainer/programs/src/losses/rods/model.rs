//! Parts of a system that a chain of RATTLE steps needs.

use crate::dynamics::{Lu, Rods};
use crate::program::{Program, Workspace};
use crate::row::Row;
use crate::system::System;

/// Maximum number of Newton updates.
pub(super) const MAX_ITERATIONS: usize = 12;
/// Relative size of the last update; the next update would be about as large as its square.
pub(super) const SETTLED: f64 = 1e-9;

/// A system L = T(v) − V(q) with drag Q(v) and rods.
pub(super) struct RodModel {
    pub n: usize,
    pub rods: Rods,
    /// Force L_q(q), N.
    pub force: Gradient,
    /// Momentum L_v(v), kg m/s.
    pub momentum: Gradient,
    /// Drag Q(v), N, if there is any.
    pub drag: Option<Gradient>,
    pub lu: Lu,
}

impl RodModel {
    /// Creates the model; `None` if the Lagrangian or the drag has another form.
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

    /// Number of unknowns of a point: x and λ.
    pub fn size(&self) -> usize {
        self.n + self.rods.count()
    }
}

/// A vector that is a function of q or of v alone, with its evaluation.
pub(super) struct Gradient {
    program: Program,
    workspace: Workspace,
}

/// Value of a vector, n rows, and its Jacobian, n × n rows.
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
        // The inputs are q, v and τ, of which the program reads only one.
        self.program.run(weights, &[x; 3], &mut self.workspace, &mut []);
        let n = x.len();
        let slope = (0..n * n).map(|k| self.workspace.output(1 + k % n)[k / n]).collect();
        Expansion { value: self.workspace.output(0).to_vec(), slope }
    }
}

/// Whether each of these has a magnitude of at most `bound`, and none is NaN.
pub(super) fn settled(mut x: impl Iterator<Item = f64>, bound: f64) -> bool {
    x.all(|x| x.abs() <= bound)
}
