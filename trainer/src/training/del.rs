//! The losses of the DEL integrator.

use super::Failed;
use super::loss::{SampleLoss, Systems, Term, TermKind, identity};
use super::samples::Sample;
use crate::architecture::Family;
use leastaction_core::discrete::{
    Control, Del, GaussPoint, Interval, Linearised, Newton, Path, Solved, Variation,
};
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::{SolveError, add_scaled, multiply, solve_many, transpose};

/// A loss of three consecutive positions under the discrete dynamics of path P, without constraints.
pub(super) struct DelLoss<P> {
    /// The integrator.
    pub del: Del<f64, P>,
    /// Newton's bounds in training.
    pub newton: Newton<f64>,
    /// Whether the residual is that of the next position; else that of the DEL equation.
    pub next_position: bool,
}

/// The two intervals of a triple, solved as far as the loss wants, and the residual.
struct Pair<P, const N: usize> {
    before: Solved<f64, P, N>,
    after: Solved<f64, P, N>,
    residual: [f64; N],
}

impl<P: Path + Sync> DelLoss<P> {
    fn solve<L, F, const N: usize>(
        &self,
        system: &System<L, F>,
        Sample { states: [q0, q1, q2], controls: [u0, u1, u2], .. }: &Sample<N>,
    ) -> Result<Pair<P, N>, Failed>
    where
        L: Lagrangian<f64, N>,
        F: Forces<f64, N>,
    {
        let h = self.del.h();
        let increment = |a: &[f64; N], b: &[f64; N]| std::array::from_fn(|i| (b[i] - a[i]) / h);
        let (w0, w1): ([f64; N], [f64; N]) = (increment(q0, q1), increment(q1, q2));
        let before = Interval::new(*q0, w0, h, Control { start: *u0, end: *u1 });
        let before = self.newton.solve_bubble(system, before)?;
        let p = before.balance.end_momentum();
        let after = Interval::new(*q1, w1, h, Control { start: *u1, end: *u2 });
        if self.next_position {
            let after = self.newton.solve_step(system, after, &p)?;
            let w = after.interval.increment();
            return Ok(Pair { before, after, residual: std::array::from_fn(|i| h * (w[i] - w1[i])) });
        }
        let after = self.newton.solve_bubble(system, after)?;
        Ok(Pair { before, after, residual: add_scaled(&p, 1.0, &after.balance.d1_ld) })
    }
}

impl<P: Path + Sync, F: Family<N>, const N: usize> SampleLoss<F, N> for DelLoss<P> {
    fn kinds(&self) -> &'static [TermKind] {
        if P::BUBBLE { &[TermKind::Along; 4] } else { &[TermKind::Along; 2] }
    }

    fn residual(&self, systems: &Systems<F, N>, sample: &Sample<N>) -> Result<[f64; N], Failed> {
        Ok(self.solve(&systems.one, sample)?.residual)
    }

    /// With G = p₁ + d1_ld the DEL residual, dG = ∂G + G_s₀ ds₀ + G_s₁ ds₁ and the bubbles follow their own equations; the
    /// next position follows from 0 = dG + K dw.
    fn linearise(
        &self,
        systems: &Systems<F, N>,
        sample: &Sample<N>,
        terms: &mut Vec<Term<N>>,
    ) -> Result<[f64; N], Failed> {
        let (system, pair) = (&systems.one, self.solve(&systems.one, sample)?);
        let (before, after) = (&pair.before.interval, &pair.after.interval);
        let ahead = after.linearise(system);
        let rows =
            if self.next_position { next_position_rows::<P, N>(&ahead, self.del.h())? } else { identity() };
        let (mut slaved_before, mut slaved_after) = ([[0.0; N]; N], [[0.0; N]; N]);
        if P::BUBBLE {
            let momentum_s = before.end_momentum_s(system);
            slaved_before = slaved(&momentum_s, &before.linearise(system).bubble_s)?;
            slaved_after = slaved(&ahead.momentum_s, &ahead.bubble_s)?;
        }
        for y in &rows {
            push_terms(before, y, &multiply(&slaved_before, y), Variation::end, self.del.h(), terms);
            push_terms(after, y, &multiply(&slaved_after, y), Variation::start, self.del.h(), terms);
        }
        Ok(pair.residual)
    }
}

/// Rows y of −h K⁻¹, K = ∂G/∂w with the bubble following.
fn next_position_rows<P: Path, const N: usize>(
    ahead: &Linearised<f64, N>,
    h: f64,
) -> Result<[[f64; N]; N], SolveError> {
    let k = if P::BUBBLE { ahead.reduced()?.1 } else { ahead.momentum_w };
    let rows = solve_many(transpose(&k), identity())?;
    Ok(rows.map(|row| row.map(|x| -h * x)))
}

/// (A B⁻¹)ᵀ: applied to y it gives the weight of the bubble's equation.
fn slaved<const N: usize>(a: &[[f64; N]; N], b: &[[f64; N]; N]) -> Result<[[f64; N]; N], SolveError> {
    // Rows of A B⁻¹ solve Bᵀx = (row of A).
    Ok(transpose(&solve_many(transpose(b), *a)?))
}

/// The terms of one interval for the weight y of its end's (or start's) momentum and z of its bubble's equation.
fn push_terms<P: Path, const N: usize>(
    interval: &Interval<f64, P, N>,
    y: &[f64; N],
    z: &[f64; N],
    end: fn(&GaussPoint<f64>, f64) -> Variation<f64>,
    h: f64,
    terms: &mut Vec<Term<N>>,
) {
    for node in P::points().as_ref() {
        let (q, v) = interval.point(node);
        let (end, bubble) = (end(node, h), Variation::bubble(node, h));
        let weigh = |end: f64, bubble: f64| -> [f64; N] {
            std::array::from_fn(|i| node.weight * (end * y[i] - bubble * z[i]))
        };
        terms.push(Term {
            q,
            v,
            dq: weigh(end.force, bubble.force),
            dv: weigh(end.momentum, bubble.momentum),
        });
    }
}
