use super::tangents::{ControlTangent, Tangents};
use super::{State, Steps};
use crate::dynamics::{
    Del, DelState, Failures, GaussPoint, Interval, Lu, Newton, Order, Variation, contracted, dot,
};
use crate::program::{Program, Workspace};
use crate::row::{Row, WIDTH};
use crate::system::System;

/// Limits of Newton's method in these steps.
const NEWTON: Newton = Newton { max_iterations: 50, stop: 1e-14, accept: 1e-9 };

/// Steps of the discrete Euler–Lagrange equation of a system without constraints ([`leastaction_core::discrete`] has
/// the equations). They carry their derivatives along. States are (q, p).
///
/// Let x = (w, s), let G(x; q₀, p₀, τ, θ) = (p₀ + D₁L_d + f⁻, D_mL_d + f_m) = 0 be the equations, and e = (q₁, p₁) =
/// (q₀ + hw, p₀ + impulse) the end. A change of a parameter changes the end by δe + YδG at constant x, with Y = −e_x
/// G_x⁻¹ (the implicit function theorem). Both terms are sums over the Gauss points of δF and δL_v, so the rows ∂/∂θ
/// \[F·δq + L_v·δv\] of all 2n numbers of the end give its derivatives with respect to the weights.
pub struct VariationalSteps {
    pub(super) n: usize,
    pub(super) del: Del,
    /// Positions of the weights whose derivatives are carried.
    pub(super) learned: Vec<usize>,
    /// Derivative ∂Q/∂τ, if a force depends on the control.
    load: Option<(Program, Workspace)>,
    /// Gradients of L_v along n directions, and of F and L_v along 2n directions.
    momentum: (Program, Workspace),
    pulls: (Program, Workspace),
    /// Derivatives ∂e/∂θ at constant (q₀, p₀): for each of the 2n numbers, rows of the length of the weight block.
    pub(super) gradients: Vec<Vec<Row>>,
    sums: Sums,
    pub(super) lu: Lu,
    /// Last states, from which paths are extrapolated.
    pub(super) last: DelState,
    pub(super) moved: Vec<Row>,
}

/// Derivatives of the equations of a step (those of momenta, then those of bubbles) and of its impulse, row by row.
#[derive(Default)]
struct Sums {
    /// Derivatives with respect to x: m × m blocks of n × n for the equations, m blocks for the impulse; m = 1, or 2
    /// with bubbles.
    of_path: Vec<Vec<Row>>,
    impulse_of_path: Vec<Vec<Row>>,
    /// Derivatives with respect to q₀: m blocks, and the block of the impulse.
    of_start: Vec<Vec<Row>>,
    /// Derivatives with respect to τ at the start and at the end, each with the same blocks.
    of_control: [Vec<Vec<Row>>; 2],
}

/// Derivative of a position at a Gauss point with respect to q₀.
const POSITION: Variation = Variation { force: 1.0, momentum: 0.0 };

impl Sums {
    /// Clears the sums for the given number of kinds of equations, n of each.
    fn reset(&mut self, kinds: usize, n: usize) {
        let clear = |blocks: &mut Vec<Vec<Row>>, count: usize| {
            blocks.resize(count, Vec::new());
            blocks.iter_mut().for_each(|block| {
                block.clear();
                block.resize(n * n, Row::default());
            });
        };
        clear(&mut self.of_path, kinds * kinds);
        clear(&mut self.impulse_of_path, kinds);
        clear(&mut self.of_start, kinds + 1);
        self.of_control.iter_mut().for_each(|blocks| clear(blocks, kinds + 1));
    }

    /// Entry (i, j) of the derivative of all equations with respect to all of x.
    fn equation(&self, kinds: usize, n: usize, [i, j]: [usize; 2], sample: usize) -> f64 {
        self.of_path[i / n * kinds + j / n][i % n * n + j % n].0[sample]
    }
}

