//! `[model.dissipation]` and `[model.potential]`: networks that correct a model of any family whose coordinates allow it.

use crate::config::fields;
use crate::config::parts::Range;
use crate::config::place::{ShapeError, Step};
use crate::config::problem::Problem;
use crate::laws::corrections::{CorrectionNetwork, Corrections, DissipationNetwork};
use crate::limits::MAX_COORDINATES;
use leastaction_core::network::Activation;
use serde::de::{Deserializer, Error};
use serde::{Deserialize, Serialize};

/// The network of a dissipation, Q = −L(q, v)Lᵀv.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DissipationConfig {
    /// Coordinates that are inputs of the network and on which its force acts, counted from 0. (Default: all.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coordinates: Option<Vec<u64>>,
    /// Coordinates, among those above, whose positions are inputs too. (Default: all of them.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub positions: Option<Vec<u64>>,
    /// Velocity scale > 0, m/s or rad/s, by which the network divides velocities: the speed over which friction changes; one number, or one
    /// per input coordinate. (Default: 1.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<ScaleConfig>,
    /// Numbers of units in the hidden layers. (Default: 8.)
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_widths")]
    pub hidden: Option<Vec<u16>>,
    /// Activation of the hidden layers. (Default: tanh.)
    #[serde(default, skip_serializing_if = "Option::is_none", with = "fields::activation_name")]
    pub activation: Option<Activation>,
}

/// The network of a potential V_c(q) that is added to that of the model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PotentialConfig {
    /// Coordinates that are inputs of the network, from 0. (Default: all that are not cyclic.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coordinates: Option<Vec<u64>>,
    /// Numbers of units in the hidden layers. (Default: 8.)
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_widths")]
    pub hidden: Option<Vec<u16>>,
    /// Activation of the hidden layers. (Default: tanh.)
    #[serde(default, skip_serializing_if = "Option::is_none", with = "fields::activation_name")]
    pub activation: Option<Activation>,
}

/// Scales of velocities.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a number above 0, or a list of them")]
pub enum ScaleConfig {
    /// One scale for all coordinates.
    All(f64),
    /// One scale per input coordinate of the network.
    Each(Vec<f64>),
}

/// Default number of units in the hidden layer of a network.
const WIDTH: u16 = 8;

/// Kinds of the coordinates that may be inputs of networks, one letter each, and how many of these coordinates every
/// tree of the model has.
pub(crate) struct Known<'k> {
    pub letters: &'k str,
    pub common: usize,
}

/// Returns the networks of a model with these coordinates.
///
/// # Errors
/// [`ShapeError`]: a coordinate that does not exist, is given twice or is not allowed, a scale out of its range, or a wrong number of
/// scales.
pub(crate) fn assemble(
    dissipation: Option<&DissipationConfig>,
    potential: Option<&PotentialConfig>,
    known: &Known,
) -> Result<Corrections, ShapeError> {
    Ok(Corrections {
        dissipation: dissipation.map(|config| config.assemble(known)).transpose()?,
        potential: potential.map(|config| config.assemble(known)).transpose()?,
    })
}

impl DissipationConfig {
    fn assemble(&self, known: &Known) -> Result<DissipationNetwork, ShapeError> {
        const TABLE: &str = "dissipation";
        let all: Vec<usize> = (0..known.common).collect();
        let seen = self.coordinates.as_ref().map_or(Ok(all), |given| {
            known.chosen(given).map_err(|problem| at(TABLE, "coordinates", problem))
        })?;
        let positions = self.positions.as_ref().map_or(Ok(seen.clone()), |given| {
            let places = known.chosen_if_any(given).and_then(|places| within(places, &seen));
            places.map_err(|problem| at(TABLE, "positions", problem))
        })?;
        check_count(&seen).map_err(|problem| at(TABLE, "coordinates", problem))?;
        let letter = |i: usize| if positions.contains(&i) { known.letter(i) } else { 'c' };
        let network = network(&seen, letter, self.hidden.as_ref(), self.activation);
        let scales = self.scales(seen.len()).map_err(|problem| at(TABLE, "scale", problem))?;
        Ok(DissipationNetwork { network, scales })
    }

