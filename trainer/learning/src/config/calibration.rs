//! `[calibration]`: which numbers of sensors and actuators are learned.

use crate::windows::{Calibration, Setting};
use serde::de::{Deserializer, Error, Unexpected, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;

/// Zero offsets of the sensors, and gain, offset, delay and lag of the actuators: each `"learned"`, or a known number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CalibrationConfig {
    /// Zero offset of every coordinate and log, m or rad: learned, or 0.
    pub zero: SettingConfig,
    /// Gain of every actuator; not 0.
    pub gain: SettingConfig,
    /// Offset of every actuator, N or N m.
    pub offset: SettingConfig,
    /// Delay common to all actuators, s; at least 0.
    pub delay: SettingConfig,
    /// Time constant of the lag common to all actuators, s; at least 0.
    #[serde(skip_serializing_if = "SettingConfig::is_none")]
    pub lag: SettingConfig,
}

/// A number that is known, or `"learned"`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SettingConfig(
    /// The setting as a loss over windows takes it.
    pub Setting,
);

impl Default for CalibrationConfig {
    fn default() -> Self {
        let known = |number| SettingConfig(Setting::Known(number));
        Self { zero: known(0.0), gain: known(1.0), offset: known(0.0), delay: known(0.0), lag: known(0.0) }
    }
}

impl CalibrationConfig {
    /// Configuration that learns every number.
    pub const LEARNED: Self = {
        let learned = SettingConfig(Setting::Learned);
        Self { zero: learned, gain: learned, offset: learned, delay: learned, lag: learned }
    };

    /// Whether all sensors and actuators are ideal.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// The first invalid known number: its key, and the requirement on its value.
    pub(super) fn problem(&self) -> Option<(&'static str, &'static str)> {
        let known = |setting: SettingConfig, holds: fn(f64) -> bool| match setting.0 {
            Setting::Known(number) => number.is_finite() && holds(number),
            Setting::Learned => true,
        };
        let checks = [
            (
                "zero",
                known(self.zero, |zero| zero == 0.0),
                "\"learned\" or 0: subtract a known one from the column",
            ),
            ("gain", known(self.gain, |gain| gain != 0.0), "\"learned\" or a finite number other than 0"),
            ("offset", known(self.offset, |_| true), "\"learned\" or a finite number, N or N m"),
            (
                "delay",
                known(self.delay, |delay| delay >= 0.0),
                "\"learned\" or a finite number of seconds, 0 or above",
            ),
            (
                "lag",
                known(self.lag, |lag| lag >= 0.0),
                "\"learned\" or a finite number of seconds, 0 or above",
            ),
        ];
        checks.into_iter().find(|(_, holds, _)| !holds).map(|(key, _, must)| (key, must))
    }

    /// The calibration as a loss over windows takes it.
    pub fn calibration(&self) -> Calibration {
        Calibration {
            zero: self.zero.0 == Setting::Learned,
            gain: self.gain.0,
            offset: self.offset.0,
            delay: self.delay.0,
            lag: self.lag.0,
        }
    }
}

impl SettingConfig {
    /// Whether the number is known to be 0.
    fn is_none(&self) -> bool {
        self.0 == Setting::Known(0.0)
    }
}

impl Serialize for SettingConfig {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            Setting::Known(number) => to.serialize_f64(number),
            Setting::Learned => to.serialize_str("learned"),
        }
    }
}

struct SettingVisitor;

impl Visitor<'_> for SettingVisitor {
    type Value = SettingConfig;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("\"learned\" or a number")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<SettingConfig, E> {
        match word {
            "learned" => Ok(SettingConfig(Setting::Learned)),
            other => Err(E::invalid_value(Unexpected::Str(other), &self)),
        }
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<SettingConfig, E> {
        Ok(SettingConfig(Setting::Known(number)))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<SettingConfig, E> {
        self.visit_f64(number as f64)
    }
}

impl<'de> Deserialize<'de> for SettingConfig {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(SettingVisitor)
    }
}
