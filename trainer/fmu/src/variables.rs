/// Kind of a variable of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Time t, s.
    Time,
    /// Step h of co-simulation, s.
    Step,
    /// Force u on a coordinate, at the actuator's output, N or N m: an input.
    Force,
    /// Position q of a coordinate, m or rad: a state.
    Position,
    /// Velocity v of a coordinate, m/s or rad/s: a state.
    Velocity,
    /// Acceleration a of a coordinate, m/s² or rad/s².
    Acceleration,
    /// Position of a coordinate at the start, m or rad.
    StartPosition,
    /// Velocity of a coordinate at the start, m/s or rad/s.
    StartVelocity,
    /// Kinetic energy T, J.
    KineticEnergy,
    /// Potential energy V, J.
    PotentialEnergy,
    /// Energy T + V, J.
    Energy,
}

impl Kind {
    /// All kinds, in the order of the description.
    pub const ALL: [Self; 11] = [
        Self::Time,
        Self::Step,
        Self::Force,
        Self::Position,
        Self::Velocity,
        Self::Acceleration,
        Self::StartPosition,
        Self::StartVelocity,
        Self::KineticEnergy,
        Self::PotentialEnergy,
        Self::Energy,
    ];

    /// Name, before the index if every coordinate has such a variable.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Step => "h",
            Self::Force => "u",
            Self::Position => "q",
            Self::Velocity => "v",
            Self::Acceleration => "a",
            Self::StartPosition => "q_start",
            Self::StartVelocity => "v_start",
            Self::KineticEnergy => "kinetic_energy",
            Self::PotentialEnergy => "potential_energy",
            Self::Energy => "energy",
        }
    }

    /// Whether every coordinate has such a variable.
    pub const fn is_of_coordinates(self) -> bool {
        !matches!(self, Self::Time | Self::Step | Self::KineticEnergy | Self::PotentialEnergy | Self::Energy)
    }

    /// Whether the unit computes such a variable for its environment.
    pub const fn is_output(self) -> bool {
        matches!(
            self,
            Self::Position
                | Self::Velocity
                | Self::Acceleration
                | Self::KineticEnergy
                | Self::PotentialEnergy
                | Self::Energy
        )
    }
}

/// A variable of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variable {
    /// Kind of the variable.
    pub kind: Kind,
    /// Position of its coordinate, from 0; 0 if it belongs to no coordinate.
    pub index: usize,
}

/// Number of value references per kind, more than there are coordinates.
const REFERENCES: u32 = 100;

impl Variable {
    /// All variables of a unit of n coordinates, in the order of the description.
    pub fn all(n: usize) -> Vec<Self> {
        let of_kind = |kind: Kind| {
            let count = if kind.is_of_coordinates() { n } else { 1 };
            (0..count).map(move |index| Self { kind, index })
        };
        Kind::ALL.into_iter().flat_map(of_kind).collect()
    }

    /// Value reference: 100 for every kind before the variable's own, and the position of the coordinate.
    pub const fn reference(self) -> u32 {
        self.kind as u32 * REFERENCES + self.index as u32
    }

    /// Variable of a unit of n coordinates with this value reference; `None` if there is none.
    pub fn of_reference(reference: u32, n: usize) -> Option<Self> {
        let kind = *Kind::ALL.get((reference / REFERENCES) as usize)?;
        let index = (reference % REFERENCES) as usize;
        let count = if kind.is_of_coordinates() { n } else { 1 };
        (index < count).then_some(Self { kind, index })
    }

    /// Name: coordinates count from 1, as in Modelica.
    pub fn name(self) -> String {
        let name = self.kind.name();
        if self.kind.is_of_coordinates() { format!("{name}[{}]", self.index + 1) } else { name.to_owned() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_are_unique_and_lead_back() {
        for n in [1, 2, 12, 99] {
            let all = Variable::all(n);
            assert_eq!(all.len(), 6 * n + 5);
            for variable in all {
                assert_eq!(Variable::of_reference(variable.reference(), n), Some(variable));
            }
        }
    }

    #[test]
    fn other_references_belong_to_nothing() {
        let known = |reference| Variable::of_reference(reference, 2).is_some();
        assert_eq!((0..2_000).filter(|reference| known(*reference)).count(), 6 * 2 + 5);
        assert!(!known(u32::MAX));
    }
}
