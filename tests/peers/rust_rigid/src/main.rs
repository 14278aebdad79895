//! phyz-rigid's side of `arm_pinocchio.py`: reads the input of `peer_arm` and prints inverse dynamics, gravity, mass matrix and forward
//! dynamics.

use phyz_math::{DVec, Mat3, SpatialInertia, SpatialTransform, Vec3};
use phyz_model::{Joint, Model, ModelBuilder, State};
use phyz_rigid::{aba, crba, rnea};
use std::hint::black_box;
use std::io::Read;
use std::time::Instant;

fn main() {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text).expect("stdin");
    let mut words = text.split_ascii_whitespace().map(|word| word.parse::<f64>().expect("a number"));
    let mut take = |count: usize| -> Vec<f64> { words.by_ref().take(count).collect() };
    let n = take(1)[0] as usize;
    let (tree, gravity, numbers) = (take(2 * n), take(3), take(26 * n));
    let model = model(&tree, &gravity, &numbers);
    let rotors: Vec<f64> = numbers.chunks(26).map(|body| body[25]).collect();
    let count = take(1)[0] as usize;
    let states: Vec<[Vec<f64>; 3]> = (0..count).map(|_| [take(n), take(n), take(n)]).collect();
    let at = |q: &[f64], v: &[f64], tau: &[f64]| State {
        q: DVec::from_slice(q),
        v: DVec::from_slice(v),
        ctrl: DVec::from_slice(tau),
        ..model.default_state()
    };
    let zero = vec![0.0; n];
    for [q, v, x] in &states {
        let inverse = |v: &[f64], a: &[f64]| -> Vec<f64> {
            // The function ignores the torques of the rotors.
            let tau = rnea(&model, &at(q, v, &zero), &DVec::from_slice(a));
            (0..n).map(|i| tau[i] + rotors[i] * a[i]).collect()
        };
        let mass = crba(&model, &at(q, v, &zero));
        let mut all = [inverse(v, x), inverse(&zero, &zero)].concat();
        all.extend((0..n * n).map(|k| mass[(k / n, k % n)]));
        all.extend(aba(&model, &at(q, v, x)).as_slice());
        println!("{}", all.iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(" "));
    }
    let made: Vec<(State, DVec)> = states.iter().map(|[q, v, x]| (at(q, v, x), DVec::from_slice(x))).collect();
    let time = |name: &str, of: &dyn Fn(&(State, DVec))| println!("{name} {}", nanoseconds(&made, of));
    time("inverse_dynamics", &|(state, x)| {
        black_box(rnea(&model, state, x));
    });
    time("mass_matrix", &|(state, _)| {
        black_box(crba(&model, state));
    });
    time("acceleration", &|(state, _)| {
        black_box(aba(&model, state));
    });
}

fn model(tree: &[f64], gravity: &[f64], numbers: &[f64]) -> Model {
    let three = |x: &[f64]| Vec3::new(x[0], x[1], x[2]);
    let mut builder = ModelBuilder::new().gravity(three(gravity));
    for (k, body) in numbers.chunks(26).enumerate() {
        let [r, rest] = [&body[..9], &body[9..]];
        // Rotation from the parent's coordinates to the joint's: the transpose of the frame's rotation.
        let rotation = Mat3::new(r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]);
        let place = SpatialTransform::new(rotation, three(rest));
        let (axis, m) = (three(&rest[3..]), rest[6]);
        let [x, y, z] = [rest[7] / m, rest[8] / m, rest[9] / m];
        let (xx, xy, yy) = (rest[10] - m * (y * y + z * z), rest[11] + m * x * y, rest[12] - m * (x * x + z * z));
        let (xz, yz, zz) = (rest[13] + m * x * z, rest[14] + m * y * z, rest[15] - m * (x * x + y * y));
        let inertia = SpatialInertia::new(m, Vec3::new(x, y, z), Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz));
        let joint = if tree[2 * k + 1] == 1.0 {
            Joint::prismatic(place, axis)
        } else {
            Joint { axis, ..Joint::revolute(place) }
        };
        let joint = Joint { armature: rest[16], ..joint };
        builder = builder.add_body(&k.to_string(), tree[2 * k] as i32, joint, inertia);
    }
    builder.build()
}

/// Time of a call in the fastest pass.
fn nanoseconds<S>(states: &[S], of: &dyn Fn(&S)) -> f64 {
    let pass = || {
        let started = Instant::now();
        states.iter().for_each(|state| of(black_box(state)));
        started.elapsed().as_secs_f64() / states.len() as f64 * 1e9
    };
    (0..40).map(|_| pass()).fold(f64::INFINITY, f64::min)
}
