//! Trees of rigid bodies with random or given parameters, and their energies computed naively, with velocities by central differences.

use super::Random;
use leastaction_core::energy::bodies::{
    BODY_PARAMETERS, BodyParameters, BodyTree, GRAVITY_PARAMETERS, Joint, PlanarBodies, TreeBody,
};
use leastaction_core::scalar::WeightFormat;

pub const fn body(joint: Joint, parent: Option<u8>) -> TreeBody {
    TreeBody { joint, parent }
}

#[derive(Clone, Debug)]
pub struct Bodies<const N: usize> {
    pub bodies: [TreeBody; N],
    pub weights: Vec<f64>,
}

impl<const N: usize> Bodies<N> {
    /// Numbers of all sizes, masses and inertias positive.
    pub fn random(bodies: [TreeBody; N], seed: u64) -> Self {
        let mut weights = Random(seed).vector(GRAVITY_PARAMETERS + BODY_PARAMETERS * N, 0.8);
        for numbers in weights[GRAVITY_PARAMETERS..].chunks_exact_mut(BODY_PARAMETERS) {
            for positive in [3, 6, 7] {
                numbers[positive] += 1.0;
            }
        }
        Self { bodies, weights }
    }

    /// Bodies of the given numbers under γ = (9.81, 0): they hang at q = 0.
    pub fn hanging(bodies: [TreeBody; N], numbers: [BodyParameters<f64>; N]) -> Self {
        let numbers = numbers.into_iter().flat_map(BodyParameters::into_array);
        Self { bodies, weights: [9.81, 0.0].into_iter().chain(numbers).collect() }
    }

    pub fn tree(&self) -> BodyTree<N> {
        BodyTree::new(self.bodies).expect("a tree")
    }

    /// The tree over a weight block of any type.
    pub fn over<'a, W: WeightFormat>(&self, mut weights: &'a [W]) -> PlanarBodies<'a, W, N> {
        let bodies = PlanarBodies::take(&mut weights, self.tree()).expect("weights of this tree");
        assert!(weights.is_empty(), "{} weights too many", weights.len());
        bodies
    }

    pub fn in_f64(&self) -> PlanarBodies<'_, f64, N> {
        self.over(&self.weights)
    }

    /// The nearest weights in single precision.
    pub fn single(&self) -> Vec<f32> {
        self.weights.iter().map(|w| *w as f32).collect()
    }

    /// Bodies with the weights that [`Bodies::single`] gives.
    pub fn rounded(&self) -> Self {
        Self { weights: self.single().into_iter().map(f64::from).collect(), ..self.clone() }
    }

    pub fn numbers(&self) -> [BodyParameters<f64>; N] {
        let (numbers, _) = self.weights[GRAVITY_PARAMETERS..].as_chunks();
        core::array::from_fn(|i| BodyParameters::from_array(numbers[i]))
    }

    /// The angle of every body and its centre of mass.
    fn places(&self, q: &[f64; N]) -> [(f64, [f64; 2]); N] {
        let (mut frames, mut places) = ([(0.0, [0.0; 2]); N], [(0.0, [0.0; 2]); N]);
        for (i, (body, numbers)) in self.bodies.iter().zip(self.numbers()).enumerate() {
            let (angle, origin) = body.parent.map_or((0.0, [0.0; 2]), |parent| frames[usize::from(parent)]);
            let joint = moved(origin, numbers.place, angle);
            let turned = angle + numbers.angle;
            frames[i] = match body.joint {
                Joint::Revolute => (turned + q[i], joint),
                Joint::Prismatic => (turned, moved(joint, [q[i], 0.0], turned)),
            };
            places[i] = (frames[i].0, moved(frames[i].1, numbers.centre, frames[i].0));
        }
        places
    }

    /// T with velocities from central differences, and V.
    pub fn naive_energies(&self, q: &[f64; N], v: &[f64; N]) -> (f64, f64) {
        const STEP: f64 = 1e-5;
        let at = |t: f64| self.places(&core::array::from_fn(|i| q[i] + t * v[i]));
        let (back, now, forth) = (at(-STEP), at(0.0), at(STEP));
        let rate = |back: f64, forth: f64| (forth - back) / (2.0 * STEP);
        let spin = |i: usize| rate(back[i].0, forth[i].0);
        let (mut twice, mut potential) = (0.0, 0.0);
        for (i, numbers) in self.numbers().into_iter().enumerate() {
            let geared = self.bodies[i].parent.map_or(0.0, |p| spin(p.into())) + numbers.gear * v[i];
            twice += numbers.inertia * spin(i).powi(2) + numbers.rotor * geared.powi(2);
            for k in 0..2 {
                twice += numbers.mass * rate(back[i].1[k], forth[i].1[k]).powi(2);
                potential -= numbers.mass * self.weights[k] * now[i].1[k];
            }
        }
        (0.5 * twice, potential)
    }
}

