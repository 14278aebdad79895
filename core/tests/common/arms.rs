//! Trees of rigid bodies in space with random numbers. Every body is made of point masses, and the energies are sums
//! over these.

use super::Random;
use super::bodies::body;
use leastaction_core::energy::arm::{
    ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, ArmBodies, ArmParameters, BodyInertia, BodyTree,
    INERTIAL_PARAMETERS, Joint, Rotation, TreeBody, Vector,
};
use leastaction_core::scalar::WeightFormat;

/// A point mass and its position in the body's frame.
pub type Point = (f64, Vector<f64>);

#[derive(Clone, Debug)]
pub struct Arm<const N: usize> {
    pub bodies: [TreeBody; N],
    pub points: [Vec<Point>; N],
    pub weights: Vec<f64>,
}

impl<const N: usize> Arm<N> {
    /// Bodies of five points, on joints with arbitrary axes, under gravity in an arbitrary direction.
    pub fn random(bodies: [TreeBody; N], seed: u64) -> Self {
        let mut random = Random(seed);
        let points = core::array::from_fn(|_| {
            (0..5).map(|_| (0.6 + random.symmetric(0.5), random.array(0.4))).collect::<Vec<Point>>()
        });
        let mut weights = random.vector(ARM_GRAVITY_PARAMETERS, 9.0);
        for points in &points {
            let rotation = rotation(unit(random.array(1.0)), random.symmetric(3.0));
            let (place, axis) = (random.array(0.7), unit(random.array(1.0)));
            let inertia = BodyInertia::from_array(inertia(points));
            let rotor = 0.2 + random.symmetric(0.2);
            weights.extend(ArmParameters { rotation, place, axis, inertia, rotor }.into_array());
        }
        Self { bodies, points, weights }
    }

    pub fn tree(&self) -> BodyTree<N> {
        BodyTree::new(self.bodies).expect("a tree")
    }

    /// The tree over a weight block of any type.
    pub fn over<'a, W: WeightFormat>(&self, mut weights: &'a [W]) -> ArmBodies<'a, W, N> {
        let bodies = ArmBodies::take(&mut weights, self.tree()).expect("weights of this tree");
        assert!(weights.is_empty(), "{} weights too many", weights.len());
        bodies
    }

    pub fn in_f64(&self) -> ArmBodies<'_, f64, N> {
        self.over(&self.weights)
    }

    /// The nearest weights in single precision.
    pub fn single(&self) -> Vec<f32> {
        self.weights.iter().map(|w| *w as f32).collect()
    }

    pub fn numbers(&self) -> [ArmParameters<f64>; N] {
        let (numbers, _) = self.weights[ARM_GRAVITY_PARAMETERS..].as_chunks::<ARM_PARAMETERS>();
        core::array::from_fn(|i| ArmParameters::from_array(numbers[i]))
    }

    /// The pose of every body relative to the base, as a homogeneous matrix.
    fn poses(&self, q: &[f64; N]) -> [Pose; N] {
        let mut poses = [[[0.0; 4]; 4]; N];
        for (i, (body, numbers)) in self.bodies.iter().zip(self.numbers()).enumerate() {
            let identity = pose(rotation([1.0, 0.0, 0.0], 0.0), [0.0; 3]);
            let parent = body.parent.map_or(identity, |parent| poses[usize::from(parent)]);
            let axis = numbers.axis;
            let moved = match body.joint {
                Joint::Revolute => pose(rotation(axis, q[i]), [0.0; 3]),
                Joint::Prismatic => pose(rotation(axis, 0.0), axis.map(|a| a * q[i])),
            };
            poses[i] = times(&times(&parent, &pose(numbers.rotation, numbers.place)), &moved);
        }
        poses
    }

    /// All point masses with their positions relative to the base.
    fn places(&self, q: &[f64; N]) -> Vec<Point> {
        let of_body = |(pose, points): (Pose, &Vec<Point>)| -> Vec<Point> {
            let place = |x: &Vector<f64>| -> Vector<f64> {
                core::array::from_fn(|r| (0..3).map(|c| pose[r][c] * x[c]).sum::<f64>() + pose[r][3])
            };
            points.iter().map(|(mass, x)| (*mass, place(x))).collect()
        };
        self.poses(q).into_iter().zip(&self.points).flat_map(of_body).collect()
    }

    /// T of the points, with velocities from differences of fourth order, and V.
    pub fn naive_energies(&self, q: &[f64; N], v: &[f64; N]) -> (f64, f64) {
        const STEP: f64 = 1e-3;
        let at = |t: f64| self.places(&core::array::from_fn(|i| q[i] + t * STEP * v[i]));
        let [a, b, now, c, d] = [-2.0, -1.0, 0.0, 1.0, 2.0].map(at);
        let mut twice: f64 = self.numbers().iter().zip(v).map(|(n, v)| n.rotor * v * v).sum();
        let mut potential = 0.0;
        for (i, (mass, place)) in now.iter().enumerate() {
            for (k, at) in place.iter().enumerate() {
                let [a, b, c, d] = [&a, &b, &c, &d].map(|points| points[i].1[k]);
                twice += mass * ((a - 8.0 * b + 8.0 * c - d) / (12.0 * STEP)).powi(2);
                potential -= mass * self.weights[k] * at;
            }
        }
        (0.5 * twice, potential)
    }
}

