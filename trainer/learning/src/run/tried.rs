//! Check whether correcting networks improve the prediction of held-back logs.

use super::held_back::{HeldBack, Learned, Trial};
use super::plan::PlanError;
use crate::config::Config;
use leastaction_models::config::ModelConfig;
use std::fmt;

/// Ratio of the error with networks to the error without, below which networks are worth their additional parameters.
const WORTH: f64 = 0.98;

/// Candidates: name, whether with a dissipation network, whether with a potential network.
const CANDIDATES: [(&str, bool, bool); 3] = [
    ("a dissipation network", true, false),
    ("a potential network", false, true),
    ("both networks", true, true),
];

/// Position errors on held-back logs, with and without correcting networks.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// Error of the model alone, m or rad; `None` if no log could be held back.
    pub alone: Option<f64>,
    /// Candidates with their errors.
    pub errors: Vec<(&'static str, f64)>,
    /// Candidate that was kept.
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

/// The model with the best candidate network if this improves the prediction enough, and the errors. In every fold each
/// candidate continues from the result without networks.
///
/// # Errors
/// See [`Trial::learn`]; [`PlanError::Networks`] if there are no windows, or if the coordinates cannot have networks.
pub(super) fn networks(
    config: &Config,
    trial: &Trial,
    alone: Option<Learned>,
) -> Result<(ModelConfig, Tried), PlanError> {
    let of = |(dissipation, potential): (bool, bool)| -> Result<Config, PlanError> {
        let model = config.model.with_networks(dissipation, potential).ok_or(PlanError::Networks)?;
        Ok(Config { model, ..config.clone() })
    };
    let simple = of((false, false))?.model;
    let Some(alone) = alone else { return Ok((simple, Tried::nothing())) };
    if alone.fits.iter().any(|fit| fit.plan.windows.is_none()) {
        return Err(PlanError::Networks);
    }
    let mut found = Vec::new();
    for (name, dissipation, potential) in CANDIDATES {
        let own = of((dissipation, potential))?;
        match trial.learn(&own, Some(&alone)) {
            Ok(learned) => found.extend(learned.map(|learned| (name, own.model, learned.held_back))),
            // This occurs, for example, if no coordinate has a position that a potential could depend on.
            Err(PlanError::Shape(_)) => {}
            Err(error) => return Err(error),
        }
    }
    let alone = alone.held_back;
    let errors = found.iter().map(|(name, _, held_back)| (*name, held_back.error())).collect();
    let is_worth = |own: &HeldBack| own.error() < WORTH * alone.error() && own.is_less_than(&alone);
    let worth = found.into_iter().filter(|(.., held_back)| is_worth(held_back));
    let best = worth.min_by(|a, b| a.2.error().total_cmp(&b.2.error()));
    let tried = Tried { alone: Some(alone.error()), errors, kept: best.as_ref().map(|(name, ..)| *name) };
    Ok((best.map_or(simple, |(_, model, _)| model), tried))
}

impl Tried {
    /// The result if no log can be held back.
    fn nothing() -> Self {
        Self { alone: None, errors: Vec::new(), kept: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Dataset;
    use crate::run::robots::pendulums;
    use std::path::Path;

    fn tried(model: &str, data: &Dataset) -> Result<(ModelConfig, Tried), PlanError> {
        let text = format!(
            "[data]\nfile = \"logs.csv\"\n[model]\n{model}\n[training]\nloss = \"windows\"\niterations = 12\ntry_networks = true\n"
        );
        let config = Config::parse(&text, Path::new("c.toml")).unwrap();
        let trial = Trial::new(&config, data);
        let alone = Config { model: config.model.with_networks(false, false).unwrap(), ..config.clone() };
        let learned = trial.learn(&alone, None)?;
        networks(&config, &trial, learned)
    }

    const BODY: &str = "family = \"bodies\"\nchain = 1";

    #[test]
    fn networks_are_kept_where_something_is_missing_alone() {
        let data = pendulums(8);
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
        let (_, tried) = tried(BODY, &pendulums(1)).unwrap();
        assert_eq!((tried.alone, tried.kept), (None, None));
    }
}
