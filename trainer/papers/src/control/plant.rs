//! The double pendulum of the competition, in double precision.

use std::array::from_fn;
use std::f64::consts::PI;

/// State (q₁, q₂, v₁, v₂), rad and rad/s: q = 0 hangs, q₂ is relative to link 1.
pub type State = [f64; 4];

/// Upright at rest: the goal.
pub const UPRIGHT: State = [PI, 0.0, 0.0, 0.0];

/// Numbers of two links with geared rotors and friction.
///
/// M₁₁ = I₁ + I₂ + m₂l₁² + 2m₂l₁r₂ cos q₂ + g_r²I_r + I_r, M₁₂ = I₂ + m₂l₁r₂ cos q₂ − g_r I_r, M₂₂ = I₂ + g_r²I_r; friction
/// b v + c arctan(100 v) against the motion of each joint, v in rad/s.
///
/// Source: Wiebe et al., "Open Source Dual-Purpose Acrobot and Pendubot Platform", IEEE Robotics & Automation Magazine 2023.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoublePendulum {
    /// Masses m, kg.
    pub mass: [f64; 2],
    /// Lengths l of the links, m.
    pub length: [f64; 2],
    /// Distances r of the centres of mass from the joints, m.
    pub centre: [f64; 2],
    /// Inertias I of the links about their joints, kg m².
    pub inertia: [f64; 2],
    /// Inertia I_r of each rotor, kg m².
    pub rotor: f64,
    /// Gear ratio g_r.
    pub gear: f64,
    /// Viscous friction b, N m s/rad.
    pub damping: [f64; 2],
    /// Dry friction c, N m.
    pub coulomb: [f64; 2],
    /// Acceleration g of gravity, m/s².
    pub gravity: f64,
}

/// Steepness of the change of sign of dry friction, s/rad.
const STEEPNESS: f64 = 100.0;

impl DoublePendulum {
    /// The pendulum of the competition: the identified numbers of DFKI's design C.1, model 1.0 (`model_parameters.yml` in
    /// `data/system_identification/identified_parameters/design_C.1/model_1.0` of its repository `double_pendulum`), with rotors and friction
    /// set to 0.
    pub const fn competition() -> Self {
        Self {
            mass: [0.5234602302310271, 0.6255677234174437],
            length: [0.2, 0.3],
            centre: [0.2, 0.25569305436052964],
            inertia: [0.031887199591513114, 0.05086984812807257],
            rotor: 0.0,
            gear: 6.0,
            damping: [0.0; 2],
            coulomb: [0.0; 2],
            gravity: 9.81,
        }
    }

    /// m₂l₁r₂, kg m².
    const fn coupling(&self) -> f64 {
        self.mass[1] * self.length[0] * self.centre[1]
    }

    /// Mass matrix M(q₂) for a cosine of q₂: M₁₁, M₁₂, M₂₂, kg m².
    pub const fn mass_matrix(&self, cosine: f64) -> [f64; 3] {
        let ([i1, i2], rotor, coupling) = (self.inertia, self.gear * self.gear * self.rotor, self.coupling());
        let m11 = i1 + i2 + self.mass[1] * self.length[0] * self.length[0] + rotor + self.rotor;
        [m11 + 2.0 * coupling * cosine, i2 - self.gear * self.rotor + coupling * cosine, i2 + rotor]
    }

    /// Coefficients of sin q₁ and sin(q₁ + q₂) in the torques of gravity, N m.
    const fn weights(&self) -> [f64; 2] {
        let ([m1, m2], [r1, r2]) = (self.mass, self.centre);
        [self.gravity * (m1 * r1 + m2 * self.length[0]), self.gravity * m2 * r2]
    }

    /// Torques ∂V/∂q that hold the pendulum against gravity, N m.
    pub fn holding_torque(&self, [q1, q2]: [f64; 2]) -> [f64; 2] {
        let [first, second] = self.weights();
        let both = second * (q1 + q2).sin();
        [first * q1.sin() + both, both]
    }

    /// Friction b v + c arctan(100 v), N m, against the motion.
    fn friction(&self, v: [f64; 2]) -> [f64; 2] {
        from_fn(|i| self.damping[i] * v[i] + self.coulomb[i] * (STEEPNESS * v[i]).atan())
    }

    /// Solves M(q₂) a = f.
    fn solve(&self, cosine: f64, [f1, f2]: [f64; 2]) -> [f64; 2] {
        let [m11, m12, m22] = self.mass_matrix(cosine);
        let determinant = m11 * m22 - m12 * m12;
        [(m22 * f1 - m12 * f2) / determinant, (m11 * f2 - m12 * f1) / determinant]
    }

