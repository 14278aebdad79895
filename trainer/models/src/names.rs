//! Names of the numbers of a weight block.

use crate::architecture::Architecture;
use leastaction_core::model::{FrictionNumber, Law};

/// Readable name of a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NumberName {
    /// Name, for example `body 1: mass`.
    pub name: String,
    /// Unit; empty for a dimensionless number.
    pub unit: &'static str,
}

pub(crate) fn named(whose: &str, name: &str, unit: &'static str) -> NumberName {
    NumberName { name: format!("{whose}: {name}"), unit }
}

/// Names of a group's viscous friction and of its numbers of dry friction.
fn of_friction(whose: &str, letter: Option<char>) -> [NumberName; 1 + FrictionNumber::ALL.len()] {
    let slides = letter == Some('t');
    let pick = |of_length, of_angle| if slides { of_length } else { of_angle };
    let force = pick("N", "N m");
    let dry = FrictionNumber::ALL.map(|number| match number {
        FrictionNumber::Constant => ("Coulomb friction", force),
        FrictionNumber::Load => ("Coulomb friction, growth with the load", ""),
        FrictionNumber::Smoothing => ("Coulomb friction, load from which it grows", force),
        FrictionNumber::Width => ("Coulomb friction, width of the change of sign", pick("m/s", "rad/s")),
    });
    let viscous = ("viscous friction", pick("N s/m", "N m s/rad"));
    let [c, load, smoothing, width] = dry;
    [viscous, c, load, smoothing, width].map(|(name, unit)| named(whose, name, unit))
}

impl Architecture {
    /// Names of all numbers of the weight block; `None` for weights and scales of networks and for a graph's numbers.
    pub fn number_names(&self) -> Vec<Option<NumberName>> {
        let count = self.parameters().unwrap_or(0);
        let mut names = self.family.number_names();
        let friction = self.friction_names();
        let servo = self.servo_names();
        let beside = self.corrections.count() + servo.len();
        names.resize(count.saturating_sub(friction.len() + beside), None);
        names.extend(friction.into_iter().map(Some));
        names.resize(count.saturating_sub(servo.len()), None);
        names.extend(servo.into_iter().map(Some));
        names
    }

    /// Names of the stiffnesses of servos.
    fn servo_names(&self) -> Vec<NumberName> {
        let unit = |group| if self.letter_of(group) == Some('t') { "N/m" } else { "N m/rad" };
        let name = |group| named(&self.family.group_name(group), "stiffness of the servo", unit(group));
        (0..self.servo.count()).map(name).collect()
    }

    /// Kind of the first coordinate of a group.
    fn letter_of(&self, group: usize) -> Option<char> {
        let first = self.family.group_of_coordinates().iter().position(|of| *of == group)?;
        self.coordinates().chars().nth(first)
    }

    /// Names of all friction numbers, the family's own included.
    fn friction_names(&self) -> Vec<NumberName> {
        let (laws, groups) = (self.friction_laws(), self.family.groups());
        let group = |group: usize| of_friction(&self.family.group_name(group), self.letter_of(group));
        let all: Vec<[NumberName; 5]> = (0..groups).map(group).collect();
        let mut names = Vec::new();
        if laws.contains(Law::Viscous) {
            names.extend(all.iter().map(|[viscous, ..]| viscous.clone()));
        }
        if laws.contains(Law::Coulomb) {
            names.extend(all.iter().flat_map(|[_, dry @ ..]| dry.iter().cloned()));
        }
        names
    }
}

#[cfg(test)]
mod tests {
    use crate::{Architecture, BodiesArchitecture, FrictionArchitecture, InertiaNetworkArchitecture, Number};
    use leastaction_core::energy::bodies::{BodyParameters, Joint, TreeBody};
    use leastaction_core::energy::inertia_network::Coordinate;

    fn friction(groups: usize) -> FrictionArchitecture {
        FrictionArchitecture::new(vec![Number::learned(0.1); groups], vec![[Number::learned(0.1); 4]; groups])
    }

    #[test]
    fn numbers_of_bodies_and_of_friction_have_names_and_units() {
        let own = BodyParameters::from_array([Number::learned(1.0); 9]);
        let body = |joint, parent| TreeBody { joint, parent };
        let bodies = [(body(Joint::Prismatic, None), own), (body(Joint::Revolute, Some(0)), own)];
        let family = BodiesArchitecture::new([Number::known(0.0); 2], bodies).unwrap();
        let architecture = Architecture { friction: friction(2), ..Architecture::from(family) };
        let names = architecture.number_names();
        assert_eq!(names.len(), architecture.parameters().unwrap());
        let text = |k: usize| {
            let name = names[k].clone().unwrap();
            format!("{}, {}", name.name, name.unit)
        };
        assert_eq!(text(1), "gravity along y, m/s²");
        assert_eq!(text(2 + 9 + 3), "body 1: mass, kg");
        assert_eq!(text(20), "coordinate 0: viscous friction, N s/m");
        assert_eq!(text(22), "coordinate 0: Coulomb friction, N");
        assert_eq!(text(29), "coordinate 1: Coulomb friction, width of the change of sign, rad/s");
    }

    #[test]
    fn weights_of_networks_have_none() {
        let inertia_network = InertiaNetworkArchitecture {
            damped: true,
            ..InertiaNetworkArchitecture::new(&[Coordinate::Angle], 3)
        };
        let names = Architecture::from(inertia_network).number_names();
        let (last, weights) = names.split_last().unwrap();
        assert_eq!(last.clone().unwrap().name, "coordinate 0: viscous friction");
        assert!(weights.iter().all(Option::is_none) && !weights.is_empty());
    }
}
