//! A simulated double pendulum that writes logs like those of the real one: jittered stamps, encoders of finite
//! resolution, friction, zero offsets, torques that change all the time.

use leastaction_papers::hardware::{Identified, Predictor};
use leastaction_programs::Row;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

/// Parameters in the form of the published ones.
pub const PARAMETERS: &str = "\
I1: 0.03
I2: 0.05
Ir: 6.3e-05
b1: 0.002
b2: 0.001
cf1: 0.16
cf2: 0.12
g: 9.81
gr: 6.0
l1: 0.2
m1: 0.5
m2: 0.6
r1: 0.2
r2: 0.25
tl1: 10.0
";

/// Step of the simulation, s.
const STEP: f64 = 5e-4;
/// Numbers of simulation steps from one sample to the next, in turn: 4 ms with jitter.
const INTERVALS: [usize; 5] = [8, 7, 8, 9, 8];
/// Resolution of an encoder, rad.
const GRID: f64 = 3.8e-4;

/// Writes `double-pendulum/model_parameters.yml` and `logs` logs, 00.csv, 01.csv, …, of `seconds` s; the zeros of the encoders of log k are
/// k times 0.01 and −0.02 rad.
pub fn write(folder: &Path, logs: usize, seconds: f64) {
    let folder = folder.join("double-pendulum");
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("model_parameters.yml");
    std::fs::write(&file, PARAMETERS).unwrap();
    let robot = Identified::read(&file).unwrap();
    for log in 0..logs {
        std::fs::write(folder.join(format!("{log:02}.csv")), text(&robot, log, seconds)).unwrap();
    }
}

fn text(robot: &Identified, log: usize, seconds: f64) -> String {
    let mut text =
        "time,pos_meas1,pos_meas2,vel_meas1,vel_meas2,tau_con1,tau_con2,tau_meas1,tau_meas2\n".to_owned();
    let (mut motion, mut state, mut due) = (robot.motion(), [[0.0; 2]; 2], 0);
    for k in 0..=(seconds / STEP) as usize {
        let t = k as f64 * STEP;
        let tau = torque(log, t);
        if k == due {
            due += INTERVALS[(k / 8 + log) % INTERVALS.len()];
            let [q, v] = state;
            let zeros = [0.01 * log as f64, -0.02 * log as f64];
            let [q1, q2] = [0, 1].map(|i| ((q[i] + zeros[i]) / GRID).round() * GRID);
            let [u1, u2] = tau;
            writeln!(text, "{t:.6},{q1:.9},{q2:.9},{:.6},{:.6},{u1:.6},{u2:.6},{u1:.6},{u2:.6}", v[0], v[1])
                .unwrap();
        }
        let mut rate = |[q, v]: [[f64; 2]; 2]| {
            let (rows, mut a) = ([q, v, tau].map(|x| x.map(Row::splat)), [Row::default(); 2]);
            motion(rows.each_ref().map(|rows| &rows[..]), &mut a);
            [v, a.map(|a| a.0[0])]
        };
        // This is the midpoint rule, for which 0.5 ms is short enough.
        let first = rate(state);
        state = moved(state, STEP, rate(moved(state, STEP / 2.0, first)));
    }
    text
}

fn moved(state: [[f64; 2]; 2], h: f64, rate: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|part| [0, 1].map(|i| state[part][i] + h * rate[part][i]))
}

/// Sums of sines of each joint, N m.
fn torque(log: usize, t: f64) -> [f64; 2] {
    let phase = log as f64;
    let sines =
        |of: [(f64, f64); 3]| of.iter().map(|(size, rate)| size * (TAU * rate * t + phase).sin()).sum();
    [sines([(0.4, 0.7), (0.24, 1.3), (0.16, 2.1)]), sines([(0.32, 0.9), (0.2, 1.7), (0.08, 2.9)])]
}
