//! A loss over all samples, as the optimisers see it: sums over fixed parts, each computed in order on one thread, added
//! in order. Results do not depend on the number of threads.

use super::loss::{AccelerationLoss, DelLoss, Failed, Group, GroupLoss, Systems, Term, TermKind};
use super::{LossKind, NormalEquations, Samples};
use crate::architecture::{Architecture, Family, FamilySystem, MAX_DISCRETE, Visitor, too_large_for_steps};
use crate::parallel;
use faer::Mat;
use leastaction_core::discrete::{Del, Galerkin, Midpoint, Newton, Path};
use leastaction_core::energy::Learnable;
use leastaction_core::forces::System;
use leastaction_core::model::ModelError;
use leastaction_core::scalar::{LANES, Lanes};
use std::ops::Range;

/// Samples whose rows are multiplied at once; not a power of two, for columns of the Jacobian would then share cache lines.
const CHUNK: usize = 248;
/// Parts whose sums are computed apart: as many threads as this can help.
const PARTS: usize = 8;

/// A sum of squares to minimise over the weights.
pub trait Objective: Sync {
    /// Numbers in the weight block.
    fn parameters(&self) -> usize;
    /// Samples.
    fn samples(&self) -> usize;
    /// Mean squared residual component; infinite where a sample cannot be evaluated at these weights.
    fn loss(&self, weights: &[f64]) -> f64;
    /// The normal equations at these weights; `None` where a sample cannot be evaluated.
    fn normal_equations(&self, weights: &[f64]) -> Option<NormalEquations>;
    /// Jᵀr and rᵀr alone, over some samples; `None` where one cannot be evaluated.
    fn gradient(&self, weights: &[f64], samples: Range<usize>) -> Option<NormalEquations>;
    /// Brings weights that have a range (damping ≥ 0) back into it.
    fn project(&self, weights: &mut [f64]);
}

/// The objective of a loss over samples for a model of this shape; `order` (2 or 4) matters to the discrete losses.
///
/// # Errors
/// Where the shape is beyond what is compiled.
pub fn objective(
    architecture: &Architecture,
    samples: Samples,
    kind: LossKind,
    order: u8,
) -> Result<Box<dyn Objective>, ModelError> {
    architecture.parameters()?;
    architecture.dispatch(Build { architecture: architecture.clone(), samples, kind, order })?
}

struct Build {
    architecture: Architecture,
    samples: Samples,
    kind: LossKind,
    order: u8,
}

impl Visitor for Build {
    type Output = Result<Box<dyn Objective>, ModelError>;

    fn visit<F: Family<N> + Clone + 'static, const N: usize>(self, family: &F) -> Self::Output {
        let h = self.samples.h;
        match (self.kind, self.order) {
            (LossKind::Acceleration, _) => Ok(self.boxed(family, AccelerationLoss)),
            // What is false for a constant is not compiled.
            _ if const { N > MAX_DISCRETE } => too_large_for_steps(N),
            (kind, 4) => Ok(self.boxed(family, del_loss::<Galerkin>(h, kind))),
            (kind, _) => Ok(self.boxed(family, del_loss::<Midpoint>(h, kind))),
        }
    }
}

impl Build {
    fn boxed<F: Family<N> + Clone + 'static, T: GroupLoss<F, N> + 'static, const N: usize>(
        self,
        family: &F,
        loss: T,
    ) -> Box<dyn Objective> {
        let Self { architecture, samples, .. } = self;
        let (damping, fixed) = (architecture.damping_positions(), architecture.fixed_positions());
        Box::new(Sum { architecture, family: family.clone(), damping, fixed, samples, loss })
    }
}

fn del_loss<P: Path>(h: f64, kind: LossKind) -> DelLoss<P> {
    let newton = Newton { max_iterations: 12, stop: 1e-14, accept: 1e-9 };
    DelLoss { del: Del::with_newton(h, newton), newton, next_position: kind == LossKind::NextPosition }
}

struct Sum<F, T, const N: usize> {
    architecture: Architecture,
    family: F,
    /// Where each coordinate has its damping, where it has any.
    damping: Vec<usize>,
    /// What the loss is not to be varied in.
    fixed: Vec<usize>,
    samples: Samples,
    loss: T,
}

impl<F: Family<N>, T: GroupLoss<F, N>, const N: usize> Sum<F, T, N> {
    /// The chunks of each part.
    fn parts(&self, samples: Range<usize>) -> Vec<Vec<Range<usize>>> {
        let chunk = CHUNK.min(samples.len().div_ceil(PARTS).next_multiple_of(LANES)).max(LANES);
        let chunks: Vec<_> =
            samples.clone().step_by(chunk).map(|start| start..samples.end.min(start + chunk)).collect();
        let per_part = chunks.len().div_ceil(PARTS).max(1);
        chunks.chunks(per_part).map(<[_]>::to_vec).collect()
    }

