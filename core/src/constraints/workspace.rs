use super::ConstraintError;
use crate::linear::Matrix;

/// The caller's workspace, handed out in pieces.
pub(crate) struct Workspace<'a, R>(&'a mut [R]);

impl<'a, R> Workspace<'a, R> {
    /// Wraps the workspace; an error if it has fewer than `needed` numbers.
    pub fn new(needed: usize, workspace: &'a mut [R]) -> Result<Self, ConstraintError<R>> {
        let given = workspace.len();
        if given < needed { Err(ConstraintError::Workspace { needed, given }) } else { Ok(Self(workspace)) }
    }

    /// Takes the next `count` numbers. There are always enough: [`Workspace::new`] has checked the total
    /// length.
    pub fn numbers(&mut self, count: usize) -> &'a mut [R] {
        let workspace = core::mem::take(&mut self.0);
        debug_assert!(count <= workspace.len(), "{count} numbers of {}", workspace.len());
        let (piece, rest) = workspace.split_at_mut(count.min(workspace.len()));
        self.0 = rest;
        piece
    }

    /// Takes one vector per node.
    pub fn vectors<const D: usize>(&mut self, nodes: usize) -> &'a mut [[R; D]] {
        self.numbers(nodes * D).as_chunks_mut().0
    }

    /// Takes one block per node.
    pub fn blocks<const D: usize>(&mut self, nodes: usize) -> &'a mut [Matrix<R, D>] {
        self.vectors(nodes * D).as_chunks_mut().0
    }
}
