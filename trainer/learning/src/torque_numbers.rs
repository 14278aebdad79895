//! Estimates of an arm's base parameters and friction from a torque log alone, beside the model's values.

use crate::data::Dataset;
use crate::torque::Samples;
use crate::torque::fit::{Alone, Arm, Bodies, FitError, JointNumber, JointNumbers, Learned, alone};
use crate::torques::{Driven, arm, samples};
use crate::windows::{Certainty, LearnedNumber, Shown};
use leastaction_models::{Actuator, Architecture, ArmArchitecture, Family, LawEntry, Model, NumberName};
use serde::Serialize;
use std::fmt;

/// Estimates without a prior ([`crate::torque::fit::alone`]), beside the numbers of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueNumbers {
    /// Names of the base parameters (each named after its independent parameter), then of the friction numbers.
    pub names: Vec<NumberName>,
    /// Further terms of every base parameter besides its independent parameter: factors and names of parameters.
    pub combinations: Vec<Vec<(f64, String)>>,
    /// The model's values.
    pub model: Vec<f64>,
    /// Estimates from the log alone; positions index `names`.
    pub certainty: Certainty,
}

/// A number as JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TorqueNumber {
    /// Name of the number.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Further terms of the sum: factors and parameter names.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub plus: Vec<(f64, String)>,
    /// The model's value.
    pub model: f64,
    /// Estimate from the log alone; `None` if the log does not show the number.
    pub by_log: Option<f64>,
    /// Standard error of `by_log`; `None` also if the estimate is at an end of its range.
    pub standard_error: Option<f64>,
    /// Half-width of the 95% interval around `by_log`.
    pub interval: Option<f64>,
    /// Name of the number with the strongest error correlation.
    pub correlated_with: Option<String>,
    /// This correlation.
    pub correlation: Option<f64>,
}

/// Estimates a model's numbers from logs filtered at `cut_off` (Hz): all bodies, rotors and friction of the model, and
/// the offsets of its drives. `None` for another family, for an arm with networks, and if
/// [`crate::torques::torque_errors`] returns `None`.
pub fn torque_numbers(model: &Model, data: &Dataset, cut_off: f64) -> Option<TorqueNumbers> {
    let architecture = &model.architecture;
    let (family, arm) = (architecture.family.arm()?, arm(model)?);
    let driven = Driven { actuator: drives(model), ..Driven::of(model) };
    let samples = samples(&data.trajectories, (data.h, data.control_kind()), &driven, cut_off).ok()?;
    let load = arm.joints.iter().any(|joint| joint.load > 0.0);
    let smoothing = |(i, joint): (usize, &JointNumbers)| (i, JointNumber::Smoothing, joint.smoothing);
    let held = arm.joints.iter().enumerate().map(smoothing).collect();
    let learned = Learned { bodies: Bodies::Free, load, held, ..Learned::friction_of(architecture) };
    TorqueNumbers::of((architecture, family), &arm, (&samples, &learned)).ok()
}

/// The model's actuator without its offsets, which are estimated.
fn drives(model: &Model) -> Actuator {
    Actuator { offset: Vec::new(), ..model.facts.actuator.clone() }
}

impl TorqueNumbers {
    /// The estimates for an arm from these samples; `learned` selects the numbers that are estimated.
    ///
    /// # Errors
    /// [`FitError`].
    pub(crate) fn of(
        (architecture, family): (&Architecture, &ArmArchitecture),
        arm: &Arm,
        (samples, learned): (&Samples, &Learned),
    ) -> Result<Self, FitError> {
        let found = alone(&arm.tree, samples, learned)?;
        let (names, signs) = names((architecture, family), &found);
        let own = found.of_model(&arm.tree.parameters(), &arm.joints);
        let number = |(position, estimate): (usize, &crate::torque::fit::Estimate)| LearnedNumber {
            position,
            value: signs[position] * estimate.value,
            shown: estimate.shown,
            strongest: estimate.strongest.map(|(other, part)| (other, signs[position] * signs[other] * part)),
        };
        Ok(Self {
            names,
            combinations: combinations((architecture, family), &found),
            model: own.iter().zip(&signs).map(|(own, sign)| sign * own).collect(),
            certainty: Certainty {
                numbers: found.estimates.iter().enumerate().map(number).collect(),
                hidden: found.hidden,
                combinations: Vec::new(),
                clusters: found.blocks,
                whole_logs: false,
            },
        })
    }

    /// Names of the numbers; a base parameter with further terms is marked as a sum.
    pub fn full_names(&self) -> impl Iterator<Item = NumberName> {
        let full = |(k, own): (usize, &NumberName)| {
            let is_sum = self.combinations.get(k).is_some_and(|of| !of.is_empty());
            let name = if is_sum { format!("{} and what adds to it", own.name) } else { own.name.clone() };
            NumberName { name, unit: own.unit }
        };
        self.names.iter().enumerate().map(full)
    }

