//! Names, groups and units of numbers.

use crate::Choice;
use leastaction_core::adapt::Number;
use leastaction_core::energy::bodies::PLANAR_INERTIAL_PARAMETERS;
use leastaction_core::forces::Coefficient;

/// Symbols of the ten inertial numbers of a body in space.
const IN_SPACE: [&str; 10] = ["m", "mc_x", "mc_y", "mc_z", "I_xx", "I_xy", "I_yy", "I_xz", "I_yz", "I_zz"];
/// Symbols of the four inertial numbers of a body in a plane.
const IN_PLANE: [&str; PLANAR_INERTIAL_PARAMETERS] = ["m", "mc_x", "mc_y", "I"];

/// Numbers of a kind, which have one unit but for the kind of coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Mass of a body.
    Mass,
    /// First moments of a body's mass.
    Moments,
    /// Moments and products of inertia of a body, about the origin of its frame.
    Inertias,
    /// Viscous friction.
    Viscous,
    /// Dry friction.
    Dry,
    /// Rotors, offsets and gains of drives.
    Drives,
    /// Last layer of a potential's network.
    Potential,
    /// Strengths of a network's dissipation.
    Dissipation,
}

/// Label of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Label {
    /// Symbol.
    pub symbol: &'static str,
    /// The body, the coordinate, the unit of the potential's network or the column of dissipation, from 0.
    pub place: u8,
    /// Kind of number.
    pub group: Group,
    /// Unit; empty for a number without one.
    pub unit: &'static str,
}

impl Group {
    /// Kind of thing that has such a number.
    fn owner(self) -> &'static str {
        match self {
            Self::Mass | Self::Moments | Self::Inertias => "body",
            Self::Viscous | Self::Dry | Self::Drives => "coordinate",
            Self::Potential => "potential unit",
            Self::Dissipation => "dissipation column",
        }
    }
}

impl Label {
    /// Symbol, and what has the number.
    pub fn name(&self) -> String {
        let Self { symbol, place, group, .. } = self;
        format!("{symbol} of {} {place}", group.owner())
    }

    /// Name among numbers of its group, of which one body at most has some.
    pub fn short_name(&self) -> String {
        let Self { symbol, place, group, .. } = self;
        match group {
            Group::Mass | Group::Moments | Group::Inertias => (*symbol).to_owned(),
            Group::Viscous | Group::Dry | Group::Drives => format!("{symbol} of q{place}"),
            Group::Potential | Group::Dissipation => format!("{symbol}{place}"),
        }
    }
}

impl Choice {
    /// Labels of all numbers; `coordinates` has a letter for every coordinate: t for one that slides, a for one that turns, and c for either.
    pub fn labels(&self, coordinates: &str) -> Vec<Label> {
        labels(&self.numbers(), coordinates)
    }
}

/// Labels of numbers, which have whole bodies.
pub(crate) fn labels(numbers: &[Number], coordinates: &str) -> Vec<Label> {
    let letter = |i: u8| coordinates.as_bytes().get(usize::from(i)).copied().unwrap_or(b'c');
    let label = |number: &Number| match *number {
        Number::Inertia { body, index } => {
            let of_body = |other: &&Number| matches!(other, Number::Inertia { body: of, .. } if *of == body);
            let is_planar = numbers.iter().filter(of_body).count() == PLANAR_INERTIAL_PARAMETERS;
            let symbols: &[&str] = if is_planar { &IN_PLANE } else { &IN_SPACE };
            of_body_number(body, symbols.get(usize::from(index)).copied())
        }
        number => of_coordinate(number, letter),
    };
    numbers.iter().map(label).collect()
}

fn of_body_number(body: u8, symbol: Option<&'static str>) -> Label {
    let symbol = symbol.unwrap_or("?");
    let (group, unit) = match symbol.as_bytes() {
        [b'm'] => (Group::Mass, "kg"),
        [b'm', ..] => (Group::Moments, "kg m"),
        _ => (Group::Inertias, "kg m²"),
    };
    Label { symbol, place: body, group, unit }
}

fn of_coordinate(number: Number, letter: impl Fn(u8) -> u8) -> Label {
    let force = ["N", "N m", "N or N m"];
    let (symbol, place, group, [slides, turns, either]) = match number {
        Number::Friction(Coefficient::Viscous | Coefficient::DirectionalViscous, i) => {
            ("b", i, Group::Viscous, ["N s/m", "N m s/rad", "N s/m or N m s/rad"])
        }
        Number::Friction(_, i) => ("c", i, Group::Dry, force),
        Number::Rotor(i) => ("J", i, Group::Drives, ["kg", "kg m²", "kg or kg m²"]),
        Number::Offset(i) => ("o", i, Group::Drives, force),
        Number::Gain(i) => ("g", i, Group::Drives, [""; 3]),
        Number::Potential(j) => ("w", j, Group::Potential, ["J"; 3]),
        Number::Dissipation(j) => ("s", j, Group::Dissipation, [""; 3]),
        Number::None | Number::Inertia { .. } => ("", 0, Group::Drives, [""; 3]),
    };
    let unit = match letter(place) {
        b't' => slides,
        b'a' => turns,
        _ => either,
    };
    Label { symbol, place, group, unit }
}
