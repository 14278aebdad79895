//! Trees of elements of every kind, with a naive evaluation of their energies.

use super::Random;
use super::oracle::Learned;
use super::shapes::naive_network;
use leastaction_core::energy::modular::{
    ELEMENT_PARAMETERS, Input, Modular, ModularShape, NetworkShape, PairInput, PairShape, TransformShape,
    TreeElement, TypeShape,
};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::network::Activation;
use leastaction_core::scalar::{Scalar, WeightFormat};

pub const KINDS: usize = 3;
pub const WIDTH: usize = 11;
pub const DEPTH: usize = 3;

/// A tree with the damping of its elements.
pub type Damped<'a, S, const N: usize> =
    System<Modular<'a, <S as Scalar>::Weight, N, KINDS, WIDTH, DEPTH>, Viscous<S, N>>;

/// A tree that owns its weights.
#[derive(Clone, Debug)]
pub struct Tree<const N: usize> {
    pub shape: ModularShape,
    pub nodes: Vec<TreeElement>,
    pub weights: Vec<f64>,
    /// Damping coefficient of each type.
    pub damping: Vec<f64>,
}

pub fn network(inputs: u8, widths: &[u16], outputs: u8, activation: Activation) -> NetworkShape {
    NetworkShape::new(inputs, widths, outputs, activation).expect("few layers")
}

pub fn node(kind: u8, parent: Option<u8>) -> TreeElement {
    TreeElement { kind, parent }
}

impl<const N: usize> Tree<N> {
    pub fn new(shape: ModularShape, nodes: &[TreeElement], seed: u64) -> Self {
        let (mut random, kinds) = (Random(seed), shape.types.len());
        let networks = shape.parameters().unwrap() - ELEMENT_PARAMETERS * kinds - 2;
        let mut weights = random.vector(networks, 0.8);
        let mut damping = Vec::new();
        for _ in 0..kinds {
            weights.extend(random.array::<ELEMENT_PARAMETERS>(0.8).map(|x| 1.0 + 0.5 * x));
            damping.push(1.0 + 0.5 * random.symmetric(0.8));
        }
        weights.extend(random.array::<2>(0.8));
        Self { shape, nodes: nodes.to_vec(), weights, damping }
    }

    /// The tree over a weight block of any type, of this shape.
    pub fn over<'a, W: WeightFormat>(&self, mut weights: &'a [W]) -> Modular<'a, W, N, KINDS, WIDTH, DEPTH> {
        let tree = self.shape.tree(self.nodes.iter().copied()).expect("a tree");
        let modular = Modular::take(&mut weights, &self.shape, tree).expect("weights of this shape");
        assert!(weights.is_empty(), "{} weights too many", weights.len());
        modular
    }

    /// The tree with the damping of its elements.
    pub fn damped<'a, S: Scalar>(&self, weights: &'a [S::Weight]) -> Damped<'a, S, N> {
        let lagrangian = self.over(weights);
        let coefficients = lagrangian.tree.kinds().map(|kind| S::constant(self.damping[usize::from(kind)]));
        System { lagrangian, forces: Viscous { coefficients } }
    }

    pub fn in_f64(&self) -> Modular<'_, f64, N, KINDS, WIDTH, DEPTH> {
        self.over(&self.weights)
    }

    /// The nearest weights in single precision.
    pub fn single(&self) -> Vec<f32> {
        self.weights.iter().map(|w| *w as f32).collect()
    }

    /// The tree with the weights that [`Tree::single`] gives.
    pub fn rounded(&self) -> Self {
        Self { weights: self.single().into_iter().map(f64::from).collect(), ..self.clone() }
    }

    /// Gives all types this damping coefficient.
    pub fn set_damping(&mut self, damping: f64) {
        self.damping.fill(damping);
    }

    fn numbers(&self, kind: u8) -> [f64; ELEMENT_PARAMETERS] {
        let start =
            self.weights.len() - 2 - ELEMENT_PARAMETERS * (self.shape.types.len() - usize::from(kind));
        self.weights[start..start + ELEMENT_PARAMETERS].try_into().unwrap()
    }

    fn run(&self, network: u8, x: &[f64]) -> Vec<f64> {
        let before = self.shape.networks.iter().take(network.into()).map(|n| n.parameters().unwrap()).sum();
        let shape = self.shape.networks.get(network).unwrap();
        let widths = shape.widths.into_iter().filter(|w| *w > 0).map(usize::from);
        let outputs = shape.outputs.into();
        naive_network(&self.weights[before..], x.to_vec(), widths, shape.activation, outputs)
    }

    /// Displacement that an element's coordinates add to positions.
    fn displacement(&self, kind: u8, q: &[f64]) -> [f64; 2] {
        let run = |network, x: &[f64]| <[f64; 2]>::try_from(self.run(network, x)).unwrap();
        match self.shape.types.get(usize::from(kind)).unwrap().transform {
            TransformShape::Network { position, input, .. } => run(position, &features(input, q[0])),
            TransformShape::Rod => {
                let [_, _, _, length] = self.numbers(kind);
                [length * q[0].sin(), -length * q[0].cos()]
            }
            TransformShape::Slide => [q[0], 0.0],
            TransformShape::Free => [q[0], q[1]],
        }
    }

    /// Velocity that an element's coordinates add: by central differences, or from its own velocity network.
    fn speed(&self, kind: u8, q: &[f64], v: &[f64]) -> [f64; 2] {
        const STEP: f64 = 1e-5;
        if let TransformShape::Network { velocity: Some(network), input, .. } =
            self.shape.types.get(usize::from(kind)).unwrap().transform
        {
            let g = self.run(network, &features(input, q[0]));
            return [g[0] * v[0], g[1] * v[0]];
        }
        let moved = |t: f64| {
            let q: Vec<f64> = q.iter().zip(v).map(|(q, v)| q + t * v).collect();
            self.displacement(kind, &q)
        };
        let (back, forth) = (moved(-STEP), moved(STEP));
        [0, 1].map(|i| (forth[i] - back[i]) / (2.0 * STEP))
    }

    fn pair_energy(&self, pair: PairShape, [ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
        let u = |x: &[f64]| self.run(pair.network, x)[0];
        let (x, y) = (ax - bx, ay - by);
        match pair.input {
            PairInput::Concat => 0.5 * (u(&[ax, ay, bx, by]) + u(&[bx, by, ax, ay])),
            PairInput::Difference => 0.5 * (u(&[x, y]) + u(&[-x, -y])),
            PairInput::Distance => u(&[x.hypot(y)]),
            PairInput::InverseDistance => u(&[1.0 / x.hypot(y)]),
        }
    }
}

