use super::{Block, Derivatives, Loss, clear, mended, straight_on};
use crate::dynamics::{
    Equations, Factors, Failures, GaussPoint, Integrals, Interval, Newton, Order, Variation, contracted,
};
use crate::program::{Program, Workspace};
use crate::row::{Row, WIDTH};
use crate::system::System;

/// A loss over three consecutive positions with the discrete Euler–Lagrange equation, without constraints.
pub struct DelLoss {
    n: usize,
    integrals: Integrals,
    newton: Newton,
    /// Whether the residual is that of the next position; otherwise it is that of the DEL equation.
    next_position: bool,
    /// Programs for one direction, and for n.
    pulls: [(Program, Workspace); 2],
    factors: [Factors; 2],
}

/// Variation of an interval's end, or of its start.
type End = fn(&GaussPoint, f64) -> Variation;

/// Weights of one interval's equations in the residual components: n rows per component.
struct Weighing {
    /// Weights of D₁L_d, or of D₂L_d.
    y: Vec<Row>,
    /// Weights of D_mL_d.
    z: Vec<Row>,
}

impl DelLoss {
    /// Creates the loss of the next position, or that of the DEL residual, for the step size h, s.
    pub fn new(system: &System, h: f64, order: Order, next_position: bool) -> Self {
        let n = system.n();
        let pulls = [1, n].map(|directions| system.along(directions).with_workspace());
        let newton = Newton { max_iterations: 50, stop: 1e-14, accept: 1e-9 };
        let integrals = Integrals::new(system, h, order);
        Self { n, integrals, newton, next_position, pulls, factors: Default::default() }
    }

    /// Adds the weighted derivatives of one interval's equations.
    fn pull(
        &mut self,
        weights: &[f64],
        (interval, end): (&Interval, End),
        weighing: &Weighing,
        rows: &mut [Vec<Row>],
    ) {
        let (n, h) = (self.n, self.integrals.h);
        let (program, workspace) = &mut self.pulls[usize::from(rows.len() > 1 || n == 1)];
        for point in self.integrals.order.points() {
            let [q, v, tau] = interval.at(point, h);
            let (end, bubble) = (end(point, h), point.bubble(h));
            let weigh = |end: f64, bubble: f64| -> Vec<Row> {
                let parts = weighing.y.iter().zip(&weighing.z);
                parts.map(|(y, z)| y.zip(z, |y, z| point.weight * (end * y + bubble * z))).collect()
            };
            let (dq, dv) = (weigh(end.force, bubble.force), weigh(end.momentum, bubble.momentum));
            let mut inputs: Vec<&[Row]> = vec![&q, &v, &tau];
            for (dq, dv) in dq.chunks_exact(n).zip(dv.chunks_exact(n)) {
                inputs.extend([dq, dv]);
            }
            program.run(weights, &inputs, workspace, rows);
        }
    }

    /// Weights of both intervals' equations in the derivative of every residual component. G = p₁ + d1_ld is the DEL
    /// residual. The bubbles follow from their own equations; the next position follows from 0 = dG + K dw.
    fn weighings(
        &mut self,
        weights: &[f64],
        before: &Interval,
        after: &Interval,
        p: &[Row],
        failures: &mut Failures,
    ) -> [Weighing; 2] {
        let (n, h, bubble) = (self.n, self.integrals.h, self.integrals.order.has_bubble());
        let zero = vec![Row::default(); n * n];
        let mut of = [(); 2].map(|()| Weighing { y: zero.clone(), z: zero.clone() });
        let ahead = self.integrals.linearise(weights, after);
        let behind = if bubble { self.integrals.linearise(weights, before) } else { Default::default() };
        let [of_before, of_after] = &mut self.factors;
        let free = if self.next_position { Some(p) } else { None };
        let equations = Equations { integrals: &mut self.integrals, weights, p0: free, contact: None };
        if self.next_position || bubble {
            *failures = failures.or(equations.factor(&ahead, of_after));
        }
        if bubble {
            let equations = Equations { integrals: &mut self.integrals, weights, p0: None, contact: None };
            *failures = failures.or(equations.factor(&behind, of_before));
        }
        let [first, second] = &mut of;
        for sample in (0..WIDTH).filter(|sample| !failures.0[*sample]) {
            for i in 0..n {
                let row = i * n..(i + 1) * n;
                let unit = |k: usize| f64::from(u8::from(k == i));
                if self.next_position {
                    let solution = of_after[sample].solve_transposed(unit);
                    store(&mut second.y[row.clone()], sample, |k| -h * solution[k]);
                    if bubble {
                        store(&mut second.z[row.clone()], sample, |k| -h * solution[n + k]);
                    }
                } else {
                    store(&mut second.y[row.clone()], sample, unit);
                    if bubble {
                        let slaved =
                            of_after[sample].solve_transposed(|k| ahead.momentum_s[i * n + k].0[sample]);
                        store(&mut second.z[row.clone()], sample, |k| -slaved[k]);
                    }
                }
                let y: Vec<f64> = second.y[row.clone()].iter().map(|y| y.0[sample]).collect();
                store(&mut first.y[row.clone()], sample, |k| y[k]);
                if bubble {
                    let pulled =
                        |k: usize| (0..n).map(|j| behind.end_momentum_s[j * n + k].0[sample] * y[j]).sum();
                    let slaved = of_before[sample].solve_transposed(pulled);
                    store(&mut first.z[row], sample, |k| -slaved[k]);
                }
            }
        }
        of
    }
}

