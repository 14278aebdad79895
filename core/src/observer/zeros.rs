use crate::continuous::ContinuousState;
use crate::discrete::StepError;
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{Matrix, add_scaled, diagonal, dot, multiply, solve_many};
use crate::scalar::{Real, all_finite};

/// Prior knowledge of the encoders' zeros.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZerosPrior<R> {
    /// Standard deviation σ_z > 0 of the zeros, rad or m.
    pub deviation: R,
    /// Standard deviation σ > 0 of an innovation, rad or m; with a larger one, the zeros are learned more slowly.
    pub innovation: R,
}

/// Limit of an innovation, in standard deviations.
const OUTLIER: f64 = 3.0;

/// The zeros with their covariance, and the derivatives of the estimate in the zeros.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Zeros<R, const N: usize> {
    /// Zeros ẑ.
    estimate: [R; N],
    /// Covariance P.
    covariance: Matrix<R, N>,
    /// ∂q̂/∂ẑ, entry \[c\]\[i\] = ∂q̂_i/∂ẑ_c.
    positions: Matrix<R, N>,
    /// ∂v̂/∂ẑ, indexed like `positions`.
    velocities: Matrix<R, N>,
}

impl<R: Real, const N: usize> Zeros<R, N> {
    pub(super) fn new(prior: Option<ZerosPrior<R>>) -> Self {
        let variance = prior.map_or(R::zero(), |prior| prior.deviation * prior.deviation);
        let zero = [[R::zero(); N]; N];
        Self {
            estimate: [R::zero(); N],
            covariance: diagonal([variance; N]),
            positions: zero,
            velocities: zero,
        }
    }

    pub(super) fn estimate(&self) -> [R; N] {
        self.estimate
    }

    pub(super) fn deviation(&self) -> [R; N] {
        core::array::from_fn(|i| self.covariance[i][i].max(R::zero()).sqrt())
    }

    /// Sets the derivatives for an estimate that begins at rest at y − ẑ.
    pub(super) fn follow_readings(&mut self) {
        self.positions = diagonal([-R::one(); N]);
        self.velocities = [[R::zero(); N]; N];
    }

    /// The zeros after a step of h seconds to (q, v) under τ.
    pub(super) fn stepped<L: Lagrangian<R, N>, F: Forces<R, N>>(
        &self,
        system: &System<L, F>,
        (q, v, tau): (&[R; N], &[R; N], &[R; N]),
        h: R,
    ) -> Result<Self, StepError<R>> {
        let d = system.lagrangian.hessian(q, v);
        let (q_q, q_v) = system.forces.derivatives(q, v, tau);
        let stiffness = sum(&d.l_qq, R::one(), &q_q);
        let forces = core::array::from_fn(|c| {
            add_scaled(
                &multiply(&stiffness, &self.positions[c]),
                R::one(),
                &multiply(&q_v, &self.velocities[c]),
            )
        });
        let changes = solve_many(sum(&d.l_vv, -h, &q_v), forces)?;
        let velocities = sum(&self.velocities, h, &changes);
        Ok(Self { positions: sum(&self.positions, h, &velocities), velocities, ..*self })
    }

    /// Applies a correction of coordinate i by (α, β/h) of its innovation, and returns ψ, the rate at which the innovation falls as ẑ
    /// rises.
    pub(super) fn corrected(&mut self, i: usize, alpha: R, rate: R) -> [R; N] {
        let own = |c: usize| if c == i { R::one() } else { R::zero() };
        let direction: [R; N] = core::array::from_fn(|c| own(c) + self.positions[c][i]);
        for (c, psi) in direction.iter().enumerate() {
            self.positions[c][i] -= alpha * *psi;
            self.velocities[c][i] -= rate * *psi;
        }
        direction
    }

    /// Takes one step of recursive least squares along ψ, and moves the estimate along.
    pub(super) fn learn(
        &mut self,
        direction: &[R; N],
        innovation: R,
        prior: &ZerosPrior<R>,
        estimate: &mut ContinuousState<R, N>,
    ) {
        let spread = multiply(&self.covariance, direction);
        let variance = prior.innovation * prior.innovation + dot(direction, &spread);
        let limit = R::constant(OUTLIER) * variance.sqrt();
        let size = innovation.abs();
        let believed = if size > limit { innovation * (limit / size) } else { innovation };
        let change = spread.map(|spread| spread * (believed / variance));
        for c in 0..N {
            self.estimate[c] += change[c];
            self.covariance[c] = add_scaled(&self.covariance[c], -(spread[c] / variance), &spread);
            estimate.q = add_scaled(&estimate.q, change[c], &self.positions[c]);
            estimate.v = add_scaled(&estimate.v, change[c], &self.velocities[c]);
        }
    }

    pub(super) fn check(&self) -> Result<(), StepError<R>> {
        let both = [&self.positions, &self.velocities];
        let finite = all_finite(&self.estimate) && both.iter().all(|rows| rows.iter().all(all_finite));
        if finite { Ok(()) } else { Err(StepError::NotFinite) }
    }
}

/// a + c b.
fn sum<R: Real, const N: usize>(a: &Matrix<R, N>, c: R, b: &Matrix<R, N>) -> Matrix<R, N> {
    core::array::from_fn(|i| add_scaled(&a[i], c, &b[i]))
}
