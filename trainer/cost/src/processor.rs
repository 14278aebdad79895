//! Cost of a model's image on a processor, predicted from the model file alone.
//!
//! The operations of an evaluation are counted by running it with a counting scalar. The instructions per operation,
//! and the growth of stack and code with the shape, are fitted to images measured under emulation:
//! `firmware-sim/chip/shapes.sh` measures them, the example `fit_processors` of `leastaction-tests` does the fit, and
//! `processors.json` holds the result.

use crate::counted::Operations;
use crate::graph::COMPOSED;
use crate::operations::{Evaluations, operations};
use crate::{Cost, cost};
use leastaction_core::energy::modular::TransformShape;
use leastaction_core::model::Law;
use leastaction_models::Architecture;
use leastaction_models::Model;
use leastaction_models::file::Precision;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A processor on which images were measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Processor {
    /// Cortex-M4F.
    CortexM4f,
    /// Cortex-M7 with a single-precision floating-point unit.
    CortexM7,
}

impl Processor {
    /// All processors.
    pub const ALL: [Self; 2] = [Self::CortexM4f, Self::CortexM7];

    /// Name on the command line and in measurements.
    pub fn name(self) -> &'static str {
        match self {
            Self::CortexM4f => "cortex-m4f",
            Self::CortexM7 => "cortex-m7",
        }
    }

    /// Predicts the cost of a model; `None` if its shape is beyond those measured or compiled here, or if its precision was not measured.
    pub fn predict(self, model: &Model) -> Option<Prediction> {
        let shape = CostFactors::of(model)?;
        let mut fits: BTreeMap<String, BTreeMap<String, Fit>> = serde_json::from_str(FITS).ok()?;
        let fit = fits.remove(self.name())?.remove(shape.family)?;
        let of = |evaluation| Taken {
            instructions: product(&fit.instructions, &shape.work(evaluation)).round() as u64,
            stack_bytes: product(&fit.stack, &shape.stack(evaluation)).round() as u64,
        };
        let code = |order| product(&fit.code, &shape.code(order)).round() as u64;
        Some(Prediction {
            processor: self.name(),
            acceleration: of(Evaluation::Acceleration),
            step_order_2: of(Evaluation::Step(2)),
            step_order_4: of(Evaluation::Step(4)),
            code_bytes: [code(2), code(4)],
        })
    }
}

const FITS: &str = include_str!("processors.json");

/// Fit for models of a family on a processor: coefficients, keyed by the names of their features.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Fit {
    /// Instructions per operation.
    pub instructions: Coefficients,
    /// Bytes of stack.
    pub stack: Coefficients,
    /// Bytes of code.
    pub code: Coefficients,
}

/// Coefficients by name.
pub type Coefficients = BTreeMap<String, f64>;

/// Cost of an evaluation.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Taken {
    /// Instructions.
    pub instructions: u64,
    /// Bytes of stack, not counting those of the caller.
    pub stack_bytes: u64,
}

/// Cost of an image that loads a model and evaluates it, compiled for exactly its sizes at opt-level 2 with rolled loops.
#[derive(Clone, Debug, Serialize)]
pub struct Prediction {
    /// Name of the processor.
    pub processor: &'static str,
    /// An acceleration.
    pub acceleration: Taken,
    /// A step of order 2, with two Newton updates per Jacobian.
    pub step_order_2: Taken,
    /// A step of order 4, with two Newton updates per Jacobian.
    pub step_order_4: Taken,
    /// Bytes of code with steps of order 2, or of order 4.
    pub code_bytes: [u64; 2],
}

/// Evaluations that are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evaluation {
    /// An acceleration.
    Acceleration,
    /// A step of order 2 or 4.
    Step(u8),
}

impl Evaluation {
    fn name(self) -> &'static str {
        match self {
            Self::Acceleration => "acceleration",
            Self::Step(2) => "step_2",
            Self::Step(_) => "step_4",
        }
    }

    /// Name of the kind: steps of both orders keep the same arrays.
    fn kind(self) -> &'static str {
        if self == Self::Acceleration { "acceleration" } else { "step" }
    }
}

/// Features of a model that determine its cost.
pub struct CostFactors {
    /// Name of the family: inertia-network, modular, bodies or graph.
    pub family: &'static str,
    evaluations: Evaluations,
    cost: Cost,
    coordinates: usize,
    /// Units of each hidden layer.
    widths: Vec<usize>,
    /// Whether the model has dry friction.
    dry: bool,
    /// Whether a network moves an element: its units are then live at the same time as those of the potentials.
    moved_by_network: bool,
}

impl CostFactors {
    /// The features of a model; `None` if its cost cannot be predicted.
    pub fn of(model: &Model) -> Option<Self> {
        let architecture = &model.architecture;
        let (family, coordinates) = (architecture.name(), architecture.n());
        if model.precision == Precision::Half || !architecture.corrections.is_none() {
            return None;
        }
        Some(Self {
            family,
            evaluations: operations(architecture, &model.weights)?,
            cost: cost(architecture).ok()?,
            coordinates,
            widths: architecture.widths(),
            dry: architecture.laws().contains(Law::Coulomb),
            moved_by_network: moved_by_network(architecture),
        })
    }

    fn operations(&self, evaluation: Evaluation) -> &Operations {
        match evaluation {
            Evaluation::Acceleration => &self.evaluations.acceleration,
            Evaluation::Step(2) => &self.evaluations.step_order_2,
            Evaluation::Step(_) => &self.evaluations.step_order_4,
        }
    }