/// Derivatives of the end e at constant θ, and with respect to the equations.
struct Transition {
    /// Y: 2n rows of m n.
    of_equations: Vec<Row>,
    /// Derivatives with respect to (q₀, p₀): 2n rows of 2n.
    of_state: Vec<Row>,
    /// Derivatives with respect to τ at the start and at the end: 2n rows of n.
    of_control: [Vec<Row>; 2],
}

impl VariationalSteps {
    /// Creates the steps of a system with step size h, s, with derivatives with respect to all weights.
    pub fn new(system: &System, h: f64, order: Order) -> Self {
        let (n, weights) = (system.n(), system.parameters());
        Self {
            n,
            del: Del::new(system, h, order, NEWTON),
            learned: (0..weights).collect(),
            load: system.load_derivatives().map(Program::with_workspace),
            momentum: system.momentum_along(n).with_workspace(),
            pulls: system.along(2 * n).with_workspace(),
            gradients: vec![vec![Row::default(); weights]; 2 * n],
            sums: Sums::default(),
            lu: Lu::default(),
            last: DelState::default(),
            moved: vec![Row::default(); 2 * n],
        }
    }

    /// Restricts the derivatives to the weights at these positions.
    #[must_use]
    pub fn with_learned(self, learned: Vec<usize>) -> Self {
        Self { learned, ..self }
    }

    /// Weights of F and L_v at a Gauss point in the equations of a step, and the derivatives of that point with respect
    /// to x.
    fn variations(&self, point: &GaussPoint) -> [[Variation; 2]; 2] {
        let h = self.del.h();
        [[point.start(h), point.bubble(h)], [point.end(h), point.bubble(h)]]
    }

    fn kinds(&self) -> usize {
        if self.del.order().has_bubble() { 2 } else { 1 }
    }

    /// Sums the derivatives of the equations and of the impulse over the Gauss points of a path.
    fn sum(&mut self, weights: &[f64], path: &Interval) {
        let (n, kinds, h) = (self.n, self.kinds(), self.del.h());
        self.sums.reset(kinds, n);
        let impulse = Variation { force: h, momentum: 0.0 };
        for point in self.del.order().points() {
            let [q, v, tau] = path.at(point, h);
            let ([equations, moves], b) = (self.variations(point), point.weight);
            let (integrals, sums) = (self.del.smooth(), &mut self.sums);
            integrals.differentiate(weights, [&q, &v, &tau]);
            for (k, row) in equations.into_iter().take(kinds).chain([impulse]).enumerate() {
                integrals.add_block((b, row, POSITION), &mut sums.of_start[k]);
                for (j, column) in moves.into_iter().take(kinds).enumerate() {
                    let of = sums.of_path.get_mut(k * kinds + j);
                    let block = of.unwrap_or(&mut sums.impulse_of_path[j]);
                    integrals.add_block((b, row, column), block);
                }
            }
            if let Some((program, workspace)) = &mut self.load {
                program.run_outputs(weights, &[&q, &v, &tau], workspace);
            }
            let forces = equations.map(|row| row.force);
            for (k, force) in forces.into_iter().take(kinds).chain([h]).enumerate() {
                self.add_control(k, b * force, point.c);
            }
        }
    }

