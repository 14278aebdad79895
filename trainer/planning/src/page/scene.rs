//! A mechanism that can be drawn: its points at any position, and the side from which a motion is seen.

use super::particles::Particles;
use super::schematic::Schematic;
use super::skeleton::{Part, Skeleton};
use super::view::View;
use leastaction_models::Model;
use leastaction_models::tree::Tree;
use nalgebra::Vector3;

/// A mechanism that can be drawn, seen from the side that shows most of a motion.
pub struct Scene {
    shape: Shape,
    /// The side from which the motion is seen.
    pub view: View,
    /// Sentence that says what is drawn.
    pub about: String,
}

/// Carrier of the points.
enum Shape {
    /// Bodies of a model that knows its geometry.
    Bodies(Skeleton),
    /// Rods and a cart that stand for a model.
    Schematic(Skeleton, Schematic),
    /// Nodes of a graph, whose coordinates are their positions.
    Particles(Particles),
}

impl Scene {
    /// The scene of a model whose coordinates take the positions of `path`; `None` if the model does not know its geometry and nothing
    /// can stand for it. `limits` of the coordinates (m or rad), if they are finite, are the ends of rails.
    pub fn new(model: &Model, path: &[Vec<f64>], limits: &[[f64; 2]]) -> Option<Self> {
        let shape = Shape::of(model, &ranges(path, limits))?;
        let points: Vec<Vector3<f64>> = path.iter().flat_map(|q| shape.at(q)).collect();
        let view = View::new(&points, &shape.gravity());
        let about = shape.about(&view);
        Some(Self { shape, view, about })
    }

    /// Parts between the points, from the back to the front.
    pub fn parts(&self) -> &[Part] {
        match &self.shape {
            Shape::Bodies(skeleton) | Shape::Schematic(skeleton, _) => &skeleton.parts,
            Shape::Particles(particles) => &particles.parts,
        }
    }

    /// Numbers of the points whose paths tell most of a motion: the ends of the last links, or the nodes.
    pub fn tips(&self) -> &[usize] {
        match &self.shape {
            Shape::Bodies(skeleton) | Shape::Schematic(skeleton, _) => &skeleton.tips,
            Shape::Particles(particles) => &particles.tips,
        }
    }

    /// All points at the position q, in the frame of the base, m.
    pub fn at(&self, q: &[f64]) -> Vec<Vector3<f64>> {
        self.shape.at(q)
    }
}

impl Shape {
    fn of(model: &Model, ranges: &[[f64; 2]]) -> Option<Self> {
        if let Some(tree) = tree(model) {
            return Some(Self::Bodies(Skeleton::new(tree, ranges)));
        }
        if let Some(graph) = model.architecture.family.graph() {
            return Particles::new(graph).map(Self::Particles);
        }
        let schematic = Schematic::new(model)?;
        Some(Self::Schematic(Skeleton::new(schematic.tree.clone(), ranges), schematic))
    }

    fn at(&self, q: &[f64]) -> Vec<Vector3<f64>> {
        match self {
            Self::Bodies(skeleton) => skeleton.at(q),
            Self::Schematic(skeleton, schematic) => skeleton.at(&schematic.joints(q)),
            Self::Particles(particles) => particles.at(q),
        }
    }

    fn gravity(&self) -> Vector3<f64> {
        match self {
            Self::Bodies(skeleton) | Self::Schematic(skeleton, _) => skeleton.gravity(),
            Self::Particles(particles) => particles.down(),
        }
    }

    fn about(&self, view: &View) -> String {
        match self {
            Self::Schematic(_, schematic) => schematic.about(),
            Self::Particles(_) => "Nodes of the graph, its rods (blue) and its edges (grey).".to_owned(),
            Self::Bodies(_) if view.from_above => "Joints and the lines between them, seen from above.".to_owned(),
            Self::Bodies(_) => "Joints and the lines between them, from the side that shows most of the motion; gravity points down."
                .to_owned(),
        }
    }
}

/// Tree of a model that knows its geometry.
fn tree(model: &Model) -> Option<Tree> {
    let (family, weights) = (&model.architecture.family, &model.weights);
    let arm = family.arm().and_then(|arm| arm.host_tree(weights));
    arm.or_else(|| family.bodies()?.host_tree(weights))
}

/// Ranges in which the coordinates move: their limits, or else 0 and a little more than the motion.
fn ranges(path: &[Vec<f64>], limits: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let range = |i: usize| {
        let along = || path.iter().filter_map(|q| q.get(i).copied());
        let (least, most) =
            (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
        let beyond = 0.1 * (most - least).max(0.5);
        let moved = [(least - beyond).min(0.0), (most + beyond).max(0.0)];
        limits.get(i).copied().filter(|ends| ends.iter().all(|x| x.is_finite())).unwrap_or(moved)
    };
    (0..path.first().map_or(0, Vec::len)).map(range).collect()
}
