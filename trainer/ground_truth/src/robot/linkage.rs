use crate::motion::BadMechanism;
use crate::{Chain, Link};
use leastaction_core::energy::trigonometric::{Trigonometric, Wave};
use serde::Deserialize;

/// Largest number of joints in a linkage.
pub const MOST_JOINTS: usize = 4;

/// A rigid link with the joint that it hangs from, and the geared rotor of the joint's drive.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Mass of the link, kg.
    pub mass: f64,
    /// Distance from the joint to the next joint, m.
    pub length: f64,
    /// Distance from the joint to the centre of mass, along the line to the next joint, m.
    pub centre: f64,
    /// Moment of inertia about the centre of mass, kg m².
    pub inertia: f64,
    /// Moment of inertia of the rotor about its axis, kg m².
    #[serde(default)]
    pub rotor: f64,
    /// Gear ratio: turns of the rotor per turn of the joint, as seen from the previous link; negative if the gear reverses.
    #[serde(default = "direct")]
    pub gear: f64,
}

/// Gear ratio without a gear.
fn direct() -> f64 {
    1.0
}

impl Joint {
    /// A point mass at the end of a massless rod, with a rotor without inertia.
    pub fn point(mass: f64, length: f64) -> Self {
        Self { mass, length, centre: length, inertia: 0.0, rotor: 0.0, gear: direct() }
    }

    fn link(&self) -> Link {
        let Self { mass, length, centre, inertia, .. } = *self;
        Link { mass, length, centre, inertia }
    }

    fn check_rotor(&self, element: usize) -> Result<(), BadMechanism> {
        let numbers =
            [("a rotor's inertia of", self.rotor, self.rotor >= 0.0), ("a gear of", self.gear, true)];
        for (quantity, value, sign) in numbers {
            if !(value.is_finite() && sign) {
                let range = "finite, an inertia not negative";
                return Err(BadMechanism::OutOfRange { element, quantity, value, range });
            }
        }
        Ok(())
    }
}

/// A planar chain of links on driven joints; q are joint angles, 0 if the chain hangs straight down.
///
/// With θ_j = q_0 + … + q_j and A, B as in [`Chain`], T = ½ Σ_jk A_jk cos(θ_j − θ_k) θ̇_j θ̇_k + ½ Σ_j J_j (θ̇_{j−1} + γ_j q̇_j)² and V =
/// −g Σ_j B_j cos θ_j: the rotor J_j of joint j is carried by link j − 1 and turns γ_j times as fast as the joint.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Linkage {
    /// Acceleration of gravity g, m/s².
    #[serde(default = "standard_gravity")]
    pub gravity: f64,
    /// Joints, starting with the one on the fixed base.
    #[serde(rename = "joint")]
    pub joints: Vec<Joint>,
}

fn standard_gravity() -> f64 {
    9.81
}

/// The terms of a mechanism's energies.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Terms<const N: usize> {
    pub inertia: Vec<(usize, usize, Wave<N>)>,
    pub potential: Vec<Wave<N>>,
}

impl<const N: usize> Terms<N> {
    pub(super) fn of(exact: &Trigonometric<'_, N>) -> Self {
        Self { inertia: exact.inertia.to_vec(), potential: exact.potential.to_vec() }
    }

    pub(super) fn lagrangian(&self) -> Trigonometric<'_, N> {
        Trigonometric { inertia: &self.inertia, potential: &self.potential }
    }

    /// Adds amplitude · cos(wave · q) to an entry on or below the diagonal.
    fn add(&mut self, row: usize, column: usize, amplitude: f64, wave: [f64; N]) {
        let same = |term: &&mut (usize, usize, Wave<N>)| (term.0, term.1, term.2.wave) == (row, column, wave);
        match self.inertia.iter_mut().find(same) {
            Some((_, _, wave)) => wave.amplitude += amplitude,
            None => self.inertia.push((row, column, Wave { amplitude, wave })),
        }
    }
}

/// Vector of 1 for coordinates from `from` up to, but not including, `to`, and 0 elsewhere.
fn between<const N: usize>(from: usize, to: usize) -> [f64; N] {
    std::array::from_fn(|i| if (from..to).contains(&i) { 1.0 } else { 0.0 })
}

impl Linkage {
    /// Equal point masses of 1 kg, 1 m apart.
    pub fn points(joints: usize) -> Self {
        Self { gravity: standard_gravity(), joints: vec![Joint::point(1.0, 1.0); joints] }
    }

    /// Parses TOML: `gravity`, and a `[[joint]]` for every link.
    ///
    /// # Errors
    /// A description of the problem, with its line.
    pub fn from_toml(text: &str) -> Result<Self, String> {
        toml::from_str(text).map_err(|error| error.to_string())
    }

