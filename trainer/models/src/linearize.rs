//! Derivatives of accelerations and of inverse dynamics.

use crate::Model;
use leastaction_core::model::ModelError;
use leastaction_programs::Row;
use leastaction_programs::dynamics::AccelerationSlopes;
use nalgebra::DMatrix;

/// Derivatives of accelerations and of inverse dynamics with respect to the state, as matrices \[n\]\[n\] in row-major order.
///
/// The control is the command u: τ = g u + o, without delay and lag.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearization {
    /// Acceleration v̇(q, v, u), m/s² or rad/s².
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
    /// Returns the derivatives at a state under a control u; `None` if the mass matrix is singular, a number is not
    /// finite, or the model has rods.
    ///
    /// With B = ∂v̇/∂u = M⁻¹(1 + ∂Q/∂τ)g, the derivatives of inverse dynamics are ∂u/∂v̇ = B⁻¹, ∂u/∂q = −B⁻¹ ∂v̇/∂q and likewise in v.
    ///
    /// # Errors
    /// See [`Model::system`]; [`ModelError::Shape`] for a state with another number of coordinates.
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
        let of_force = slopes.of_control(&self.weights, [&q, &v, &tau]);
        let by_control = DMatrix::from_fn(n, n, |i, j| of_force[j * n + i].0[0] * actuator.gain(j));
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

#[cfg(test)]
mod tests {
    use crate::{Actuator, Architecture, Facts, GroupLaws, InertiaNetworkArchitecture, Model, Number};
    use leastaction_core::energy::inertia_network::Coordinate;

    const STATE: [[f64; 2]; 3] = [[0.3, -0.7], [0.4, -0.2], [0.6, 0.9]];
    const STEP: f64 = 1e-5;

    /// Dry friction that grows with the load, so that Q depends on τ, and drives with different gains.
    fn machine() -> Model {
        let dry = [0.3, 0.4, 0.2, 0.25].map(Number::known);
        let architecture = Architecture {
            group_laws: GroupLaws::of_friction(vec![Number::known(0.1); 2], vec![dry; 2]),
            ..InertiaNetworkArchitecture::new(&[Coordinate::Translation, Coordinate::Angle], 5).into()
        };
        let weights = architecture.initial_weights(3);
        let actuator = Actuator { gain: vec![1.5, -0.5], offset: vec![0.25, 0.125], ..Actuator::default() };
        Model::new(architecture, weights).with_facts(Facts { actuator, ..Facts::default() })
    }

    fn acceleration(model: &Model, [q, v, u]: [[f64; 2]; 3]) -> [f64; 2] {
        let tau = [0, 1].map(|i| model.facts.actuator.output(i, u[i]));
        let mut a = [0.0; 2];
        model.with_forced(|forced| forced(&q, &v, &tau, &mut a)).unwrap().unwrap();
        a
    }

    /// Derivatives of every output with respect to entry j of an input, for all j, by central differences.
    fn differences(input: usize, of: impl Fn([[f64; 2]; 3]) -> [f64; 2], at: [[f64; 2]; 3]) -> Vec<f64> {
        let moved = |j: usize, step: f64| {
            let mut at = at;
            at[input][j] += step;
            of(at)
        };
        let column = |j: usize| {
            let (forth, back) = (moved(j, STEP), moved(j, -STEP));
            [0, 1].map(|i| (forth[i] - back[i]) / (2.0 * STEP))
        };
        let columns = [column(0), column(1)];
        (0..4).map(|k| columns[k % 2][k / 2]).collect()
    }

    fn assert_close(found: &[f64], expected: &[f64]) {
        let close =
            |(found, expected): (&f64, &f64)| (found - expected).abs() < 1e-7 * expected.abs().max(1.0);
        assert!(found.len() == 4 && found.iter().zip(expected).all(close), "{found:?} {expected:?}");
    }

    #[test]
    fn derivatives_are_differences_of_accelerations_and_of_inverse_dynamics() {
        let model = machine();
        let [q, v, u] = STATE;
        let found = model.linearize(&q, &v, &u).unwrap().unwrap();
        let of = |at| acceleration(&model, at);
        assert!(found.acceleration.iter().zip(of(STATE)).all(|(a, b)| (a - b).abs() < 1e-12));
        assert_close(&found.acceleration_q, &differences(0, of, STATE));
        assert_close(&found.acceleration_v, &differences(1, of, STATE));
        assert_close(&found.acceleration_u, &differences(2, of, STATE));
        let inverse = |[q, v, a]: [[f64; 2]; 3]| -> [f64; 2] {
            model.inverse_dynamics([&q, &v, &a]).unwrap().try_into().unwrap()
        };
        let motion = [q, v, of(STATE)];
        assert!(inverse(motion).iter().zip(u).all(|(found, u)| (found - u).abs() < 1e-12));
        assert_close(&found.control_q, &differences(0, inverse, motion));
        assert_close(&found.control_v, &differences(1, inverse, motion));
        assert_close(&found.control_a, &differences(2, inverse, motion));
    }

    #[test]
    fn a_state_of_another_size_is_refused() {
        let model = machine();
        assert!(model.linearize(&[0.0; 3], &[0.0; 2], &[0.0; 2]).is_err());
        assert!(model.inverse_dynamics([&[0.0; 4], &[0.0; 2], &[0.0; 4]]).is_err());
    }
}
