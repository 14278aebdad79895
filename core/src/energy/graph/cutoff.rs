//! Edges between all pairs of nodes that are near each other.

use super::radial::square;
use super::{Edge, GraphError, MAX_NODES};
use crate::scalar::Real;

/// Writes an edge of type `kind` for every pair of nodes whose distance is below `cutoff` (m) to the front of `edges`, and
/// returns how many there are. Pairs come in the order of their second node, and of their first where that is the same, so the
/// list is the same on every target.
///
/// Compares every pair, so time grows with the square of the number of nodes: for graphs of some hundred nodes, or that are
/// rebuilt seldom.
///
/// # Errors
/// [`GraphError::TooManyNodes`], and [`GraphError::TooManyEdges`] with the number of near pairs where `edges` is too short.
pub fn cutoff_edges<R: Real, const D: usize>(
    q: &[[R; D]],
    cutoff: R,
    kind: u8,
    edges: &mut [Edge],
) -> Result<usize, GraphError> {
    if q.len() > MAX_NODES {
        return Err(GraphError::TooManyNodes { found: q.len(), most: MAX_NODES });
    }
    let (capacity, mut needed, mut slots) = (edges.len(), 0, edges.iter_mut());
    for (b, near) in (0..=u16::MAX).zip(q) {
        for (a, far) in (0..b).zip(q) {
            let d: [R; D] = core::array::from_fn(|i| near[i] - far[i]);
            if square(&d) < cutoff * cutoff {
                needed += 1;
                if let Some(slot) = slots.next() {
                    *slot = Edge { kind, ends: [a, b] };
                }
            }
        }
    }
    if needed > capacity { Err(GraphError::TooManyEdges { capacity, needed }) } else { Ok(needed) }
}
