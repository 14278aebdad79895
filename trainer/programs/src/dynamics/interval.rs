//! Path of one step, and the sums over it ([`leastaction_core::discrete`] has the equations).

use crate::derivative_outputs::DerivativeOutputs;
use crate::program::{Program, Workspace};
use crate::row::Row;
use crate::system::System;

/// Order of a step: 2, the midpoint rule, or 4, a quadratic path with two Gauss points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Order 2.
    Two,
    /// Order 4.
    Four,
}

/// A Gauss point: its place c between 0 and 1, and its weight b.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GaussPoint {
    pub c: f64,
    pub weight: f64,
}

/// Weights of F and L_v in the first variation of the action at a Gauss point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Variation {
    pub force: f64,
    pub momentum: f64,
}

impl GaussPoint {
    /// D₁, the variation of the start position.
    pub fn start(&self, h: f64) -> Variation {
        Variation { force: h * (1.0 - self.c), momentum: -1.0 }
    }

    /// D₂, the variation of the end position; its weights are also the derivatives of the point's position and velocity
    /// with respect to w.
    pub fn end(&self, h: f64) -> Variation {
        Variation { force: h * self.c, momentum: 1.0 }
    }

    /// D_m, the variation of the bubble; its weights are also the derivatives of the point's position and velocity with
    /// respect to s.
    pub fn bubble(&self, h: f64) -> Variation {
        Variation { force: h * 4.0 * self.c * (1.0 - self.c), momentum: 4.0 * (1.0 - 2.0 * self.c) }
    }

    /// Whether the point lies in the first half of the step, where a growing bubble speeds up the motion.
    pub fn is_early(&self) -> bool {
        self.c < 0.5
    }
}

impl Order {
    /// Gauss points of the order.
    pub(crate) fn points(self) -> &'static [GaussPoint] {
        const LATE: f64 = 0.788_675_134_594_812_9;
        match self {
            Self::Two => &[GaussPoint { c: 0.5, weight: 1.0 }],
            Self::Four => &[GaussPoint { c: 1.0 - LATE, weight: 0.5 }, GaussPoint { c: LATE, weight: 0.5 }],
        }
    }

    /// Whether the path has a bubble.
    pub(crate) fn has_bubble(self) -> bool {
        self == Self::Four
    }
}

/// Path of a step: its start, its increment w = (q₁ − q₀)/h, its bubble s (0 at order 2), and the control at both ends,
/// between which it is linear; n rows each.
#[derive(Clone, Debug, Default)]
pub struct Interval {
    /// Start position q₀.
    pub q0: Vec<Row>,
    /// Increment w.
    pub w: Vec<Row>,
    /// Bubble s.
    pub s: Vec<Row>,
    /// Control τ at the start and at the end.
    pub tau: [Vec<Row>; 2],
}

impl Interval {
    /// Creates a straight path.
    pub fn new(q0: &[Row], w: &[Row], tau: [&[Row]; 2]) -> Self {
        let s = vec![Row::default(); q0.len()];
        Self { q0: q0.to_vec(), w: w.to_vec(), s, tau: tau.map(<[Row]>::to_vec) }
    }

    /// Fraction of a sample's Newton update of w and s that is applied before the equations are evaluated again. If the
    /// update would reverse a velocity at one of these Gauss points, starting from beyond the range in which forces
    /// bend, it stops where that velocity is 0.
    pub(crate) fn trusted_part<'p>(
        &self,
        points: impl Iterator<Item = &'p GaussPoint>,
        bends: &[Row],
        [of_w, of_s]: [&[f64]; 2],
        sample: usize,
    ) -> f64 {
        let mut least = 1.0_f64;
        for rate in points.map(|point| point.bubble(1.0).momentum) {
            for (i, bend) in bends.iter().enumerate() {
                let change = |x: &[f64]| x.get(i).copied().unwrap_or_default();
                let v = self.w[i].0[sample] + rate * self.s[i].0[sample];
                let taken = change(of_w) + rate * change(of_s);
                let turns = (v > 0.0) != (v - taken > 0.0);
                if turns && v.abs() > bend.0[sample] {
                    least = least.min((v / taken).abs());
                }
            }
        }
        least
    }

    /// Position, velocity and τ at a Gauss point.
    pub(crate) fn at(&self, point: &GaussPoint, h: f64) -> [Vec<Row>; 3] {
        let bubble = point.bubble(h);
        let (mut q, mut v) = (self.q0.clone(), self.w.clone());
        let mut tau = self.tau[0].clone();
        for i in 0..q.len() {
            q[i].add_scaled(h * point.c, &self.w[i]);
            q[i].add_scaled(bubble.force, &self.s[i]);
            v[i].add_scaled(bubble.momentum, &self.s[i]);
            tau[i] = tau[i].zip(&self.tau[1][i], |start, end| start + point.c * (end - start));
        }
        [q, v, tau]
    }
}

