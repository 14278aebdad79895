//! Models that give the logged quantity directly, as a function of the state and the control, without solving an
//! equation.

use super::enough_weights;
use leastaction_core::model::ModelError;
use leastaction_learning::training::{Objective, Samples, objective_of};
use leastaction_models::accelerations::Forced;
use leastaction_models::parallel::Pool;
use leastaction_programs::dynamics::Failures;
use leastaction_programs::losses::{Block, Derivatives, Loss};
use leastaction_programs::{Builder, Node, Program, Row, Workspace};
use std::array::from_fn;

/// A function f(q, v, u) of n coordinates each, written as a list of operations.
#[derive(Clone)]
pub(super) struct Direct {
    builder: Builder,
    value: Node,
}

impl Direct {
    /// Creates the function that `write` makes of q, v and u.
    pub fn new(n: usize, write: impl FnOnce(&mut Builder, [Node; 3]) -> Node) -> Self {
        let mut builder = Builder::new();
        let state = [(); 3].map(|()| builder.input(n));
        let value = write(&mut builder, state);
        Self { builder, value }
    }

    /// Mean squared difference from `logged`, row by row, over samples, for `parameters` weights.
    pub fn error(
        self,
        parameters: usize,
        logged: fn(&Block) -> Vec<Row>,
        samples: Samples,
    ) -> Box<dyn Objective> {
        objective_of(move || Box::new(Errors::new(&self, logged)), parameters, samples)
    }

    /// The function itself; an empty u stands for 0.
    pub fn motion<'w>(
        &self,
        n: usize,
        (weights, parameters): (&'w [f64], usize),
    ) -> Result<Box<Forced<'w>>, ModelError> {
        enough_weights(weights, parameters)?;
        let program = Program::new(&self.builder, &[self.value], &[]);
        let workspace = program.workspace();
        let (pool, zero) = (Pool::new(move || workspace.clone()), vec![0.0; n]);
        Ok(Box::new(move |q, v, u, out| {
            let rows = |x: &[f64]| x.iter().copied().map(Row::splat).collect::<Vec<_>>();
            let fits = [q.len(), v.len(), out.len()] == [n; 3] && [0, n].contains(&u.len());
            let (q, v, u) = fits.then(|| (rows(q), rows(v), rows(if u.is_empty() { &zero } else { u })))?;
            pool.with(|workspace| {
                program.run(weights, &[&q, &v, &u], workspace, &mut []);
                out.iter_mut().zip(workspace.output(0)).for_each(|(out, y)| *out = y.0[0]);
            });
            Some(())
        }))
    }

    /// Derivatives of f with respect to the weights, weighted by these vectors: one row each.
    fn pulled(builder: &mut Builder, value: Node, y: &[Node]) -> Program {
        let rows: Vec<_> = y.iter().map(|y| builder.pull_back(value, *y).weights).collect();
        Program::new(builder, &[], &rows)
    }

    /// Gradient ∂(y·f)/∂θ; y is an input after the state and the control.
    fn gradient(&self) -> Program {
        let mut builder = self.builder.clone();
        let y = builder.input(builder.length(self.value));
        Self::pulled(&mut builder, self.value, &[y])
    }

    /// Derivatives of every component of f.
    fn jacobian(&self) -> Program {
        let mut builder = self.builder.clone();
        let count = builder.length(self.value);
        let axis = |k: usize| (0..count).map(|i| f64::from(u8::from(i == k))).collect::<Vec<_>>();
        let axes: Vec<Node> = (0..count).map(|k| builder.constant(&axis(k))).collect();
        Self::pulled(&mut builder, self.value, &axes)
    }
}

/// The residual: f minus the logged value.
struct Errors {
    logged: fn(&Block) -> Vec<Row>,
    components: usize,
    /// Programs of f, of its gradient along a direction, and of its Jacobian.
    programs: [(Program, Workspace); 3],
}

impl Errors {
    fn new(direct: &Direct, logged: fn(&Block) -> Vec<Row>) -> Self {
        let Direct { builder, value } = direct;
        let programs = [Program::new(builder, &[*value], &[]), direct.gradient(), direct.jacobian()];
        let with_workspace = |program: Program| {
            let workspace = program.workspace();
            (program, workspace)
        };
        Self { logged, components: builder.length(*value), programs: programs.map(with_workspace) }
    }
}

impl Loss for Errors {
    fn components(&self) -> usize {
        self.components
    }

    fn evaluate(
        &mut self,
        weights: &[f64],
        block: &Block,
        residual: &mut [Row],
        derivatives: Derivatives,
    ) -> Failures {
        let [(value, found), (gradient, of_gradient), (jacobian, of_jacobian)] = &mut self.programs;
        let state = [&block.states[0][..], &block.states[1], &block.controls[0]];
        value.run(weights, &state, found, &mut []);
        for ((residual, found), logged) in residual.iter_mut().zip(found.output(0)).zip((self.logged)(block))
        {
            *residual = Row(from_fn(|sample| found.0[sample] - logged.0[sample]));
        }
        match derivatives {
            Derivatives::None => {}
            Derivatives::Jacobian(rows) => jacobian.run(weights, &state, of_jacobian, rows),
            Derivatives::Gradient(row) => {
                let [q, v, u] = state;
                gradient.run(weights, &[q, v, u, residual], of_gradient, std::slice::from_mut(row));
            }
        }
        Failures::default()
    }

    fn of_constant_velocity(&self, _: &Block) -> Option<Vec<Row>> {
        None
    }
}
