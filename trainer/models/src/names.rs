//! Names of the numbers of a weight block.

use crate::architecture::Architecture;
use crate::laws::NumberKind;

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

impl Architecture {
    /// Names of all numbers of the weight block; `None` for weights and scales of networks and for a graph's numbers.
    pub fn number_names(&self) -> Vec<Option<NumberName>> {
        let count = self.parameters().unwrap_or(0);
        let mut names = self.family.number_names();
        names.resize(count, None);
        let own = self.family.laws();
        let before = self.laws_start().saturating_sub(own.parameters(self.family.groups()).unwrap_or(0));
        let own = own.iter().flat_map(|law| (0..self.family.groups()).map(move |group| (law, group)));
        let own = own.flat_map(|(law, group)| NumberKind::of(law).iter().map(move |kind| (group, *kind)));
        let beside = self.law_entries().map(|entry| (entry.position, (entry.group, entry.kind)));
        for (position, (group, kind)) in (before..).zip(own).chain(beside) {
            if let Some(name) = names.get_mut(position) {
                let unit = kind.unit(self.letter_of(group) == Some('t'));
                *name = Some(named(&self.family.group_name(group), kind.words(), unit));
            }
        }
        names
    }

    /// Kind of the first coordinate of a group.
    fn letter_of(&self, group: usize) -> Option<char> {
        let first = self.family.group_of_coordinates().iter().position(|of| *of == group)?;
        self.coordinates().chars().nth(first)
    }
}

#[cfg(test)]
mod tests {
    use crate::{Architecture, BodiesArchitecture, GroupLaws, InertiaNetworkArchitecture, Number};
    use leastaction_core::energy::bodies::{BodyParameters, Joint, TreeBody};
    use leastaction_core::energy::inertia_network::Coordinate;

    fn friction(groups: usize) -> GroupLaws {
        GroupLaws::of_friction(vec![Number::learned(0.1); groups], vec![[Number::learned(0.1); 4]; groups])
    }

    #[test]
    fn numbers_of_bodies_and_of_friction_have_names_and_units() {
        let own = BodyParameters::from_array([Number::learned(1.0); 9]);
        let body = |joint, parent| TreeBody { joint, parent };
        let bodies = [(body(Joint::Prismatic, None), own), (body(Joint::Revolute, Some(0)), own)];
        let family = BodiesArchitecture::new([Number::known(0.0); 2], bodies).unwrap();
        let architecture = Architecture { group_laws: friction(2), ..Architecture::from(family) };
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
