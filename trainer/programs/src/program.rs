//! The operations of a list that the results need, in an executable order.

use crate::builder::Builder;
use crate::layout::Form;
use crate::numbers::Numbers;
use crate::operation::Node;
use crate::reverse::WeightTerm;
use crate::row::Row;
use crate::schedule::Scheduler;
use crate::step::{Slot, Step};

/// A program for vectors, and for gradients with respect to the weights; each gradient is a row of a Jacobian.
#[derive(Clone, Debug)]
pub struct Program {
    pub(crate) steps: Vec<Step>,
    /// Number of steps that the vectors need; the gradients also need the remaining steps.
    pub(crate) first: usize,
    /// Length of every slot, and the constants that some slots hold from the start.
    pub(crate) slots: Vec<usize>,
    pub(crate) constants: Vec<(Slot, Vec<Row>)>,
    pub(crate) outputs: Vec<Slot>,
    pub(crate) forms: Vec<Form>,
    pub(crate) inputs: usize,
    pub(crate) rows: usize,
    /// Version that runs number by number, if that is faster.
    pub(crate) numbers: Option<Numbers>,
}

/// Numbers of a program during a run.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    slots: Vec<Vec<Row>>,
    registers: Vec<Row>,
    outputs: Vec<Slot>,
}

impl Workspace {
    /// Returns an output of the last run.
    pub fn output(&self, number: usize) -> &[Row] {
        &self.slots[self.outputs[number]]
    }
}

impl Program {
    /// Creates the program for these vectors and these gradients with respect to the weights, each a sum of terms.
    pub fn new(builder: &Builder, outputs: &[Node], rows: &[Vec<WeightTerm>]) -> Self {
        let mut program = Scheduler::new(builder, outputs, rows).schedule(outputs, rows);
        program.numbers = Numbers::of(&program, builder.is_of_short_vectors);
        program
    }

    /// Creates the program for these vectors of a single sample. Inputs and outputs are numbers one after the other in
    /// rows, and the columns to which layers are applied lie side by side. Many nodes or edges of one graph take as
    /// long as the same number of samples of a small system.
    ///
    /// All outputs of a group, which are vectors of one length, have the arrangement given by [`Program::form`].
    pub(crate) fn of_one_sample(builder: &Builder, groups: &[Vec<Node>]) -> Self {
        let outputs = groups.concat();
        Scheduler::new(builder, &outputs, &[]).for_one_sample(groups).schedule(&outputs, &[])
    }

    /// Arrangement of an output in rows.
    pub(crate) fn form(&self, output: usize) -> Form {
        self.forms[output]
    }

    /// Count of the numbers that a workspace keeps for every sample.
    pub fn workspace_len(&self) -> usize {
        self.slots.iter().sum()
    }

    /// Number of operations in a run.
    pub fn steps(&self) -> usize {
        self.steps.len()
    }

    /// Number of gradients with respect to the weights.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Creates a workspace for the program.
    pub fn workspace(&self) -> Workspace {
        let mut slots: Vec<Vec<Row>> =
            self.slots.iter().map(|length| vec![Row::default(); *length]).collect();
        for (slot, constant) in &self.constants {
            slots[*slot].copy_from_slice(constant);
        }
        let registers = self.numbers.as_ref().map_or(Vec::new(), Numbers::registers);
        Workspace { slots, registers, outputs: self.outputs.clone() }
    }

    /// Returns the program together with a workspace.
    pub(crate) fn with_workspace(self) -> (Self, Workspace) {
        let workspace = self.workspace();
        (self, workspace)
    }

    /// Evaluates the vectors at these weights and inputs, and adds the gradients with respect to the weights to `rows`;
    /// each row is as long as the weight block.
    ///
    /// # Panics
    /// If inputs, rows or workspace do not belong to the program.
    pub fn run(&self, weights: &[f64], inputs: &[&[Row]], workspace: &mut Workspace, rows: &mut [Vec<Row>]) {
        self.run_outputs(weights, inputs, workspace);
        self.run_rows(weights, inputs, workspace, rows);
    }

    /// Evaluates only the vectors; inputs that none of them needs may be missing.
    ///
    /// # Panics
    /// See [`Program::run`].
    pub fn run_outputs(&self, weights: &[f64], inputs: &[&[Row]], workspace: &mut Workspace) {
        if let Some(numbers) = &self.numbers {
            let Workspace { slots, registers, outputs } = workspace;
            return numbers.run_outputs(weights, inputs, registers, |output, k, row| {
                slots[outputs[output]][k] = row;
            });
        }
        for step in &self.steps[..self.first] {
            step.run(weights, inputs, &mut workspace.slots, &mut []);
        }
    }

    /// Adds the gradients after [`Program::run_outputs`], with the same weights, workspace and inputs, and with any
    /// inputs that were missing there.
    ///
    /// # Panics
    /// See [`Program::run`].
    pub fn run_rows(
        &self,
        weights: &[f64],
        inputs: &[&[Row]],
        workspace: &mut Workspace,
        rows: &mut [Vec<Row>],
    ) {
        assert!(inputs.len() >= self.inputs && rows.len() >= self.rows, "inputs or rows are missing");
        if let Some(numbers) = &self.numbers {
            return numbers.run_rows(weights, inputs, &mut workspace.registers, rows);
        }
        for step in &self.steps[self.first..] {
            step.run(weights, inputs, &mut workspace.slots, rows);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::function::Function;
    use leastaction_core::network::Activation;

    /// A function that only a product reads takes no separate pass, while other readers of a function still get it.
    #[test]
    fn functions_are_multiplied_where_they_are_computed() {
        let mut builder = Builder::new();
        let [x, y] = [(); 2].map(|()| builder.input(40));
        let function = builder.map(Function::Activation(Activation::Squareplus), x);
        let product = builder.product(function, y);
        let rows = [0.1, -1.0].map(|c| (0..40).map(|i| Row::splat(c * f64::from(i))).collect::<Vec<_>>());
        let results = [vec![product], vec![product, function]].map(|outputs| {
            let (program, mut workspace) = Program::new(&builder, &outputs, &[]).with_workspace();
            program.run_outputs(&[], &rows.each_ref().map(Vec::as_slice), &mut workspace);
            (program.steps(), workspace.output(0).to_vec())
        });
        assert_eq!((results[0].0, results[1].0), (3, 4));
        assert_eq!(results[0].1, results[1].1);
    }
}
