//! Edges between all pairs of nearby nodes.

use super::radial::square;
use super::{Edge, GraphError, MAX_NODES};
use crate::scalar::Real;

/// Writes an edge of type `kind` for every pair of nodes closer than `cutoff` (m) to the front of `edges`, and returns the number of edges.
/// Pairs are sorted by their second node, then by their first, so the list is the same on every target.
///
/// Compares all pairs, so time grows with the square of the number of nodes: meant for graphs of some hundred nodes, or for lists that are
/// seldom rebuilt.
///
/// # Errors
/// [`GraphError::TooManyNodes`]; [`GraphError::TooManyEdges`] with the number of near pairs if `edges` is too short.
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
