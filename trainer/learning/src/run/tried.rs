//! Whether networks that correct a model predict logs better that they have not seen.

use super::choose::{folds, plan_of_fold};
use super::plan::{Plan, PlanError};
use super::stages::NETWORKS;
use crate::config::{Config, ModelConfig};
use crate::data::Dataset;
use std::fmt;

/// Networks whose error is not below this part of that of the model alone are not worth their numbers.
const WORTH: f64 = 0.98;
/// Part of the folds, at least, in which they must be better.
const MOST_FOLDS: f64 = 0.75;

/// What is tried: its name, whether with a dissipation, and whether with a potential.
const CANDIDATES: [(&str, bool, bool); 3] = [
    ("a dissipation network", true, false),
    ("a potential network", false, true),
    ("both networks", true, true),
];

/// How far off positions of held-back logs were with networks beside a model and without.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// Of the model alone, m or rad; none where no log could be held back.
    pub alone: Option<f64>,
    /// With what, and how far off.
    pub errors: Vec<(&'static str, f64)>,
    /// What was kept.
    pub kept: Option<&'static str>,
}

impl fmt::Display for Tried {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Some(alone) = self.alone else {
            return f.write_str("networks that correct the model were not tried: no log could be held back");
        };
        write!(f, "positions of held-back logs are {alone:.2e} off (m, rad) with the model alone")?;
        self.errors.iter().try_for_each(|(name, error)| write!(f, ", {error:.2e} with {name}"))?;
        match self.kept {
            Some(name) => write!(f, ": {name} beside the model"),
            None => f.write_str(": the model alone"),
        }
    }
}

/// Held-back losses, fold by fold.
struct Losses {
    alone: Vec<f64>,
    with: [Option<Vec<f64>>; CANDIDATES.len()],
}

/// The model with what is worth it, and the figures.
///
/// In each fold the model alone is learned first; then every candidate goes on from there, its networks hardly acting at first. What judges are
/// the last numbers, not those that the held-back logs like best: more numbers would have more chances.
///
/// # Errors
/// As [`Plan::new`]; [`PlanError::Networks`] where there are no windows, or the coordinates can have no networks.
pub(super) fn networks(config: &Config, data: &Dataset) -> Result<(ModelConfig, Tried), PlanError> {
    let of = |with: (bool, bool)| -> Result<Config, PlanError> {
        let model = config.model.with_networks(with.0, with.1).ok_or(PlanError::Networks)?;
        Ok(Config { model, ..config.clone() })
    };
    let alone = of((false, false))?;
    let mut losses = Losses { alone: Vec::new(), with: [const { Some(Vec::new()) }; CANDIDATES.len()] };
    let folds = folds(data);
    for fold in 0..folds {
        let plan = plan_of_fold(&alone, data, (fold, folds))?;
        if plan.windows.is_none() {
            return Err(PlanError::Networks);
        }
        let Some((weights, loss)) = last(&plan) else { break };
        losses.alone.push(loss);
        for ((_, dissipation, potential), all) in CANDIDATES.into_iter().zip(&mut losses.with) {
            let own = of((dissipation, potential))?;
            let loss = match plan_of_fold(&own, data, (fold, folds)) {
                Ok(own) => last(&going_on(own, (&plan, &weights))).map(|(_, loss)| loss),
                // As where no coordinate has a position that a potential could see.
                Err(PlanError::Shape(_)) => None,
                Err(error) => return Err(error),
            };
            let all_before = all.take();
            *all = all_before.zip(loss).map(|(mut all, loss)| {
                all.push(loss);
                all
            });
        }
    }
    let tried = losses.judged(folds);
    let kept = CANDIDATES.into_iter().find(|(name, ..)| tried.kept == Some(name));
    let model =
        of(kept.map_or((false, false), |(_, dissipation, potential)| (dissipation, potential)))?.model;
    Ok((model, tried))
}

/// The last numbers that training gives, and their held-back loss.
fn last(plan: &Plan) -> Option<(Vec<f64>, f64)> {
    let state = plan.last_state()?;
    let validation = plan.stages.last()?.validation.as_ref()?;
    let loss = validation.held_back_loss(state.optimiser.weights());
    loss.is_finite().then(|| (state.optimiser.weights().to_vec(), loss))
}