impl<const N: usize> Learned<N> for Tree<N> {
    // Velocities are central differences in this evaluation.
    const NAIVE: f64 = 1e-9;

    type Over<'w, S: Scalar>
        = Modular<'w, S::Weight, N, KINDS, WIDTH, DEPTH>
    where
        S::Weight: 'w,
        Self: 'w;

    fn energies_over<'w, S: Scalar>(&'w self, weights: &'w [S::Weight]) -> Self::Over<'w, S> {
        self.over(weights)
    }

    fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Energies, element by element from the ground.
    fn naive_energies(&self, q: &[f64; N], v: &[f64; N]) -> (f64, f64) {
        let mut tips: Vec<([f64; 2], [f64; 2])> = Vec::new();
        let mut centres: Vec<(f64, [f64; 2])> = Vec::new();
        let (mut kinetic, mut potential, mut first) = (0.0, 0.0, 0);
        let [c1, c2] = self.weights[self.weights.len() - 2..].try_into().unwrap();
        for TreeElement { kind, parent } in &self.nodes {
            let shape = self.shape.types.get(usize::from(*kind)).unwrap();
            let [mass, inertia, centre, _] = self.numbers(*kind);
            let range = first..first + shape.coordinates();
            let (own, speed) = (
                self.displacement(*kind, &q[range.clone()]),
                self.speed(*kind, &q[range.clone()], &v[range.clone()]),
            );
            let (base, base_speed) = parent.map_or(([0.0; 2], [0.0; 2]), |parent| tips[usize::from(parent)]);
            let at = |part: f64| [0, 1].map(|i| base[i] + part * own[i]);
            let moving = |part: f64| [0, 1].map(|i| base_speed[i] + part * speed[i]);
            let [vx, vy] = moving(centre);
            kinetic += 0.5 * mass * (vx * vx + vy * vy);
            kinetic += v[range].iter().map(|v| 0.5 * inertia * v * v).sum::<f64>();
            if let Some(network) = shape.potential {
                potential += c1 * mass * self.run(network, &at(centre))[0];
            }
            if let Some(pair) = self.shape.pair {
                for (other, x) in &centres {
                    potential += c2 * mass * other * self.pair_energy(pair, *x, at(centre));
                }
            }
            centres.push((mass, at(centre)));
            tips.push((at(1.0), moving(1.0)));
            first += shape.coordinates();
        }
        (kinetic, potential)
    }
}

fn features(input: Input, q: f64) -> Vec<f64> {
    match input {
        Input::Translation => vec![q],
        Input::Angle => vec![q.cos(), q.sin()],
        Input::WrappedAngle => vec![q.rem_euclid(std::f64::consts::TAU)],
    }
}

