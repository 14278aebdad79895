//! Schematic trees of rods and a cart for models that do not know their geometry.

use leastaction_models::Model;
use leastaction_models::tree::{Body, Inertia, Joint, Limits, Pose, Tree};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Length of a rod, m.
const ROD: f64 = 1.0;
/// Change of an angle in which the forces of gravity are compared, rad.
const CHANGE: f64 = 0.1;

/// Largest relative change of a cart's inertia, as networks learn it.
const EVEN: f64 = 0.1;

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
    /// Schematic of a model with one angle, a translation and an angle, or two angles; `None` for any other. A cyclic coordinate before an
    /// angle is a cart if its inertia is the same whatever the angle, as that of a rotating arm is not.
    pub fn new(model: &Model) -> Option<Self> {
        let letters = model.architecture.coordinates();
        let (slides, rods) = match letters.as_str() {
            "a" => (false, 1),
            "ta" => (true, 1),
            "ca" if has_even_inertia(model) => (true, 1),
            "aa" => (false, 2),
            _ => return None,
        };
        let n = letters.len();
        let last = n - 1;
        let is_upright = stiffness(model, (last, last)).is_some_and(|own| own < 0.0);
        // Elements of a modular model have their angles from the vertical.
        let is_absolute = rods == 2 && (model.architecture.family.modular().is_some() || is_apart(model));
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
        let zero = if self.is_upright { "stand upright" } else { "hang" };
        let from = if self.is_absolute { ", both from the vertical" } else { "" };
        format!(
            "A schematic: the model does not know its geometry. Rods have the length {ROD} m and {zero} at 0, as its gravity says; angles \
             count counter-clockwise{from}."
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

/// Whether the inertia of the first of two coordinates does not depend on the second, an angle.
fn has_even_inertia(model: &Model) -> bool {
    let rest = [0.0; 2];
    let force =
        |angle: f64, a: f64| Some(*model.inverse_dynamics([&[0.0, angle], &rest, &[a, 0.0]]).ok()?.first()?);
    let inertia = |turn: f64| Some(force(FRAC_PI_2 * turn, 1.0)? - force(FRAC_PI_2 * turn, 0.0)?);
    let Some(inertias) = [0.0, 1.0, 2.0].map(inertia).into_iter().collect::<Option<Vec<f64>>>() else {
        return false;
    };
    inertias.iter().all(|inertia| (inertia / inertias[0] - 1.0).abs() < EVEN)
}

/// Whether gravity on the first of two rods does not feel the second angle, which is then measured from the vertical.
fn is_apart(model: &Model) -> bool {
    let [own, cross] = [(1, 1), (0, 1)].map(|pair| stiffness(model, pair).unwrap_or_default().abs());
    cross < 0.2 * own
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Machine;
    use leastaction_core::energy::bodies::{BodyParameters, Joint as PlanarJoint, TreeBody};
    use leastaction_core::energy::modular::{ModularShape, TransformShape, TypeShape};
    use leastaction_models::modular::{ModularArchitecture, NamedTree, NamedType};
    use leastaction_models::{Architecture, BodiesArchitecture, InertiaNetworkArchitecture, Number};
    use std::path::Path;

    fn described(name: &str) -> Option<Schematic> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/peers/control");
        Schematic::new(&Machine::of_description(&folder.join(name)).unwrap().model)
    }

    /// Two rods of 1 kg and 1 m, whose angles are both from the vertical.
    fn rods() -> Model {
        let kind = TypeShape { transform: TransformShape::Rod, potential: None };
        let shape = ModularShape::new(&[], &[kind], None).unwrap();
        let numbers = [1.0, 0.1, 0.5, 1.0, 0.0].map(Number::known);
        let rod = NamedType { name: "rod".to_owned(), numbers };
        let coefficients = [9.81, 0.0].map(Number::known);
        let chain = vec![NamedTree::chain("rods", &[0, 0])];
        let architecture =
            Architecture::from(ModularArchitecture::new(shape, vec![rod], coefficients, chain));
        let weights = architecture.initial_weights(0);
        Model::new(architecture, weights)
    }

    #[test]
    fn gravity_tells_upright_rods_from_hanging_ones() {
        let upright = ["pendulum.urdf", "cartpole.urdf", "acrobot.urdf", "pendubot.urdf"]
            .map(|name| described(name).unwrap().is_upright);
        assert_eq!(upright, [true, true, false, false]);
        assert!(described("arm.urdf").is_none());
    }

    #[test]
    fn angles_from_the_vertical_are_known_by_the_family_or_the_forces() {
        let apart = BodiesArchitecture::new([0.0, -9.81].map(Number::known), [hanging(), hanging()]).unwrap();
        let weights: Vec<f64> = apart.all_numbers().map(|number| number.value).collect();
        assert!(Schematic::new(&Model::new(apart, weights)).unwrap().is_absolute);
        assert!(!described("acrobot.urdf").unwrap().is_absolute);
    }

    /// A rod of 1 kg that hangs from the ground.
    fn hanging() -> (TreeBody, BodyParameters<Number>) {
        let numbers = [0.0, 0.0, 0.0, 1.0, 0.0, -0.5, 0.1, 0.0, 1.0].map(Number::known);
        (TreeBody { joint: PlanarJoint::Revolute, parent: None }, BodyParameters::from_array(numbers))
    }

    #[test]
    fn a_cyclic_coordinate_is_a_cart_if_its_inertia_is_even() {
        use leastaction_core::energy::inertia_network::Coordinate::{Angle, Cyclic};
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../firmware-sim/chip/models/cartpole.postcard");
        let cart = leastaction_models::file::decode(&std::fs::read(file).unwrap()).unwrap();
        assert_eq!(cart.architecture.coordinates(), "ca");
        assert!(Schematic::new(&cart).is_some());
        // A network with random weights has an inertia that depends on the angle.
        let architecture = Architecture::from(InertiaNetworkArchitecture::new(&[Cyclic, Angle], 8));
        let weights = architecture.initial_weights(3).iter().map(|weight| 4.0 * weight).collect();
        assert!(Schematic::new(&Model::new(architecture, weights)).is_none());
    }

    #[test]
    fn level_rods_reach_twice_their_length() {
        let rods = Schematic::new(&rods()).unwrap();
        assert!(rods.is_absolute && !rods.is_upright && rods.about().contains("both from the vertical"));
        let quarter = std::f64::consts::FRAC_PI_2;
        let ends = rods.tree.poses(&rods.joints(&[quarter, quarter]));
        let tip = ends[1].translation + ends[1].rotation * Vector3::new(0.0, 0.0, -ROD);
        assert!((tip - Vector3::x() * 2.0 * ROD).amax() < 1e-9, "{tip}");
    }
}
