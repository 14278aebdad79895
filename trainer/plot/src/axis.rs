//! Ranges, ticks and tick labels of an axis.

use std::f64::consts::{FRAC_PI_4, PI};
use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

/// Largest magnitude that is drawn; larger ones would overflow in the layout.
const LARGEST: f64 = 1e300;

/// Margin between the data and the frame, as a fraction of the range.
const PADDING: f64 = 0.04;

/// Layout of values along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scale {
    Linear,
    Log,
    /// Linear, with ticks at parts of π.
    Angle,
}

impl Scale {
    /// Whether a value can be placed on the axis: it is finite, and positive on a logarithmic axis.
    pub(super) fn shows(self, value: f64) -> bool {
        let magnitude = value.abs();
        match self {
            Self::Log => value > 1.0 / LARGEST && value < LARGEST,
            _ => magnitude < LARGEST,
        }
    }

    fn to_axis(self, value: f64) -> f64 {
        if self == Self::Log { value.log10() } else { value }
    }
}

/// An axis that shows all of its data.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    scale: Scale,
    /// Ends of the axis, as logarithms on a logarithmic axis.
    low: f64,
    high: f64,
    ticks: Vec<f64>,
    /// Distance between ticks, which determines the digits of the labels; 0 for decades.
    step: f64,
}

impl Axis {
    /// The axis that fits these values, with at most `most` ticks.
    pub(super) fn fit(scale: Scale, values: impl Iterator<Item = f64>, most: usize) -> Self {
        let shown = values.filter(|&value| scale.shows(value)).map(|value| scale.to_axis(value));
        let range = shown.fold(None, |range: Option<(f64, f64)>, x| {
            let (low, high) = range.unwrap_or((x, x));
            Some((low.min(x), high.max(x)))
        });
        let (low, high) = widen(range.unwrap_or((0.0, 1.0)));
        let (ticks, step) = ticks(scale, low, high, most.max(2));
        Self { scale, low, high, ticks, step }
    }

    /// The axis without margins at the ends, as for time.
    pub(super) fn tight(scale: Scale, values: impl Iterator<Item = f64> + Clone, most: usize) -> Self {
        let mut axis = Self::fit(scale, values, most);
        let padding = (axis.high - axis.low) * PADDING / (1.0 + 2.0 * PADDING);
        (axis.low, axis.high) = (axis.low + padding, axis.high - padding);
        let slack = (axis.high - axis.low) * 1e-9;
        let (low, high) = (axis.low - slack, axis.high + slack);
        axis.ticks.retain(|&tick| (low..=high).contains(&scale.to_axis(tick)));
        axis
    }

    pub(super) fn scale(&self) -> Scale {
        self.scale
    }

    pub(super) fn label(&self, value: f64) -> String {
        match self.scale {
            Scale::Log if self.step == 0.0 => power_label(value, self.is_plain()),
            Scale::Angle if self.step >= FRAC_PI_4 => angle_label(value),
            _ => number_label(value, self.step, self.ticks.iter().fold(0.0, |max: f64, t| max.max(t.abs()))),
        }
    }

    /// Whether the ticks are not only decades and can be read without powers of ten.
    fn is_plain(&self) -> bool {
        let decades = self.ticks.iter().all(|tick| format!("{tick:.0e}").starts_with('1'));
        !decades && self.ticks.iter().all(|tick| (9e-4..1.1e3).contains(tick))
    }

    pub(super) fn ticks(&self) -> &[f64] {
        &self.ticks
    }

    /// The value in the middle of the axis.
    pub(super) fn middle(&self) -> f64 {
        let middle = (self.low + self.high) / 2.0;
        if self.scale == Scale::Log { 10_f64.powf(middle) } else { middle }
    }

    /// Number of characters in the longest tick label.
    pub(super) fn label_width(&self) -> usize {
        self.ticks.iter().map(|&tick| self.label(tick).chars().count()).max().unwrap_or(1)
    }
}

/// Adds margins at both ends; a single value becomes a range.
fn widen((low, high): (f64, f64)) -> (f64, f64) {
    let smallest = (1e-9 * low.abs().max(high.abs())).max(1.0 / LARGEST);
    let padding = if high - low > smallest { PADDING * (high - low) } else { (0.1 * low.abs()).max(0.1) };
    (low - padding, high + padding)
}