    /// The numbers as rows for JSON.
    pub fn rows(&self) -> Vec<TorqueNumber> {
        let row = |(own, (name, model)): (&LearnedNumber, (&NumberName, &f64))| {
            let standard_error = match own.shown {
                Shown::Within(error) => Some(error),
                _ => None,
            };
            let strongest = own.strongest.filter(|_| standard_error.is_some());
            TorqueNumber {
                name: name.name.clone(),
                unit: name.unit,
                plus: self.combinations.get(own.position).cloned().unwrap_or_default(),
                model: *model,
                by_log: (own.shown != Shown::Together).then_some(own.value),
                standard_error,
                interval: standard_error.map(|error| self.certainty.interval() * error),
                correlated_with: strongest.map(|(other, _)| self.names[other].name.clone()),
                correlation: strongest.map(|(_, part)| part),
            }
        };
        self.certainty.numbers.iter().zip(self.names.iter().zip(&self.model)).map(row).collect()
    }
}

impl fmt::Display for TorqueNumbers {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let interval = self.certainty.interval();
        writeln!(
            f,
            "by the log alone, without the prior, ± a standard error ({interval:.2} of them make a 95% interval), and in the model:"
        )?;
        let width = self.full_names().map(|name| name.name.chars().count()).max().unwrap_or(0);
        for ((own, name), model) in self.certainty.numbers.iter().zip(self.full_names()).zip(&self.model) {
            let NumberName { name, unit } = name;
            let shown = match own.shown {
                Shown::Within(error) => format!("{:>10.4} ± {error:<9.4}", own.value),
                Shown::Together => format!("{:>22}", "not shown"),
                Shown::AtBound => format!("{:>10.4} {:<11}", own.value, "at its end"),
            };
            writeln!(f, "  {name:width$} {shown} {model:>10.4} {unit}")?;
        }
        Ok(())
    }
}

/// Position in the weight block of a column of the regressor.
fn position(family: &ArmArchitecture, column: usize) -> usize {
    let bodies = leastaction_models::tree::INERTIAL * family.n();
    match column.checked_sub(bodies) {
        Some(rotor) => ArmArchitecture::rotor_position(rotor),
        None => {
            ArmArchitecture::inertia_position(column / leastaction_models::tree::INERTIAL)
                + column % leastaction_models::tree::INERTIAL
        }
    }
}

/// Names of the numbers, and the signs that turn the fit's numbers into the model's: an offset that the drive adds is
/// missing from the log, so its sign is reversed.
fn names(
    (architecture, family): (&Architecture, &ArmArchitecture),
    found: &Alone,
) -> (Vec<NumberName>, Vec<f64>) {
    let all = architecture.number_names();
    let letters = architecture.coordinates();
    let of = |position: usize| {
        let unknown = || NumberName { name: format!("number {position}"), unit: "" };
        (all.get(position).cloned().flatten().unwrap_or_else(unknown), 1.0)
    };
    let entries: Vec<LawEntry> = architecture.law_entries().collect();
    let of_law = |i: usize, number: JointNumber| {
        let own = entries.iter().filter(|of| of.group == i && JointNumber::of(of.kind) == Some(number));
        // Among laws with the same part, the one that is learned or acts.
        let acts = |of: &&LawEntry| of.number.learned || of.number.value != 0.0;
        own.clone().find(acts).or(own.clone().next()).map_or(usize::MAX, |entry| entry.position)
    };
    let joint = |(i, number): &(usize, JointNumber)| match number {
        JointNumber::Rotor => of(ArmArchitecture::rotor_position(*i)),
        JointNumber::Offset => {
            let unit = if letters.as_bytes().get(*i) == Some(&b't') { "N" } else { "N m" };
            (NumberName { name: format!("coordinate {i}: offset of the actuator"), unit }, -1.0)
        }
        _ => of(of_law(*i, *number)),
    };
    let base = found.base.independent.iter().map(|column| of(position(family, *column)));
    base.chain(found.joints.iter().map(joint)).unzip()
}

/// Size below which factors are rounding errors of 0.
const NOTHING: f64 = 1e-9;

fn combinations(
    (architecture, family): (&Architecture, &ArmArchitecture),
    found: &Alone,
) -> Vec<Vec<(f64, String)>> {
    let all = architecture.number_names();
    let name = |column: usize| all.get(position(family, column)).cloned().flatten().map(|of| of.name);
    let of = |(row, own): (usize, &usize)| {
        let row = found.base.combination.row(row);
        let factors = row.iter().copied().enumerate();
        let others = factors.filter(|(column, factor)| column != own && factor.abs() > NOTHING);
        others.filter_map(|(column, factor)| Some((factor, name(column)?))).collect()
    };
    found.base.independent.iter().enumerate().map(of).collect()
}
