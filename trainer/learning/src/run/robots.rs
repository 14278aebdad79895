//! Logs of simulated robots for tests.

use crate::data::Dataset;
use leastaction_ground_truth::robot::{
    Drives, Excitation, Joint, JointFriction, Linkage, Machine, RobotSettings, Sensors, StartSpread,
    robot_logs,
};

/// The given number of logs of a pendulum with dry friction, 1.5 s each.
pub fn pendulums(logs: usize) -> Dataset {
    let joint = Joint { mass: 0.5, length: 0.2, centre: 0.2, inertia: 0.01, rotor: 0.0, gear: 1.0 };
    robot_logs(&RobotSettings {
        machine: Machine::Linkage(Linkage { gravity: 9.81, joints: vec![joint] }),
        friction: vec![JointFriction { viscous: 0.005, coulomb: 0.1, width: 0.2 }],
        sensors: Sensors { noise: 1e-3, ..Sensors::default() },
        drives: Drives { gain: vec![1.0], delay: 0.0, noise: 0.0, driven: vec![true] },
        excitation: Excitation { sines: 3, frequency: [0.3, 2.5], amplitude: [0.1, 0.5] },
        start: StartSpread::default(),
        logs,
        samples: 151,
        h: 0.01,
        seed: 4,
    })
    .unwrap()
    .measured()
}
