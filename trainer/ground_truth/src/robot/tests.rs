use super::*;
use crate::Mechanism;
use leastaction_core::continuous::{ContinuousState, rk4_step};
use leastaction_core::energy::trigonometric::ACROBOT;
use leastaction_core::forces::{Coulomb, DryFriction, System, Viscous};

const FRICTION: [JointFriction; 2] = [
    JointFriction { viscous: 0.05, coulomb: 0.3, width: 0.2 },
    JointFriction { viscous: 0.02, coulomb: 0.1, width: 0.3 },
];

fn settings() -> RobotSettings {
    RobotSettings {
        machine: Machine::Named(Mechanism::Acrobot),
        friction: FRICTION.to_vec(),
        sensors: Sensors::default(),
        drives: Drives { gain: vec![1.0; 2], delay: 0.0, noise: 0.0, driven: vec![true; 2] },
        excitation: Excitation { sines: 3, frequency: [0.3, 2.5], amplitude: [0.5, 2.0] },
        start: StartSpread { q: 0.5, v: 0.2 },
        logs: 2,
        samples: 60,
        h: 0.01,
        seed: 3,
    }
}

#[test]
fn the_truth_is_the_motion_under_the_held_commands() {
    let logs = robot_logs(&settings()).unwrap();
    let dry = |i: usize| DryFriction {
        constant: FRICTION[i].coulomb,
        width: FRICTION[i].width,
        ..DryFriction::none()
    };
    let coordinates = [dry(0), dry(1)];
    let viscous = Viscous { coefficients: FRICTION.map(|friction| friction.viscous) };
    let system = System { lagrangian: ACROBOT, forces: (viscous, Coulomb { coordinates }) };
    for log in &logs.logs {
        let row = |rows: &Rows, k: usize| <[f64; 2]>::try_from(rows.get(k).unwrap()).unwrap();
        let mut state = ContinuousState { q: row(&log.q, 0), v: row(&log.v, 0) };
        for k in 1..log.times.len() {
            let u = row(&log.commands, k - 1);
            for _ in 0..400 {
                state = rk4_step(&system, &state, &u, 0.01 / 400.0).unwrap();
            }
            let error = [0, 1].map(|i| (state.q[i] - row(&log.q, k)[i]).abs());
            assert!(error.iter().all(|e| *e < 1e-10), "{k}: {error:?}");
        }
    }
}

#[test]
fn each_kind_of_chance_has_a_stream_of_its_own() {
    let plain = robot_logs(&settings()).unwrap();
    let sensors = Sensors { noise: 0.01, grid: 1e-3, zeros: 0.02, jitter: 0.0 };
    let noisy = robot_logs(&RobotSettings { sensors, logs: 3, ..settings() }).unwrap();
    for (plain, noisy) in plain.logs.iter().zip(&noisy.logs) {
        assert_eq!((&plain.q, &plain.commands), (&noisy.q, &noisy.commands));
        assert_ne!(plain.readings, noisy.readings);
    }
    assert_ne!(plain.logs[0].q, plain.logs[1].q);
    assert_ne!(plain, robot_logs(&RobotSettings { seed: 4, ..settings() }).unwrap());
    assert_eq!(plain, robot_logs(&settings()).unwrap());
}

#[test]
fn readings_lie_on_the_grid_about_the_zero() {
    let sensors = Sensors { noise: 0.01, grid: 1e-3, zeros: 0.5, jitter: 0.0 };
    let logs = robot_logs(&RobotSettings { sensors, samples: 2000, logs: 1, ..settings() }).unwrap();
    let log = &logs.logs[0];
    assert!(log.readings.as_flat().iter().all(|x| ((x / 1e-3) - (x / 1e-3).round()).abs() < 1e-6));
    for (i, zero) in log.zeros.iter().enumerate() {
        let off: Vec<f64> = log.readings.column(i).zip(log.q.column(i)).map(|(y, q)| y - q - zero).collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        let deviation = (off.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / off.len() as f64).sqrt();
        assert!(mean.abs() < 1e-3 && (deviation / 0.01 - 1.0).abs() < 0.1, "{mean} {deviation}");
    }
}

#[test]
fn torques_are_late_and_weak_as_asked_for() {
    let drives = Drives { gain: vec![0.8, -1.5], delay: 0.03, noise: 0.0, driven: vec![true, false] };
    let logs = robot_logs(&RobotSettings { drives, ..settings() }).unwrap();
    for log in &logs.logs {
        assert!(log.commands.column(1).all(|u| u == 0.0) && log.commands.column(0).all(|u| u != 0.0));
        // A delay that is longer than three steps only by rounding would take effect one sample later.
        let torques: Vec<f64> = log.torques.column(0).collect();
        let commands: Vec<f64> = log.commands.column(0).collect();
        assert_eq!(torques[..3], [0.0; 3]);
        for k in 4..torques.len() {
            let due = [0.8 * commands[k - 3], 0.8 * commands[k - 4]];
            assert!(due.contains(&torques[k]), "{k}");
        }
    }
}

