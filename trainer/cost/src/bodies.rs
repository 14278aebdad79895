//! What a tree of rigid bodies computes, whatever its size: a sum over its bodies, and over their pairs, of which one may
//! carry the other.

use crate::counted::{Counted, Operations, count};
use leastaction_core::energy::bodies::{
    BODY_PARAMETERS, BodyTree, GRAVITY_PARAMETERS, PlanarBodies, TreeBody,
};
use leastaction_core::lagrangian::Lagrangian;

type Real = Counted<f64>;

/// An evaluation of the energies.
#[derive(Clone, Copy)]
pub(super) enum Evaluation {
    /// M, L_q, L_v and L_vq v.
    Dynamics,
    /// All derivatives but L_qq.
    Linearization,
}

/// Additions and multiplications of an evaluation, taken in pairs.
pub(super) fn multiply_adds(bodies: &[TreeBody], evaluation: Evaluation) -> usize {
    let alone = |joint| counted([TreeBody { joint, parent: None }], evaluation);
    let together = |first: &TreeBody, second: &TreeBody, parent| {
        let pair = [TreeBody { joint: first.joint, parent: None }, TreeBody { joint: second.joint, parent }];
        counted(pair, evaluation) - alone(first.joint) - alone(second.joint)
    };
    let of_body = |(k, body): (usize, &TreeBody)| -> u64 {
        let carriers = carriers(bodies, body);
        let parent = |j: usize| carriers.contains(&j).then_some(0);
        let pairs = bodies.iter().take(k).enumerate().map(|(j, other)| together(other, body, parent(j)));
        alone(body.joint) + pairs.sum::<u64>()
    };
    let sum: u64 = bodies.iter().enumerate().map(of_body).sum();
    sum.div_ceil(2) as usize
}

/// The bodies that carry one.
fn carriers(bodies: &[TreeBody], body: &TreeBody) -> Vec<usize> {
    let below = |body: &TreeBody| body.parent.map(usize::from);
    let next = |j: &usize| bodies.get(*j).and_then(below);
    std::iter::successors(below(body), next).collect()
}

/// Additions and multiplications of an evaluation of a small tree.
fn counted<const N: usize>(tree: [TreeBody; N], evaluation: Evaluation) -> u64 {
    let weights = vec![1.0; GRAVITY_PARAMETERS + BODY_PARAMETERS * N];
    let bodies: Option<PlanarBodies<f64, N>> =
        BodyTree::new(tree).ok().and_then(|tree| PlanarBodies::take(&mut weights.as_slice(), tree));
    let at = [Counted(0.1); N];
    let (_, Operations { flops, .. }) = count(|| {
        bodies.map(|bodies| match evaluation {
            Evaluation::Dynamics => drop(Lagrangian::<Real, N>::dynamics(&bodies, &at, &at)),
            Evaluation::Linearization => drop(Lagrangian::<Real, N>::linearization(&bodies, &at, &at)),
        })
    });
    flops
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_core::energy::bodies::Joint;

    #[test]
    fn the_sum_is_what_is_counted() {
        let body = |joint, parent| TreeBody { joint, parent };
        let (turns, slides) = (Joint::Revolute, Joint::Prismatic);
        let chain = [None, Some(0), Some(1), Some(2)].map(|on| body(turns, on));
        let crane = [body(slides, None), body(turns, Some(0)), body(slides, Some(1)), body(turns, Some(0))];
        for tree in [chain, crane] {
            for evaluation in [Evaluation::Dynamics, Evaluation::Linearization] {
                let whole = counted(tree, evaluation);
                assert!(whole > 100);
                assert_eq!(multiply_adds(&tree, evaluation), whole.div_ceil(2) as usize);
            }
        }
    }
}