fn store(rows: &mut [Row], sample: usize, of: impl Fn(usize) -> f64) {
    rows.iter_mut().enumerate().for_each(|(k, row)| row.0[sample] = of(k));
}

impl Loss for DelLoss {
    fn components(&self) -> usize {
        self.n
    }

    fn of_constant_velocity(&self, block: &Block) -> Option<Vec<Row>> {
        self.next_position.then(|| straight_on(&block.states))
    }

    fn evaluate(
        &mut self,
        weights: &[f64],
        block: &Block,
        residual: &mut [Row],
        mut derivatives: Derivatives,
    ) -> Failures {
        let (n, h) = (self.n, self.integrals.h);
        let [q0, q1, q2] = &block.states;
        let increment = |a: &[Row], b: &[Row]| -> Vec<Row> {
            a.iter().zip(b).map(|(a, b)| b.zip(a, |b, a| (b - a) / h)).collect()
        };
        let (w0, w1) = (increment(q0, q1), increment(q1, q2));
        let mut before = Interval::new(q0, &w0, block.acting(0));
        let mut after = Interval::new(q1, &w1, block.acting(1));
        let [of_before, of_after] = &mut self.factors;
        let mut equations = Equations { integrals: &mut self.integrals, weights, p0: None, contact: None };
        let (balance, failed) = self.newton.solve(&mut equations, &mut before, of_before);
        let p = balance.end_momentum();
        equations.p0 = self.next_position.then_some(&p);
        let (balance, mut failures) = self.newton.solve(&mut equations, &mut after, of_after);
        failures = failures.or(failed);
        for i in 0..n {
            residual[i] = if self.next_position {
                after.w[i].zip(&w1[i], |w, logged| h * (w - logged))
            } else {
                p[i].zip(&balance.d1_ld[i], |p, d1| p + d1)
            };
        }
        failures.add_not_finite(residual);
        if matches!(derivatives, Derivatives::None) {
            clear(&failures, residual);
            return failures;
        }
        let mut weighings = self.weighings(weights, &before, &after, &p, &mut failures);
        clear(&failures, residual);
        if failures.all() {
            return failures;
        }
        let intervals: [(&Interval, End); 2] = [(&before, GaussPoint::end), (&after, GaussPoint::start)];
        for (interval, weighing) in intervals.into_iter().zip(&mut weighings) {
            [&mut weighing.y, &mut weighing.z].into_iter().for_each(|rows| clear(&failures, rows));
            let part = |rows: &Vec<Row>| mended(&failures, rows);
            let Interval { q0, w, s, tau } = interval.0;
            let path = Interval { q0: part(q0), w: part(w), s: part(s), tau: tau.each_ref().map(part) };
            let of = (&path, interval.1);
            match &mut derivatives {
                Derivatives::None => {}
                Derivatives::Jacobian(rows) => self.pull(weights, of, weighing, rows),
                Derivatives::Gradient(row) => {
                    let [y, z] = [&weighing.y, &weighing.z].map(|x| contracted(residual, x, n));
                    self.pull(weights, of, &Weighing { y, z }, std::slice::from_mut(row));
                }
            }
        }
        failures
    }
}
