//! What a log of torques says alone of an arm's base parameters and friction, beside what the model has.

use crate::data::Dataset;
use crate::torque::Samples;
use crate::torque::fit::{Alone, Arm, Bodies, FitError, JointNumber, JointNumbers, Learned, alone};
use crate::torques::{arm, samples};
use crate::windows::{Certainty, LearnedNumber, Shown};
use leastaction_models::{Actuator, Architecture, ArmArchitecture, Family, Model, NumberName};
use serde::Serialize;
use std::fmt;

/// Estimates without a prior ([`crate::torque::fit::alone`]) beside the numbers of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueNumbers {
    /// Of the independent parameter of every base parameter, and of every number of friction.
    pub names: Vec<NumberName>,
    /// What a base parameter is the sum of beside the parameter of its name: factors and their names.
    pub combinations: Vec<Vec<(f64, String)>>,
    /// The model's.
    pub model: Vec<f64>,
    /// By the log alone, positions being those in `names`.
    pub certainty: Certainty,
}

/// One of them in JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TorqueNumber {
    /// Of the number.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Factors and names of what else it is the sum of.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub plus: Vec<(f64, String)>,
    /// The model's.
    pub model: f64,
    /// By the log alone; none where the log does not show it.
    pub by_log: Option<f64>,
    /// Of `by_log`; none too where it ended at an end of its range.
    pub standard_error: Option<f64>,
    /// Half of the 95% interval around `by_log`.
    pub interval: Option<f64>,
    /// The number that its error hangs together with most.
    pub correlated_with: Option<String>,
    /// Their correlation.
    pub correlation: Option<f64>,
}

/// Estimates of a model's numbers by logs that are filtered at so many Hz: of all bodies, rotors and friction that it has, and of the offsets of its drives;
/// `None` of another family, of an arm with networks, and where [`crate::torques::torque_errors`] has none either.
pub fn torque_numbers(model: &Model, data: &Dataset, cut_off: f64) -> Option<TorqueNumbers> {
    let architecture = &model.architecture;
    let (family, arm) = (architecture.family.arm()?, arm(model)?);
    let samples = samples(&data.trajectories, (data.h, data.control_kind()), &drives(model), cut_off).ok()?;
    let friction = &architecture.friction;
    let (viscous, dry) = (!friction.viscous.is_empty(), !friction.dry.is_empty());
    let load = arm.joints.iter().any(|joint| joint.load > 0.0);
    let smoothing = |(i, joint): (usize, &JointNumbers)| (i, JointNumber::Smoothing, joint.smoothing);
    let held = arm.joints.iter().enumerate().map(smoothing).collect();
    let learned = Learned { bodies: Bodies::Free, viscous, coulomb: dry, load, held, ..Learned::default() };
    TorqueNumbers::of((architecture, family), &arm, (&samples, &learned)).ok()
}

/// The model's actuator without its offsets, which are estimated.
fn drives(model: &Model) -> Actuator {
    Actuator { offset: Vec::new(), ..model.facts.actuator.clone() }
}

impl TorqueNumbers {
    /// Of an arm by these samples; `learned` says what is not known.
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
                clusters: found.blocks,
                whole_logs: false,
            },
        })
    }

    /// Of the numbers their names, whose base parameters are said to be sums.
    pub fn full_names(&self) -> impl Iterator<Item = NumberName> {
        let full = |(k, own): (usize, &NumberName)| {
            let is_sum = self.combinations.get(k).is_some_and(|of| !of.is_empty());
            let name = if is_sum { format!("{} and what adds to it", own.name) } else { own.name.clone() };
            NumberName { name, unit: own.unit }
        };
        self.names.iter().enumerate().map(full)
    }

    /// For JSON.
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

/// Where a column of the regressor stands in the weight block.
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

/// Names, and the signs that turn the fit's numbers into those of a model: what a drive adds is what the log has less.
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
    let (start, n) = (architecture.friction_start(), family.n());
    let dry = |i: usize, place: usize| {
        let viscous = if architecture.friction.viscous.is_empty() { 0 } else { n };
        of(start + viscous + 4 * i + place)
    };
    let joint = |(i, number): &(usize, JointNumber)| match number {
        JointNumber::Rotor => of(ArmArchitecture::rotor_position(*i)),
        JointNumber::Viscous => of(start + i),
        JointNumber::Coulomb => dry(*i, 0),
        JointNumber::Load => dry(*i, 1),
        JointNumber::Smoothing => dry(*i, 2),
        JointNumber::Width => dry(*i, 3),
        JointNumber::Offset => {
            let unit = if letters.as_bytes().get(*i) == Some(&b't') { "N" } else { "N m" };
            (NumberName { name: format!("coordinate {i}: offset of the actuator"), unit }, -1.0)
        }
    };
    let base = found.base.independent.iter().map(|column| of(position(family, *column)));
    base.chain(found.joints.iter().map(joint)).unzip()
}

/// Factors below this are rounding errors of 0.
const NOTHING: f64 = 1e-9;

fn combinations(
    (architecture, family): (&Architecture, &ArmArchitecture),
    found: &Alone,
) -> Vec<Vec<(f64, String)>> {
    let all = architecture.number_names();
    let name = |column: usize| all.get(position(family, column)).cloned().flatten().map(|of| of.name);
    let of = |(row, own): (usize, &usize)| {
        let factors = found.base.combination.row(row).iter().copied().enumerate();
        let others = factors.filter(|(column, factor)| column != own && factor.abs() > NOTHING);
        others.filter_map(|(column, factor)| Some((factor, name(column)?))).collect()
    };
    found.base.independent.iter().enumerate().map(of).collect()
}