    fn scales(&self, needed: usize) -> Result<Vec<f64>, Problem> {
        const KEY: &str = "scale";
        let scales = match &self.scale {
            None => vec![1.0; needed],
            Some(ScaleConfig::All(scale)) => vec![*scale; needed],
            Some(ScaleConfig::Each(each)) => each.clone(),
        };
        if scales.len() != needed {
            let (found, what) = (scales.len(), "coordinate of the network");
            return Err(Problem::GroupCount { key: KEY, found, needed, what });
        }
        let checked = scales.iter().map(|scale| Range::ABOVE.number(KEY, *scale, false));
        checked.map(|number| number.map(|number| number.value)).collect()
    }
}

impl PotentialConfig {
    fn assemble(&self, known: &Known) -> Result<CorrectionNetwork, ShapeError> {
        const TABLE: &str = "potential";
        let is_cyclic = |i: &usize| known.letter(*i) == 'c';
        let all: Vec<usize> = (0..known.common).filter(|i| !is_cyclic(i)).collect();
        let seen = match &self.coordinates {
            None if all.is_empty() => Err(Problem::NothingSeen),
            None => Ok(all),
            Some(given) => known.chosen(given),
        };
        let wrong = |problem| at(TABLE, "coordinates", problem);
        let seen = seen.map_err(wrong)?;
        if let Some(coordinate) = seen.iter().copied().find(is_cyclic) {
            return Err(wrong(Problem::Cyclic { coordinate }));
        }
        check_count(&seen).map_err(wrong)?;
        Ok(network(&seen, |i| known.letter(i), self.hidden.as_ref(), self.activation))
    }
}

impl Known<'_> {
    fn letter(&self, i: usize) -> char {
        self.letters.chars().nth(i).unwrap_or('c')
    }

    /// Returns the coordinates with these numbers, in order; there must be at least one.
    fn chosen(&self, given: &[u64]) -> Result<Vec<usize>, Problem> {
        if given.is_empty() { Err(Problem::NothingSeen) } else { self.chosen_if_any(given) }
    }

    fn chosen_if_any(&self, given: &[u64]) -> Result<Vec<usize>, Problem> {
        let mut chosen = Vec::new();
        for number in given {
            let i = usize::try_from(*number).ok().filter(|i| *i < self.common);
            let i = i.ok_or(Problem::NoCoordinate { coordinate: *number, coordinates: self.common })?;
            if chosen.contains(&i) {
                return Err(Problem::CoordinateTwice { coordinate: i });
            }
            chosen.push(i);
        }
        chosen.sort_unstable();
        Ok(chosen)
    }
}

/// Refuses positions of coordinates that are no inputs of the network.
fn within(places: Vec<usize>, seen: &[usize]) -> Result<Vec<usize>, Problem> {
    match places.iter().find(|place| !seen.contains(place)) {
        Some(coordinate) => Err(Problem::Unseen { coordinate: *coordinate }),
        None => Ok(places),
    }
}

/// Refuses more coordinates than a model file allows for a network.
fn check_count(seen: &[usize]) -> Result<(), Problem> {
    let (what, found, most) = ("coordinates of a network", seen.len(), MAX_COORDINATES);
    if found <= most { Ok(()) } else { Err(Problem::TooMany { what, found, most }) }
}

fn network(
    seen: &[usize],
    letter: impl Fn(usize) -> char,
    hidden: Option<&Vec<u16>>,
    activation: Option<Activation>,
) -> CorrectionNetwork {
    let end = seen.last().map_or(0, |last| last + 1);
    CorrectionNetwork {
        coordinates: (0..end).map(|i| if seen.contains(&i) { letter(i) } else { '-' }).collect(),
        widths: hidden.cloned().unwrap_or_else(|| vec![WIDTH]),
        activation: activation.unwrap_or(Activation::Tanh),
    }
}

fn at(table: &str, key: &str, problem: Problem) -> ShapeError {
    ShapeError { place: ["model", table, key].map(Step::from).into(), problem }
}

/// `dissipation` or `potential` of a family whose coordinates allow no such networks; reading it gives the error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct NoCorrections;

impl<'de> Deserialize<'de> for NoCorrections {
    fn deserialize<D: Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        Err(D::Error::custom(
            "a graph has no networks of its coordinates; give its node types `drag_network` or `potential`",
        ))
    }
}