/// The ticks between `low` and `high`, and their distance.
fn ticks(scale: Scale, low: f64, high: f64, most: usize) -> (Vec<f64>, f64) {
    match scale {
        Scale::Log if 3.0 * (high - low) > most as f64 => (decades(low, high, most), 0.0),
        Scale::Log if high - low > 0.9 => (thirds_of_decades(low, high), 0.0),
        Scale::Log => {
            let (from, to) = (10_f64.powf(low), 10_f64.powf(high));
            let step = round_step((to - from) / most as f64);
            (multiples(step, from, to), step)
        }
        Scale::Angle if high - low >= PI / 2.0 => {
            let step = angle_step((high - low) / most as f64);
            (multiples(step, low, high), step)
        }
        _ => {
            let step = round_step((high - low) / most as f64);
            (multiples(step, low, high), step)
        }
    }
}

fn multiples(step: f64, low: f64, high: f64) -> Vec<f64> {
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    // The step is chosen for only a few ticks; the bound only guards against rounding at extreme magnitudes.
    let count = (last - first).clamp(0.0, 50.0) as i32;
    (0..=count).map(|k| (first + f64::from(k)) * step).collect()
}

/// Ticks at powers of ten.
fn decades(low: f64, high: f64, most: usize) -> Vec<f64> {
    let span = high.floor() - low.ceil();
    let step = (span / most as f64).ceil().max(1.0);
    multiples(step, low, high).into_iter().map(|exponent| 10_f64.powi(exponent as i32)).collect()
}

