//! Checks that every loss must pass.

use leastaction_programs::dynamics::Failures;
use leastaction_programs::losses::{Block, Derivatives, Loss};
use leastaction_programs::{Row, WIDTH};

/// Residuals of samples; none may fail.
pub fn evaluate(loss: &mut dyn Loss, weights: &[f64], block: &Block) -> Vec<Row> {
    let mut residual = vec![Row::default(); loss.components()];
    let failures = loss.evaluate(weights, block, &mut residual, Derivatives::None);
    assert!(!failures.any(WIDTH));
    residual
}

/// Checks the Jacobian against central differences, and the gradient against the Jacobian.
pub fn check_derivatives(loss: &mut dyn Loss, weights: &[f64], block: &Block, tolerance: f64) {
    let (n, p) = (loss.components(), weights.len());
    let mut residual = vec![Row::default(); n];
    let mut rows = vec![vec![Row::default(); p]; n];
    let failures = loss.evaluate(weights, block, &mut residual, Derivatives::Jacobian(&mut rows));
    assert!(!failures.any(WIDTH));
    assert_eq!(residual, evaluate(loss, weights, block));
    let mut gradient = vec![Row::default(); p];
    let failures = loss.evaluate(weights, block, &mut residual, Derivatives::Gradient(&mut gradient));
    assert!(!failures.any(WIDTH));
    for i in 0..p {
        let step = 1e-5;
        let [above, below] = [step, -step].map(|step| {
            let mut moved = weights.to_vec();
            moved[i] += step;
            evaluate(loss, &moved, block)
        });
        for sample in 0..WIDTH {
            let mut sum = 0.0;
            for c in 0..n {
                let difference = (above[c].0[sample] - below[c].0[sample]) / (2.0 * step);
                let (found, size) =
                    (rows[c][i].0[sample], rows[c].iter().fold(0.0_f64, |s, r| s.max(r.0[sample].abs())));
                let error = (found - difference).abs();
                assert!(
                    error < tolerance * (size + 1e-6),
                    "weight {i}, component {c}: {found} {difference} of {size}"
                );
                sum += found * residual[c].0[sample];
            }
            let error = (gradient[i].0[sample] - sum).abs();
            assert!(error < 1e-11 * (1.0 + sum.abs()), "{} {sum}", gradient[i].0[sample]);
        }
    }
}

/// Residuals and Jacobian.
fn differentiated(
    loss: &mut dyn Loss,
    weights: &[f64],
    block: &Block,
) -> (Failures, Vec<Row>, Vec<Vec<Row>>) {
    let components = loss.components();
    let mut residual = vec![Row::default(); components];
    let mut rows = vec![vec![Row::default(); weights.len()]; components];
    let failures = loss.evaluate(weights, block, &mut residual, Derivatives::Jacobian(&mut rows));
    (failures, residual, rows)
}

/// Checks that the bad samples of a block fail, with zero residual, Jacobian and gradient, and that the other samples
/// give the same as in the good block.
pub fn check_failures(loss: &mut dyn Loss, weights: &[f64], [good, bad]: [&Block; 2], failing: &[usize]) {
    let (none, residual, rows) = differentiated(loss, weights, good);
    let (failures, found, found_rows) = differentiated(loss, weights, bad);
    assert!(!none.any(WIDTH));
    let (mut alone, mut gradient) = (residual.clone(), vec![Row::default(); weights.len()]);
    let of_gradient = loss.evaluate(weights, bad, &mut alone, Derivatives::Gradient(&mut gradient));
    assert_eq!((of_gradient, &alone), (failures, &found));
    for sample in 0..WIDTH {
        let failed = failing.contains(&sample);
        assert_eq!(failures.0[sample], failed, "sample {sample}");
        let same = |found: &Row, good: &Row| found.0[sample] == if failed { 0.0 } else { good.0[sample] };
        assert!(found.iter().zip(&residual).all(|(found, good)| same(found, good)), "sample {sample}");
        let (found, good) = (found_rows.iter().flatten(), rows.iter().flatten());
        assert!(found.zip(good).all(|(found, good)| same(found, good)), "sample {sample}");
        assert!(gradient.iter().all(|g| g.0[sample].is_finite() && !(failed && g.0[sample] != 0.0)));
    }
}
