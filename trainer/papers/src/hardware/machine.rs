//! Known machines: the columns of their logs, and the motion that counts.

use leastaction_learning::data::{Column, Columns};
use serde::Serialize;

/// A machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Machine {
    /// Two links, a drive at each joint; q₁ from hanging, q₂ relative to link 1.
    DoublePendulum,
    /// One link and a drive; q from hanging.
    Pendulum,
    /// Franka Panda: seven joints, judged by torques.
    Panda,
    /// Pendulums of one to three arms that swing freely, judged by their own protocol.
    MultiArm,
    /// Universal Robots UR10e: six joints, judged by the currents of its drives.
    Ur10e,
    /// EMPS, one axis of an electro-mechanical positioning system, judged by its position along a whole log.
    Emps,
}

/// Value of cos q of a pendulum below which it is about to fall either way.
const UPRIGHT: f64 = -0.9;

impl Machine {
    /// Name on the command line, and of the folder of its logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::DoublePendulum => "double-pendulum",
            Self::Pendulum => "pendulum",
            Self::Panda => "panda",
            Self::MultiArm => "multi-arm",
            Self::Ur10e => "ur10e",
            Self::Emps => "emps",
        }
    }

    /// Largest number of joints n.
    pub const fn joints(self) -> usize {
        match self {
            Self::DoublePendulum => 2,
            Self::Pendulum | Self::Emps => 1,
            Self::Panda => 7,
            Self::MultiArm => 3,
            Self::Ur10e => 6,
        }
    }

    /// Whether its drives log the commanded torque in addition to the measured one.
    pub const fn logs_commands(self) -> bool {
        matches!(self, Self::DoublePendulum)
    }

    /// Columns of its logs: u is the measured torque of every joint, followed by the commanded torque if it is logged.
    pub fn columns(self) -> Columns {
        if self == Self::Panda {
            return Self::numbered_columns(self.joints());
        }
        if self == Self::Ur10e {
            return Self::counted_columns(self.joints());
        }
        if self == Self::Emps {
            let [t, q, u] = ["time", "position", "force"].map(Column::si);
            return Columns { t, q: vec![q], v: Vec::new(), u: vec![u], actuation: None };
        }
        let of = |names: &[&str]| names.iter().map(|name| Column::si(*name)).collect();
        let [q, v, u]: [&[&str]; 3] = match self {
            Self::DoublePendulum => [
                &["pos_meas1", "pos_meas2"],
                &["vel_meas1", "vel_meas2"],
                &["tau_meas1", "tau_meas2", "tau_con1", "tau_con2"],
            ],
            _ => [&["position"], &["velocity"], &["torque"]],
        };
        Columns { t: Column::si("time"), q: of(q), v: of(v), u: of(u), actuation: None }
    }

    /// Columns position_1, …, velocity_1, …, torque_1, ….
    fn numbered_columns(n: usize) -> Columns {
        let of = |name: &str| (1..=n).map(|k| Column::si(format!("{name}_{k}"))).collect();
        let (q, v, u) = (of("position"), of("velocity"), of("torque"));
        Columns { t: Column::si("time"), q, v, u, actuation: None }
    }

    /// Columns of a file without a header, by number: time, positions, velocities, currents.
    fn counted_columns(n: usize) -> Columns {
        let of = |part: usize| (0..n).map(|k| Column::si(format!("#{}", 2 + part * n + k))).collect();
        Columns { t: Column::si("#1"), q: of(0), v: of(1), u: of(2), actuation: None }
    }

    /// Whether a window through these positions, \[samples\]\[n\], counts. A pendulum near its upright position falls
    /// either way, whatever the model, so windows that pass it are left out. All windows of the double pendulum count.
    pub fn counts<'q>(self, mut positions: impl Iterator<Item = &'q [f64]>) -> bool {
        match self {
            Self::DoublePendulum | Self::Panda | Self::MultiArm | Self::Ur10e | Self::Emps => true,
            Self::Pendulum => positions.all(|q| q.iter().all(|q| q.cos() >= UPRIGHT)),
        }
    }
}
