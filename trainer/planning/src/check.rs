//! Trial of a plan: the chip's law follows it from other starts, on the plant as it is and on one whose masses are off.

use crate::machine::visit;
use crate::task::Check;
use crate::{Machine, Plan, PlanError};
use leastaction_core::control::Plant;
use leastaction_core::plan::{Plan as Followed, PlanFile};
use leastaction_models::Model;
use leastaction_replica::{StateVisitor, SystemOf};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::array::from_fn;

/// Result of a trial.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Trials {
    /// Number of starts.
    pub starts: usize,
    /// Starts from which the plant as it is reached the end.
    pub exact: usize,
    /// Starts from which a plant with other masses did.
    pub off: usize,
}

/// Largest deviation at the end, in the deviations of equal weight of the gains.
const REACHED: f64 = 1.0;

impl Plan {
    /// Follows the plan from random starts around its own. A motion counts if it stays finite and ends near the goal; if the drives hold
    /// the goal, a while later.
    ///
    /// # Errors
    /// [`PlanError::Motion`] if plan or model cannot be written as for the chip.
    pub fn trials(&self, machine: &Machine, check: &Check) -> Result<Trials, PlanError> {
        let mut random = Pcg64Mcg::seed_from_u64(self.task.search.seed ^ 0x5eed);
        let mut trials = Trials { starts: check.starts, ..Trials::default() };
        let bytes = self.all_driven()?;
        for _ in 0..check.starts {
            let mut one = || 2.0 * random.random::<f64>() - 1.0;
            let deviation: Vec<f64> = check.x.iter().map(|spread| spread * one()).collect();
            let factors: Vec<f64> = (0..self.task.n()).map(|_| 1.0 + check.masses * one().signum()).collect();
            trials.exact += usize::from(self.reaches(&machine.model, &bytes, &deviation)?);
            trials.off +=
                usize::from(self.reaches(&with_masses(&machine.model, &factors), &bytes, &deviation)?);
        }
        Ok(trials)
    }

    /// Whether the plant of a model reaches the end from a start that deviates.
    fn reaches(&self, model: &Model, plan: &[u8], deviation: &[f64]) -> Result<bool, PlanError> {
        visit(model, Trial { plan: self, model, file: plan, deviation })
    }
}

/// A model whose masses, and with them its inertias, are multiplied by a factor for each body; a model without bodies gets weaker or
/// stronger drives instead.
fn with_masses(model: &Model, factors: &[f64]) -> Model {
    let mut other = model.clone();
    let masses = model.architecture.family.masses();
    for (positions, factor) in masses.iter().zip(factors.iter().cycle()) {
        for position in positions {
            if let Some(number) = other.weights.get_mut(*position) {
                *number *= factor;
            }
        }
    }
    if masses.is_empty() {
        let factor = factors.first().copied().unwrap_or(1.0);
        other.facts.actuator.gain.iter_mut().for_each(|gain| *gain /= factor);
    }
    other
}

/// A motion along a plan.
struct Trial<'t> {
    plan: &'t Plan,
    model: &'t Model,
    file: &'t [u8],
    deviation: &'t [f64],
}

impl<'c> StateVisitor<'c> for Trial<'_> {
    type Output = Result<bool, PlanError>;

    fn states<const N: usize, const D: usize>(self, system: &'c SystemOf<'c, N>) -> Self::Output {
        let mut words = vec![0_u32; self.file.len().div_ceil(size_of::<u32>())];
        let memory: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
        memory.iter_mut().zip(self.file).for_each(|(to, from)| *to = *from);
        let bytes = memory.get(..self.file.len()).unwrap_or_default();
        let failed = |error: leastaction_core::plan::PlanError| PlanError::Motion(error.to_string());
        let file = PlanFile::parse(bytes).map_err(failed)?;
        let law = Followed::<N, N>::new(file).map_err(failed)?;
        let end: Option<[f64; D]> = self.followed(&law, system);
        Ok(end.is_some_and(|end| self.is_near(&end)))
    }

    fn graph(self) -> Self::Output {
        Ok(false)
    }
}

impl Trial<'_> {
    /// State after the motion, and after a rest of a third of its time if the drives hold it.
    fn followed<const N: usize, const D: usize>(
        &self,
        law: &Followed<N, N>,
        system: &SystemOf<N>,
    ) -> Option<[f64; D]> {
        let plant = self.plan.task.plant::<N>(system, self.model);
        let start = |i: usize| Some(self.plan.task.start.get(i)? + self.deviation.get(i)?);
        let mut x: [f64; D] = from_fn(|i| start(i).unwrap_or_default());
        let mut motion = plant.begin(&x).ok()?;
        let rest = if self.plan.holds { law.ticks() / 3 } else { 0 };
        for tick in 0..law.ticks().saturating_add(rest) {
            let half = |from: usize| -> [f32; N] { from_fn(|i| x.get(from + i).map_or(0.0, |x| *x as f32)) };
            let u = law.command(tick, &half(0), &half(N)).ok()?;
            x = plant.advance(&mut motion, (1, &u.map(f64::from)), &mut [0.0; D]).ok()?;
        }
        Some(x)
    }

    fn is_near(&self, end: &[f64]) -> bool {
        let task = &self.plan.task;
        let each = end.iter().zip(&self.plan.end.x).zip(&task.follow.x).zip(&task.goal.turns);
        each.into_iter().all(|(((x, end), deviation), turns)| {
            let off = x - end;
            let off = if *turns { leastaction_core::scalar::Real::short_way(off) } else { off };
            off.abs() <= REACHED * deviation
        })
    }
}
