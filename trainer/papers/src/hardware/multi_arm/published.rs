//! Parameters that the authors of the logs identified.
//!
//! Source: Kaheman, Fasel, Bramburger, Strom, Kutz and Brunton, "The experimental multi-arm pendulum on a cart",
//! arXiv 2205.06231, 2022.

use std::fmt::Write;

/// An arm: its joint lies at the end of the arm before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arm {
    /// Mass m, kg.
    pub mass: f64,
    /// Distance a of the centre of mass from the joint, m.
    pub centre: f64,
    /// Moment of inertia I about the centre of mass, kg m².
    pub inertia: f64,
    /// Viscous friction k of the joint, N m s/rad.
    pub viscous: f64,
    /// Distance L of the next joint, m; 0 for the last arm.
    pub length: f64,
}

/// A mounted pendulum that swings freely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pendulum {
    /// Name, and beginning of the name of its file.
    pub name: &'static str,
    /// Arms from the mount on.
    pub arms: &'static [Arm],
    /// Rough learning time, s.
    pub expected_seconds: f64,
}

const fn arm([mass, centre, inertia, viscous, length]: [f64; 5]) -> Arm {
    Arm { mass, centre, inertia, viscous, length }
}

/// The three pendulums.
pub const PENDULUMS: [Pendulum; 3] = [
    Pendulum { name: "single", arms: &[arm([0.1478, 0.1476, 1.09e-4, 2.2e-4, 0.0])], expected_seconds: 10.0 },
    Pendulum {
        name: "double",
        arms: &[arm([0.0938, 0.1086, 4.4e-4, 2.4e-4, 0.1727]), arm([0.1376, 0.1168, 1.27e-3, 1e-5, 0.0])],
        expected_seconds: 80.0,
    },
    Pendulum {
        name: "triple",
        arms: &[
            arm([0.2582, 0.16, 1e-4, 1.5e-3, 0.1728]),
            arm([0.2794, 0.2029, 3.1e-4, 2.6e-4, 0.2287]),
            arm([0.1186, 0.1837, 1.7e-4, 1e-5, 0.0]),
        ],
        expected_seconds: 150.0,
    },
];

impl Pendulum {
    /// Name of the file of its logs.
    pub fn file(&self) -> String {
        format!("{}_id.npz", self.name)
    }

    /// Configuration of the model with all parameters known, or with the first mass and the lengths alone. Angles are
    /// counted from upright.
    pub fn configuration(&self, file: &str, is_known: bool) -> String {
        let number = |known: f64| if is_known { known.to_string() } else { "\"learned\"".to_owned() };
        let friction: Vec<f64> = self.arms.iter().map(|arm| arm.viscous).collect();
        let friction = if is_known { format!("{friction:?}") } else { "\"learned\"".to_owned() };
        let mut text = format!(
            "[data]\nfile = {file:?}\nvalidation = 0.0\n\n[model]\nfamily = \"bodies\"\ngravity = [-9.81, 0.0]\n\
             friction = {{ viscous = {friction} }}\n"
        );
        for (k, arm) in self.arms.iter().enumerate() {
            let place = match k.checked_sub(1) {
                Some(before) => format!("on = {before}\nat = [{}, 0.0]\n", self.arms[before].length),
                None => String::new(),
            };
            let mass = if k == 0 { arm.mass.to_string() } else { number(arm.mass) };
            // Writing to a string does not fail.
            let _ = write!(
                text,
                "\n[[model.bodies]]\njoint = \"revolute\"\n{place}mass = {mass}\ncentre = [{}, 0.0]\ninertia = {}\n",
                number(arm.centre),
                number(arm.inertia)
            );
        }
        text + "\n[training]\nloss = \"windows\"\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_learning::config::Config;
    use std::path::Path;

    #[test]
    fn configurations_have_their_numbers() {
        for pendulum in PENDULUMS {
            let weights = [true, false].map(|is_known| {
                let text = pendulum.configuration("log.npz", is_known);
                let config = Config::parse(&text, Path::new("pendulum.toml")).unwrap();
                let (architecture, weights) = config.beginning().unwrap();
                let n = pendulum.arms.len();
                let learned = if is_known { 0 } else { 4 * n - 1 };
                assert_eq!((architecture.n(), architecture.learned_parameters().unwrap()), (n, learned));
                weights
            });
            let [known, _] = &weights;
            for (k, arm) in pendulum.arms.iter().enumerate() {
                assert!(known.contains(&arm.inertia) && known.contains(&arm.viscous), "{k}: {known:?}");
            }
            assert_eq!(weights[0].len(), weights[1].len());
        }
    }
}