    /// The evaluation that is measured, and how many of them are needed: for a graph a step of order 4 consists of
    /// several steps of order 2.
    fn once(&self, evaluation: Evaluation) -> (String, f64) {
        match evaluation {
            Evaluation::Step(4) if self.family == GRAPH => {
                (Evaluation::Step(2).name().to_owned(), COMPOSED as f64)
            }
            evaluation => (evaluation.name().to_owned(), 1.0),
        }
    }

    /// Features of the number of instructions.
    pub fn work(&self, evaluation: Evaluation) -> Coefficients {
        let energies =
            if self.family == BODIES { self.measured(evaluation.name()) } else { self.counted(evaluation) };
        energies.into_iter().chain(self.friction(evaluation.name())).collect()
    }

    /// The feature of rigid bodies, whose cost hardly depends on anything but their number: a measurement for this
    /// number.
    fn measured(&self, name: &str) -> Coefficients {
        [(format!("{name}_of_{}", self.coordinates), 1.0)].into()
    }

    /// Features of dry friction, which costs the same for any energies.
    fn friction(&self, name: &str) -> Coefficients {
        let dry = f64::from(self.dry);
        [(format!("dry_{name}"), dry), (format!("dry_n_{name}"), dry * self.coordinates as f64)].into()
    }

    /// Counted operations.
    fn counted(&self, evaluation: Evaluation) -> Coefficients {
        let done = self.operations(evaluation);
        let [eights, fours, ones] = done.multiply_adds;
        let layers = [
            ("multiply_adds_8", eights),
            ("multiply_adds_4", fours),
            ("multiply_adds_1", ones),
            ("panels", done.panels),
            ("passes", done.passes),
            ("moved", done.moved),
            ("components", done.components),
            ("layers", done.layers),
        ];
        let others = [
            ("flops", done.flops),
            ("divisions", done.divisions),
            ("roots", done.roots),
            ("exponentials", done.exponentials),
            ("logarithms", done.logarithms),
            ("tangents", done.tangents),
            ("sines", done.sines),
        ];
        let all = layers.into_iter().chain(others).map(|(name, count)| (name.to_owned(), count as f64));
        let recorded = self.recorded(evaluation).iter().sum::<usize>() as f64;
        all.chain([self.once(evaluation), ("recorded".to_owned(), recorded)]).collect()
    }

    /// Units of the layers that leave a tape for an adjoint: for the acceleration of a network of three or more coordinates.
    fn recorded(&self, evaluation: Evaluation) -> &[usize] {
        let by_adjoint =
            self.family == INERTIA_NETWORK && self.coordinates > 2 && evaluation == Evaluation::Acceleration;
        if by_adjoint { &self.widths } else { &[] }
    }

    /// Features of the stack.
    pub fn stack(&self, evaluation: Evaluation) -> Coefficients {
        let energies =
            if self.family == BODIES { self.measured(evaluation.name()) } else { self.arrays(evaluation) };
        energies.into_iter().chain(self.friction(evaluation.name())).collect()
    }

    fn arrays(&self, evaluation: Evaluation) -> Coefficients {
        let Cost { acceleration, step_order_2, step_order_4, .. } = self.cost;
        let arrays = match evaluation {
            Evaluation::Acceleration => acceleration,
            Evaluation::Step(2) => step_order_2,
            Evaluation::Step(_) => step_order_4,
        };
        let (kind, n) = (evaluation.kind(), self.coordinates as f64);
        // A tape of several layers is built next to its final place.
        let recorded = self.recorded(evaluation);
        let widest = recorded.iter().max().copied().filter(|_| recorded.len() > 1).unwrap_or(0);
        let common =
            [(format!("arrays_{kind}"), arrays.stack_bytes as f64), ("recorded".to_owned(), widest as f64)];
        if self.family == GRAPH {
            // The order does not matter here: steps of both orders are alike.
            return common.into_iter().chain([(kind.to_owned(), 1.0), (format!("n_{kind}"), n)]).collect();
        }
        let name = evaluation.name();
        let own = [
            (name.to_owned(), 1.0),
            (format!("n_{name}"), n),
            (format!("n2_{name}"), n * n),
            (format!("moved_by_network_{kind}"), f64::from(self.moved_by_network)),
        ];
        common.into_iter().chain(own).collect()
    }

    /// Features of the code size.
    pub fn code(&self, order: u8) -> Coefficients {
        let name = Evaluation::Step(order).name();
        let energies = if self.family == BODIES { self.measured(name) } else { self.functions(order) };
        energies.into_iter().chain(self.friction(name)).collect()
    }

    fn functions(&self, order: u8) -> Coefficients {
        let from = |n: usize| f64::from(self.family != GRAPH && self.coordinates >= n);
        [
            ("image", 1.0),
            ("order_4", f64::from(order == 4)),
            ("n_from_2", from(2)),
            ("n_from_3", from(3)),
            ("n_from_4", from(4)),
        ]
        .map(|(name, x)| (name.to_owned(), x))
        .into_iter()
        .collect()
    }
}

fn moved_by_network(architecture: &Architecture) -> bool {
    let Some(modular) = architecture.family.modular() else { return false };
    modular.shape.types.iter().any(|of| matches!(of.transform, TransformShape::Network { .. }))
}

const INERTIA_NETWORK: &str = "inertia-network";
const GRAPH: &str = "graph";
const BODIES: &str = "bodies";

fn product(fitted: &Coefficients, found: &Coefficients) -> f64 {
    found.iter().map(|(name, x)| x * fitted.get(name).copied().unwrap_or(0.0)).sum()
}
