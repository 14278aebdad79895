//! Settings of an adapter as constants of a firmware.

use crate::Choice;
use leastaction_core::adapt::{Following, Number};
use std::fmt::Write;

/// First words of a module with the settings of an adapter.
pub const SETTINGS_HEAD: &str = "// Numbers that follow the machine while it runs.";

impl Choice {
    /// The settings as Rust source for a control loop of n coordinates: constants N, P and T, `BLOCK`, and `TUNING`, with the bits that this
    /// machine has.
    pub fn source(&self, n: usize) -> String {
        let settings = &self.settings;
        let all = &settings.numbers;
        let (places, block) = (all.len(), self.block);
        let each = |of: fn(&Following) -> f32| list(all.iter().map(of));
        let numbers: String =
            all.iter().map(|following| format!("        {},\n", number(following.number))).collect();
        let dry = settings.dry.as_ref().map_or("None".to_owned(), |(coefficient, levels)| {
            format!("Some((Coefficient::{coefficient:?}, {}))", list(levels.iter().copied()))
        });
        let mut source = format!("{SETTINGS_HEAD} Written by `leastaction adapt`.\n\n");
        let coefficient = if numbers.contains("Friction") || settings.dry.is_some() {
            "use leastaction_core::forces::Coefficient;\n"
        } else {
            ""
        };
        _ = write!(
            source,
            "use leastaction_core::adapt::{{Limits, Number, Tuning}};\n{coefficient}\n\
             /// Number of coordinates.\npub const N: usize = {n};\n\
             /// Number of numbers that follow.\npub const P: usize = {places};\n\
             /// Number of their pairs.\npub const T: usize = P * (P - 1) / 2;\n\
             /// Ticks of the loop in a tick of the adapter.\npub const BLOCK: u16 = {block};\n\
             /// Settings of the adapter.\n\
             #[rustfmt::skip]\n\
             pub const TUNING: Tuning<f32, N, P> = Tuning {{\n    numbers: [\n{numbers}    ],\n    half: {half},\n    h: {h:?},\n    \
             deviation: {deviation},\n    prior: {prior},\n    forgotten: {forgotten:?},\n    walk: {walk},\n    change: {change:?},\n    \
             limits: Limits {{\n        model: {model},\n        lower: {lower},\n        upper: {upper},\n        kept: {kept:?},\n    }},\n    \
             dry: {dry},\n}};\n",
            half = settings.half,
            h = settings.h,
            deviation = list(settings.deviation.iter().copied()),
            prior = each(|number| number.prior),
            forgotten = settings.forgotten,
            walk = each(|number| number.walk),
            change = settings.change,
            model = each(|number| number.model),
            lower = each(|number| number.limits[0]),
            upper = each(|number| number.limits[1]),
            kept = settings.kept,
        );
        source
    }
}

/// The shortest decimals with these bits.
fn list(numbers: impl Iterator<Item = f32>) -> String {
    let numbers: Vec<String> = numbers.map(|x| format!("{x:?}")).collect();
    format!("[{}]", numbers.join(", "))
}

/// A number as an expression.
fn number(number: Number) -> String {
    match number {
        Number::Friction(coefficient, i) => format!("Number::Friction(Coefficient::{coefficient:?}, {i})"),
        other => format!("Number::{other:?}"),
    }
}