/// A point in a frame at the given angle, from the origin of the frame.
fn moved(origin: [f64; 2], [x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [origin[0] + cos * x - sin * y, origin[1] + sin * x + cos * y]
}

const REVOLUTE: Joint = Joint::Revolute;
const PRISMATIC: Joint = Joint::Prismatic;

pub const CHAIN: [TreeBody; 2] = [body(REVOLUTE, None), body(REVOLUTE, Some(0))];

pub fn of_one() -> [Bodies<1>; 2] {
    [REVOLUTE, PRISMATIC].map(|joint| Bodies::random([body(joint, None)], 1))
}

/// Every pair of kinds of joints, on each other and side by side.
pub fn of_two() -> Vec<Bodies<2>> {
    let kinds = [(REVOLUTE, REVOLUTE), (REVOLUTE, PRISMATIC), (PRISMATIC, REVOLUTE), (PRISMATIC, PRISMATIC)];
    let trees = kinds.into_iter().flat_map(|(a, b)| [None, Some(0)].map(|on| [body(a, None), body(b, on)]));
    trees.zip(2..).map(|(bodies, seed)| Bodies::random(bodies, seed)).collect()
}

/// Branches that turn and slide, long and short, and two trees on one ground.
pub fn of_five() -> [Bodies<5>; 3] {
    let branched = [
        body(PRISMATIC, None),
        body(REVOLUTE, Some(0)),
        body(PRISMATIC, Some(1)),
        body(REVOLUTE, Some(2)),
        body(REVOLUTE, Some(0)),
    ];
    let hand = [
        body(REVOLUTE, None),
        body(REVOLUTE, Some(0)),
        body(PRISMATIC, Some(1)),
        body(PRISMATIC, Some(1)),
        body(REVOLUTE, Some(2)),
    ];
    let two = [
        body(REVOLUTE, None),
        body(PRISMATIC, None),
        body(PRISMATIC, Some(0)),
        body(REVOLUTE, Some(1)),
        body(PRISMATIC, Some(3)),
    ];
    [Bodies::random(branched, 21), Bodies::random(hand, 22), Bodies::random(two, 23)]
}

const LINK: BodyParameters<f64> = BodyParameters {
    place: [0.0, 0.0],
    angle: 0.0,
    mass: 0.5,
    centre: [0.2, 0.01],
    inertia: 0.008,
    rotor: 5e-5,
    gear: 6.0,
};

/// Two links of 0.2 m and 0.3 m on geared drives.
pub fn double_pendulum() -> Bodies<2> {
    let below = BodyParameters { place: [0.2, 0.0], mass: 0.6, centre: [0.22, 0.0], ..LINK };
    Bodies::hanging(CHAIN, [LINK, below])
}

/// A cart of 1 kg on a level rail along x, by a geared drive, and a link that hangs from it at q = 0.
pub fn cart_and_pole() -> Bodies<2> {
    let cart = BodyParameters { mass: 1.0, gear: 40.0, ..LINK };
    let link = BodyParameters { angle: -core::f64::consts::FRAC_PI_2, ..LINK };
    let mut tree = Bodies::hanging([body(PRISMATIC, None), body(REVOLUTE, Some(0))], [cart, link]);
    (tree.weights[0], tree.weights[1]) = (0.0, -9.81);
    tree
}
