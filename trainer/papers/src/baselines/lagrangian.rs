//! Common parts of all models in which a network gives the Lagrangian as one number.

use super::enough_weights;
use leastaction_core::constraints::{Constraints, Holonomic, Positions};
use leastaction_core::model::ModelError;
use leastaction_learning::training::{Objective, Samples, objective_of};
use leastaction_models::accelerations::Accelerations;
use leastaction_models::parallel::Pool;
use leastaction_programs::dynamics::{Failures, Rods};
use leastaction_programs::energies::Energies;
use leastaction_programs::losses::{AccelerationLoss, Block, Derivatives, Loss};
use leastaction_programs::{Builder, Program, Row, System, WIDTH, Workspace};
use nalgebra::{DMatrix, DVector};
use std::array::from_fn;

/// Mean squared error of v̇ with rods; infinite if an acceleration does not exist. `definite` says whether A L_vv⁻¹Aᵀ
/// must be positive definite.
pub(super) fn acceleration_error(
    energies: &dyn Energies,
    (rods, definite): (Rods, bool),
    samples: Samples,
) -> Box<dyn Objective> {
    let system = System::new(energies);
    let parameters = system.parameters();
    let loss = move || AccelerationLoss::with_rods(&system, rods.clone(), definite);
    objective_of(move || Box::new(Everywhere(loss())), parameters, samples)
}

/// A loss that is undefined as a whole if one sample cannot be computed.
struct Everywhere(AccelerationLoss);

impl Loss for Everywhere {
    fn components(&self) -> usize {
        self.0.components()
    }

    fn evaluate(
        &mut self,
        weights: &[f64],
        block: &Block,
        residual: &mut [Row],
        derivatives: Derivatives,
    ) -> Failures {
        self.0.evaluate(weights, block, residual, derivatives)
    }

    fn of_constant_velocity(&self, _: &Block) -> Option<Vec<Row>> {
        None
    }
}

/// Returns v̇(q, v) of particles on any number of rods: L_vv v̇ = L_q − L_vq v + Aᵀλ, A v̇ = −Ȧv.
pub(super) fn motion<'w, const D: usize>(
    energies: &dyn Energies,
    rods: Vec<Holonomic<f64, D>>,
    weights: &'w [f64],
) -> Result<Box<Accelerations<'w>>, ModelError> {
    enough_weights(weights, energies.parameters())?;
    let (n, slopes) = (energies.n(), slopes(energies));
    let pool = Pool::new(move || (slopes.clone(), slopes.workspace()));
    Ok(Box::new(move |q, v, out| {
        let fits = [q.len(), v.len(), out.len()] == [n; 3];
        let (mass, force) = fits.then(|| pool.with(|own| equation(own, weights, [q, v])))?;
        out.copy_from_slice(&on_rods(&rods, (mass, force), [q, v])?);
        Some(())
    }))
}

/// Program with inputs q, v, δq, δv; outputs L_q, and the derivative of L_v along (δq, δv).
fn slopes(energies: &dyn Energies) -> Program {
    let mut builder = Builder::new();
    let [q, v, dq, dv] = [(); 4].map(|()| builder.input(energies.n()));
    let [kinetic, potential] = energies.energies(&mut builder, q, v);
    let lagrangian = builder.difference(kinetic, potential);
    let one = builder.constant(&[1.0]);
    let slope = builder.pull_back(lagrangian, one);
    let [l_q, l_v] = [q, v].map(|x| slope.of(&mut builder, x));
    let along = builder.tangents(&[l_v], &[(q, dq), (v, dv)])[0];
    Program::new(&builder, &[l_q, along], &[])
}

/// Computes L_vv, and L_q − L_vq v. The lanes of the program are directions here: first that of the motion, then the
/// axes of v.
fn equation(
    (program, workspace): &mut (Program, Workspace),
    weights: &[f64],
    [q, v]: [&[f64]; 2],
) -> (DMatrix<f64>, DVector<f64>) {
    let n = q.len();
    let (mut mass, mut force) = (DMatrix::zeros(n, n), DVector::zeros(n));
    let [q, still] = [q, v].map(|x| x.iter().copied().map(Row::splat).collect::<Vec<_>>());
    for first in (0..=n).step_by(WIDTH) {
        let unit = |i: usize| Row(from_fn(|lane| f64::from(u8::from(first + lane == i + 1))));
        let along = |v: &f64| Row(from_fn(|lane| if first + lane == 0 { *v } else { 0.0 }));
        let (dq, dv): (Vec<_>, Vec<_>) = (v.iter().map(along).collect(), (0..n).map(unit).collect());
        program.run(weights, &[&q, &still, &dq, &dv], workspace, &mut []);
        let (l_q, moved) = (workspace.output(0), workspace.output(1));
        for (lane, direction) in (first..=n).take(WIDTH).enumerate() {
            for i in 0..n {
                match direction.checked_sub(1) {
                    None => force[i] = l_q[i].0[lane] - moved[i].0[lane],
                    Some(j) => mass[(i, j)] = moved[i].0[lane],
                }
            }
        }
    }
    (mass, force)
}

/// Acceleration v̇, solved together with the multipliers.
fn on_rods<const D: usize>(
    rods: &[Holonomic<f64, D>],
    (mass, force): (DMatrix<f64>, DVector<f64>),
    [q, v]: [&[f64]; 2],
) -> Option<Vec<f64>> {
    let (n, equations) = (q.len(), rods.len());
    let mut matrix = mass.resize(n + equations, n + equations, 0.0);
    let mut right = force.resize_vertically(n + equations, 0.0);
    let (x, rates) = (Positions::new(q.as_chunks().0), v.as_chunks().0);
    for (k, row) in (n..).zip(0..equations) {
        for (slot, node) in rods.nodes(row).iter().enumerate() {
            for (i, along) in (D * node..).zip(rods.gradient(row, slot, x)) {
                (matrix[(k, i)], matrix[(i, k)]) = (along, -along);
            }
        }
        right[k] = -rods.curvature(row, x, rates);
    }
    let solution = matrix.lu().solve(&right)?;
    Some(solution.as_slice()[..n].to_vec())
}
