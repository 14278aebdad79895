//! Explicit Runge–Kutta steps of q̈ = v̇(q, v), and their adjoints.

use leastaction_core::linear::add_scaled;
use leastaction_core::scalar::Scalar;

/// An explicit Runge–Kutta method.
///
/// Source: Hairer, Nørsett and Wanner, "Solving Ordinary Differential Equations I", section II.1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RungeKutta {
    /// The explicit midpoint rule, of order 2: two stages.
    Midpoint,
    /// Kutta's 3/8 rule, of order 4: four stages. It is what SyMo's authors call RK4.
    ThreeEighths,
}

/// q and v.
pub type State<S, const N: usize> = [[S; N]; 2];

/// A state within a step, and the acceleration there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage<S, const N: usize> {
    /// Where.
    pub state: State<S, N>,
    /// v̇.
    pub acceleration: [S; N],
}

impl<S: Scalar, const N: usize> Stage<S, N> {
    /// (v, v̇).
    fn rate(&self) -> State<S, N> {
        [self.state[1], self.acceleration]
    }
}

/// The numbers of a method.
struct Tableau {
    /// Of each stage, how much of the rates of the stages before it.
    stages: &'static [&'static [f64]],
    /// How much of the rate of each stage the end has.
    end: &'static [f64],
}

const MIDPOINT: Tableau = Tableau { stages: &[&[], &[0.5]], end: &[0.0, 1.0] };
const THREE_EIGHTHS: Tableau = Tableau {
    stages: &[&[], &[1.0 / 3.0], &[-1.0 / 3.0, 1.0], &[1.0, -1.0, 1.0]],
    end: &[0.125, 0.375, 0.375, 0.125],
};

impl RungeKutta {
    /// The 3/8 rule for order 4, the midpoint rule for 2 or whatever else.
    pub fn of_order(order: u8) -> Self {
        if order == 4 { Self::ThreeEighths } else { Self::Midpoint }
    }

    fn tableau(self) -> Tableau {
        match self {
            Self::Midpoint => MIDPOINT,
            Self::ThreeEighths => THREE_EIGHTHS,
        }
    }

    /// When each stage is, as a fraction of the step.
    pub fn times(self) -> impl Iterator<Item = f64> {
        self.tableau().stages.iter().map(|shares| shares.iter().sum())
    }

    /// The stages of a step of h, s, under accelerations v̇(q, v).
    ///
    /// # Errors
    /// That of the first acceleration that does not exist.
    pub fn stages<S: Scalar, E, const N: usize>(
        self,
        h: f64,
        start: &State<S, N>,
        mut acceleration: impl FnMut(&[S; N], &[S; N]) -> Result<[S; N], E>,
    ) -> Result<Vec<Stage<S, N>>, E> {
        let mut stages: Vec<Stage<S, N>> = Vec::new();
        for shares in self.tableau().stages {
            let rates = shares.iter().zip(&stages).map(|(share, stage)| (*share, stage.rate()));
            let state = sum(start, h, rates);
            let acceleration = acceleration(&state[0], &state[1])?;
            stages.push(Stage { state, acceleration });
        }
        Ok(stages)
    }

    /// The state at the end of a step of these stages.
    pub fn end<S: Scalar, const N: usize>(
        self,
        h: f64,
        start: &State<S, N>,
        stages: &[Stage<S, N>],
    ) -> State<S, N> {
        sum(start, h, self.tableau().end.iter().zip(stages).map(|(share, stage)| (*share, stage.rate())))
    }

    /// Carries the adjoint of the end back through the stages, last to first.
    ///
    /// `pull` gets a stage's number and the adjoint y of its acceleration, and gives (y·∂v̇/∂q, y·∂v̇/∂v) there. So the derivative
    /// in a parameter of the end, weighed by `end_bar`, is Σ y·∂v̇ over the stages.
    pub fn adjoint<S: Scalar, const N: usize>(
        self,
        h: f64,
        end_bar: &State<S, N>,
        mut pull: impl FnMut(usize, &[S; N]) -> State<S, N>,
    ) {
        let Tableau { stages, end } = self.tableau();
        let zero = [[S::zero(); N]; 2];
        // Those of the stages' states.
        let mut bars = vec![zero; end.len()];
        for (k, share) in end.iter().enumerate().rev() {
            let later = (k + 1..end.len()).map(|later| (stages[later][k], bars[later]));
            let [v_bar, y] = sum(&zero, h, std::iter::once((*share, *end_bar)).chain(later));
            let [in_q, in_v] = pull(k, &y);
            bars[k] = [in_q, add_scaled(&in_v, S::one(), &v_bar)];
        }
    }
}

/// The state and h times the sum of these, each times its share.
fn sum<S: Scalar, const N: usize>(
    state: &State<S, N>,
    h: f64,
    shares: impl Iterator<Item = (f64, State<S, N>)>,
) -> State<S, N> {
    shares.fold(*state, |[q, v], (share, rate)| {
        let c = S::constant(h * share);
        [add_scaled(&q, c, &rate[0]), add_scaled(&v, c, &rate[1])]
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

    fn after(method: RungeKutta, steps: usize) -> State<f64, 1> {
        let h = 1.5 / steps as f64;
        (0..steps).fold([[1.2], [0.4]], |state, _| {
            let Ok(stages) = method.stages(h, &state, swing);
            method.end(h, &state, &stages)
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

    #[test]
    fn the_adjoint_is_the_derivative_in_a_force() {
        // One more force of size p in every acceleration.
        let end = |method: RungeKutta, p: f64| {
            let forced = |q: &[f64; 1], v: &[f64; 1]| swing(q, v).map(|[a]| [a + p * q[0]]);
            let (h, start) = (0.7, [[0.9], [-1.3]]);
            let Ok(stages) = method.stages(h, &start, forced);
            (method.end(h, &start, &stages), stages)
        };
        for method in [RungeKutta::Midpoint, RungeKutta::ThreeEighths] {
            let (_, stages) = end(method, 0.0);
            let (less, more) = (end(method, -1e-5).0, end(method, 1e-5).0);
            for (k, end_bar) in [[[1.0], [0.0]], [[0.0], [1.0]]].into_iter().enumerate() {
                let mut found = 0.0;
                method.adjoint(0.7, &end_bar, |stage, [y]| {
                    let [[q], [v]] = stages[stage].state;
                    found += y * q;
                    [[y * (-2.0 * q.cos() + 0.3 * v * q.sin())], [-y * 0.3 * q.cos()]]
                });
                let expected = (more[k][0] - less[k][0]) / 2e-5;
                assert!((found - expected).abs() < 1e-8, "{method:?}: {found} {expected}");
            }
        }
    }
}