type Pose = [[f64; 4]; 4];

fn pose(rotation: Rotation<f64>, [x, y, z]: Vector<f64>) -> Pose {
    let [a, b, c] = rotation;
    [[a[0], a[1], a[2], x], [b[0], b[1], b[2], y], [c[0], c[1], c[2], z], [0.0, 0.0, 0.0, 1.0]]
}

fn times(a: &Pose, b: &Pose) -> Pose {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

pub fn unit(a: Vector<f64>) -> Vector<f64> {
    let length = a.iter().map(|a| a * a).sum::<f64>().sqrt();
    a.map(|a| a / length)
}

/// Rotation by the quaternion of half the angle.
pub fn rotation(axis: Vector<f64>, angle: f64) -> Rotation<f64> {
    let (sin, w) = (angle / 2.0).sin_cos();
    let [x, y, z] = axis.map(|a| sin * a);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// The ten inertial parameters of a set of points.
pub fn inertia(points: &[Point]) -> [f64; INERTIAL_PARAMETERS] {
    let mut sums = [0.0; INERTIAL_PARAMETERS];
    for (mass, [x, y, z]) in points {
        let of_unit = [1.0, *x, *y, *z, y * y + z * z, -x * y, x * x + z * z, -x * z, -y * z, x * x + y * y];
        sums.iter_mut().zip(of_unit).for_each(|(sum, number)| *sum += mass * number);
    }
    sums
}

const R: Joint = Joint::Revolute;
const P: Joint = Joint::Prismatic;

pub fn of_one() -> [Arm<1>; 2] {
    [(R, 1), (P, 2)].map(|(joint, seed)| Arm::random([body(joint, None)], seed))
}

/// Arms with every kind of joint on every other, in a chain and in a fork.
pub fn of_three() -> Vec<Arm<3>> {
    let kinds = (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 0 { R } else { P }));
    let trees =
        kinds.flat_map(|[a, b, c]| [1, 0].map(|on| [body(a, None), body(b, Some(0)), body(c, Some(on))]));
    trees.zip(3..).map(|(bodies, seed)| Arm::random(bodies, seed)).collect()
}

/// A chain of seven revolute joints.
pub fn chain_of_seven() -> Arm<7> {
    let on = |i: u8| body(R, i.checked_sub(1));
    Arm::random(core::array::from_fn(|i| on(i as u8)), 40)
}

/// The branched tree with axes along the z axes of the joints' frames and against them, as most descriptions of robots have them.
pub fn along_z() -> Arm<12> {
    let mut arm = branched();
    for (k, body) in arm.weights[ARM_GRAVITY_PARAMETERS..].chunks_exact_mut(ARM_PARAMETERS).enumerate() {
        body[12..15].copy_from_slice(&[0.0, 0.0, if k % 3 == 1 { -1.0 } else { 1.0 }]);
    }
    arm
}

/// Two arms of unequal length on a sliding trunk, with grippers.
pub fn branched() -> Arm<12> {
    let on = |joint, parent| body(joint, Some(parent));
    let bodies = [
        body(P, None),
        on(R, 0),
        on(R, 1),
        on(R, 2),
        on(P, 3),
        on(P, 3),
        on(R, 1),
        on(P, 6),
        on(R, 7),
        on(R, 8),
        body(R, None),
        on(P, 10),
    ];
    Arm::random(bodies, 41)
}
