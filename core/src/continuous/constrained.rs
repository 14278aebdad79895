use crate::constraints::{
    Banded, Constrained, ConstraintError, Constraints, Positions, Rows, Workspace, at, inverse,
};
use crate::linear::{Matrix, add_scaled, multiply};
use crate::particles::Particles;
use crate::scalar::{Real, all_finite};

/// Feedback that drives a continuous simulation back to its constraints: φ̈ = −2ζω φ̇ − ω² φ (Baumgarte 1972).
///
/// Only explicit integrators need this feedback, because they let φ grow. [`crate::discrete::rattle::Rattle`]
/// keeps φ = 0 by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Baumgarte<R> {
    /// Rate ω ≥ 0, rad/s; useless beyond about 1/h.
    pub omega: R,
    /// Damping ratio ζ ≥ 0; 1 is critical.
    pub zeta: R,
}

impl<R: Real> Baumgarte<R> {
    /// No feedback: φ̈ = 0.
    pub fn none() -> Self {
        Self { omega: R::zero(), zeta: R::zero() }
    }
}

/// Inputs of a constrained acceleration other than the system itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive<'a, R, const D: usize> {
    /// External force on each node, N.
    pub force: Option<&'a [[R; D]]>,
    /// Feedback of the constraints.
    pub baumgarte: Baumgarte<R>,
}

impl<R: Real, const D: usize> Drive<'_, R, D> {
    /// No force and no feedback.
    pub fn none() -> Self {
        Self { force: None, baumgarte: Baumgarte::none() }
    }
}

/// Workspace length of [`constrained_acceleration`].
pub fn constrained_workspace<R, S, C, const D: usize>(mechanism: &Constrained<R, S, C, D>) -> usize
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    let system = mechanism.system();
    system.workspace() + system.nodes() * D * D + mechanism.matrix_workspace()
}

/// Writes the acceleration v̇ = M⁻¹(r + Aᵀλ), m/s², and the multipliers λ = −(A M⁻¹ Aᵀ)⁻¹(A M⁻¹ r + Ȧ v), N, with
/// r = L_q + Q + external force.
///
/// Positions need not satisfy the constraints (φ̈ = 0 holds wherever they are). After an error the outputs have no meaning.
pub fn constrained_acceleration<R, S, C, const D: usize>(
    mechanism: &Constrained<R, S, C, D>,
    (q, v): (&[[R; D]], &[[R; D]]),
    drive: &Drive<R, D>,
    workspace: &mut [R],
    (acceleration, lambda): (&mut [[R; D]], &mut [R]),
) -> Result<(), ConstraintError<R>>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    let (system, constraints) = (mechanism.system(), mechanism.constraints());
    for slice in [q, v, acceleration].into_iter().chain(drive.force) {
        mechanism.check_nodes(slice)?;
    }
    mechanism.check_equations(lambda)?;
    let mut workspace = Workspace::new(constrained_workspace(mechanism), workspace)?;
    system.l_q(q, workspace.numbers(system.workspace()), acceleration);
    let inverses = workspace.blocks(system.nodes());
    free_acceleration(system, v, drive.force, inverses, acceleration)?;

    let x = Positions::new(q);
    let rows = Rows { constraints, x };
    for (k, b) in lambda.iter_mut().enumerate() {
        *b = -(rows.times(k, acceleration) + constraints.curvature(k, x, v) + feedback(drive, &rows, k, v));
    }
    check_finite(acceleration, lambda)?;
    let mut matrix = Banded::new(mechanism.band(), workspace.numbers(mechanism.matrix_workspace()));
    matrix.set(true, |k, l| rows.coupling(k, inverses, &rows, l));
    matrix.factor().map_err(|constraint| ConstraintError::Redundant { constraint })?;
    matrix.solve(lambda);
    rows.transposed_times(lambda, |node, force| {
        if let (Some(a), Some(inverse)) = (acceleration.get_mut(node), inverses.get(node)) {
            *a = add_scaled(a, R::one(), &multiply(inverse, &force));
        }
    });
    check_finite(acceleration, lambda)
}

/// Writes the external force u = M a − L_q − Q on each node, N, that gives the acceleration a, m/s², without
/// help from the constraints (inverse dynamics). If a satisfies the constraints, they then carry no load. Any
/// other force with the same effect differs from u by some Aᵀλ.
///
/// The workspace is that of [`constrained_acceleration`]. After an error the output has no meaning.
pub fn constrained_inverse_dynamics<R, S, C, const D: usize>(
    mechanism: &Constrained<R, S, C, D>,
    [q, v, a]: [&[[R; D]]; 3],
    workspace: &mut [R],
    force: &mut [[R; D]],
) -> Result<(), ConstraintError<R>>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    for slice in [q, v, a, force] {
        mechanism.check_nodes(slice)?;
    }
    let system = mechanism.system();
    let mut workspace = Workspace::new(constrained_workspace(mechanism), workspace)?;
    system.l_q(q, workspace.numbers(system.workspace()), force);
    let masses = workspace.blocks(system.nodes());
    system.masses(0, v, masses);
    for (node, (((force, v), a), mass)) in force.iter_mut().zip(v).zip(a).zip(masses).enumerate() {
        let r = add_scaled(force, R::one(), &system.drag(node, v));
        *force = add_scaled(&multiply(mass, a), -R::one(), &r);
    }
    check_finite(force, &[])
}

fn check_finite<R: Real, const D: usize>(
    acceleration: &[[R; D]],
    lambda: &[R],
) -> Result<(), ConstraintError<R>> {
    let finite = acceleration.iter().all(all_finite) && lambda.iter().all(|lambda| lambda.is_finite());
    if finite { Ok(()) } else { Err(ConstraintError::NotFinite) }
}

/// Replaces L_q by M⁻¹ r, and stores the blocks of M⁻¹.
fn free_acceleration<R: Real, S: Particles<R, D>, const D: usize>(
    system: &S,
    v: &[[R; D]],
    force: Option<&[[R; D]]>,
    inverses: &mut [Matrix<R, D>],
    l_q: &mut [[R; D]],
) -> Result<(), ConstraintError<R>> {
    system.masses(0, v, inverses);
    for (node, ((v, l_q), block)) in v.iter().zip(l_q).zip(inverses).enumerate() {
        *block = inverse(*block).ok_or(ConstraintError::Mass { node })?;
        let mut r = add_scaled(l_q, R::one(), &system.drag(node, v));
        if let Some(force) = force {
            r = add_scaled(&r, R::one(), &at(force, node));
        }
        *l_q = multiply(block, &r);
    }
    Ok(())
}

/// 2ζω φ̇ + ω² φ.
fn feedback<R: Real, C: Constraints<R, D> + ?Sized, const D: usize>(
    drive: &Drive<R, D>,
    rows: &Rows<R, C, D>,
    k: usize,
    v: &[[R; D]],
) -> R {
    let Baumgarte { omega, zeta } = drive.baumgarte;
    let damped = (zeta + zeta) * rows.times(k, v);
    omega * (damped + omega * rows.constraints.value(k, rows.x))
}
