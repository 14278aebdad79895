//! Derivatives of accelerations and of inverse dynamics.

use crate::Model;
use leastaction_core::model::ModelError;
use leastaction_programs::Row;
use leastaction_programs::dynamics::AccelerationSlopes;
use nalgebra::DMatrix;

/// How accelerations and inverse dynamics move with the state, matrices \[n\]\[n\] row by row.
///
/// The control is u: τ = g u + o, without delay.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearization {
    /// v̇(q, v, u), m/s² or rad/s².
    pub acceleration: Vec<f64>,
    /// ∂v̇/∂q.
    pub acceleration_q: Vec<f64>,
    /// ∂v̇/∂v.
    pub acceleration_v: Vec<f64>,
    /// ∂v̇/∂u.
    pub acceleration_u: Vec<f64>,
    /// ∂u/∂q of inverse dynamics u(q, v, v̇).
    pub control_q: Vec<f64>,
    /// ∂u/∂v of inverse dynamics.
    pub control_v: Vec<f64>,
    /// ∂u/∂v̇ of inverse dynamics.
    pub control_a: Vec<f64>,
}

impl Model {
    /// Derivatives at a state under a control u; `None` where the inertia is singular or a number is not finite, and of models on
    /// rods.
    ///
    /// With B = ∂v̇/∂u = M⁻¹(1 + ∂Q/∂τ)g, inverse dynamics move by ∂u/∂v̇ = B⁻¹, ∂u/∂q = −B⁻¹ ∂v̇/∂q and likewise in v.
    ///
    /// # Errors
    /// As [`Model::system`]; [`ModelError::Shape`] for a state of another number of coordinates.
    pub fn linearize(&self, q: &[f64], v: &[f64], u: &[f64]) -> Result<Option<Linearization>, ModelError> {
        let (system, n) = (self.system()?, self.n());
        for found in [q, v, u].map(<[f64]>::len) {
            if found != n {
                return Err(ModelError::Shape { what: "coordinates of the state", found, compiled: n });
            }
        }
        if self.architecture.rods()?.count() > 0 {
            return Ok(None);
        }
        let rows = |x: &[f64]| x.iter().map(|x| Row::splat(*x)).collect::<Vec<Row>>();
        let actuator = &self.facts.actuator;
        let tau: Vec<f64> = u.iter().enumerate().map(|(i, u)| actuator.output(i, *u)).collect();
        let (q, v, tau) = (rows(q), rows(v), rows(&tau));
        let mut slopes = AccelerationSlopes::new(&system);
        let (mut a, mut columns) = (vec![Row::default(); n], vec![Row::default(); 2 * n * n]);
        if slopes.evaluate(&self.weights, [&q, &v, &tau], &mut a, &mut columns).any(1) {
            return Ok(None);
        }
        let compliance = slopes.compliance();
        let inverse_mass = DMatrix::from_fn(n, n, |i, j| compliance[i * n + j].0[0]);
        let mut through = DMatrix::identity(n, n);
        if let Some(load) = system.load_derivatives() {
            let mut workspace = load.workspace();
            load.run_outputs(&self.weights, &[&q, &v, &tau], &mut workspace);
            through += DMatrix::from_fn(n, n, |i, j| workspace.output(j)[i].0[0]);
        }
        let gain = DMatrix::from_fn(n, n, |i, j| if i == j { actuator.gain(i) } else { 0.0 });
        let by_control = inverse_mass * through * gain;
        let [by_q, by_v] =
            [0, n * n].map(|first| DMatrix::from_fn(n, n, |i, j| columns[first + j * n + i].0[0]));
        let Some(inverse) = by_control.clone().try_inverse() else { return Ok(None) };
        let flat = |matrix: &DMatrix<f64>| matrix.transpose().as_slice().to_vec();
        Ok(Some(Linearization {
            acceleration: a.iter().map(|a| a.0[0]).collect(),
            acceleration_q: flat(&by_q),
            acceleration_v: flat(&by_v),
            acceleration_u: flat(&by_control),
            control_q: flat(&(-&inverse * by_q)),
            control_v: flat(&(-&inverse * by_v)),
            control_a: flat(&inverse),
        }))
    }
}
