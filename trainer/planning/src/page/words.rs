//! Names, units and numbers as the page writes them.

use crate::Machine;
use leastaction_plot::page::number;

/// Names and units of a machine's coordinates.
pub struct Words<'m> {
    machine: &'m Machine,
    letters: Vec<char>,
}

impl<'m> Words<'m> {
    /// Words for a machine.
    pub fn new(machine: &'m Machine) -> Self {
        Self { machine, letters: machine.model.architecture.coordinates().chars().collect() }
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.machine.n()
    }

    /// Name of coordinate i.
    pub fn name(&self, i: usize) -> &'m str {
        self.machine.names.get(i).map_or("", String::as_str)
    }

    /// Notes on the machine.
    pub fn notes(&self) -> &'m [String] {
        &self.machine.notes
    }

    /// Family and size of the model.
    pub fn model(&self) -> String {
        let (family, n) = (self.machine.model.architecture.name(), self.n());
        format!("{family} with {n} coordinate{}", if n == 1 { "" } else { "s" })
    }

    fn is_translation(&self, i: usize) -> bool {
        self.letters.get(i) == Some(&'t')
    }

    /// Unit of coordinate i.
    pub fn unit(&self, i: usize) -> &'static str {
        if self.is_translation(i) { "m" } else { "rad" }
    }

    /// Unit of the velocity of coordinate i.
    pub fn speed_unit(&self, i: usize) -> &'static str {
        if self.is_translation(i) { "m/s" } else { "rad/s" }
    }

    /// Unit of the command of coordinate i. Commands that an actuator turns into forces have a unit of their own.
    pub fn force_unit(&self, i: usize) -> &'static str {
        let model = &self.machine.model;
        if model.facts.actuator.gain(i) == 1.0 {
            model.architecture.command_unit(i)
        } else {
            "units of the command"
        }
    }

    /// Duration in words.
    pub fn duration(&self, seconds: f64) -> String {
        format!("{} s", number(seconds))
    }
}

/// Least and most in words: a number, an interval, or any.
pub fn interval([least, most]: [f64; 2]) -> String {
    match (least.is_finite(), most.is_finite()) {
        (false, false) => "any".to_owned(),
        (true, false) => format!("≥ {}", number(least)),
        (false, true) => format!("≤ {}", number(most)),
        (true, true) if least == most => number(least),
        (true, true) => format!("{} … {}", number(least), number(most)),
    }
}

/// A share as a percentage. Shares below 1 are not rounded up to 100%.
pub fn percent(share: f64) -> String {
    let whole = (100.0 * share).round();
    if whole == 100.0 && share < 1.0 - 1e-6 {
        format!("{:.1}%", (1000.0 * share).floor() / 10.0)
    } else {
        format!("{whole}%")
    }
}

/// A count with its noun.
pub fn count(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_and_shares_read_as_text() {
        let all = f64::INFINITY;
        let texts = [[-all, all], [0.5, all], [-all, 2.0], [1.0, 1.0], [-1.0, 1.0]].map(interval);
        assert_eq!(texts, ["any", "≥ 0.500", "≤ 2.00", "1.00", "-1.00 … 1.00"]);
        assert_eq!([0.5, 1.0, 0.9999, 1.2].map(percent), ["50%", "100%", "99.9%", "120%"]);
    }
}
