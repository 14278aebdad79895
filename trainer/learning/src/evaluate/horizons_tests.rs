use super::horizons::{HorizonErrors, Predictor};
use crate::data::{Dataset, Rows, Trajectory};
use crate::windows::WindowLogs;
use leastaction_core::energy::bodies::{BodyParameters, Joint, TreeBody};
use leastaction_models::Model;
use leastaction_models::{Architecture, BodiesArchitecture, Number};

const H: f64 = 0.01;
const INERTIA: f64 = 0.5;
const ACCELERATION: f64 = 3.0;

/// A wheel: one body with a moment of inertia, without gravity or friction.
fn wheel() -> Architecture {
    let numbers = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, INERTIA, 0.0, 1.0].map(Number::known);
    let body = TreeBody { joint: Joint::Revolute, parent: None };
    let own = BodyParameters::from_array(numbers);
    BodiesArchitecture::new([Number::known(0.0); 2], [(body, own)]).unwrap().into()
}

/// Logs of the wheel with the given numbers of samples, under a constant force; the encoder has the zero offset `zero`.
fn logs(samples: &[usize], zero: f64) -> WindowLogs {
    let trajectory = |count: &usize| {
        let t = |k: usize| k as f64 * H;
        let rows = |of: &dyn Fn(usize) -> f64| Rows::from_flat(1, (0..*count).map(of).collect()).unwrap();
        let q = rows(&|k| 0.2 + zero + 0.5 * ACCELERATION * t(k) * t(k));
        let u = Some(rows(&|_| INERTIA * ACCELERATION));
        Trajectory { id: 0, t0: 0.0, q, v: None, a: None, u }
    };
    let trajectories = samples.iter().map(trajectory).collect();
    WindowLogs::new(&Dataset { n: 1, h: H, control: None, trajectories })
}

fn exact() -> Model {
    let weights = wheel().initial_weights(0);
    Model::new(wheel(), weights)
}

fn errors(logs: &WindowLogs, zeros: &[Vec<f64>]) -> Vec<HorizonErrors> {
    Predictor { model: &exact(), zeros, logs }.predict().unwrap().errors(logs)
}

/// The error of a constant velocity after k samples is ½a(kh)², and Σk⁴ is known in closed form.
#[test]
fn an_exact_model_is_exact_and_a_constant_velocity_as_wrong_as_it_is() {
    for (logs, zeros) in [(logs(&[160, 20], 0.0), Vec::new()), (logs(&[160, 20], 0.7), vec![vec![0.7]; 2])] {
        let errors = errors(&logs, &zeros);
        let seconds: Vec<Option<f64>> = errors.iter().map(|of| of.seconds).collect();
        assert_eq!(seconds, [Some(0.1), Some(0.5), Some(1.0), None]);
        assert_eq!(errors.iter().map(|of| of.predictions).collect::<Vec<_>>(), [3, 3, 3, 2]);
        for (of, steps) in errors.iter().zip([10.0, 50.0, 100.0]) {
            let k: f64 = steps;
            let fourth = k * (k + 1.0) * (2.0 * k + 1.0) * (3.0 * k * k + 3.0 * k - 1.0) / 30.0;
            let exact = 0.5 * ACCELERATION * H * H * (fourth / (k + 1.0)).sqrt();
            for column in 0..2 {
                assert!((of.constant_velocity[column].median - exact).abs() < 1e-9, "{of:?} {exact}");
                assert!(of.model[column].percentile_90 < 1e-9, "{of:?}");
            }
        }
    }
}

#[test]
fn horizons_are_as_long_as_the_logs() {
    let seconds = |samples: &[usize]| -> Vec<Option<f64>> {
        errors(&logs(samples, 0.0), &[]).iter().map(|of| of.seconds).collect()
    };
    assert_eq!(seconds(&[60]), [Some(0.1), Some(0.5), None]);
    assert_eq!(seconds(&[9]), [None]);
    assert!(seconds(&[5]).is_empty() && seconds(&[]).is_empty());
}

#[test]
fn a_wrong_model_is_beside_the_logs_and_the_median_window_is_in_the_middle() {
    let logs = logs(&[180], 0.0);
    let mut model = exact();
    model.weights[2 + 6] = 1e-3;
    let predictor = Predictor { model: &model, zeros: &[], logs: &logs };
    let predictions = predictor.predict().unwrap();
    let growth = predictions.growth(&logs);
    assert!(growth.len() == 101 && growth[100][0] > growth[100][1] && growth[0][0] < 1e-9);
    assert!(predictions.window_at(&logs, 0.5).is_some());
    assert!((predictor.largest_force(0) - INERTIA * ACCELERATION).abs() < 1e-12);
    assert!((predictor.range(0) - 0.5 * ACCELERATION * (179.0 * H).powi(2)).abs() < 1e-12);
}