#[test]
fn torques_are_as_noisy_as_asked_for() {
    let drives = Drives { gain: vec![0.8, -1.5], delay: 0.0, noise: 0.3, driven: vec![true, false] };
    let logs = robot_logs(&RobotSettings { drives, samples: 2000, logs: 1, ..settings() }).unwrap();
    let log = &logs.logs[0];
    assert!(log.torques.column(1).all(|torque| torque == 0.0));
    let off: Vec<f64> = log.torques.column(0).zip(log.commands.column(0)).map(|(g, u)| g - 0.8 * u).collect();
    let mean = off.iter().sum::<f64>() / off.len() as f64;
    let deviation = (off.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / off.len() as f64).sqrt();
    assert!(mean.abs() < 0.03 && (deviation / 0.3 - 1.0).abs() < 0.1, "{mean} {deviation}");
    // Each is drawn for itself.
    let squares: f64 = off.iter().map(|x| x * x).sum();
    let next: f64 = off.windows(2).map(|pair| pair[0] * pair[1]).sum();
    assert!((next / squares).abs() < 0.1, "{next}");
}

#[test]
fn half_a_step_of_delay_is_half_a_step_of_the_torque() {
    let excitation = Excitation { sines: 1, frequency: [0.0, 0.0], amplitude: [1.0, 1.0] };
    let quiet = RobotSettings {
        machine: Machine::Named(Mechanism::Cartpole),
        drives: Drives { gain: vec![1.0; 2], delay: 0.005, noise: 0.0, driven: vec![true, false] },
        friction: vec![JointFriction { viscous: 0.0, coulomb: 0.0, width: 1.0 }; 2],
        start: StartSpread::default(),
        excitation,
        samples: 3,
        ..settings()
    };
    let log = robot_logs(&quiet).unwrap().logs.remove(0);
    let [first, second] = [0, 1].map(|k| log.commands.get(k).unwrap()[0]);
    // The robot starts at rest, hanging: the mass that the force accelerates is 1.1 kg − 0.05²/(0.1/3) kg.
    let speed = |k: usize| log.v.get(k).unwrap()[0] * (1.1 - 0.075);
    assert!((speed(1) - 0.005 * first).abs() < 1e-6, "{} {first}", speed(1));
    assert!((speed(2) - 0.01 * first - 0.005 * second).abs() < 1e-5, "{}", speed(2));
}

#[test]
fn stamps_jitter_within_their_bound() {
    let sensors = Sensors { jitter: 0.002, ..Sensors::default() };
    let logs = robot_logs(&RobotSettings { sensors, ..settings() }).unwrap();
    let late: Vec<f64> = logs.logs[0].times.iter().enumerate().map(|(k, t)| t - 0.01 * k as f64).collect();
    assert!(late[0] == 0.0 && late.iter().all(|late| late.abs() <= 0.002));
    assert!(late.iter().any(|late| *late > 0.001) && late.iter().any(|late| *late < -0.001));
}

#[test]
fn stiff_friction_is_followed_too() {
    let stiff = JointFriction { viscous: 0.0, coulomb: 0.5, width: 1e-4 };
    let logs = robot_logs(&RobotSettings { friction: vec![stiff; 2], ..settings() }).unwrap();
    let fastest = logs.logs.iter().flat_map(|log| log.v.as_flat()).fold(0.0_f64, |most, v| most.max(v.abs()));
    assert!(fastest < 5.0, "{fastest}");
}

#[test]
fn settings_out_of_range_are_named() {
    let bad = [
        RobotSettings { h: 0.0, ..settings() },
        RobotSettings { friction: FRICTION[..1].to_vec(), ..settings() },
        RobotSettings { sensors: Sensors { jitter: 0.005, ..Sensors::default() }, ..settings() },
        RobotSettings { sensors: Sensors { noise: f64::NAN, ..Sensors::default() }, ..settings() },
        RobotSettings {
            excitation: Excitation { frequency: [2.0, 1.0], ..settings().excitation },
            ..settings()
        },
    ];
    for bad in bad {
        let error = robot_logs(&bad).unwrap_err();
        assert!(matches!(error, RobotError::Setting { .. } | RobotError::Count { .. }), "{error}");
    }
    let machine = Machine::Linkage(Linkage::points(5));
    let five = RobotSettings {
        friction: vec![FRICTION[0]; 5],
        drives: Drives { gain: vec![1.0; 5], delay: 0.0, noise: 0.0, driven: vec![true; 5] },
        machine,
        ..settings()
    };
    assert_eq!(robot_logs(&five), Err(RobotError::Joints { joints: 5 }));
}

#[test]
fn a_written_log_is_read_back_by_its_columns() {
    use leastaction_data::{Column, Columns, Reading, read_as};
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("00.csv");
    let logs = robot_logs(&RobotSettings { logs: 1, ..settings() }).unwrap();
    write_csv(&file, &logs.logs[0]).unwrap();
    let two = |name: &str| [1, 2].map(|i| Column::si(format!("{name}{i}"))).to_vec();
    let columns = Columns {
        t: Column::si("time"),
        q: two("pos_meas"),
        v: Vec::new(),
        u: two("tau_con"),
        actuation: None,
    };
    let (data, notes) = read_as(&file, &Reading { columns: Some(columns), ..Reading::default() }).unwrap();
    assert!(notes.is_empty(), "{notes:?}");
    let measured = logs.measured();
    assert_eq!((data.h, data.trajectories.len()), (0.01, 1));
    let (read, written) = (&data.trajectories[0], &measured.trajectories[0]);
    assert_eq!((&read.q, &read.u), (&written.q, &written.u));
}
