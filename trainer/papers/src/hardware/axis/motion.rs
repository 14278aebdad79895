//! Motion of a driven axis with Coulomb friction that sticks, exact between and at the events.

use serde::Serialize;

/// Numbers of an axis: m q̈ = u + o − k₁ q − k₂ q² − k₃ q³ − b± q̇ − c± sign q̇.
///
/// At rest it stays while the other forces are within \[−c₋, c₊\]. Index 0 of friction is for q̇ > 0, index 1 for q̇ < 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Axis {
    /// Mass m > 0, kg.
    pub mass: f64,
    /// Viscous friction b > 0 in each direction, N s/m.
    pub viscous: [f64; 2],
    /// Coulomb friction c in each direction, N.
    pub coulomb: [f64; 2],
    /// Force o that acts in addition to the logged one, N.
    pub offset: f64,
    /// Stiffnesses k₁ (N/m), k₂ (N/m²) and k₃ (N/m³).
    pub stiffness: [f64; 3],
}

/// Position (m) and velocity (m/s).
pub type State = [f64; 2];

impl Axis {
    /// Whether the numbers give a motion: a positive mass, viscous friction in both directions, and forces that hold the axis within an
    /// interval.
    pub fn is_physical(&self) -> bool {
        let [up, down] = self.coulomb;
        self.mass > 0.0 && self.viscous.iter().all(|b| *b > 0.0) && up + down >= 0.0
    }

    /// Positions (m) at the samples of a log from a state on; `forces` (N) are held for h (s) each.
    pub fn roll_out(&self, mut state: State, forces: &[f64], h: f64) -> Vec<f64> {
        let mut positions = vec![state[0]];
        for u in forces {
            state = self.step(state, *u, h);
            positions.push(state[0]);
        }
        positions
    }

    /// Advances by h seconds. Without stiffness the solution is exact; forces of a position are those in the middle of the step.
    fn step(&self, mut state: State, u: f64, h: f64) -> State {
        let force = u + self.offset - self.restoring(state[0] + 0.5 * h * state[1]);
        let mut left = h;
        // Under a constant force the velocity changes its sign at most once.
        while left > 0.0 {
            let Some(direction) = self.direction(state[1], force) else { break };
            let slides = self.slides(direction, force);
            let time = slides.until_rest(state[1]).min(left);
            let is_event = time < left;
            state = slides.after(state, time);
            if is_event {
                state[1] = 0.0;
            }
            left -= time;
        }
        state
    }

    fn restoring(&self, q: f64) -> f64 {
        let [k1, k2, k3] = self.stiffness;
        q * (k1 + q * (k2 + q * k3))
    }

    /// Index of the direction of motion; `None` if the axis sticks.
    fn direction(&self, v: f64, force: f64) -> Option<usize> {
        let [up, down] = self.coulomb;
        match v {
            v if v > 0.0 || v == 0.0 && force > up => Some(0),
            v if v < 0.0 || v == 0.0 && force < -down => Some(1),
            _ => None,
        }
    }

    fn slides(&self, direction: usize, force: f64) -> Slide {
        let sign = if direction == 0 { 1.0 } else { -1.0 };
        let viscous = self.viscous[direction];
        Slide { limit: (force - sign * self.coulomb[direction]) / viscous, time: self.mass / viscous }
    }
}

/// Motion in one direction under a constant force: v tends to `limit` (m/s) with the time constant `time` (s).
struct Slide {
    limit: f64,
    time: f64,
}

impl Slide {
    /// Time until the velocity is 0; infinite if it never is.
    fn until_rest(&self, v: f64) -> f64 {
        if v * self.limit < 0.0 { self.time * (-v / self.limit).ln_1p() } else { f64::INFINITY }
    }

    fn after(&self, [q, v]: State, seconds: f64) -> State {
        // 1 − exp(−t/T).
        let gone = -(-seconds / self.time).exp_m1();
        [q + self.limit * seconds + (v - self.limit) * self.time * gone, v + (self.limit - v) * gone]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXIS: Axis =
        Axis { mass: 2.0, viscous: [3.0, 1.0], coulomb: [4.0, 2.0], offset: 0.5, stiffness: [0.0; 3] };

    /// The balance m Δv = ∫ force − Σ friction with friction b Δq + c Δt, from the state before to that after.
    fn assert_balance([q0, v0]: State, [q1, v1]: State, [b, c, force]: [f64; 3], seconds: f64) {
        let impulse = (force - c) * seconds - b * (q1 - q0);
        assert!((AXIS.mass * (v1 - v0) - impulse).abs() < 1e-12, "{v1} {impulse}");
    }

    #[test]
    fn momentum_balances_in_both_directions() {
        let up = AXIS.step([0.1, 1.0], 2.0, 0.01);
        assert_balance([0.1, 1.0], up, [3.0, 4.0, 2.5], 0.01);
        let down = AXIS.step([0.1, -1.0], 2.0, 0.01);
        assert_balance([0.1, -1.0], down, [1.0, -2.0, 2.5], 0.01);
    }

    #[test]
    fn it_stops_where_its_momentum_ends_and_stays_while_friction_holds() {
        // Without viscous friction it would stop after m v/(c − force) = .02/1.5 s.
        let [q, v] = AXIS.step([0.0, 0.01], 2.0, 1.0);
        assert_eq!(v, 0.0);
        assert!(q > 0.0 && q < 0.5 * 0.01 * 0.02 / 1.5);
        for (u, moves) in [(3.4, false), (3.6, true), (-2.4, false), (-2.6, true)] {
            assert_eq!(AXIS.step([q, 0.0], u, 0.1) != [q, 0.0], moves, "{u}");
        }
    }

    #[test]
    fn a_force_that_is_strong_enough_turns_it_around_within_a_step() {
        let forces = [-9.0; 4];
        let [whole, parts] =
            [(1, 0.4), (4, 0.1)].map(|(steps, h)| AXIS.roll_out([0.0, 0.7], &forces[..steps], h));
        assert!((whole[1] - parts[4]).abs() < 1e-12);
        assert!(parts[4] < parts[1]);
    }

    #[test]
    fn a_spring_alone_makes_it_swing_with_its_period() {
        let spring = Axis {
            mass: 1.0,
            viscous: [1e-9; 2],
            stiffness: [(2.0 * std::f64::consts::PI).powi(2), 0.0, 0.0],
            ..Axis::default()
        };
        let q = spring.roll_out([0.1, 0.0], &[0.0; 1000], 1e-3);
        assert!((q[500] + 0.1).abs() < 1e-3 && (q[1000] - 0.1).abs() < 1e-3, "{} {}", q[500], q[1000]);
    }

    #[test]
    fn numbers_without_a_motion_are_told() {
        assert!(AXIS.is_physical());
        assert!(!Axis { mass: -1.0, ..AXIS }.is_physical());
        assert!(!Axis { viscous: [1.0, 0.0], ..AXIS }.is_physical());
        assert!(!Axis { coulomb: [1.0, -2.0], ..AXIS }.is_physical());
    }
}