/// The stage of networks alone, from the numbers of the model alone.
fn going_on(mut plan: Plan, (alone, weights): (&Plan, &[f64])) -> Plan {
    plan.stages.retain(|stage| stage.name == NETWORKS);
    let (shared, start) = (alone.calibration().map_or(0, |layout| layout.end()), alone.parameters());
    let mut initial = weights.get(..shared).unwrap_or(weights).to_vec();
    initial.splice(start..start, plan.architecture.corrections.without_effect());
    plan.initial = initial;
    plan
}

impl Losses {
    fn judged(self, folds: usize) -> Tried {
        if folds == 0 || self.alone.len() < folds {
            return Tried { alone: None, errors: Vec::new(), kept: None };
        }
        let error =
            |losses: &[f64]| (losses.iter().map(|loss| loss.ln()).sum::<f64>() / (2.0 * folds as f64)).exp();
        let is_better = |losses: &[f64]| {
            let better = losses.iter().zip(&self.alone).filter(|(with, alone)| with < alone).count();
            better as f64 >= MOST_FOLDS * folds as f64
        };
        let alone = error(&self.alone);
        let found = || {
            let each = CANDIDATES.iter().zip(&self.with);
            each.filter_map(|((name, ..), losses)| Some((*name, losses.as_deref()?)))
        };
        let worth = found().filter(|(_, losses)| error(losses) < WORTH * alone && is_better(losses));
        let kept = worth.min_by(|a, b| error(a.1).total_cmp(&error(b.1))).map(|(name, _)| name);
        Tried {
            alone: Some(alone),
            errors: found().map(|(name, losses)| (name, error(losses))).collect(),
            kept,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ground_truth::robot::{
        Drives, Excitation, Joint, JointFriction, Linkage, Machine, RobotSettings, Sensors, StartSpread,
        robot_logs,
    };
    use std::path::Path;

    /// A pendulum with dry friction.
    fn logs(logs: usize) -> Dataset {
        let joint = Joint { mass: 0.5, length: 0.2, centre: 0.2, inertia: 0.01, rotor: 0.0, gear: 1.0 };
        robot_logs(&RobotSettings {
            machine: Machine::Linkage(Linkage { gravity: 9.81, joints: vec![joint] }),
            friction: vec![JointFriction { viscous: 0.005, coulomb: 0.1, width: 0.2 }],
            sensors: Sensors { noise: 1e-3, ..Sensors::default() },
            drives: Drives { gain: vec![1.0], delay: 0.0, driven: vec![true] },
            excitation: Excitation { sines: 3, frequency: [0.3, 2.5], amplitude: [0.1, 0.5] },
            start: StartSpread::default(),
            logs,
            samples: 151,
            h: 0.01,
            seed: 4,
        })
        .unwrap()
        .measured()
    }

    fn tried(model: &str, data: &Dataset) -> Result<(ModelConfig, Tried), PlanError> {
        let text = format!(
            "[data]\nfile = \"logs.csv\"\n[model]\n{model}\n[training]\nloss = \"windows\"\niterations = 12\ntry_networks = true\n"
        );
        networks(&Config::parse(&text, Path::new("c.toml")).unwrap(), data)
    }

    const BODY: &str = "family = \"bodies\"\nchain = 1";

    #[test]
    fn networks_are_kept_where_something_is_missing_alone() {
        let data = logs(8);
        let viscous = format!(
            "{BODY}\nfriction = {{ viscous = \"learned\" }}\n[model.dissipation]\npositions = []\nscale = 0.3"
        );
        let (model, tried_then) = tried(&viscous, &data).unwrap();
        assert_eq!(tried_then.errors.len(), 3);
        let with = tried_then.errors[0].1;
        assert!(with < 0.5 * tried_then.alone.unwrap(), "{tried_then}");
        let ModelConfig::Bodies(bodies) = model else { panic!("another family") };
        assert!(bodies.dissipation.unwrap().positions == Some(Vec::new()), "{tried_then}");

        let complete = format!("{BODY}\nfriction = {{ viscous = \"learned\", coulomb = \"learned\" }}");
        let (model, tried_then) = tried(&complete, &data).unwrap();
        let ModelConfig::Bodies(bodies) = model else { panic!("another family") };
        assert!(bodies.dissipation.is_none() && bodies.potential.is_none(), "{tried_then}");
        assert!(tried_then.to_string().ends_with(": the model alone"), "{tried_then}");
    }

    #[test]
    fn nothing_is_tried_without_a_log_to_hold_back() {
        let (_, tried) = tried(BODY, &logs(1)).unwrap();
        assert_eq!((tried.alone, tried.kept), (None, None));
    }
}
