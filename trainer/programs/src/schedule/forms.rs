//! Vectors of a single sample, in the forms that the steps that read them want.

use super::Scheduler;
use crate::layout::Form;
use crate::operation::Node;
use crate::row::WIDTH;
use crate::step::{Slot, Step};

impl Scheduler<'_> {
    /// Form of a node; with several samples side by side all nodes have the same form.
    pub(super) fn form(&self, node: Node) -> Form {
        self.layout.as_ref().map_or(Form::of_units(1), |layout| layout.form(node))
    }

    /// Slot of a node in this form, if columns lie side by side.
    pub(super) fn in_form(&mut self, node: Node, form: Form) -> Slot {
        let slot = self.place(node);
        let Some(layout) = &self.layout else { return slot };
        let (own, length) = (layout.form(node), self.builder.length(node));
        if own == form {
            return slot;
        }
        let done = self.rearranged.entry(node).or_default();
        if let Some((_, slot)) = done.iter().find(|(other, _)| *other == form) {
            return *slot;
        }
        let to = if let Some(known) = self.builder.known(node) {
            self.constant(form.constant(&known))
        } else {
            let to = self.slot(form.rows(length));
            self.program.steps.push(Step::Pick { x: slot, picks: form.picks(length, (own, |i| i)), to });
            to
        };
        self.rearranged.entry(node).or_default().push((form, to));
        to
    }

    /// Slot of a node in columns of `units` units, if columns lie side by side.
    pub(super) fn in_columns(&mut self, node: Node, units: usize) -> Slot {
        self.in_form(node, self.form(node).in_units(units))
    }

    /// Slots of the results.
    pub(super) fn outputs(&mut self, outputs: &[Node]) -> Vec<Slot> {
        self.program.forms.resize(outputs.len(), Form::of_units(1));
        (0..outputs.len()).map(|k| self.in_form(outputs[k], self.program.forms[k])).collect()
    }

    /// Number of columns, or of rows of columns, to which a layer with this input is applied: with a single sample,
    /// columns lie side by side.
    pub(super) fn columns(&self, columns: usize, x: Node, units: usize) -> usize {
        match &self.layout {
            None => columns,
            Some(layout) if layout.form(x).in_units(units).alike => 1,
            Some(_) => columns.div_ceil(WIDTH),
        }
    }

    /// Slots of two nodes that are combined entry by entry.
    pub(super) fn alike(&mut self, node: Node, of: [Node; 2]) -> [Slot; 2] {
        let units = self.form(node).units;
        of.map(|x| self.in_columns(x, units))
    }
}
