//! Fits to torques without noise.

use leastaction_data::Rows;
use leastaction_learning::torque::Samples;
use leastaction_learning::torque::fit::{Learned, fit_by_folds, mean_nmse, squared_errors, variances};
use leastaction_models::tree::Tree;
use leastaction_models::urdf::{Inertias, parse};

/// A rich motion, and the exact torques of the tree.
fn samples(tree: &Tree, count: usize) -> Samples {
    let n = tree.coordinates();
    let t: Vec<f64> = (0..count).map(|k| 0.02 * k as f64).collect();
    let rows = |order: usize| {
        let of = |(t, i): (&f64, usize)| -> f64 {
            let waves = [(1.1 + 0.3 * i as f64, 0.5), (2.3 - 0.2 * i as f64, 0.3)];
            waves
                .into_iter()
                .map(|(w, size)| {
                    size * w.powi(order as i32)
                        * (w * t + i as f64 + order as f64 * std::f64::consts::FRAC_PI_2).sin()
                })
                .sum()
        };
        Rows::from_flat(n, t.iter().flat_map(|t| (0..n).map(move |i| (t, i))).map(of).collect()).unwrap()
    };
    let (q, v, a) = (rows(0), rows(1), rows(2));
    let states = q.iter().zip(v.iter().zip(a.iter()));
    let tau = states.flat_map(|(q, (v, a))| tree.inverse_dynamics(q, v, a)).collect();
    Samples { tau: Rows::from_flat(n, tau).unwrap(), q, v, a, t }
}

/// Two links on crossed axes: no torque depends on the second link's first moment along its axis alone.
const ROBOT: &str = r#"<robot name="two"><link name="base"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="l1"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/></joint>
<link name="l1"><inertial><origin xyz="0.1 0 0"/><mass value="1.0"/>
<inertia ixx="0.002" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="j2" type="revolute"><parent link="l1"/><child link="l2"/><origin xyz="0.2 0 0" rpy="1.57079632679 0 0"/><axis xyz="0 0 1"/></joint>
<link name="l2"><inertial><origin xyz="0.1 0 0"/><mass value="0.5"/>
<inertia ixx="0.001" ixy="0" ixz="0" iyy="0.005" iyz="0" izz="0.005"/></inertial></link></robot>"#;

/// Against torques known exactly a prior counts for nothing, and combinations that they do not show went astray by
/// kilograms.
#[test]
fn what_exact_torques_do_not_show_stays_where_it_began() {
    let guess = parse(ROBOT, Inertias::Required).unwrap();
    let mut truth = guess.clone();
    truth.rotors = vec![0.011, 0.004];
    let samples = samples(&truth, 400);
    let folds: Vec<usize> = samples.t.iter().map(|t| (t / 0.75) as usize % 5).collect();
    let learned = Learned { rotors: true, ..Learned::default() };
    let strengths = [1000.0, 300.0, 100.0, 30.0, 10.0, 3.0, 1.0, 0.1, 0.01];
    let (fitted, _) = fit_by_folds(&guess, &samples, &learned, (&strengths, &folds)).unwrap();
    let errors = squared_errors(&fitted.arm.torques(&samples), &samples);
    let nmse = mean_nmse(&errors, &variances(&samples));
    assert!(nmse < 1e-6, "{nmse}");
    for (found, began) in fitted.arm.tree.bodies().iter().zip(guess.bodies()) {
        for (found, began) in found.inertia.0.iter().zip(began.inertia.0) {
            assert!((found - began).abs() < 0.02, "{found} from {began}");
        }
    }
}
