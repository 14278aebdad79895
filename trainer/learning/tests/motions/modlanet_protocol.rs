//! Data by ModLaNet's protocol: its distribution, and the authors' own file where `LEASTACTION_REFERENCE` points to it.

use leastaction_ground_truth::{
    ExactMotion, GenerationError, ManyBody, ModlanetSettings, circular_speed, generate_many, modlanet_set_of,
    starts,
};
use leastaction_learning::data::modlanet::{self, ModlanetRows};
use std::f64::consts::TAU;
use std::path::PathBuf;

fn reference(name: &str) -> PathBuf {
    let folder =
        std::env::var_os("LEASTACTION_REFERENCE").expect("LEASTACTION_REFERENCE names the reference data");
    PathBuf::from(folder).join("modlanet").join(name)
}

fn small(system: ManyBody) -> ModlanetSettings {
    ModlanetSettings { trajectories: 12, samples: 7, ..ModlanetSettings::published(system, 3) }
}

#[test]
fn on_the_circle_the_circular_speed_stays_there() {
    for count in [2, 3, 5] {
        let (r, v) = (1.7, circular_speed(count, 1.7));
        let at = |i: usize| (TAU * i as f64 / count as f64).sin_cos();
        let q: Vec<f64> = (0..count).flat_map(|i| [r * at(i).1, r * at(i).0]).collect();
        let motion = ManyBody::Bodies(count).motion().unwrap();
        let mut a = vec![0.0; 2 * count];
        motion.acceleration(&q, &vec![0.0; 2 * count], &mut a).unwrap();
        // Centripetal: a = −(v²/r²) q.
        assert!(a.iter().zip(&q).all(|(a, q)| (a + v * v / (r * r) * q).abs() < 1e-12), "{count}: {a:?}");
    }
}

#[test]
fn pendulums_start_anywhere_up_to_their_speed() {
    let settings =
        ModlanetSettings { trajectories: 2000, ..ModlanetSettings::published(ManyBody::Pendulum(2), 1) };
    let starts = starts(&settings);
    let q: Vec<f64> = starts.iter().flat_map(|start| start.q.clone()).collect();
    let v: Vec<f64> = starts.iter().flat_map(|start| start.v.clone()).collect();
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    assert!(q.iter().all(|q| (0.0..TAU).contains(q)) && v.iter().all(|v| v.abs() <= 10.0));
    assert!((mean(&q) - TAU / 2.0).abs() < 0.15 && mean(&v).abs() < 0.5);
    let squares: Vec<f64> = v.iter().map(|v| v * v).collect();
    assert!((mean(&squares) - 100.0 / 3.0).abs() < 2.0);
}

/// Radius, spread of the radii, largest gap between neighbours' angles from 2π/n, and speed components along and across the
/// circular velocity in units of √2 times it.
fn shape_of(q: &[f64], v: &[f64]) -> (f64, f64, f64, Vec<[f64; 2]>) {
    let n = q.len() / 2;
    let radius = |i: usize| q[2 * i].hypot(q[2 * i + 1]);
    let r = radius(0);
    let spread = (0..n).map(|i| (radius(i) - r).abs()).fold(0.0, f64::max);
    let angle = |i: usize| q[2 * (i % n) + 1].atan2(q[2 * (i % n)]);
    let gap = |i: usize| ((angle(i + 1) - angle(i)).rem_euclid(TAU) - TAU / n as f64).abs();
    let unit = std::f64::consts::SQRT_2 * circular_speed(n, r);
    let parts = (0..n).map(|i| {
        let ([x, y], [vx, vy]) = ([q[2 * i] / r, q[2 * i + 1] / r], [v[2 * i] / unit, v[2 * i + 1] / unit]);
        [vx * x + vy * y, vy * x - vx * y]
    });
    (r, spread, (0..n).map(gap).fold(0.0, f64::max), parts.collect())
}

/// Mean square of the radial parts, mean of the tangential ones, and their mean square, over all bodies and starts.
fn check_bodies(starts: impl Iterator<Item = (Vec<f64>, Vec<f64>)>, tolerance: f64) {
    let (mut radii, mut parts) = (Vec::new(), Vec::new());
    for (q, v) in starts {
        let (r, spread, gap, own) = shape_of(&q, &v);
        assert!((1.0..5.0).contains(&r) && spread < 1e-12 && gap < 1e-12);
        assert!(own.iter().all(|[radial, along]| radial.abs() <= 0.5 && (0.5..=1.5).contains(along)));
        radii.push(r);
        parts.extend(own);
    }
    let mean = |x: &mut dyn Iterator<Item = f64>| {
        let x: Vec<f64> = x.collect();
        x.iter().sum::<f64>() / x.len() as f64
    };
    assert!((mean(&mut radii.iter().copied()) - 3.0).abs() < 2.0 * tolerance);
    assert!((mean(&mut parts.iter().map(|p| p[1])) - 1.0).abs() < tolerance);
    // With factors 1 + a, 1 + b on the components (c, s) of the circular velocity: 1 + c²a + s²b along it, cs(a − b) across, and
    // a², b² are 1/12 on average, so (c⁴ + s⁴ + 2c²s²)/12 = 1/12 together whatever the direction.
    let (along, radial) =
        (mean(&mut parts.iter().map(|p| (p[1] - 1.0).powi(2))), mean(&mut parts.iter().map(|p| p[0] * p[0])));
    assert!((along + radial - 1.0 / 12.0).abs() < 0.2 * tolerance, "{along} {radial}");
}

