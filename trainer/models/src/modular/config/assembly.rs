//! A modular model under construction: types, pair potential and trees are added one by one.

use super::assembled::Assembled;
use super::numbers::DEFAULTS;
use super::source::Source;
use super::{ElementConfig, PairConfig, Problem, ShapeError, TransformKind, TypeConfig};
use crate::config::checks::{check_count, check_name, list};
use crate::config::parts::Networks;
use crate::laws::corrections::Corrections;
use crate::laws::group::GroupLaws;
use crate::limits::MAX_TREE_COORDINATES;
use crate::modular::{ModularArchitecture, NamedTree, NamedType};
use crate::number::Number;
use leastaction_core::energy::List;
use leastaction_core::energy::modular::{
    Input, MAX_NETWORKS, MAX_TYPES, ModularShape, PairInput, PairShape, SPACE, TransformShape, TypeShape,
};
use leastaction_core::model::MAX_TREES;
use leastaction_core::network::Activation;

/// Default number of units in the hidden layer of a network.
const WIDTH: u16 = 16;
/// Maximum number of coordinates of any tree in a model file.
const MOST_COORDINATES: usize = 64;

/// A model under construction.
#[derive(Default)]
pub(super) struct Assembly {
    networks: Networks,
    pub types: Vec<(TypeShape, NamedType)>,
    pair: Option<PairShape>,
    coefficients: Option<[Number; 2]>,
    /// Whether damping belongs to the types.
    damped: bool,
    group_laws: GroupLaws,
    corrections: Corrections,
    trained_corrections: [Vec<f64>; 2],
    pub trees: Vec<NamedTree>,
    /// Number of types that come from a trained model; they come first.
    old: usize,
    trained: Vec<f64>,
}

impl Assembly {
    /// An empty model, whose damping belongs to the types.
    pub fn new() -> Self {
        Self { damped: true, ..Self::default() }
    }

    /// A trained model, to which types and trees are added.
    pub fn of(source: &Source) -> Self {
        let Source { architecture, group_laws, corrections, networks, weights } = source;
        let shape = &architecture.shape;
        let types: Vec<_> = shape.types.iter().copied().zip(architecture.types.iter().cloned()).collect();
        let mut trees = architecture.trees.clone();
        if architecture.tree < trees.len() {
            trees.swap(0, architecture.tree);
        }
        Self {
            networks: Networks(shape.networks.iter().copied().collect()),
            old: types.len(),
            types,
            pair: shape.pair,
            coefficients: Some(architecture.coefficients),
            damped: architecture.damped,
            group_laws: group_laws.clone(),
            corrections: corrections.clone(),
            trained_corrections: corrections.split(networks).map(<[f64]>::to_vec),
            trees,
            trained: weights.get(..architecture.numbers_start()).unwrap_or_default().to_vec(),
        }
    }

    /// Replaces the old friction by the given one; if viscous damping is given here, it no longer belongs to the types.
    pub fn take_friction(&mut self, friction: GroupLaws) {
        self.damped &= !friction.damps();
        self.group_laws.take_friction(friction);
    }

    /// Replaces the old stops by the given ones, if there are any.
    pub fn take_stops(&mut self, given: GroupLaws) {
        if !given.stops.is_empty() {
            self.group_laws.stops = given.stops;
        }
    }

    fn kind(&self, name: &str) -> Option<usize> {
        self.types.iter().position(|(_, named)| named.name == name)
    }

    pub fn add_type(&mut self, i: usize, kind: &TypeConfig, twice: bool) -> Result<(), ShapeError> {
        let at = |key: &str, problem: Problem| problem.at(["types".into(), i.into(), key.into()]);
        let name = || kind.name.clone();
        check_name(&kind.name).map_err(|problem| at("name", problem))?;
        if twice {
            return Err(at("name", Problem::Twice { name: name() }));
        }
        if let Some(old) = self.kind(&kind.name).filter(|old| *old < self.old) {
            if let Some(key) = kind.shape_keys().find_map(|(key, given)| given.then_some(key)) {
                return Err(at(key, Problem::Trained { key, name: name() }));
            }
            let (shape, named) = &mut self.types[old];
            let numbers = kind.numbers(transform_of(shape), named.numbers);
            named.numbers = numbers.map_err(|(key, problem)| at(key, problem))?;
            return Ok(());
        }
        let transform = kind.transform.ok_or_else(|| at("name", Problem::NoTransform { name: name() }))?;
        let learned = transform.input().is_some();
        let networks = [("position", kind.position.is_some()), ("velocity", kind.velocity.is_some())];
        if let Some((key, _)) = networks.into_iter().find(|(_, given)| *given && !learned) {
            return Err(at(key, Problem::Meaningless { key, transform: transform.name() }));
        }
        let numbers = kind.numbers(transform, DEFAULTS).map_err(|(key, problem)| at(key, problem))?;
        let shape = self.type_shape(kind, transform);
        self.types.push((shape, NamedType { name: name(), numbers }));
        Ok(())
    }

    fn type_shape(&mut self, kind: &TypeConfig, transform: TransformKind) -> TypeShape {
        let activation = kind.activation.unwrap_or(Activation::Tanh);
        let mut network =
            |widths: &[u16], inputs, outputs| self.networks.add(widths, (inputs, outputs), activation);
        let default = [WIDTH];
        let transform = match (transform, transform.input()) {
            (_, Some(input)) => {
                let inputs = input.features();
                let position = network(kind.position.as_deref().unwrap_or(&default), inputs, SPACE);
                let velocity = kind.velocity.as_ref().map(|widths| network(widths, inputs, SPACE));
                TransformShape::Network { position, velocity, input }
            }
            (TransformKind::Slide, None) => TransformShape::Slide,
            (TransformKind::Free, None) => TransformShape::Free,
            (_, None) => TransformShape::Rod,
        };
        TypeShape { transform, potential: kind.potential.as_ref().map(|widths| network(widths, SPACE, 1)) }
    }

