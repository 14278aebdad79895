//! The observer of the firmware, bit for bit.

use crate::arguments::order;
use crate::arrays::Numbers;
use crate::errors::{Kind, input};
use crate::model::{Model, OnChip};
use leastaction_core::observer::{Tuning, ZerosPrior};
use leastaction_firmware_sim::observer::ObserverConfig;
use leastaction_replica::{Control, Step, Watch};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// An observer in the chip's arithmetic.
type AnyWatch<'c> = Box<dyn Watch + 'c>;

self_cell::self_cell!(
    struct Watching {
        owner: Arc<OnChip>,
        #[not_covariant]
        dependent: AnyWatch,
    }
);

/// Estimates the state of a mechanism from its encoder readings alone.
#[pyclass(frozen, module = "leastaction._leastaction")]
pub struct Observer {
    n: usize,
    watching: Mutex<Watching>,
}

impl Observer {
    fn watching(&self) -> MutexGuard<'_, Watching> {
        self.watching.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Observer {
    /// Creates an observer for a model with the step `step` (h, order). `zeros` are two standard deviations: of the
    /// encoders' zeros, and of an innovation.
    #[new]
    #[pyo3(signature = (model, step, memory, patience, zeros))]
    fn new(
        model: &Model,
        step: (f64, u8),
        memory: u8,
        patience: u8,
        zeros: Option<(f32, f32)>,
    ) -> PyResult<Self> {
        let architecture = &model.host().architecture;
        let angle: Vec<bool> = architecture.coordinates().chars().map(|letter| letter == 'a').collect();
        let zeros = zeros.map(|(deviation, innovation)| ZerosPrior { deviation, innovation });
        let tuning = Tuning { memory, patience, zeros };
        let newton = ObserverConfig::new().newton;
        let step = (Step { order: order(step.1)?, h: step.0 as f32 }, newton);
        let chip = model.chip()?.clone();
        let watching = Watching::try_new(chip, |chip| chip.borrow_dependent().watch(step, &angle, tuning));
        Ok(Self { n: architecture.n(), watching: Mutex::new(watching.map_err(input)?) })
    }

    /// Steps the model under the acting force; returns the number of Newton updates, `None` before the first samples.
    fn predict(
        &self,
        start: PyReadonlyArray1<'_, f32>,
        end: PyReadonlyArray1<'_, f32>,
    ) -> PyResult<Option<u8>> {
        let [start, end] = [start.as_array().to_vec(), end.as_array().to_vec()];
        let control = Control { start: &start, end: &end };
        let report = self.watching().with_dependent_mut(|_, watch| watch.predict(control));
        Ok(report.map_err(|error| Kind::Solve.says(error))?.map(|report| report.iterations))
    }

    /// Takes the samples of a tick; missing samples are NaN.
    fn correct(&self, measured: PyReadonlyArray1<'_, f32>) -> PyResult<()> {
        let measured: Vec<Option<f32>> =
            measured.as_array().iter().map(|y| (!y.is_nan()).then_some(*y)).collect();
        let taken = self.watching().with_dependent_mut(|_, watch| watch.correct(&measured));
        taken.map_err(|error| Kind::Solve.says(error))
    }

    /// Returns the estimates of q and v; `None` until every coordinate has been measured.
    fn estimate<'py>(&self, py: Python<'py>) -> PyResult<Option<(Numbers<'py, f32>, Numbers<'py, f32>)>> {
        let (mut q, mut v) = (vec![0.0; self.n], vec![0.0; self.n]);
        let known = self.watching().with_dependent(|_, watch| watch.estimate(&mut q, &mut v));
        let known = known.map_err(|error| Kind::Solve.says(error))?;
        Ok(known.then(|| (PyArray1::from_vec(py, q), PyArray1::from_vec(py, v))))
    }

    /// Returns the zero offsets of the encoders: reading minus true position.
    fn zeros<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let mut zeros = vec![0.0; self.n];
        self.watching().with_dependent(|_, watch| watch.zeros(&mut zeros)).map_err(input)?;
        Ok(PyArray1::from_vec(py, zeros))
    }

    /// Returns whether the estimate can be relied on.
    fn trusted(&self) -> bool {
        self.watching().with_dependent(|_, watch| watch.trusted())
    }
}
