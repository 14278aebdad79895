use super::Solver;
use crate::constraints::{ConstraintError, Constraints};
use crate::discrete::rattle::points::Points;
use crate::discrete::rattle::stage::{BLOCK, Stage, size, worse};
use crate::linear::{add_scaled, solve_definite};
use crate::newton::{Equations, Report, relative};
use crate::particles::Particles;
use crate::scalar::Real;

impl<R, S, C, const D: usize> Solver<'_, '_, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    /// Solves the nodes block by block, since nothing couples them.
    #[inline(never)]
    pub(super) fn solve_nodes(
        &self,
        points: &mut Points<R, D>,
        stage: Stage<R>,
    ) -> Result<Report<R>, ConstraintError<R>> {
        let mut worst = Report::nothing();
        for (block, (v, p)) in points.v.chunks_mut(BLOCK).zip(points.p.chunks(BLOCK)).enumerate() {
            let mut block =
                Block::new(self.mechanism.system(), stage, block * BLOCK, (v, p), self.newton.stop);
            worst = worst.worse(self.newton.solve(&mut block)?);
        }
        Ok(worst)
    }
}

/// Block of nodes that are evaluated side by side.
struct Block<'e, R, S, const D: usize> {
    system: &'e S,
    stage: Stage<R>,
    /// Index of the first node.
    first: usize,
    v: &'e mut [[R; D]],
    p: &'e [[R; D]],
    /// Residuals of the momenta.
    r: [[R; D]; BLOCK],
    /// Size of the residuals' terms at the guess, for relative residuals.
    scale: Option<[R; BLOCK]>,
    /// Relative residual of every node; a node at `stop` or below needs no further update.
    residuals: [R; BLOCK],
    stop: R,
}

impl<'e, R: Real, S, const D: usize> Block<'e, R, S, D> {
    fn new(
        system: &'e S,
        stage: Stage<R>,
        first: usize,
        (v, p): (&'e mut [[R; D]], &'e [[R; D]]),
        stop: R,
    ) -> Self {
        let zero = R::zero();
        Self {
            system,
            stage,
            first,
            v,
            p,
            r: [[zero; D]; BLOCK],
            scale: None,
            residuals: [zero; BLOCK],
            stop,
        }
    }
}

impl<R: Real, S: Particles<R, D>, const D: usize> Equations<R> for Block<'_, R, S, D> {
    type Error = ConstraintError<R>;

    #[inline(always)]
    fn residual(&mut self) -> R {
        let (mut terms, mut worst) = ([R::zero(); BLOCK], R::zero());
        self.stage.imbalances(self.system, self.first, (self.v, self.p), (&mut self.r, &mut terms));
        let r = &self.r;
        let scale = self.scale.get_or_insert_with(|| core::array::from_fn(|i| terms[i] + size(&r[i])));
        for (((r, scale), residual), _) in r.iter().zip(scale).zip(&mut self.residuals).zip(&*self.v) {
            *residual = relative(size(r), *scale);
            worst = worse(worst, *residual);
        }
        worst
    }

    /// v += M⁻¹r for every node that is not solved.
    #[inline(always)]
    fn update(&mut self) -> Result<(), ConstraintError<R>> {
        let mut masses = [[[R::zero(); D]; D]; BLOCK];
        self.stage.effective_masses(self.system, self.first, self.v, &mut masses);
        let equations = masses.iter().zip(&self.r).zip(&self.residuals);
        for (node, (v, ((mass, r), residual))) in (self.first..).zip(self.v.iter_mut().zip(equations)) {
            if *residual > self.stop {
                let [change] = solve_definite(*mass, [*r]).map_err(|_| ConstraintError::Mass { node })?;
                *v = add_scaled(v, R::one(), &change);
            }
        }
        Ok(())
    }
}
