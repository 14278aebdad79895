//! Operation counts of a tree of rigid bodies of any size: a sum over its bodies, over pairs of bodies (one of which
//! may carry the other), and over triples (two of which sit on others).

use crate::counted::{Counted, Operations, count};
use leastaction_core::energy::arm::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, ArmBodies};
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

/// Space in which bodies move.
#[derive(Clone, Copy)]
pub(super) enum Where {
    Plane,
    Space,
}

/// Number of additions and multiplications of an evaluation; a pair of them counts as one.
pub(super) fn multiply_adds(place: Where, bodies: &[TreeBody], evaluation: Evaluation) -> usize {
    let alone = |joint| counted(place, [TreeBody { joint, parent: None }], evaluation);
    let together = |first: &TreeBody, second: &TreeBody, parent| {
        let pair = [TreeBody { joint: first.joint, parent: None }, TreeBody { joint: second.joint, parent }];
        counted(place, pair, evaluation) - alone(first.joint) - alone(second.joint)
    };
    // The cost of a body depends on whether another body is its parent or further down; that of two bodies depends on
    // whether they have a common carrier.
    let three = |[first, second, third]: [&TreeBody; 3], on: u8| {
        let with = |body: &TreeBody, parent| TreeBody { joint: body.joint, parent };
        let tree = [with(first, None), with(second, Some(0)), with(third, Some(on))];
        let beside = if on == 0 { None } else { Some(0) };
        let pairs = together(first, second, Some(0))
            + together(first, third, Some(0))
            + together(second, third, beside);
        counted(place, tree, evaluation)
            - pairs
            - [first, second, third].map(|body| alone(body.joint)).iter().sum::<i64>()
    };
    let of_body = |(k, body): (usize, &TreeBody)| -> i64 {
        let carriers = carriers(bodies, body);
        let parent = |j: usize| carriers.contains(&j).then_some(0);
        let pairs = bodies.iter().take(k).enumerate().map(|(j, other)| together(other, body, parent(j)));
        let on = carriers.first().and_then(|on| bodies.get(*on));
        let further = carriers.iter().skip(1).filter_map(|j| Some(three([bodies.get(*j)?, on?, body], 1)));
        let apart = bodies.iter().enumerate().take(k).filter(|(j, _)| !carriers.contains(j));
        let beside = apart.filter_map(|(_, other)| {
            let of_other = self::carriers(bodies, other);
            let common = carriers.iter().find(|j| of_other.contains(j))?;
            Some(three([bodies.get(*common)?, other, body], 0))
        });
        alone(body.joint) + pairs.sum::<i64>() + further.sum::<i64>() + beside.sum::<i64>()
    };
    let sum: i64 = bodies.iter().enumerate().map(of_body).sum();
    sum.unsigned_abs().div_ceil(2) as usize
}

/// Indices of the bodies that carry `body`.
fn carriers(bodies: &[TreeBody], body: &TreeBody) -> Vec<usize> {
    let below = |body: &TreeBody| body.parent.map(usize::from);
    let next = |j: &usize| bodies.get(*j).and_then(below);
    std::iter::successors(below(body), next).collect()
}

/// Number of additions and multiplications of an evaluation of a small tree.
fn counted<const N: usize>(place: Where, tree: [TreeBody; N], evaluation: Evaluation) -> i64 {
    let Ok(tree) = BodyTree::new(tree) else { return 0 };
    let count = match place {
        Where::Plane => GRAVITY_PARAMETERS + BODY_PARAMETERS * N,
        Where::Space => ARM_GRAVITY_PARAMETERS + ARM_PARAMETERS * N,
    };
    let weights = vec![1.0; count];
    let block = &mut weights.as_slice();
    match place {
        Where::Plane => flops(PlanarBodies::<f64, N>::take(block, tree), evaluation),
        Where::Space => flops(ArmBodies::<f64, N>::take(block, tree), evaluation),
    }
}

fn flops<L: Lagrangian<Real, N>, const N: usize>(bodies: Option<L>, evaluation: Evaluation) -> i64 {
    let at = [Counted(0.1); N];
    let (_, Operations { flops, .. }) = count(|| {
        bodies.map(|bodies| match evaluation {
            Evaluation::Dynamics => drop(bodies.dynamics(&at, &at)),
            Evaluation::Linearization => drop(bodies.linearization(&at, &at)),
        })
    });
    flops as i64
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
            for (place, evaluation) in [
                (Where::Plane, Evaluation::Dynamics),
                (Where::Plane, Evaluation::Linearization),
                (Where::Space, Evaluation::Dynamics),
                (Where::Space, Evaluation::Linearization),
            ] {
                let whole = counted(place, tree, evaluation);
                assert!(whole > 100);
                assert_eq!(multiply_adds(place, &tree, evaluation), (whole as usize).div_ceil(2));
            }
        }
    }
}