    pub fn add_pair(&mut self, pair: &PairConfig) -> Result<(), Problem> {
        if self.pair.is_some() {
            return Err(Problem::Pair);
        }
        let input = PairInput::from(pair.input);
        let widths = pair.hidden.clone().unwrap_or_else(|| vec![WIDTH]);
        let activation = pair.activation.unwrap_or(Activation::Tanh);
        let network = self.networks.add(&widths, (input.features(), 1), activation);
        self.pair = Some(PairShape { network, input });
        Ok(())
    }

    pub fn add_tree(&mut self, name: &str, elements: &[ElementConfig]) -> Result<(), ShapeError> {
        let at = |problem: Problem| problem.at(["trees".into(), name.into()]);
        check_name(name).map_err(at)?;
        if elements.is_empty() {
            return Err(at(Problem::EmptyTree));
        }
        let mut bytes = Vec::new();
        let mut coordinates = 0;
        for (e, element) in elements.iter().enumerate() {
            let here = |problem: Problem| problem.at(["trees".into(), name.into(), e.into()]);
            let (kind, parent) = self.element(e, element).map_err(here)?;
            coordinates += self.types[kind].0.coordinates();
            if coordinates > MOST_COORDINATES {
                let (found, most) = (coordinates, MOST_COORDINATES);
                return Err(here(Problem::TooMany { what: "coordinates in a tree", found, most }));
            }
            // Both casts are safe: more types than a byte can hold are refused, and each element has a coordinate.
            bytes.extend([kind as u8, parent as u8]);
        }
        let tree = NamedTree { name: name.to_owned(), elements: bytes };
        match self.trees.iter_mut().find(|tree| tree.name == name) {
            Some(old) => *old = tree,
            None => self.trees.push(tree),
        }
        Ok(())
    }

    /// Returns the type of an element, and its parent: 0 for the ground, or 1 + the number of the element from which it
    /// hangs.
    fn element(&self, e: usize, element: &ElementConfig) -> Result<(usize, usize), Problem> {
        let kind = |name: &String| {
            let known = || list(self.types.iter().map(|(_, named)| named.name.as_str()));
            let what = "element type";
            self.kind(name).ok_or_else(|| Problem::UnknownType { what, name: name.clone(), known: known() })
        };
        match element {
            ElementConfig::Next(name) => {
                let kind = kind(name)?;
                let free = self.types[kind].0.transform == TransformShape::Free;
                Ok((kind, if free { 0 } else { e }))
            }
            ElementConfig::On { kind: name, on } => match *on {
                None => Ok((kind(name)?, 0)),
                Some(on) if on < e as u64 => Ok((kind(name)?, on as usize + 1)),
                Some(on) => Err(Problem::Parent { element: e, on }),
            },
        }
    }

    /// Checks that the model file and this program can hold the model.
    pub fn check(&self) -> Result<(), ShapeError> {
        check_count("element types", "types", self.types.len(), MAX_TYPES)?;
        let networks = "networks (positions, velocities, potentials, pair)";
        check_count(networks, "types", self.networks.0.len(), MAX_NETWORKS)?;
        check_count("trees", "trees", self.trees.len(), MAX_TREES)?;
        let trained = self.trees.first();
        let found = trained.map_or(0, |tree| {
            let kinds = tree.elements.iter().step_by(2).filter_map(|kind| self.types.get(usize::from(*kind)));
            kinds.map(|(shape, _)| shape.coordinates()).sum()
        });
        if (1..=MAX_TREE_COORDINATES).contains(&found) {
            return Ok(());
        }
        let most = format!("1 to {MAX_TREE_COORDINATES}");
        let name = trained.map_or("", |tree| tree.name.as_str());
        Err(Problem::Size { found, most }.at(["trees".into(), name.into()]))
    }

    pub fn finish(self) -> Assembled {
        let mut shape = ModularShape { networks: List::default(), types: List::default(), pair: self.pair };
        let networks = shape.networks.slots.iter_mut().zip(&self.networks.0);
        networks.for_each(|(slot, network)| *slot = Some(*network));
        let types = shape.types.slots.iter_mut().zip(&self.types);
        types.for_each(|(slot, (kind, _))| *slot = Some(*kind));
        let types = self.types.into_iter().map(|(_, named)| named).collect();
        let coefficients = self.coefficients.unwrap_or([Number::known(1.0); 2]);
        let group_laws = self.group_laws.with_groups(shape.types.len());
        let mut architecture = ModularArchitecture::new(shape, types, coefficients, self.trees);
        architecture.damped = self.damped;
        let Self { corrections, trained_corrections, trained, .. } = self;
        Assembled { architecture, group_laws, corrections, trained_corrections, trained }
    }
}

fn transform_of(shape: &TypeShape) -> TransformKind {
    match shape.transform {
        TransformShape::Network { input: Input::Angle, .. } => TransformKind::Angle,
        TransformShape::Network { input: Input::Translation, .. } => TransformKind::Translation,
        TransformShape::Network { input: Input::WrappedAngle, .. } => TransformKind::WrappedAngle,
        TransformShape::Rod => TransformKind::Rod,
        TransformShape::Slide => TransformKind::Slide,
        TransformShape::Free => TransformKind::Free,
    }
}