    /// Sums over parts: each on one thread, merged in order.
    fn sum(
        &self,
        samples: Range<usize>,
        zero: impl Fn() -> NormalEquations + Sync,
        add: impl Fn(&mut NormalEquations, &mut ChunkRows, Range<usize>) -> Result<(), Failed> + Sync,
    ) -> Option<NormalEquations> {
        let parts = self.parts(samples);
        let sums: Vec<Option<NormalEquations>> = parallel::map(parts.len(), &|k| {
            let (mut sum, mut room) = (zero(), ChunkRows::new());
            parts[k].iter().try_for_each(|chunk| add(&mut sum, &mut room, chunk.clone())).ok()?;
            Some(sum)
        });
        sums.into_iter().reduce(|total, part| {
            let (mut total, part) = (total?, part?);
            total.merge(&part);
            Some(total)
        })?
    }

    fn rows<'s, 'w>(&'s self, systems: &'s Systems<'w, F, N>) -> Rows<'s, FamilySystem<'w, F, Lanes, N>> {
        let Self { damping, fixed, .. } = self;
        Rows { system: &systems.eight, kinds: self.loss.kinds(), damping, fixed }
    }

    /// The samples from `start` on; the last of `samples` fills the group up.
    fn group(&self, start: usize, samples: &Range<usize>) -> Group<N> {
        std::array::from_fn(|lane| self.samples.get((start + lane).min(samples.end - 1)))
    }

    fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed> {
        let systems = Systems::new(&self.family, weights)?;
        let mut sum = 0.0;
        for start in samples.clone().step_by(LANES) {
            let residuals = self.loss.residuals(&systems, &self.group(start, &samples))?;
            let own = residuals.iter().take(samples.end - start);
            sum += own.map(|residual| residual.iter().map(|r| r * r).sum::<f64>()).sum::<f64>();
        }
        Ok(sum)
    }

    /// Residuals and their derivatives of a chunk: component i of sample k is row i · samples + k.
    fn linearise(&self, weights: &[f64], samples: Range<usize>, rows: &mut ChunkRows) -> Result<(), Failed> {
        let systems = Systems::new(&self.family, weights)?;
        let (count, width) = (samples.len(), self.loss.kinds().len());
        rows.reset(count * N, weights.len());
        for start in (0..count).step_by(LANES) {
            let mut terms = [const { Vec::new() }; LANES];
            let group = self.group(samples.start + start, &samples);
            let residuals = self.loss.linearise_group(&systems, &group, &mut terms)?;
            for (k, residual) in (start..count).zip(residuals) {
                for (i, residual) in residual.into_iter().enumerate() {
                    rows.residual[i * count + k] = residual;
                }
            }
            for i in 0..N {
                let terms = terms.each_ref().map(|terms| &terms[i * width..]);
                rows.buffer.fill(Lanes([0.0; LANES]));
                self.rows(&systems).add(terms, &mut rows.buffer);
                rows.store(i * count + start, (count - start).min(LANES));
            }
        }
        Ok(())
    }

    /// Adds r·∂r/∂θ of a chunk, without its Jacobian: the terms are linear in their weights, so a sample's components are
    /// added before the network is differentiated.
    fn add_gradient(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        sum: &mut NormalEquations,
    ) -> Result<(), Failed> {
        let systems = Systems::new(&self.family, weights)?;
        let mut buffer = vec![Lanes([0.0; LANES]); weights.len()];
        for start in samples.clone().step_by(LANES) {
            let mut terms = [const { Vec::new() }; LANES];
            let group = self.group(start, &samples);
            let mut residuals = self.loss.linearise_group(&systems, &group, &mut terms)?;
            for residual in residuals.iter_mut().skip(samples.end - start) {
                *residual = [0.0; N];
            }
            sum.squares += residuals.as_flattened().iter().map(|r| r * r).sum::<f64>();
            let weighed: [Vec<Term<N>>; LANES] =
                std::array::from_fn(|lane| contracted(&residuals[lane], &terms[lane], self.loss.kinds()));
            self.rows(&systems).add(weighed.each_ref().map(Vec::as_slice), &mut buffer);
        }
        for (gradient, lanes) in sum.gradient.iter_mut().zip(&buffer) {
            *gradient += lanes.0.iter().sum::<f64>();
        }
        sum.rows += samples.len() * N;
        Ok(())
    }
}

/// Of each kind one term: the components' terms, weighed by the residual.
fn contracted<const N: usize>(residual: &[f64; N], terms: &[Term<N>], kinds: &[TermKind]) -> Vec<Term<N>> {
    let weighed = |(k, kind): (usize, &TermKind)| {
        let of_kind = || terms.iter().skip(k).step_by(kinds.len()).zip(residual);
        let sum = |field: fn(&Term<N>) -> &[f64; N]| -> [f64; N] {
            std::array::from_fn(|i| of_kind().map(|(term, r)| r * field(term)[i]).sum())
        };
        let first = terms[k];
        let dv = if *kind == TermKind::Residual { first.dv } else { sum(|term| &term.dv) };
        Term { dq: sum(|term| &term.dq), dv, ..first }
    };
    kinds.iter().enumerate().map(weighed).collect()
}