    /// The terms of the energies, for N joints.
    ///
    /// # Errors
    /// [`BadMechanism`] for a number out of range.
    pub(super) fn terms<const N: usize>(&self) -> Result<Terms<N>, BadMechanism> {
        let chain = Chain::new(self.joints.iter().map(Joint::link).collect(), None)?;
        self.joints.iter().enumerate().try_for_each(|(j, joint)| joint.check_rotor(j))?;
        let mut terms = Terms { inertia: Vec::new(), potential: Vec::new() };
        for row in 0..N {
            for column in 0..=row {
                (row..N).for_each(|j| {
                    for k in column..N {
                        terms.add(row, column, chain.inertia[(j, k)], between(j.min(k) + 1, j.max(k) + 1));
                    }
                });
                terms.add(row, column, self.rotors(row, column), [0.0; N]);
            }
        }
        let weight =
            |(j, moment): (usize, &f64)| Wave { amplitude: -self.gravity * moment, wave: between(0, j + 1) };
        terms.potential = chain.moments.iter().enumerate().map(weight).collect();
        Ok(terms)
    }

    /// Contribution of the rotors to an entry of M: J_j c_row c_column with c_i = 1 for i before joint j, γ_j for i =
    /// j, and 0 for i after it.
    fn rotors(&self, row: usize, column: usize) -> f64 {
        let turns = |j: usize, i: usize| match i.cmp(&j) {
            std::cmp::Ordering::Less => 1.0,
            std::cmp::Ordering::Equal => self.joints[j].gear,
            std::cmp::Ordering::Greater => 0.0,
        };
        (0..self.joints.len()).map(|j| self.joints[j].rotor * turns(j, row) * turns(j, column)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ExactMotion;
    use leastaction_core::energy::trigonometric::ACROBOT;
    use leastaction_core::lagrangian::Lagrangian;

    fn joint(mass: f64, length: f64, centre: f64, inertia: f64) -> Joint {
        Joint { mass, length, centre, inertia, rotor: 0.0, gear: 1.0 }
    }

    #[test]
    fn two_links_of_symos_acrobot_are_symos_acrobot() {
        let link = joint(1.0, 1.0, 0.5, 1.0);
        let terms = Linkage { gravity: 9.81, joints: vec![link; 2] }.terms::<2>().unwrap();
        let (own, exact) = (terms.lagrangian(), ACROBOT);
        let (q, v) = ([0.4, -1.1], [1.3, 0.7]);
        let (a, b): (_, leastaction_core::lagrangian::Energies<f64>) =
            (own.energies(&q, &v), exact.energies(&q, &v));
        assert!((a.kinetic - b.kinetic).abs() < 1e-12, "{a:?} {b:?}");
        assert!((a.potential - b.potential).abs() < 1e-12, "{a:?} {b:?}");
    }

    #[test]
    fn joint_angles_add_up_to_the_chains() {
        let joints =
            vec![joint(0.5, 0.2, 0.15, 0.01), joint(0.6, 0.3, 0.2, 0.02), joint(0.7, 0.4, 0.1, 0.03)];
        let chain = Chain::new(joints.iter().map(Joint::link).collect(), None).unwrap();
        let linkage = Linkage { gravity: 9.8, joints };
        let terms = linkage.terms::<3>().unwrap();
        let (q, v) = ([0.4, -1.1, 0.3], [1.3, 0.7, -2.0]);
        let own = terms.lagrangian().energies(&q, &v);
        let sums = |x: [f64; 3]| [x[0], x[0] + x[1], x[0] + x[1] + x[2]];
        assert!((own.kinetic - chain.kinetic_energy(&sums(q), &sums(v))).abs() < 1e-12);
        assert!((own.potential - chain.potential_energy(&sums(q))).abs() < 1e-12);
    }

    #[test]
    fn a_rotor_rides_on_the_link_before_and_turns_by_its_gear() {
        let bare = vec![joint(0.5, 0.2, 0.15, 0.01), joint(0.6, 0.3, 0.2, 0.02)];
        let mut geared = bare.clone();
        (geared[1].rotor, geared[1].gear) = (6e-5, -6.0);
        let kinetic = |joints: Vec<Joint>| {
            let terms = Linkage { gravity: 9.81, joints }.terms::<2>().unwrap();
            terms.lagrangian().energies(&[0.3, 0.4], &[1.5, -0.7]).kinetic
        };
        let turning: f64 = 1.5 + 6.0 * 0.7;
        assert!((kinetic(geared) - kinetic(bare) - 0.5 * 6e-5 * turning * turning).abs() < 1e-15);
    }

    #[test]
    fn toml_is_read_and_its_mistakes_are_named() {
        let text = "[[joint]]\nmass = 1.0\nlength = 0.5\ncentre = 0.2\ninertia = 0.1\n";
        let linkage = Linkage::from_toml(text).unwrap();
        assert_eq!((linkage.gravity, linkage.joints.len(), linkage.joints[0].gear), (9.81, 1, 1.0));
        assert!(Linkage::from_toml(&format!("{text}mas = 2.0\n")).unwrap_err().contains("mas"));
        let bad = Linkage::from_toml(&text.replace("0.1", "-0.1")).unwrap();
        assert!(bad.terms::<1>().is_err());
    }
}