/// Ticks at 1, 2 and 5 times powers of ten.
fn thirds_of_decades(low: f64, high: f64) -> Vec<f64> {
    let powers = multiples(1.0, low.floor(), high).into_iter().map(|exponent| 10_f64.powi(exponent as i32));
    let all = powers.flat_map(|power| [1.0, 2.0, 5.0].map(|factor| factor * power));
    all.filter(|tick| (low..=high).contains(&tick.log10())).collect()
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `x`.
fn round_step(x: f64) -> f64 {
    let power = 10_f64.powf(x.log10().floor());
    let factors = [1.0, 2.0, 5.0, 10.0];
    factors.into_iter().map(|factor| factor * power).find(|&step| step >= x).unwrap_or(x)
}

/// The smallest of π/4, π/2 and round multiples of π that is not below `x`.
fn angle_step(x: f64) -> f64 {
    let parts = [PI / 4.0, PI / 2.0];
    parts.into_iter().find(|&step| step >= x).unwrap_or_else(|| PI * round_step(x / PI).max(1.0))
}

/// A number with as many digits as the distance to the next tick requires.
fn number_label(value: f64, step: f64, largest: f64) -> String {
    if value.abs() < 1e-9 * step {
        return "0".to_owned();
    }
    let last_digit = (step * (1.0 + 1e-9)).log10().floor() as i32;
    if (1e-3..1e5).contains(&largest) && last_digit >= -4 {
        return with_minus(&format!("{value:.*}", usize::try_from(-last_digit).unwrap_or(0)));
    }
    let digits = usize::try_from(value.abs().log10().floor() as i32 - last_digit).unwrap_or(0);
    let text = format!("{value:.digits$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa =
        if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    format!("{}×10{}", with_minus(mantissa), superscript(exponent))
}

/// Label of 1, 2 or 5 times a power of ten; in plain digits if `plain`.
fn power_label(value: f64, plain: bool) -> String {
    let text = format!("{value:.0e}");
    match (plain, text.split_once('e')) {
        (false, Some(("1", exponent))) => format!("10{}", superscript(exponent)),
        (false, Some((mantissa, exponent))) => format!("{mantissa}×10{}", superscript(exponent)),
        _ => text.parse().map_or(text, |rounded: f64| rounded.to_string()),
    }
}

/// Label of a multiple of π/4.
fn angle_label(value: f64) -> String {
    let quarters = (value / FRAC_PI_4).round() as i64;
    let (count, part) = match quarters {
        0 => return "0".to_owned(),
        q if q % 4 == 0 => (q / 4, ""),
        q if q % 2 == 0 => (q / 2, "/2"),
        q => (q, "/4"),
    };
    let count = match count {
        1 => String::new(),
        -1 => "−".to_owned(),
        other => with_minus(&other.to_string()),
    };
    format!("{count}π{part}")
}

fn with_minus(number: &str) -> String {
    number.replace('-', "−")
}

fn superscript(digits: &str) -> String {
    let raised = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raise = |c: char| c.to_digit(10).and_then(|d| raised.get(d as usize).copied()).unwrap_or('⁻');
    digits.chars().map(raise).collect()
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let part = (self.scale.to_axis(*value) - self.low) / (self.high - self.low);
        let (from, to) = (f64::from(limit.0), f64::from(limit.1));
        // Values far outside the frame saturate.
        (from + part * (to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        match self.scale {
            Scale::Log => 10_f64.powf(self.low)..10_f64.powf(self.high),
            _ => self.low..self.high,
        }
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, values: &[f64], most: usize) -> Vec<String> {
        let axis = Axis::fit(scale, values.iter().copied(), most);
        axis.ticks.iter().map(|&tick| axis.label(tick)).collect()
    }

    #[test]
    fn linear_ticks_are_round_and_few() {
        assert_eq!(labels(Scale::Linear, &[0.0, 10.0], 6), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(
            labels(Scale::Linear, &[-0.3, 0.3], 5),
            ["−0.2", "0.0", "0.2"].map(|s| s.replace("0.0", "0"))
        );
        assert_eq!(labels(Scale::Linear, &[0.0, 2e-7], 4), ["0", "1×10⁻⁷", "2×10⁻⁷"]);
        assert_eq!(labels(Scale::Linear, &[0.0, 3e6], 4), ["0", "1×10⁶", "2×10⁶", "3×10⁶"]);
    }

    #[test]
    fn logarithmic_ticks_are_decades_where_there_are_any() {
        assert_eq!(labels(Scale::Log, &[2e-6, 3.0], 8), ["10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
        assert_eq!(labels(Scale::Log, &[1e-12, 1.0], 5), ["10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "10⁰"]);
        assert_eq!(labels(Scale::Log, &[3e-3, 0.2], 8), ["0.005", "0.01", "0.02", "0.05", "0.1", "0.2"]);
        assert_eq!(labels(Scale::Log, &[3e-8, 4e-7], 5), ["5×10⁻⁸", "10⁻⁷", "2×10⁻⁷"]);
        assert_eq!(labels(Scale::Log, &[1.0, 4.0], 5), ["1", "2", "3", "4"]);
        assert_eq!(labels(Scale::Log, &[8e-8, 1.2e-7], 4), ["8×10⁻⁸", "1×10⁻⁷", "1.2×10⁻⁷"]);
    }

    #[test]
    fn angles_are_labelled_in_parts_of_pi() {
        assert_eq!(labels(Scale::Angle, &[-3.2, 3.2], 6), ["−π", "−π/2", "0", "π/2", "π"]);
        assert_eq!(labels(Scale::Angle, &[0.0, 20.0], 5), ["0", "2π", "4π", "6π"]);
        assert_eq!(labels(Scale::Angle, &[0.0, 2.4], 4), ["0", "π/4", "π/2", "3π/4"]);
        assert_eq!(labels(Scale::Angle, &[0.0, 0.2], 3), ["0", "0.1", "0.2"].map(|s| s.replace("0.0", "0")));
    }

    #[test]
    fn any_values_give_an_axis_with_ticks_in_it() {
        let nasty =
            [f64::NAN, f64::INFINITY, -f64::INFINITY, 0.0, -1.0, 1e308, -1e308, 5e-324, 1.0, 1e-299, 1e299];
        for scale in [Scale::Linear, Scale::Log, Scale::Angle] {
            for pair in nasty.iter().flat_map(|a| nasty.iter().map(move |b| [*a, *b])) {
                let axis = Axis::fit(scale, pair.into_iter(), 6);
                assert!(axis.low < axis.high && axis.ticks.len() <= 51, "{scale:?} {pair:?}");
                assert!(axis.label_width() < 40, "{scale:?} {pair:?}");
                for value in pair.into_iter().filter(|&value| scale.shows(value)) {
                    assert!((0..=1000).contains(&axis.map(&value, (0, 1000))), "{scale:?} {pair:?} {value}");
                }
            }
        }
    }

    #[test]
    fn a_tight_axis_ends_at_the_data() {
        let axis = Axis::tight(Scale::Linear, [0.0, 10.0].into_iter(), 6);
        assert_eq!((axis.map(&0.0, (0, 100)), axis.map(&10.0, (0, 100))), (0, 100));
        assert_eq!((axis.ticks.first(), axis.ticks.last()), (Some(&0.0), Some(&10.0)));
    }
}
