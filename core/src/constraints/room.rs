use super::ConstraintError;
use crate::linear::Matrix;

/// The caller's room, handed out piece by piece.
pub(crate) struct Room<'a, R>(&'a mut [R]);

impl<'a, R> Room<'a, R> {
    /// An error where the room has less than `needed` numbers.
    pub fn new(needed: usize, room: &'a mut [R]) -> Result<Self, ConstraintError<R>> {
        let given = room.len();
        if given < needed { Err(ConstraintError::Room { needed, given }) } else { Ok(Self(room)) }
    }

    /// The next numbers; fewer where the room ends.
    pub fn numbers(&mut self, count: usize) -> &'a mut [R] {
        let room = core::mem::take(&mut self.0);
        let (piece, rest) = room.split_at_mut(count.min(room.len()));
        self.0 = rest;
        piece
    }

    /// A vector for each node.
    pub fn vectors<const D: usize>(&mut self, nodes: usize) -> &'a mut [[R; D]] {
        self.numbers(nodes * D).as_chunks_mut().0
    }

    /// A block for each node.
    pub fn blocks<const D: usize>(&mut self, nodes: usize) -> &'a mut [Matrix<R, D>] {
        self.vectors(nodes * D).as_chunks_mut().0
    }
}