    /// Adds the derivatives of c(τ + Q) with respect to τ at both ends, at a given fraction of the step.
    fn add_control(&mut self, k: usize, c: f64, part: f64) {
        let n = self.n;
        for (share, blocks) in [1.0 - part, part].into_iter().zip(&mut self.sums.of_control) {
            (0..n).for_each(|i| blocks[k][i * n + i].add_scaled(c * share, &Row::splat(1.0)));
            let Some((_, load)) = &self.load else { continue };
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                blocks[k][i * n + j].add_scaled(c * share, &load.output(j)[i]);
            }
        }
    }

    /// Derivatives of e with respect to the equations: Yᵀ = −G_x⁻ᵀ e_xᵀ. A sample with a singular matrix is NaN.
    fn of_equations(&mut self) -> Vec<Row> {
        let (n, kinds, h) = (self.n, self.kinds(), self.del.h());
        let unknowns = kinds * n;
        let mut of_equations = vec![Row::splat(f64::NAN); 2 * n * unknowns];
        let sums = &self.sums;
        for sample in 0..WIDTH {
            if !self.lu.factor(unknowns, |i, j| sums.equation(kinds, n, [i, j], sample)) {
                continue;
            }
            for (r, rows) in of_equations.chunks_exact_mut(unknowns).enumerate() {
                let end = |j: usize| match r.checked_sub(n) {
                    Some(i) => sums.impulse_of_path[j / n][i * n + j % n].0[sample],
                    None if r == j => h,
                    None => 0.0,
                };
                let y = self.lu.solve_transposed(end);
                rows.iter_mut().zip(y).for_each(|(row, y)| row.0[sample] = -y);
            }
        }
        of_equations
    }

    /// Derivatives of the end of a path.
    fn transition(&mut self, weights: &[f64], path: &Interval) -> Transition {
        self.sum(weights, path);
        let (n, of_equations) = (self.n, self.of_equations());
        let (kinds, unit) = (self.kinds(), Row::splat(1.0));
        // This is Yδ of the equations, plus the change of the impulse.
        let moved = |blocks: &[Vec<Row>]| -> Vec<Row> {
            let equations = blocks[..kinds].concat();
            let mut rows: Vec<Row> =
                of_equations.chunks_exact(kinds * n).flat_map(|y| contracted(y, &equations, n)).collect();
            rows[n * n..].iter_mut().zip(&blocks[kinds]).for_each(|(sum, x)| sum.add_scaled(1.0, x));
            rows
        };
        let of_control = self.sums.of_control.each_ref().map(|blocks| moved(blocks));
        let of_position = moved(&self.sums.of_start);
        let mut of_state = vec![Row::default(); 4 * n * n];
        for (r, rows) in of_state.chunks_exact_mut(2 * n).enumerate() {
            rows[..n].copy_from_slice(&of_position[r * n..][..n]);
            rows[n..].copy_from_slice(&of_equations[r * kinds * n..][..n]);
            rows[r].add_scaled(1.0, &unit);
        }
        Transition { of_equations, of_state, of_control }
    }

    /// Computes the derivatives of e with respect to the weights at constant (q₀, p₀).
    fn pull(&mut self, weights: &[f64], path: &Interval, of_equations: &[Row]) {
        let (n, kinds, h) = (self.n, self.kinds(), self.del.h());
        self.gradients.iter_mut().for_each(|row| row.fill(Row::default()));
        for point in self.del.order().points() {
            let [equations, _] = self.variations(point);
            let mut directions = [(); 2].map(|()| vec![Row::default(); 2 * n * n]);
            for (r, y) in of_equations.chunks_exact(kinds * n).enumerate() {
                for (variation, y) in equations.iter().zip(y.chunks_exact(n)) {
                    for (i, y) in y.iter().enumerate() {
                        directions[0][r * n + i].add_scaled(point.weight * variation.force, y);
                        directions[1][r * n + i].add_scaled(point.weight * variation.momentum, y);
                    }
                }
                if let Some(i) = r.checked_sub(n) {
                    directions[0][r * n + i].add_scaled(point.weight * h, &Row::splat(1.0));
                }
            }
            let [q, v, tau] = path.at(point, h);
            let mut inputs: Vec<&[Row]> = vec![&q, &v, &tau];
            let [dq, dv] = &directions;
            dq.chunks_exact(n).zip(dv.chunks_exact(n)).for_each(|(dq, dv)| inputs.extend([dq, dv]));
            let (program, workspace) = &mut self.pulls;
            program.run(weights, &inputs, workspace, &mut self.gradients);
        }
    }

    /// Converts derivatives of (q, v) into those of (q, p): δp = ∂L_v/∂q δq + M δv + ∂L_v/∂θ.
    fn carry_to_momenta(&mut self, weights: &[f64], [q, v]: [&[Row]; 2], tangents: &mut Tangents) {
        let (n, learned) = (self.n, tangents.weights());
        let none = vec![Row::default(); n];
        self.del.smooth().differentiate(weights, [q, v, &none]);
        if learned > 0 {
            self.pull_momenta(weights, [q, v, &none]);
        }
        for (number, moved) in tangents.each_mut().enumerate() {
            self.moved.copy_from_slice(moved);
            let position = self.learned.get(number).filter(|_| number < learned);
            for (i, place) in moved[n..].iter_mut().enumerate() {
                *place = position.map_or(Row::default(), |position| self.gradients[i][*position]);
                for j in 0..n {
                    let [of_q, of_v] = self.del.smooth().momentum_columns(j).map(|column| &column[i]);
                    place.add_product(of_q, &self.moved[j]);
                    place.add_product(of_v, &self.moved[n + j]);
                }
            }
        }
    }

    /// Computes ∂L_v/∂θ, row by row.
    pub(super) fn pull_momenta(&mut self, weights: &[f64], at: [&[Row]; 3]) {
        let n = self.n;
        self.gradients[..n].iter_mut().for_each(|row| row.fill(Row::default()));
        let axis = |k: usize| Row::splat(f64::from(u8::from(k / n == k % n)));
        let axes: Vec<Row> = (0..n * n).map(axis).collect();
        let inputs: Vec<&[Row]> = at.into_iter().chain(axes.chunks_exact(n)).collect();
        let (program, workspace) = &mut self.momentum;
        program.run(weights, &inputs, workspace, &mut self.gradients[..n]);
    }

    /// Carries the derivatives with respect to every parameter to the end of a path.
    fn carry(
        &mut self,
        weights: &[f64],
        path: &Interval,
        (tangents, controls): (&mut Tangents, &[ControlTangent]),
    ) {
        let (n, learned) = (self.n, tangents.weights());
        let transition = self.transition(weights, path);
        if learned > 0 {
            self.pull(weights, path, &transition.of_equations);
        }
        for (number, moved) in tangents.each_mut().enumerate() {
            self.moved.copy_from_slice(moved);
            for (place, rows) in moved.iter_mut().zip(transition.of_state.chunks_exact(2 * n)) {
                *place = dot(rows, &self.moved);
            }
            if let Some(position) = self.learned.get(number).filter(|_| number < learned) {
                let own = self.gradients.iter().map(|row| &row[*position]);
                moved.iter_mut().zip(own).for_each(|(place, own)| place.add_scaled(1.0, own));
            }
        }
        for control in controls {
            let moved = tangents.of_mut(learned + control.number);
            for (change, of) in control.change.iter().zip(&transition.of_control) {
                for (place, rows) in moved.iter_mut().zip(of.chunks_exact(n)) {
                    place.add_product(change, &rows[control.coordinate]);
                }
            }
        }
    }
}

