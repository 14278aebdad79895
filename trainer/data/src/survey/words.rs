//! Words in names of columns, and what they say of a column.

use crate::columns::UNITS;

/// Words of positions, velocities, forces, and of other quantities, which are none of these.
const POSITIONS: [&str; 7] = ["q", "pos", "position", "angle", "theta", "enc", "encoder"];
const VELOCITIES: [&str; 8] = ["v", "vel", "velocity", "qd", "dq", "qdot", "speed", "omega"];
const FORCES: [&str; 7] = ["u", "tau", "torque", "effort", "force", "moment", "trq"];
const TIMES: [&str; 5] = ["t", "time", "timestamp", "stamp", "sec"];
const OTHERS: [&str; 6] = ["current", "voltage", "temp", "temperature", "acc", "acceleration"];

/// Words that tell columns of one quantity apart, other than by joint, by their beginnings.
const MEASURED: [&str; 3] = ["meas", "raw", "actual"];
const COMMANDED: [&str; 7] = ["con", "cmd", "com", "des", "target", "ref", "setpoint"];
const FILTERED: [&str; 2] = ["filt", "smooth"];

/// Beginnings of words of what is computed, such as the output of a friction compensator: neither measured nor commanded.
const COMPUTED: [&str; 12] =
    ["fric", "comp", "grav", "ext", "dist", "cor", "pred", "resid", "err", "std", "lim", "max"];

/// Quantity of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Position,
    Velocity,
    Force,
    Time,
    Other,
}

const QUANTITIES: [(Quantity, &[&str]); 5] = [
    (Quantity::Time, &TIMES),
    (Quantity::Position, &POSITIONS),
    (Quantity::Velocity, &VELOCITIES),
    (Quantity::Force, &FORCES),
    (Quantity::Other, &OTHERS),
];

/// Kind of a column by a word that is neither its joint nor its quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Qualifier {
    Measured,
    Commanded,
    Filtered,
    Computed,
}

/// Lower-case words of a name: they end where letters and digits meet, before a capital letter, and at all other
/// characters.
pub(super) fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for c in name.chars() {
        let starts = c.is_numeric() != before.is_numeric()
            || c.is_uppercase() && before.is_lowercase()
            || !before.is_alphanumeric();
        if c.is_alphanumeric() {
            if starts {
                words.push(String::new());
            }
            if let Some(word) = words.last_mut() {
                word.extend(c.to_lowercase());
            }
        }
        before = c;
    }
    words
}

/// Quantity of a word, with a rank: 0 for a word that is known, 1 for one that begins so, 2 for one that contains it.
pub(super) fn quantity(word: &str) -> Option<(u8, Quantity)> {
    let ranks = QUANTITIES.into_iter().filter_map(|(quantity, known)| Some((rank(word, known)?, quantity)));
    ranks.min_by_key(|(rank, _)| *rank)
}

fn rank(word: &str, known: &[&str]) -> Option<u8> {
    let long = || known.iter().filter(|known| known.len() > 2);
    if known.contains(&word) {
        Some(0)
    } else if long().any(|known| word.starts_with(known)) {
        Some(1)
    } else {
        long().any(|known| word.contains(known)).then_some(2)
    }
}

/// The qualifier that a word is.
pub(super) fn qualifier(word: &str) -> Option<Qualifier> {
    let begins = |known: &[&str]| known.iter().any(|known| word.starts_with(known));
    if begins(&MEASURED) {
        Some(Qualifier::Measured)
    } else if word != "command" && begins(&COMPUTED) {
        Some(Qualifier::Computed)
    } else if begins(&COMMANDED) {
        Some(Qualifier::Commanded)
    } else {
        begins(&FILTERED).then_some(Qualifier::Filtered)
    }
}

/// Whether a name says that its column is an angle.
#[must_use]
pub fn is_of_angle(name: &str) -> bool {
    const ANGLES: [&str; 8] = ["angle", "theta", "phi", "deg", "rad", "degrees", "radians", "angles"];
    words(name).iter().any(|word| ANGLES.contains(&word.as_str()))
}

/// The known unit that a text stands for, such as `deg` for `[°]`.
pub(super) fn unit_in(text: &str) -> Option<&'static str> {
    const OTHERS: [(&str, &str); 14] = [
        ("°", "deg"),
        ("degree", "deg"),
        ("degrees", "deg"),
        ("degs", "deg"),
        ("°/s", "deg/s"),
        ("radian", "rad"),
        ("radians", "rad"),
        ("sec", "s"),
        ("seconds", "s"),
        ("µs", "us"),
        ("N*m", "Nm"),
        ("N·m", "Nm"),
        ("N.m", "Nm"),
        ("N m", "Nm"),
    ];
    let text = text.trim().trim_matches(['[', ']', '(', ')']).trim();
    let known = UNITS.into_iter().map(|(unit, _)| (unit, unit)).chain(OTHERS);
    known.into_iter().find(|(name, _)| *name == text).map(|(_, unit)| unit)
}

/// Whether a word stands for the nanoseconds beside a column of whole seconds.
pub(super) fn is_of_nanoseconds(word: &str) -> bool {
    word.starts_with("nanosec") || word.starts_with("nsec")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_many_habits_have_words() {
        assert_eq!(words("shoulder_pan_joint.position"), ["shoulder", "pan", "joint", "position"]);
        assert_eq!(words("jointPos[12]"), ["joint", "pos", "12"]);
        assert_eq!(words("tau_meas2"), ["tau", "meas", "2"]);
        assert_eq!(words("DQ1"), ["dq", "1"]);
    }

    #[test]
    fn words_have_quantities_and_qualifiers() {
        let known = |word| quantity(word).map(|(_, quantity)| quantity);
        assert_eq!((known("dq"), known("positions")), (Some(Quantity::Velocity), Some(Quantity::Position)));
        assert_eq!((known("jointtorque"), known("arm")), (Some(Quantity::Force), None));
        assert_eq!(
            (qualifier("comp"), qualifier("commands")),
            (Some(Qualifier::Computed), Some(Qualifier::Commanded))
        );
        assert_eq!((qualifier("friction"), qualifier("shoulder")), (Some(Qualifier::Computed), None));
    }
}