#[test]
fn bodies_start_on_a_circle_near_the_authors_speed() {
    for count in [3, 6] {
        let settings = ModlanetSettings {
            trajectories: 2000,
            ..ModlanetSettings::published(ManyBody::Bodies(count), 1)
        };
        check_bodies(starts(&settings).into_iter().map(|start| (start.q, start.v)), 0.05);
    }
}

#[test]
#[ignore = "needs the reference data"]
fn the_authors_bodies_start_alike() {
    let set = modlanet::read(reference("3_body_modlanet.npz")).unwrap();
    let part = &set.train;
    assert_eq!((part.q.len(), part.q.width(), set.test.q.len()), (18_180, 6, 2_020));
    let starts = part.starts();
    assert_eq!(starts.len(), 180);
    check_bodies(starts.into_iter().map(|k| (part.q[k].to_vec(), part.v[k].to_vec())), 0.15);
}

/// Largest error of the accelerations and the energies of the rows, relative to 1 + their size.
fn disagreement(motion: &dyn ExactMotion, rows: &ModlanetRows) -> (f64, f64) {
    let mut a = vec![0.0; motion.coordinates()];
    let (mut of_a, mut of_energy) = (0.0_f64, 0.0_f64);
    for k in 0..rows.q.len() {
        motion.acceleration(&rows.q[k], &rows.v[k], &mut a).unwrap();
        let errors = a.iter().zip(&rows.a[k]).map(|(a, b)| (a - b).abs() / (1.0 + b.abs()));
        of_a = errors.fold(of_a, f64::max);
        let energy = rows.energy.as_ref().unwrap()[k];
        of_energy =
            of_energy.max((motion.energy(&rows.q[k], &rows.v[k]) - energy).abs() / (1.0 + energy.abs()));
    }
    (of_a, of_energy)
}

#[test]
#[ignore = "needs the reference data"]
fn the_authors_rows_obey_these_equations() {
    for (file, system, n, squares) in [
        ("2_pend_modlanet.npz", ManyBody::Pendulum(2), 2, [2364.0, 1588.0]),
        ("3_body_modlanet.npz", ManyBody::Bodies(3), 6, [0.0185, 0.0101]),
    ] {
        let set = modlanet::read(reference(file)).unwrap();
        let motion = system.motion().unwrap();
        assert_eq!((set.train.q.width(), motion.coordinates()), (n, n));
        for (rows, square) in [&set.train, &set.test].into_iter().zip(squares) {
            let (of_a, of_energy) = disagreement(motion.as_ref(), rows);
            assert!(of_a < 1e-11 && of_energy < 1e-12, "{file}: {of_a:e} {of_energy:e}");
            assert!((rows.mean_squared_acceleration() / square - 1.0).abs() < 0.01, "{file}");
        }
    }
}

#[test]
fn a_set_is_whole_trajectories_of_exact_rows() {
    for system in [ManyBody::Pendulum(3), ManyBody::Bodies(4)] {
        let set = modlanet_set_of(&small(system)).unwrap();
        let motion = system.motion().unwrap();
        assert_eq!((set.train.q.len(), set.test.q.len(), set.test.q.width()), (77, 7, motion.coordinates()));
        for part in [&set.train, &set.test] {
            assert_eq!(disagreement(motion.as_ref(), part), (0.0, 0.0));
            assert!(part.starts().iter().enumerate().all(|(k, row)| *row == 7 * k));
            let energies = part.energy.as_ref().unwrap();
            let drift = |pair: &[f64]| (pair[1] - pair[0]).abs() / (1.0 + pair[0].abs());
            assert!(energies.chunks(7).flat_map(|e| e.windows(2)).all(|pair| drift(pair) < 1e-9));
        }
    }
}

#[test]
fn a_seed_is_a_set_and_noise_is_as_wide_as_asked() {
    let settings = ModlanetSettings { trajectories: 30, ..small(ManyBody::Pendulum(2)) };
    let exact = generate_many(&settings).unwrap();
    assert_eq!(exact, generate_many(&settings).unwrap());
    assert_ne!(exact, generate_many(&ModlanetSettings { seed: 4, ..settings.clone() }).unwrap());
    let noisy = generate_many(&ModlanetSettings { noise: 0.01, ..settings }).unwrap();
    let pairs = noisy.trajectories.iter().zip(&exact.trajectories);
    let differences: Vec<f64> = pairs
        .flat_map(|(a, b)| a.q.as_flat().iter().zip(b.q.as_flat()))
        .map(|(a, b)| (a - b) * (a - b))
        .collect();
    let variance = differences.iter().sum::<f64>() / differences.len() as f64;
    assert!((variance / 1e-4 - 1.0).abs() < 0.25, "{variance}");
}

#[test]
fn impossible_sets_are_errors() {
    let none = modlanet_set_of(&small(ManyBody::Pendulum(0))).unwrap_err();
    assert!(none.to_string().contains("no element"), "{none}");
    let one = ModlanetSettings { trajectories: 1, ..small(ManyBody::Bodies(3)) };
    assert_eq!(modlanet_set_of(&one), Err(GenerationError::TooFew(1)));
}
