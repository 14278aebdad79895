//! Distance of a trajectory in single precision from the trajectory in double precision.

use crate::common::trees;
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Path, State};
use leastaction_core::energy::trigonometric::{CARTPOLE, PENDULUM};
use leastaction_core::forces::System;
use leastaction_core::lagrangian::Lagrangian;

/// Largest distance of the f32 trajectory from the f64 one over 3 s at 1 ms, per coordinate. Both start at the same
/// f32 numbers and take the same f32 step.
fn precision_gap<P: Path, const N: usize>(
    single: impl Lagrangian<f32, N>,
    double: impl Lagrangian<f64, N>,
    q: [f32; N],
    v: [f32; N],
) -> [f64; N] {
    let h = 1e-3_f32;
    let (in_single, in_double) = (System::conservative(single), System::conservative(double));
    let (single, double) = (Del::<f32, P>::new(h), Del::<f64, P>::new(h.into()));
    let mut a = State::new(&in_single.lagrangian, q, v).unwrap();
    let mut b = State::new(&in_double.lagrangian, q.map(f64::from), v.map(f64::from)).unwrap();
    let mut gap = [0.0_f64; N];
    for _ in 0..3_000 {
        single.step(&in_single, &mut a, &Control::none()).unwrap();
        double.step(&in_double, &mut b, &Control::none()).unwrap();
        gap = core::array::from_fn(|i| gap[i].max((f64::from(a.q()[i]) - b.q()[i]).abs()));
    }
    gap
}

#[test]
fn single_precision_stays_within_2e_6_rad_of_double_over_3_s() {
    let starts = [(0.5, 0.0), (1.0, 0.0), (2.0, 1.0), (-2.5, 3.0), (0.1, 4.0), (3.0, -6.0)];
    let mut largest = 0.0_f64;
    for (angle, rate) in starts {
        let [pendulum2] = precision_gap::<Midpoint, 1>(PENDULUM, PENDULUM, [angle], [rate]);
        let [pendulum4] = precision_gap::<Galerkin, 1>(PENDULUM, PENDULUM, [angle], [rate]);
        let [cart2, pole2] = precision_gap::<Midpoint, 2>(CARTPOLE, CARTPOLE, [0.3, angle], [0.05, rate]);
        let [cart4, pole4] = precision_gap::<Galerkin, 2>(CARTPOLE, CARTPOLE, [0.3, angle], [0.05, rate]);
        for gap in [pendulum2, pendulum4, cart2, pole2, cart4, pole4] {
            assert!(gap <= 2e-6, "{gap:e} from ({angle}, {rate})");
            largest = largest.max(gap);
        }
    }
    println!("largest gap {largest:.2e} rad");
}

#[test]
fn single_precision_of_a_tree_stays_near_double_over_3_s() {
    for learned in [false, true] {
        let tree = trees::double_pendulum(learned).rounded();
        let single = tree.single();
        for (q, v) in [([0.5, -0.3], [0.0, 0.0]), ([1.0, 0.8], [0.5, -0.5]), ([0.1, 1.2], [2.0, 1.0])] {
            let gaps = [
                precision_gap::<Midpoint, 2>(tree.over(&single), tree.in_f64(), q, v),
                precision_gap::<Galerkin, 2>(tree.over(&single), tree.in_f64(), q, v),
            ];
            println!("learned: {learned}, from {q:?}, {v:?}: {gaps:?} rad");
            assert!(gaps.concat().iter().all(|gap| *gap <= 5e-6), "{gaps:?} from {q:?}, {v:?}");
        }
    }
}
