//! A model file in memory, and evaluation of the model at given states.

use crate::arguments::{common, inputs, order, quantity, second, unsolved};
use crate::arrays::{rows, table, tables};
use crate::double::{self, Rollout, Start};
use crate::errors::{Kind, failure, input};
use crate::facts;
use crate::motion::{Flight, Motions};
use crate::single;
use leastaction::models::{Loaded as Read, chip_file, of_part, read, refused};
use leastaction_core::forces::ControlKind;
use leastaction_core::model::FORMAT_VERSION;
use leastaction_learning::data::control_name;
use leastaction_models as models;
use leastaction_models::file::{Precision, c_source, rust_source};
use leastaction_replica::{ModelFile, Replica, Step};
use numpy::{PyArray1, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::PathBuf;
use std::sync::Arc;

self_cell::self_cell!(
    /// A model in the chip's arithmetic, with the file from which it borrows.
    pub struct OnChip {
        owner: ModelFile,
        #[covariant]
        dependent: Replica,
    }
);

/// A learned model: a model file in memory.
#[pyclass(frozen, module = "leastaction._leastaction")]
pub struct Model {
    host: models::Model,
    bytes: Vec<u8>,
    /// The model in the chip's arithmetic, or the reason why it is not available (core is not compiled for its size).
    chip: Result<Arc<OnChip>, String>,
}

impl Model {
    /// Creates a model from a file that was read.
    pub fn new(Read { model: host, bytes }: Read) -> Self {
        let current = host.version == FORMAT_VERSION;
        let bytes = if current { bytes } else { host.to_bytes().unwrap_or(bytes) };
        let file = chip_file(&host);
        let part = host.architecture.part().map(|(_, name)| name.to_owned());
        let chip = file.and_then(|file| {
            OnChip::try_new(file, |file| file.replica(part.as_deref())).map_err(|error| error.to_string())
        });
        Self { host, bytes, chip: chip.map(Arc::new) }
    }

    /// The model on the host.
    pub fn host(&self) -> &models::Model {
        &self.host
    }

    /// The bytes of the file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The model in the chip's arithmetic.
    pub fn chip(&self) -> PyResult<&Arc<OnChip>> {
        self.chip
            .as_ref()
            .map_err(|error| input(format!("{error}; model.double computes in double precision")))
    }

    fn n(&self) -> usize {
        self.host.architecture.n()
    }
}

#[pymethods]
impl Model {
    /// Reads a model file; `part` selects one of several trees or graphs by name.
    #[staticmethod]
    #[pyo3(signature = (path, part=None))]
    fn load(path: PathBuf, part: Option<&str>) -> PyResult<Self> {
        let loaded =
            read(&path).and_then(|read| of_part(&path, read.model, part).map(|model| Read { model, ..read }));
        loaded.map(Self::new).map_err(failure)
    }

    /// Reads a model from the bytes of a file, as `load` does from a path.
    #[staticmethod]
    #[pyo3(signature = (bytes, part=None))]
    fn from_bytes(bytes: Vec<u8>, part: Option<&str>) -> PyResult<Self> {
        let path = PathBuf::from("the bytes");
        let model = leastaction_models::file::decode(&bytes).map_err(|error| input(refused(error)))?;
        let model = of_part(&path, model, part).map_err(failure)?;
        Ok(Self::new(Read { model, bytes }))
    }

    /// Returns the bytes of the file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.bytes)
    }

    /// Returns the model as a file in the current format, with weights in half precision or in the model's own
    /// precision.
    fn encoded<'py>(&self, py: Python<'py>, half: bool) -> PyResult<Bound<'py, PyBytes>> {
        let precision = if half { Precision::Half } else { self.host.precision };
        let model = models::Model { precision, ..self.host.clone() };
        let bytes = model.to_bytes().map_err(|error| Kind::Work.says(error))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Returns the file as a Rust module.
    fn rust_source(&self) -> PyResult<String> {
        rust_source(&self.bytes).map_err(|error| Kind::Work.says(error))
    }

    /// Returns the file as a C header.
    fn c_source(&self, name: &str) -> PyResult<String> {
        c_source(&self.bytes, name).map_err(|error| Kind::Work.says(error))
    }

    /// Returns the facts about the model besides its weights.
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (facts, architecture) = (&self.host.facts, &self.host.architecture);
        let step = facts.trained_step;
        let dictionary = PyDict::new(py);
        dictionary.set_item("family", architecture.name())?;
        dictionary.set_item("n", architecture.n())?;
        dictionary.set_item("coordinates", architecture.coordinates())?;
        dictionary.set_item("order", step.map(|step| step.order.number()))?;
        // This is the shortest decimal notation of the single-precision number.
        let h = step.and_then(|step| step.h.to_string().parse::<f64>().ok());
        dictionary.set_item("h", h)?;
        dictionary.set_item("control", step.map(|step| control_name(step.control)))?;
        dictionary.set_item("parameters", self.host.weights.len())?;
        dictionary.set_item("weight_bits", self.host.precision.bits())?;
        dictionary.set_item("part", architecture.part().map(|(_, name)| name))?;
        dictionary.set_item("parts", architecture.parts())?;
        dictionary.set_item("provenance", &facts.provenance)?;
        dictionary.set_item("format_version", self.host.version)?;
        dictionary.set_item("range", facts::range(py, &self.host.facts)?)?;
        dictionary.set_item("actuator", facts::actuator(py, &self.host.facts)?)?;
        dictionary.set_item("on_chip", self.chip.is_ok())?;
        Ok(dictionary)
    }

    /// Returns the weight block as it is in the file.
    fn weights<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.host.weights)
    }

    /// Computes a quantity of every state in single precision, \[states\]\[numbers\].
    fn single<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        arrays: Vec<PyReadonlyArrayDyn<'py, f32>>,
        nan: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let quantity = quantity(name)?;
        let (tables, count) = inputs(quantity, &arrays, self.n())?;
        let chip = self.chip()?;
        let found =
            py.detach(|| single::evaluate(chip.borrow_dependent(), (quantity, nan), (&tables, count)));
        let width = quantity.width(self.n());
        Ok(rows(py, found.map_err(unsolved)?, [count, width])?.into_any())
    }

    /// Computes a quantity of every state in double precision, \[states\]\[numbers\].
    fn double<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        arrays: Vec<PyReadonlyArrayDyn<'py, f64>>,
        nan: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let quantity = quantity(name)?;
        let (tables, count) = inputs(quantity, &arrays, self.n())?;
        let found = py.detach(|| double::evaluate(&self.host, quantity, (&tables, count))).map_err(input)?;
        let width = quantity.width(self.n());
        if !nan && let Some(place) = found.iter().position(|x| !x.is_finite()) {
            let message =
                format!("state {}: the inertia is singular or a number is not finite", place / width.max(1));
            return Err(Kind::Solve.says(message));
        }
        Ok(rows(py, found, [count, width])?.into_any())
    }

    /// Begins motions in single precision, from states or, if `positions` is set, from two positions.
    fn motions(
        &self,
        py: Python<'_>,
        start: (PyReadonlyArrayDyn<'_, f32>, PyReadonlyArrayDyn<'_, f32>),
        tau: (PyReadonlyArrayDyn<'_, f32>, PyReadonlyArrayDyn<'_, f32>),
        positions: bool,
        step: (f64, u8),
    ) -> PyResult<Motions> {
        let flight = self.flight(start, positions, step)?;
        let tau = [table("u", &tau.0, &[self.n()])?, table("u", &tau.1, &[self.n()])?];
        let chip = self.chip()?.clone();
        py.detach(|| Motions::begin(chip, &flight, &tau)).map_err(unsolved)
    }

    /// Computes positions and velocities at every sample, in single precision.
    #[allow(clippy::too_many_arguments)]
    fn rollout<'py>(
        &self,
        py: Python<'py>,
        start: (PyReadonlyArrayDyn<'py, f32>, PyReadonlyArrayDyn<'py, f32>),
        tau: (PyReadonlyArrayDyn<'py, f32>, PyReadonlyArrayDyn<'py, f32>),
        steps: usize,
        positions: bool,
        step: (f64, u8),
        nan: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let n = self.n();
        let flight = self.flight(start, positions, step)?;
        let tau = [table("u", &tau.0, &[steps, n])?, table("u", &tau.1, &[steps, n])?];
        let count = common([flight.count, tau[0].count, tau[1].count].into_iter())?;
        let flight = Flight { count, ..flight };
        let chip = self.chip()?;
        let found = py.detach(|| flight.run(chip.borrow_dependent(), &tau, steps, nan)).map_err(unsolved)?;
        Ok(tables(py, found, [count, steps + 1, 2 * n])?.into_any())
    }

    /// Computes positions and momenta at every sample, in double precision.
    #[allow(clippy::too_many_arguments)]
    fn rollout_double<'py>(
        &self,
        py: Python<'py>,
        start: (PyReadonlyArrayDyn<'py, f64>, PyReadonlyArrayDyn<'py, f64>),
        tau: (PyReadonlyArrayDyn<'py, f64>, PyReadonlyArrayDyn<'py, f64>),
        steps: usize,
        positions: bool,
        step: (f64, u8),
        nan: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let n = self.n();
        let [first, second] = [table("q", &start.0, &[n])?, table(second(positions), &start.1, &[n])?];
        let tau = [table("u", &tau.0, &[steps, n])?, table("u", &tau.1, &[steps, n])?];
        let count = common([first.count, second.count, tau[0].count, tau[1].count].into_iter())?;
        let start = [first, second];
        let start = if positions { Start::Positions(start) } else { Start::State(start) };
        let rollout = Rollout { count, steps, step: (step.0, double::order(step.1)?), start, tau };
        let found = py.detach(|| rollout.run(&self.host)).map_err(input)?;
        let width = 2 * n * (steps + 1);
        let lost =
            found.chunks(width.max(1)).position(|motion| motion.iter().rev().take(n).any(|x| x.is_nan()));
        if let Some(index) = lost.filter(|_| !nan) {
            return Err(Kind::Solve.says(format!("motion {index}: a step cannot be solved")));
        }
        Ok(tables(py, found, [count, steps + 1, 2 * n])?.into_any())
    }

    /// Converts commands, \[samples\]\[n\], to the forces at the start and the end of every step, by the file's actuator.
    fn forces<'py>(
        &self,
        py: Python<'py>,
        commands: PyReadonlyArrayDyn<'py, f32>,
        h: f64,
        linear: bool,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let n = self.n();
        let commands = table("u", &commands, &[n])?;
        let mut actuators = self.chip()?.borrow_dependent().actuators(h as f32).map_err(input)?;
        if commands.count > 0 {
            actuators.take_past(commands.row(0)).map_err(input)?;
        }
        let (mut start, mut end) = (Vec::new(), Vec::new());
        for k in 0..commands.count {
            let next = commands.row((k + 1).min(commands.count - 1));
            let own = commands.row(k);
            let force = if linear { actuators.linear(own, next) } else { actuators.held(own) };
            let force = force.map_err(input)?;
            start.extend_from_slice(force.start);
            end.extend_from_slice(force.end);
        }
        let shape = [commands.count, n];
        Ok((rows(py, start, shape)?.into_any(), rows(py, end, shape)?.into_any()))
    }

    /// Converts commands to forces as `forces` does, in double precision and for any size.
    fn forces_double<'py>(
        &self,
        py: Python<'py>,
        commands: PyReadonlyArrayDyn<'py, f64>,
        h: f64,
        linear: bool,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let n = self.n();
        let commands = table("u", &commands, &[n])?;
        let kind = if linear { ControlKind::Linear } else { ControlKind::Held };
        let last = commands.count.saturating_sub(1);
        let command = |k: isize, i: usize| {
            let k = usize::try_from(k).unwrap_or(0);
            commands.row(k.min(last)).get(i).copied().unwrap_or(0.0)
        };
        let actuator = &self.host.facts.actuator;
        let places = (0..commands.count).flat_map(|k| (0..n).map(move |i| (k, i)));
        let lagging = actuator.lagging((h, kind), (commands.count, n), command);
        let ends = places.map(|(k, i)| actuator.over_step((h, kind), (k, i), &lagging, |k| command(k, i)));
        let (start, end): (Vec<f64>, Vec<f64>) = ends.map(|[start, end]| (start, end)).unzip();
        let shape = [commands.count, n];
        Ok((rows(py, start, shape)?.into_any(), rows(py, end, shape)?.into_any()))
    }

    /// Returns for every state the first quantity outside the range of the training data: 3 i + 0, 1, 2 for q, v, u of
    /// coordinate i; −1 if there is none.
    fn outside<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArrayDyn<'py, f32>,
        v: PyReadonlyArrayDyn<'py, f32>,
        u: PyReadonlyArrayDyn<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let n = self.n();
        let tables = [table("q", &q, &[n])?, table("v", &v, &[n])?, table("u", &u, &[n])?];
        let chip = self.chip()?.borrow_dependent();
        let count = common(tables.iter().map(|table| table.count))?;
        let of = |k: usize| {
            let [q, v, u] = tables.each_ref().map(|table| table.row(k));
            let outside = chip.outside(q, v, u).map_err(input)?;
            let number = |quantity| "qvu".find(quantity).unwrap_or(0);
            Ok(outside.map_or(-1, |outside| (3 * outside.coordinate + number(outside.quantity)) as i64))
        };
        let found = (0..count).map(of).collect::<PyResult<Vec<i64>>>()?;
        Ok(PyArray1::from_vec(py, found))
    }
}

impl Model {
    fn flight(
        &self,
        start: (PyReadonlyArrayDyn<'_, f32>, PyReadonlyArrayDyn<'_, f32>),
        positions: bool,
        (h, number): (f64, u8),
    ) -> PyResult<Flight> {
        let n = self.n();
        let start = [table("q", &start.0, &[n])?, table(second(positions), &start.1, &[n])?];
        let count = common(start.iter().map(|table| table.count))?;
        let h = h as f32;
        if !(h.is_finite() && h > 0.0) {
            return Err(input(format!("h is {h}; it must be a finite number above 0")));
        }
        Ok(Flight { count, step: Step { order: order(number)?, h }, start, positions })
    }
}