    /// Accelerations under the torques of both joints, rad/s².
    pub fn acceleration(&self, [q1, q2, v1, v2]: State, tau: [f64; 2]) -> [f64; 2] {
        let (sine, cosine) = q2.sin_cos();
        let centrifugal = self.coupling() * sine;
        let coriolis = [-centrifugal * v2 * (2.0 * v1 + v2), centrifugal * v1 * v1];
        let (held, friction) = (self.holding_torque([q1, q2]), self.friction([v1, v2]));
        self.solve(cosine, from_fn(|i| tau[i] - coriolis[i] - held[i] - friction[i]))
    }

    /// Change of the accelerations a at a state for a change of state and torques, to first order:
    /// M δa = δτ − δM a − δ(Coriolis, gravity, friction).
    fn acceleration_change(&self, x: State, a: [f64; 2], dx: State, dtau: [f64; 2]) -> [f64; 2] {
        let ([q1, q2, v1, v2], [dq1, dq2, dv1, dv2]) = (x, dx);
        let (sine, cosine) = q2.sin_cos();
        let (s, c) = (self.coupling() * sine, self.coupling() * cosine * dq2);
        let dmass_a = [-s * dq2 * (2.0 * a[0] + a[1]), -s * dq2 * a[0]];
        let dcoriolis = [
            -c * v2 * (2.0 * v1 + v2) - 2.0 * s * (dv1 * v2 + v1 * dv2 + v2 * dv2),
            c * v1 * v1 + 2.0 * s * v1 * dv1,
        ];
        let [first, second] = self.weights();
        let dboth = second * (q1 + q2).cos() * (dq1 + dq2);
        let dheld = [first * q1.cos() * dq1 + dboth, dboth];
        let dfriction = |i: usize, v: f64, dv: f64| {
            let steep = STEEPNESS * v;
            (self.damping[i] + self.coulomb[i] * STEEPNESS / (1.0 + steep * steep)) * dv
        };
        let dfriction = [dfriction(0, v1, dv1), dfriction(1, v2, dv2)];
        self.solve(cosine, from_fn(|i| dtau[i] - dmass_a[i] - dcoriolis[i] - dheld[i] - dfriction[i]))
    }

    /// Energy T + V, J; V = 0 with both links level.
    pub fn energy(&self, [q1, q2, v1, v2]: State) -> f64 {
        let ([m11, m12, m22], [first, second]) = (self.mass_matrix(q2.cos()), self.weights());
        let kinetic = 0.5 * (m11 * v1 * v1 + m22 * v2 * v2) + m12 * v1 * v2;
        kinetic - first * q1.cos() - second * (q1 + q2).cos()
    }

    /// Height of the tip over the first joint, m.
    pub fn tip(&self, [q1, q2, ..]: State) -> f64 {
        let [l1, l2] = self.length;
        -l1 * q1.cos() - l2 * (q1 + q2).cos()
    }

    /// Rate of the state.
    fn rate(&self, x: State, tau: [f64; 2]) -> State {
        let [a1, a2] = self.acceleration(x, tau);
        [x[2], x[3], a1, a2]
    }

    /// State after a step of h s by the classical Runge–Kutta method of order 4 with torques that are held, N m.
    pub fn step(&self, x: State, tau: [f64; 2], h: f64) -> State {
        let k1 = self.rate(x, tau);
        let k2 = self.rate(shifted(x, 0.5 * h, k1), tau);
        let k3 = self.rate(shifted(x, 0.5 * h, k2), tau);
        let k4 = self.rate(shifted(x, h, k3), tau);
        shifted(x, h / 6.0, from_fn(|i| k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    }

    /// [`step`](Self::step), and the change of its end for each of some changes (of the state, of the torques) of its start, to first order.
    pub fn step_with_changes<const K: usize>(
        &self,
        x: State,
        tau: [f64; 2],
        h: f64,
        changes: [(State, [f64; 2]); K],
    ) -> (State, [State; K]) {
        let mut rates = [[0.0; 4]; 4];
        let mut slopes = [[[0.0; 4]; 4]; K];
        for stage in 0..4 {
            let (part, last) = (STAGES[stage] * h, stage.saturating_sub(1));
            let at = shifted(x, part, rates[last]);
            rates[stage] = self.rate(at, tau);
            let a = [rates[stage][2], rates[stage][3]];
            for ((dx, dtau), slopes) in changes.iter().zip(&mut slopes) {
                let d = shifted(*dx, part, slopes[last]);
                let [da1, da2] = self.acceleration_change(at, a, d, *dtau);
                slopes[stage] = [d[2], d[3], da1, da2];
            }
        }
        let ended = |x: State, [k1, k2, k3, k4]: [State; 4]| {
            shifted(x, h / 6.0, from_fn(|i| k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
        };
        (ended(x, rates), from_fn(|k| ended(changes[k].0, slopes[k])))
    }
}

/// Part of the step at which each stage lies.
const STAGES: [f64; 4] = [0.0, 0.5, 0.5, 1.0];

/// x + h k.
fn shifted(x: State, h: f64, k: State) -> State {
    from_fn(|i| x[i] + h * k[i])
}