const LEARNED: fn(Input, Option<u8>) -> TransformShape =
    |input, velocity| TransformShape::Network { position: 0, velocity, input };

/// Element types of all kinds: a learned link, a rod and a slide, each with a potential or without.
pub fn chain(input: Input, velocity: Option<u8>, pair: Option<PairInput>) -> ModularShape {
    let inputs = input.features() as u8;
    let networks = [
        network(inputs, &[7, 5], 2, Activation::Tanh),
        network(2, &[9], 1, Activation::Softplus),
        network(inputs, &[4], 2, Activation::Isru),
        network(pair.map_or(1, |p| p.features() as u8), &[6, 11], 1, Activation::Squareplus),
    ];
    let types = [
        TypeShape { transform: LEARNED(input, velocity), potential: Some(1) },
        TypeShape { transform: TransformShape::Rod, potential: Some(1) },
        TypeShape { transform: TransformShape::Slide, potential: None },
    ];
    ModularShape::new(&networks, &types, pair.map(|input| PairShape { network: 3, input }))
        .expect("few parts")
}

/// Free points, of two types.
pub fn bodies(pair: PairInput) -> ModularShape {
    let networks = [
        network(2, &[5, 3], 1, Activation::Tanh),
        network(pair.features() as u8, &[10], 1, Activation::Tanh),
    ];
    let types = [None, Some(0)].map(|potential| TypeShape { transform: TransformShape::Free, potential });
    ModularShape::new(&networks, &types, Some(PairShape { network: 1, input: pair })).expect("few parts")
}

pub fn of_three() -> Vec<Tree<3>> {
    let in_line = [node(2, None), node(0, Some(0)), node(1, Some(1))];
    let branched = [node(1, None), node(0, Some(0)), node(0, Some(0))];
    vec![
        Tree::new(chain(Input::Angle, None, None), &in_line, 1),
        Tree::new(chain(Input::Translation, None, Some(PairInput::Concat)), &branched, 2),
        Tree::new(chain(Input::Angle, Some(2), Some(PairInput::Difference)), &in_line, 3),
        Tree::new(chain(Input::WrappedAngle, Some(2), Some(PairInput::Distance)), &branched, 4),
    ]
}

pub fn of_six() -> Vec<Tree<6>> {
    let free = [node(0, None), node(1, None), node(0, None)];
    let tree = [
        node(2, None),
        node(0, Some(0)),
        node(1, Some(1)),
        node(1, Some(0)),
        node(0, Some(3)),
        node(2, None),
    ];
    vec![
        Tree::new(bodies(PairInput::Distance), &free, 5),
        Tree::new(bodies(PairInput::Concat), &free, 6),
        Tree::new(bodies(PairInput::Difference), &free, 7),
        Tree::new(bodies(PairInput::InverseDistance), &free, 9),
        Tree::new(chain(Input::Angle, None, Some(PairInput::Distance)), &tree, 8),
    ]
}

/// A link that gravity pulls, rigid or learned, and a cart.
const LINK: u8 = 0;
const CART: u8 = 1;

/// A mechanism of links of 1 m and 1 kg and carts of 2 kg under gravity. A learned link has a network that is not quite a
/// rod: x = tanh(ε(sin q, −cos q))/ε.
fn mechanism<const N: usize>(learned: bool, nodes: &[TreeElement]) -> Tree<N> {
    const EPSILON: f64 = 0.3;
    let networks = [network(2, &[2], 2, Activation::Tanh), network(2, &[], 1, Activation::Identity)];
    let transform = if learned { LEARNED(Input::Angle, None) } else { TransformShape::Rod };
    let types = [
        TypeShape { transform, potential: Some(1) },
        TypeShape { transform: TransformShape::Slide, potential: None },
    ];
    let hidden = [EPSILON, 0.0, 0.0, EPSILON, 0.0, 0.0];
    let output = [0.0, 1.0 / EPSILON, -1.0 / EPSILON, 0.0, 0.0, 0.0];
    let (gravity, numbers) = ([0.0, 9.81, 0.0], [1.0, 0.0, 1.0, 1.0, 2.0, 0.0, 1.0, 1.0]);
    let weights = [&hidden[..], &output, &gravity, &numbers, &[1.0, 0.0]].concat();
    let shape = ModularShape::new(&networks, &types, None).expect("few parts");
    Tree { shape, nodes: nodes.to_vec(), weights, damping: vec![0.0; 2] }
}

pub fn double_pendulum(learned: bool) -> Tree<2> {
    mechanism(learned, &[node(LINK, None), node(LINK, Some(0))])
}

/// A free slide that carries a link.
pub fn cart_and_pole(learned: bool) -> Tree<2> {
    mechanism(learned, &[node(CART, None), node(LINK, Some(0))])
}
