//! Explicit Runge–Kutta steps of q̈ = v̇(q, v).

use leastaction_core::linear::add_scaled;
pub use leastaction_programs::steps::RungeKutta;

/// State (q, v).
pub type State<const N: usize> = [[f64; N]; 2];

/// The state after a step of h (s) under accelerations v̇(q, v).
///
/// # Errors
/// The error of the first acceleration that does not exist.
pub fn step<E, const N: usize>(
    method: RungeKutta,
    h: f64,
    start: &State<N>,
    mut acceleration: impl FnMut(&[f64; N], &[f64; N]) -> Result<[f64; N], E>,
) -> Result<State<N>, E> {
    let mut rates: Vec<State<N>> = Vec::new();
    for shares in method.stages() {
        let [q, v] = moved(start, h, shares, &rates);
        rates.push([v, acceleration(&q, &v)?]);
    }
    Ok(moved(start, h, method.end(), &rates))
}

/// The state plus h times the weighted sum of the rates (v, v̇).
fn moved<const N: usize>(state: &State<N>, h: f64, shares: &[f64], rates: &[State<N>]) -> State<N> {
    shares.iter().zip(rates).fold(*state, |[q, v], (share, rate)| {
        [add_scaled(&q, h * share, &rate[0]), add_scaled(&v, h * share, &rate[1])]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// A swing whose friction and frequency depend on the position.
    fn swing([q]: &[f64; 1], [v]: &[f64; 1]) -> Result<[f64; 1], Infallible> {
        Ok([-2.0 * q.sin() - 0.3 * v * q.cos()])
    }

    fn after(method: RungeKutta, steps: usize) -> State<1> {
        let h = 1.5 / steps as f64;
        (0..steps).fold([[1.2], [0.4]], |state, _| {
            let Ok(end) = step(method, h, &state, swing);
            end
        })
    }

    #[test]
    fn the_error_falls_with_the_order() {
        let exact = after(RungeKutta::ThreeEighths, 4000);
        let error = |method, steps| {
            let [[q], [v]] = after(method, steps);
            (q - exact[0][0]).hypot(v - exact[1][0])
        };
        for (order, steps) in [(2, 40), (4, 10)] {
            let method = RungeKutta::of_order(order);
            let slope = (error(method, steps) / error(method, 4 * steps)).log2() / 2.0;
            assert!((slope - f64::from(order)).abs() < 0.2, "{method:?}: {slope}");
        }
    }
}
