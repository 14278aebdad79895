//! Schematic trees of rods and a cart for models that do not know their geometry.

use leastaction_models::Model;
use leastaction_models::tree::{Body, Inertia, Joint, Limits, Pose, Tree};
use nalgebra::{Matrix3, Vector3};

/// Length of a rod, m.
const ROD: f64 = 1.0;
/// Change of an angle in which the forces of gravity are compared, rad.
const CHANGE: f64 = 0.1;

/// A tree that stands for a model.
pub struct Schematic {
    /// The tree.
    pub tree: Tree,
    /// Whether the rods are upright at 0.
    pub is_upright: bool,
    /// Whether the second of two angles is measured from the vertical, not from the first rod.
    pub is_absolute: bool,
}

impl Schematic {
    /// Schematic of a model with one angle, a translation and an angle, or two angles; `None` for any other.
    pub fn new(model: &Model) -> Option<Self> {
        let letters = model.architecture.coordinates();
        let (slides, rods) = match letters.as_str() {
            "a" => (false, 1),
            "ta" => (true, 1),
            "aa" => (false, 2),
            _ => return None,
        };
        let n = letters.len();
        let last = n - 1;
        let is_upright = stiffness(model, (last, last)).is_some_and(|own| own < 0.0);
        let is_absolute = rods == 2 && is_apart(model);
        let up = if is_upright { 1.0 } else { -1.0 };
        let mut bodies = Vec::new();
        for k in 0..n {
            let joint = if slides && k == 0 {
                Joint::Prismatic(Vector3::x_axis())
            } else {
                Joint::Revolute(-Vector3::y_axis())
            };
            let start = if k + 1 == n && rods == 2 { Vector3::z() * (up * ROD) } else { Vector3::zeros() };
            bodies.push(body(k, joint, start, up));
        }
        Some(Self { tree: Tree::new(bodies).ok()?, is_upright, is_absolute })
    }

    /// Positions of the tree's joints at the position q of the model.
    pub fn joints(&self, q: &[f64]) -> Vec<f64> {
        match q {
            [first, second] if self.is_absolute => vec![*first, second - first],
            _ => q.to_vec(),
        }
    }

    /// Sentence that says what is drawn.
    pub fn about(&self) -> String {
        let zero = if self.is_upright { "upright" } else { "hanging" };
        let from = if self.is_absolute { ", both from the vertical" } else { "" };
        format!(
            "A schematic: the model does not know its geometry. Rods have the length {ROD} m and are {zero} at 0, as the model's \
             gravity has them; angles count counter-clockwise{from}."
        )
    }
}

fn body(k: usize, joint: Joint, start: Vector3<f64>, up: f64) -> Body {
    let centre =
        if matches!(joint, Joint::Revolute(_)) { Vector3::z() * (0.5 * up * ROD) } else { Vector3::zeros() };
    Body {
        name: String::new(),
        joint_name: String::new(),
        parent: k.checked_sub(1),
        joint,
        pose: Pose { translation: start, ..Pose::identity() },
        coordinate: k,
        ratio: 1.0,
        offset: 0.0,
        inertia: Inertia::of_centre(1.0, centre, Matrix3::identity()),
        limits: Limits::none(),
    }
}

/// Change of the command that holds coordinate i at rest, near q = 0, over a change of coordinate j; `None` if the model has none.
fn stiffness(model: &Model, (i, j): (usize, usize)) -> Option<f64> {
    let rest = vec![0.0; model.n()];
    let at = |x: f64| {
        let mut q = rest.clone();
        *q.get_mut(j)? = x;
        model.inverse_dynamics([&q, &rest, &rest]).ok()?.get(i).copied()
    };
    let gain = model.facts.actuator.gain(i);
    Some((at(CHANGE)? - at(-CHANGE)?) * gain / (2.0 * CHANGE)).filter(|slope| slope.is_finite())
}

/// Whether gravity on the first of two rods does not feel the second angle, which is then measured from the vertical.
fn is_apart(model: &Model) -> bool {
    let [own, cross] = [(1, 1), (0, 1)].map(|pair| stiffness(model, pair).unwrap_or_default().abs());
    cross < 0.2 * own
}
