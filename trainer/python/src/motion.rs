//! Motions side by side, step by step, in the chip's arithmetic.

use crate::arguments::unsolved;
use crate::arrays::{Numbers, Table, rows, table};
use crate::blocks::fill;
use crate::model::OnChip;
use crate::single::Unsolved;
use leastaction_replica::{Control, Motion, Replica, ReplicaError, Step};
use numpy::{PyArray1, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Number of motions per block.
const BLOCK: usize = 8;

/// Start of motions.
pub struct Flight {
    /// Number of motions.
    pub count: usize,
    /// Order and step h.
    pub step: Step,
    /// Positions, then velocities or second positions.
    pub start: [Table<f32>; 2],
    /// Whether motions start from two positions.
    pub positions: bool,
}

/// A motion in the chip's arithmetic.
type AnyMotion<'c> = Box<dyn Motion + 'c>;

impl Flight {
    /// Begins motion `k`; `tau` is the control of the first step.
    fn begin<'c>(&self, chip: &'c Replica, k: usize, tau: Control) -> Result<AnyMotion<'c>, ReplicaError> {
        let [first, second] = self.start.each_ref().map(|table| table.row(k));
        if self.positions {
            chip.motion_between(self.step, [first, second], tau)
        } else {
            chip.motion_at(self.step, first, second)
        }
    }

    /// Positions and velocities at every sample, \[motions\]\[steps + 1\]\[2n\], under controls
    /// \[motions\]\[steps\]\[n\]. If a motion starts from two positions, the velocity at the first is NaN. If a step
    /// cannot be solved, the rest of the motion is NaN, or an error is returned.
    ///
    /// # Errors
    /// [`Unsolved`] for the first motion that cannot be stepped, unless `nan` is set.
    pub fn run(
        &self,
        chip: &Replica,
        tau: &[Table<f32>; 2],
        steps: usize,
        nan: bool,
    ) -> Result<Vec<f32>, Unsolved> {
        let width = (steps + 1) * 2 * chip.n();
        let mut numbers = vec![f32::NAN; self.count * width];
        fill((&mut numbers, width, BLOCK), |first, motions| {
            for (k, to) in motions.chunks_exact_mut(width).enumerate() {
                match self.run_one(chip, (first + k, steps), tau, to) {
                    Err(_) if nan => {}
                    done => done.map_err(|error| Unsolved { index: first + k, error })?,
                }
            }
            Ok(())
        })?;
        Ok(numbers)
    }

    fn run_one(
        &self,
        chip: &Replica,
        (index, steps): (usize, usize),
        tau: &[Table<f32>; 2],
        to: &mut [f32],
    ) -> Result<(), ReplicaError> {
        let n = chip.n();
        let [start, end] = tau.each_ref().map(|tau| tau.row(index));
        let control = |k: usize| {
            let of = |tau: &'_ [f32]| k * n..((k + 1) * n).min(tau.len());
            Control {
                start: start.get(of(start)).unwrap_or_default(),
                end: end.get(of(end)).unwrap_or_default(),
            }
        };
        let mut motion = self.begin(chip, index, control(0))?;
        if self.positions
            && let Some(place) = to.get_mut(..n)
        {
            place.copy_from_slice(self.start[0].row(index));
        }
        let begin = usize::from(self.positions);
        for k in begin..=steps {
            if k > begin {
                motion.step(control(k - 1))?;
            }
            let (q, v) = to[2 * n * k..2 * n * (k + 1)].split_at_mut(n);
            q.copy_from_slice(motion.q());
            motion.velocity(v)?;
        }
        Ok(())
    }
}

self_cell::self_cell!(
    /// A motion with the model from which it borrows.
    struct Moving {
        owner: Arc<OnChip>,
        #[not_covariant]
        dependent: AnyMotion,
    }
);

/// Motions side by side: q with its rounding remainder, and the momentum p = L_v, as the chip keeps them.
#[pyclass(frozen, module = "leastaction._leastaction")]
pub struct Motions {
    n: usize,
    each: Mutex<Vec<Moving>>,
}

impl Motions {
    /// Begins the motions; `tau` acts between the two positions of a start.
    ///
    /// # Errors
    /// [`Unsolved`] for the first motion that cannot begin.
    pub fn begin(chip: Arc<OnChip>, flight: &Flight, tau: &[Table<f32>; 2]) -> Result<Self, Unsolved> {
        let begin = |k: usize| {
            let control = Control { start: tau[0].row(k), end: tau[1].row(k) };
            Moving::try_new(chip.clone(), |chip| flight.begin(chip.borrow_dependent(), k, control))
                .map_err(|error| Unsolved { index: k, error })
        };
        let each = (0..flight.count).map(begin).collect::<Result<_, _>>()?;
        Ok(Self { n: chip.borrow_dependent().n(), each: Mutex::new(each) })
    }

    fn each(&self) -> MutexGuard<'_, Vec<Moving>> {
        self.each.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn rows<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&AnyMotion, &mut [f32]) -> Result<(), ReplicaError>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let each = self.each();
        let mut numbers = vec![0.0; each.len() * self.n];
        for (index, (motion, to)) in each.iter().zip(numbers.chunks_exact_mut(self.n)).enumerate() {
            motion
                .with_dependent(|_, motion| of(motion, to))
                .map_err(|error| unsolved(Unsolved { index, error }))?;
        }
        Ok(rows(py, numbers, [each.len(), self.n])?.into_any())
    }
}

#[pymethods]
impl Motions {
    /// Returns q of every motion.
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.rows(py, |motion, to| {
            to.copy_from_slice(motion.q());
            Ok(())
        })
    }

    /// Returns p of every motion.
    fn p<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.rows(py, |motion, to| {
            to.copy_from_slice(motion.p());
            Ok(())
        })
    }

    /// Returns v of every motion.
    fn v<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.rows(py, |motion, to| motion.velocity(to))
    }

    /// Steps every motion under forces at the start and the end of the step. If one motion cannot be stepped, only the
    /// motions before it are stepped. Returns the Newton updates and the remaining residual of every motion.
    fn step<'py>(
        &self,
        py: Python<'py>,
        start: PyReadonlyArrayDyn<'_, f32>,
        end: PyReadonlyArrayDyn<'_, f32>,
    ) -> PyResult<(Numbers<'py, u8>, Numbers<'py, f32>)> {
        let tau = [table("u", &start, &[self.n])?, table("u", &end, &[self.n])?];
        let reports = py.detach(|| {
            let mut each = self.each();
            let mut reports = (Vec::new(), Vec::new());
            for (index, motion) in each.iter_mut().enumerate() {
                let control = Control { start: tau[0].row(index), end: tau[1].row(index) };
                let report = motion
                    .with_dependent_mut(|_, motion| motion.step(control))
                    .map_err(|error| Unsolved { index, error })?;
                reports.0.push(report.iterations);
                reports.1.push(report.residual);
            }
            Ok(reports)
        });
        let (iterations, residual) = reports.map_err(unsolved)?;
        Ok((PyArray1::from_vec(py, iterations), PyArray1::from_vec(py, residual)))
    }
}
