use super::State;

/// An explicit Runge–Kutta method for q̈ = v̇(q, v).
///
/// Source: Hairer, Nørsett and Wanner, "Solving Ordinary Differential Equations I", section II.1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RungeKutta {
    /// The explicit midpoint rule, of order 2: two stages.
    Midpoint,
    /// Kutta's 3/8 rule, of order 4: four stages. SyMo's authors call it RK4.
    ThreeEighths,
}

impl RungeKutta {
    /// Returns the 3/8 rule for order 4, otherwise the midpoint rule.
    pub fn of_order(order: u8) -> Self {
        if order == 4 { Self::ThreeEighths } else { Self::Midpoint }
    }

    /// Weights of the rates of the earlier stages in each stage.
    pub fn stages(self) -> &'static [&'static [f64]] {
        match self {
            Self::Midpoint => &[&[], &[0.5]],
            Self::ThreeEighths => &[&[], &[1.0 / 3.0], &[-1.0 / 3.0, 1.0], &[1.0, -1.0, 1.0]],
        }
    }

    /// Time of each stage, as a fraction of the step.
    pub fn times(self) -> impl Iterator<Item = f64> {
        self.stages().iter().map(|shares| shares.iter().sum())
    }

    /// Weight of the rate of each stage in the end of the step.
    pub fn end(self) -> &'static [f64] {
        match self {
            Self::Midpoint => &[0.0, 1.0],
            Self::ThreeEighths => &[0.125, 0.375, 0.375, 0.125],
        }
    }
}

/// Returns the state plus h times the weighted sum of the rates.
pub(crate) fn sum<'r>(state: &State, h: f64, shares: impl Iterator<Item = (f64, &'r State)>) -> State {
    let mut sum = state.clone();
    for (share, rate) in shares {
        sum.iter_mut().zip(rate).for_each(|(sum, rate)| sum.add_scaled(h * share, rate));
    }
    sum
}