/// Sums over an interval that make up a step, with F = L_q + Q + τ; n rows each.
#[derive(Clone, Debug, Default)]
pub struct Balance {
    /// Sum D₁L_d + f⁻ = Σ b \[h(1 − c)F − L_v\].
    pub d1_ld: Vec<Row>,
    /// Sum D_mL_d + f_m = Σ b \[hβF + γL_v\].
    pub dm_ld: Vec<Row>,
    /// Impulse h Σ b F.
    pub impulse: Vec<Row>,
}

impl Balance {
    fn zero(n: usize) -> Self {
        let zero = vec![Row::default(); n];
        Self { d1_ld: zero.clone(), dm_ld: zero.clone(), impulse: zero }
    }

    fn add(&mut self, point: &GaussPoint, h: f64, force: &[Row], momentum: &[Row]) {
        let b = point.weight;
        for (sums, of) in [(&mut self.d1_ld, point.start(h)), (&mut self.dm_ld, point.bubble(h))] {
            for ((sum, force), momentum) in sums.iter_mut().zip(force).zip(momentum) {
                sum.add_scaled(b * of.force, force);
                sum.add_scaled(b * of.momentum, momentum);
            }
        }
        self.impulse.iter_mut().zip(force).for_each(|(sum, force)| sum.add_scaled(h * b, force));
    }

    /// Momentum p₁ = D₂L_d + f⁺.
    pub fn end_momentum(&self) -> Vec<Row> {
        self.impulse.iter().zip(&self.d1_ld).map(|(impulse, d1)| impulse.zip(d1, |a, b| a - b)).collect()
    }
}

/// A balance with its exact derivatives, n × n rows each, in row-major order.
#[derive(Clone, Debug, Default)]
pub struct Linearised {
    /// The sums themselves.
    pub balance: Balance,
    /// ∂ d1_ld/∂w.
    pub momentum_w: Vec<Row>,
    /// ∂ d1_ld/∂s.
    pub momentum_s: Vec<Row>,
    /// ∂ dm_ld/∂w.
    pub bubble_w: Vec<Row>,
    /// ∂ dm_ld/∂s.
    pub bubble_s: Vec<Row>,
    /// Part of ∂ dm_ld/∂s that comes from the velocity dependence of the forces at the early Gauss point.
    pub early_force_s: Vec<Row>,
    /// ∂(D₂L_d + f⁺)/∂s.
    pub end_momentum_s: Vec<Row>,
    /// Magnitude of the terms whose rounding errors count, even if the terms cancel; n rows.
    pub scale: Vec<Row>,
}

/// Evaluator of intervals of one step size and order.
#[derive(Clone, Debug)]
pub(crate) struct Integrals {
    pub h: f64,
    pub order: Order,
    n: usize,
    first: (Program, Workspace),
    second: (Program, Workspace),
    bends: Option<(Program, Workspace)>,
    at: DerivativeOutputs,
}

impl Integrals {
    pub fn new(system: &System, h: f64, order: Order) -> Self {
        let (second, at) = system.derivatives();
        let first = system.force_and_momentum().with_workspace();
        let bends = system.bends().map(Program::with_workspace);
        Self { h, order, n: system.n(), first, second: second.with_workspace(), bends, at }
    }

    /// Speed up to which forces bend ([`Energies::bends`](crate::energies::Energies::bends)), n rows.
    pub fn bends(&mut self, weights: &[f64]) -> Option<Vec<Row>> {
        let (program, workspace) = self.bends.as_mut()?;
        let nothing = vec![Row::default(); self.n];
        program.run(weights, &[&nothing, &nothing], workspace, &mut []);
        Some(workspace.output(0).to_vec())
    }

    /// Computes the balance from first derivatives alone.
    pub fn balance(&mut self, weights: &[f64], interval: &Interval) -> Balance {
        let mut sum = Balance::zero(self.n);
        for point in self.order.points() {
            let [q, v, tau] = interval.at(point, self.h);
            let (program, workspace) = &mut self.first;
            program.run(weights, &[&q, &v, &tau], workspace, &mut []);
            let force = plus(workspace.output(0), &tau);
            sum.add(point, self.h, &force, workspace.output(1));
        }
        sum
    }

    /// Momentum L_v(q, v).
    pub fn momentum(&mut self, weights: &[f64], q: &[Row], v: &[Row]) -> Vec<Row> {
        let (program, workspace) = &mut self.first;
        program.run(weights, &[q, v, &vec![Row::default(); self.n]], workspace, &mut []);
        workspace.output(1).to_vec()
    }