impl Steps for VariationalSteps {
    /// Sets p = L_v(q, v).
    fn begin(&mut self, weights: &[f64], state: &mut State, tangents: Option<&mut Tangents>) {
        let (q, v) = state.split_at(self.n);
        self.last = self.del.start_at(weights, q, v);
        if let Some(tangents) = tangents {
            self.carry_to_momenta(weights, [q, v], tangents);
        }
        state[self.n..].copy_from_slice(&self.last.p);
    }

    fn step(
        &mut self,
        weights: &[f64],
        state: &mut State,
        tau: [&[Row]; 2],
        tangents: Option<(&mut Tangents, &[ControlTangent])>,
    ) -> Failures {
        let (q, p) = state.split_at_mut(self.n);
        self.last.q.copy_from_slice(q);
        self.last.p.copy_from_slice(p);
        self.del.step(weights, &mut self.last, tau);
        if let Some(with) = tangents {
            let [w, s] = self.last.last().map(<[Row]>::to_vec);
            let path = Interval { s, ..Interval::new(q, &w, tau) };
            let (tangents, controls) = with;
            self.carry(weights, &path, (&mut *tangents, controls));
            let [q, p] = [&self.last.q, &self.last.p].map(Clone::clone);
            self.carry_across_strikes(weights, [&q, &p], tangents);
        }
        q.copy_from_slice(&self.last.q);
        p.copy_from_slice(&self.last.p);
        self.last.failed
    }
}
