//! A learned double pendulum that is stepped a million times in single precision. With the DEL equation its energy
//! stays bounded; with a Runge–Kutta method on the same accelerations the energy drifts.

use super::LearnedTree;
use crate::task::TaskError;
use leastaction_core::continuous::{ContinuousState, energy, rk4_step};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Path, State};
use leastaction_core::energy::modular::{MAX_TYPES, Modular};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::solve;
use leastaction_core::model::Laws;
use leastaction_core::scalar::Scalar;
use serde::Serialize;

const N: usize = 2;
const WIDTH: usize = 64;
const DEPTH: usize = 3;
/// Number of energies kept of each run.
const KEPT: usize = 1000;

type Tree<'w, S> = System<Modular<'w, <S as Scalar>::Weight, N, MAX_TYPES, WIDTH, DEPTH>, Viscous<S, N>>;

/// Energies along three runs, minus the energy at the start, J.
#[derive(Clone, Debug, PartialEq)]
pub struct LongRun {
    /// Number of steps of each run.
    pub steps: usize,
    /// Step size, s.
    pub h: f32,
    /// Energy errors of the DEL equation of order 2: (time, error).
    pub del_2: Vec<(f64, f64)>,
    /// Energy errors of the DEL equation of order 4: (time, error).
    pub del_4: Vec<(f64, f64)>,
    /// Energy errors of the classical Runge–Kutta method of order 4 on the accelerations: (time, error).
    pub rk4: Vec<(f64, f64)>,
}

/// Summary of the energy errors of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Energies {
    /// Largest error, J.
    pub largest: f64,
    /// Change over the run of the straight line fitted to the errors, J.
    pub drift: f64,
}

impl Energies {
    /// Summarises errors at equally spaced times.
    pub fn of(errors: &[(f64, f64)]) -> Self {
        let n = errors.len() as f64;
        let (mx, my) =
            (errors.iter().map(|e| e.0).sum::<f64>() / n, errors.iter().map(|e| e.1).sum::<f64>() / n);
        let covariance: f64 = errors.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
        let variance: f64 = errors.iter().map(|(x, _)| (x - mx) * (x - mx)).sum();
        let span = errors.last().map_or(0.0, |last| last.0);
        Self {
            largest: errors.iter().map(|e| e.1.abs()).fold(0.0, f64::max),
            drift: covariance / variance * span,
        }
    }
}

/// Steps a model of two pendulums from rest at 0.9 and −0.6 rad, by all three methods.
pub fn long_run(model: &LearnedTree, steps: usize, h: f32) -> Result<LongRun, TaskError> {
    let rounded: Vec<f32> = model.weights.iter().map(|w| *w as f32).collect();
    let exact: Vec<f64> = rounded.iter().map(|w| f64::from(*w)).collect();
    let header = model.architecture.header();
    let tree = model.architecture.tree_header();
    let system: Tree<f32> = header.system(&tree, Laws::VISCOUS, &rounded)?;
    let judge: Tree<f64> = header.system(&tree, Laws::VISCOUS, &exact)?;
    let run = Run { system, judge, steps, h, every: steps.div_ceil(KEPT).max(1) };
    Ok(LongRun { steps, h, del_2: run.del::<Midpoint>()?, del_4: run.del::<Galerkin>()?, rk4: run.rk4()? })
}

struct Run<'w> {
    system: Tree<'w, f32>,
    /// The model in double precision, which evaluates the energies.
    judge: Tree<'w, f64>,
    steps: usize,
    h: f32,
    every: usize,
}

const START: ContinuousState<f32, N> = ContinuousState { q: [0.9, -0.6], v: [0.0; N] };

impl Run<'_> {
    fn del<P: Path>(&self) -> Result<Vec<(f64, f64)>, TaskError> {
        let del = Del::<f32, P>::new(self.h);
        let mut state = State::new(&self.system.lagrangian, START.q, START.v)?;
        self.run(|| {
            del.step(&self.system, &mut state, &Control::held([0.0; N]))?;
            let q = state.q().map(f64::from);
            let mass = self.judge.lagrangian.dynamics(&q, &[0.0; N]).mass;
            Ok((q, solve(mass, state.p().map(f64::from))?))
        })
    }

    fn rk4(&self) -> Result<Vec<(f64, f64)>, TaskError> {
        let mut state = START;
        self.run(|| {
            state = rk4_step(&self.system, &state, &[0.0; N], self.h)?;
            Ok((state.q.map(f64::from), state.v.map(f64::from)))
        })
    }

    /// Energy errors after every `every` steps.
    fn run(
        &self,
        mut step: impl FnMut() -> Result<([f64; N], [f64; N]), TaskError>,
    ) -> Result<Vec<(f64, f64)>, TaskError> {
        let energy = |q: &[f64; N], v: &[f64; N]| energy(&self.judge.lagrangian, q, v);
        let start = energy(&START.q.map(f64::from), &START.v.map(f64::from));
        let mut errors = Vec::with_capacity(KEPT);
        for k in 1..=self.steps {
            let (q, v) = step()?;
            if k.is_multiple_of(self.every) {
                errors.push((k as f64 * f64::from(self.h), energy(&q, &v) - start));
            }
        }
        Ok(errors)
    }
}