    /// Computes the balance and its derivatives.
    pub fn linearise(&mut self, weights: &[f64], interval: &Interval) -> Linearised {
        let n = self.n;
        let zero = vec![Row::default(); n * n];
        let mut sum = Linearised {
            balance: Balance::zero(n),
            momentum_w: zero.clone(),
            momentum_s: zero.clone(),
            bubble_w: zero.clone(),
            bubble_s: zero.clone(),
            early_force_s: zero.clone(),
            end_momentum_s: zero,
            scale: vec![Row::default(); n],
        };
        for point in self.order.points() {
            let [q, v, tau] = interval.at(point, self.h);
            self.differentiate(weights, [&q, &v, &tau]);
            let workspace = &self.second.1;
            let force = plus(workspace.output(DerivativeOutputs::FORCE), &tau);
            sum.balance.add(point, self.h, &force, workspace.output(DerivativeOutputs::MOMENTUM));
            self.add_derivatives(point, &mut sum);
            self.add_sizes(point, (&q, &v, &force), &mut sum.scale);
        }
        sum
    }

    /// Evaluates F and L_v with their derivatives at one point; the functions below read the result.
    pub fn differentiate(&mut self, weights: &[f64], at: [&[Row]; 3]) {
        let (program, workspace) = &mut self.second;
        program.run(weights, &at, workspace, &mut []);
    }

    /// Column j of ∂L_v/∂q and of M in the last [`Integrals::differentiate`].
    pub fn momentum_columns(&self, j: usize) -> [&[Row]; 2] {
        [self.at.momentum_q(j), self.at.mass(j)].map(|output| self.second.1.output(output))
    }

    fn add_derivatives(&self, point: &GaussPoint, sum: &mut Linearised) {
        let (h, b) = (self.h, point.weight);
        let (start, end, bubble) = (point.start(h), point.end(h), point.bubble(h));
        self.add_block((b, start, end), &mut sum.momentum_w);
        if self.order.has_bubble() {
            self.add_block((b, start, bubble), &mut sum.momentum_s);
            self.add_block((b, bubble, end), &mut sum.bubble_w);
            self.add_block((b, bubble, bubble), &mut sum.bubble_s);
            self.add_block((b, end, bubble), &mut sum.end_momentum_s);
        }
        if self.order.has_bubble() && point.is_early() {
            self.add_force_v(b * bubble.force * bubble.momentum, &mut sum.early_force_s);
        }
    }

    /// Adds the derivative of b (row.force F + row.momentum L_v) when the point moves along `column`: its position by
    /// the force weight, its velocity by the momentum weight. n × n rows.
    pub fn add_block(&self, (b, row, column): (f64, Variation, Variation), to: &mut [Row]) {
        let (n, at, workspace) = (self.n, self.at, &self.second.1);
        for j in 0..n {
            let [force_q, force_v] = [at.force_q(j), at.force_v(j)].map(|output| workspace.output(output));
            let [momentum_q, mass] = self.momentum_columns(j);
            for i in 0..n {
                let place = &mut to[i * n + j];
                place.add_scaled(b * row.force * column.force, &force_q[i]);
                place.add_scaled(b * row.force * column.momentum, &force_v[i]);
                place.add_scaled(b * row.momentum * column.force, &momentum_q[i]);
                place.add_scaled(b * row.momentum * column.momentum, &mass[i]);
            }
        }
    }

    /// Adds c ∂Q/∂v, which is ∂F/∂v without ∂L_q/∂v = (∂L_v/∂q)ᵀ.
    fn add_force_v(&self, c: f64, to: &mut [Row]) {
        let (n, at, workspace) = (self.n, self.at, &self.second.1);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            to[i * n + j].add_scaled(c, &workspace.output(at.force_v(j))[i]);
            to[i * n + j].add_scaled(-c, &workspace.output(at.momentum_q(i))[j]);
        }
    }

    /// Adds b \[Σ_j |M_ij| (|v_j| + √ε |q_j|/h) + Σ_j |∂L_v,i/∂q_j q_j| + h |F_i|\].
    fn add_sizes(&self, point: &GaussPoint, (q, v, force): (&[Row], &[Row], &[Row]), scale: &mut [Row]) {
        let (b, h, rounding) = (point.weight, self.h, f64::EPSILON.sqrt() / self.h);
        for (i, (sum, force)) in scale.iter_mut().zip(force).enumerate() {
            *sum = sum.zip(force, |sum, force| sum + b * h * force.abs());
            for j in 0..self.n {
                let mass = &self.second.1.output(self.at.mass(j))[i];
                let moved = v[j].zip(&q[j], |v, q| b * (v.abs() + rounding * q.abs()));
                let turned = &self.second.1.output(self.at.momentum_q(j))[i];
                let turned = turned.zip(&q[j], |slope, q| b * (slope * q).abs());
                let moved = moved.zip(mass, |moved, mass| moved * mass.abs());
                *sum = sum.zip(&moved, |sum, x| sum + x).zip(&turned, |sum, x| sum + x);
            }
        }
    }
}

/// Returns x + y.
pub(crate) fn plus(x: &[Row], y: &[Row]) -> Vec<Row> {
    x.iter().zip(y).map(|(x, y)| x.zip(y, |x, y| x + y)).collect()
}
