//! Conversion of a configuration into the shape of a model.

use super::assembled::Assembled;
use super::assembly::Assembly;
use super::source::Source;
use super::{ModularConfig, Problem, ShapeError};
use crate::architecture::Architecture;
use crate::config::checks::list;
use crate::config::family::{FamilyConfig, NetworksBeside, Source as Begins};
use crate::config::origin::Open;
use crate::family::Family;
use crate::laws::corrections::config::{Known, assemble};
use crate::laws::group::GroupLaws;
use crate::laws::stops::StopsConfig;
use std::path::PathBuf;

impl FamilyConfig for ModularConfig {
    fn defaults() -> &'static str {
        include_str!("../config.toml")
    }

    fn files(&mut self) -> Vec<&mut PathBuf> {
        self.from.iter_mut().collect()
    }

    fn networks(&mut self) -> Option<NetworksBeside<'_>> {
        Some((&mut self.dissipation, &mut self.potential))
    }

    fn source(&self) -> Begins {
        if self.from.is_some() { Begins::Weights } else { Begins::Nothing }
    }

    fn architecture(&self, open: Open) -> Result<Architecture, ShapeError> {
        self.assemble(open).map(Into::into)
    }

    fn beginning(&self, seed: u64, open: Open) -> Result<(Architecture, Vec<f64>), ShapeError> {
        Ok(self.assemble(open)?.beginning(seed))
    }
}

impl ModularConfig {
    /// Returns the model with these types and trees; reads the one to continue from, if any.
    ///
    /// # Errors
    /// [`ShapeError`]: what is invalid, and where.
    pub fn assemble(&self, open: Open) -> Result<Assembled, ShapeError> {
        let mut model = match &self.from {
            None => Assembly::new(),
            Some(file) => {
                Assembly::of(&Source::read(file, open).map_err(|problem| problem.at(["from".into()]))?)
            }
        };
        for (i, kind) in self.types.iter().enumerate() {
            let twice = self.types.iter().take(i).any(|other| other.name == kind.name);
            model.add_type(i, kind, twice)?;
        }
        if model.types.is_empty() {
            return Err(Problem::NoTypes.at([]));
        }
        if let Some(pair) = &self.pair {
            model.add_pair(pair).map_err(|problem| problem.at(["pair".into()]))?;
        }
        for (name, elements) in &self.trees {
            model.add_tree(name, elements)?;
        }
        let damped = self
            .types
            .iter()
            .filter_map(|kind| kind.damping)
            .any(|damping| damping.learned || damping.value != 0.0);
        self.friction.check_damping("damping", damped)?;
        if !self.friction.is_none() {
            model.take_friction(self.friction.assemble(model.types.len(), "element type")?);
        }
        let groups = (model.types.len(), "element type");
        let stops = StopsConfig::assemble(self.stops.as_ref(), groups, None, GroupLaws::default())?;
        model.take_stops(stops);
        let chosen = self.chosen(&model).map_err(|problem| problem.at(["tree".into()]))?;
        model.trees.swap(0, chosen);
        model.check()?;
        let mut assembled = model.finish();
        self.correct(&mut assembled)?;
        Ok(assembled)
    }

    /// Adds the networks that are given, replacing trained ones.
    fn correct(&self, assembled: &mut Assembled) -> Result<(), ShapeError> {
        let architecture = &assembled.architecture;
        let (letters, common) = (architecture.coordinates(), architecture.header().fewest_coordinates());
        let known = Known { letters: &letters, common };
        let given = assemble(self.dissipation.as_ref(), self.potential.as_ref(), &known)?;
        let [dissipation, potential] = &mut assembled.trained_corrections;
        if given.dissipation.is_some() {
            (assembled.corrections.dissipation, *dissipation) = (given.dissipation, Vec::new());
        }
        if given.potential.is_some() {
            (assembled.corrections.potential, *potential) = (given.potential, Vec::new());
        }
        match assembled.corrections.networks().map(|network| network.coordinates.len()).max() {
            Some(needed) if needed > common => {
                let coordinate = needed as u64 - 1;
                Err(Problem::NoCoordinate { coordinate, coordinates: common }.at(["trees".into()]))
            }
            _ => Ok(()),
        }
    }

    /// Position of the tree that is trained.
    fn chosen(&self, model: &Assembly) -> Result<usize, Problem> {
        let known = || list(model.trees.iter().map(|tree| tree.name.as_str()));
        let position = |name: &str| model.trees.iter().position(|tree| tree.name == name);
        let only = if self.trees.len() == 1 { self.trees.keys().next() } else { None };
        match self.tree.as_ref().or(only) {
            Some(name) => {
                position(name).ok_or_else(|| Problem::UnknownTree { name: name.clone(), known: known() })
            }
            None if model.trees.is_empty() => Err(Problem::NoTree),
            // The first tree of a trained model is the one on which it was trained.
            None if self.trees.is_empty() => Ok(0),
            None => Err(Problem::WhichTree { known: known() }),
        }
    }
}