/// What the rows of the Jacobian depend on beside the terms: the family alone, whatever the loss.
struct Rows<'s, Y> {
    system: &'s Y,
    kinds: &'s [TermKind],
    /// Where each coordinate has its damping, where it has any.
    damping: &'s [usize],
    /// What the loss is not to be varied in.
    fixed: &'s [usize],
}

impl<L, D> Rows<'_, System<L, D>> {
    /// Adds the derivatives in the weights of one residual component of eight samples; `terms\[lane\]\[k\]` is the term of
    /// kind k.
    fn add<const N: usize>(&self, terms: [&[Term<N>]; LANES], row: &mut [Lanes])
    where
        L: Learnable<Lanes, N>,
    {
        let lagrangian = &self.system.lagrangian;
        for (k, kind) in self.kinds.iter().enumerate() {
            let lanes = |field: fn(&Term<N>) -> &[f64; N]| -> [Lanes; N] {
                std::array::from_fn(|i| Lanes(std::array::from_fn(|lane| field(&terms[lane][k])[i])))
            };
            let (q, v, dq, dv) = (lanes(|t| &t.q), lanes(|t| &t.v), lanes(|t| &t.dq), lanes(|t| &t.dv));
            let mut add = |i: usize, g: Lanes| row[i] += g;
            match kind {
                TermKind::Along => lagrangian.directional_gradient((&q, &v), (&dq, &dv), &mut add),
                TermKind::Residual => lagrangian.residual_gradient((&q, &v), &dv, &dq, &mut add),
            }
            for (i, position) in self.damping.iter().enumerate() {
                add(*position, -(dq[i] * v[i]));
            }
        }
        for position in self.fixed {
            row[*position] = Lanes([0.0; LANES]);
        }
    }
}

/// Room for the rows of one chunk.
struct ChunkRows {
    residual: Vec<f64>,
    jacobian: Mat<f64>,
    buffer: Vec<Lanes>,
}

impl ChunkRows {
    fn new() -> Self {
        Self { residual: Vec::new(), jacobian: Mat::new(), buffer: Vec::new() }
    }

    fn reset(&mut self, rows: usize, parameters: usize) {
        self.residual.clear();
        self.residual.resize(rows, 0.0);
        self.buffer.resize(parameters, Lanes([0.0; LANES]));
        if self.jacobian.shape() != (rows, parameters) {
            self.jacobian = Mat::zeros(rows, parameters);
        }
    }

    /// Copies the first `count` lanes of the buffer to rows from `row` on.
    fn store(&mut self, row: usize, count: usize) {
        for (j, lanes) in self.buffer.iter().enumerate() {
            let column = &mut self.jacobian.col_as_slice_mut(j)[row..row + count];
            match column.first_chunk_mut() {
                Some(all) => *all = lanes.0,
                None => column.copy_from_slice(&lanes.0[..count]),
            }
        }
    }
}

impl<F: Family<N>, T: GroupLoss<F, N>, const N: usize> Objective for Sum<F, T, N> {
    fn parameters(&self) -> usize {
        self.architecture.parameters().unwrap_or(0)
    }

    fn samples(&self) -> usize {
        self.samples.len()
    }

    fn loss(&self, weights: &[f64]) -> f64 {
        let parts = self.parts(0..self.samples.len());
        let sums: Vec<Result<f64, Failed>> = parallel::map(parts.len(), &|k| {
            parts[k].iter().map(|chunk| self.squares(weights, chunk.clone())).sum()
        });
        match sums.into_iter().sum::<Result<f64, Failed>>() {
            Ok(sum) if sum.is_finite() => sum / (self.samples.len() * N) as f64,
            _ => f64::INFINITY,
        }
    }

    fn normal_equations(&self, weights: &[f64]) -> Option<NormalEquations> {
        let p = weights.len();
        self.sum(
            0..self.samples.len(),
            || NormalEquations::zero(p),
            |sum, rows, chunk| {
                self.linearise(weights, chunk, rows)?;
                sum.add(&rows.jacobian, &rows.residual);
                Ok(())
            },
        )
    }

    fn gradient(&self, weights: &[f64], samples: Range<usize>) -> Option<NormalEquations> {
        let p = weights.len();
        let zero = || NormalEquations { gram: Mat::new(), gradient: vec![0.0; p], squares: 0.0, rows: 0 };
        self.sum(samples, zero, |sum, _, chunk| self.add_gradient(weights, chunk, sum))
    }

    fn project(&self, weights: &mut [f64]) {
        self.architecture.project(weights);
    }
}
