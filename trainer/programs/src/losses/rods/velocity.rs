//! Velocity at a position, which determines the drag: the second line of a RATTLE step.

use super::model::{Gradient, MAX_ITERATIONS, RodModel, SETTLED, settled};
use crate::dynamics::{Failures, Lu, Rods, add, contracted, max_abs, product, times};
use crate::row::{Row, WIDTH};

/// Velocity v with L_v(v) = p + ½h Q(v) + Aᵀμ and A v = 0, its drag, and the derivatives of the drag.
#[derive(Clone, Default)]
pub(super) struct Velocity {
    pub v: Vec<Row>,
    /// Drag Q(v).
    pub drag: Vec<Row>,
    /// Derivative ∂Q/∂p.
    pub drag_p: Vec<Row>,
    /// Derivative ∂Q/∂q through the constraints, at constant p.
    pub drag_q: Vec<Row>,
}

/// Quantities that determine the velocity.
pub(super) struct Arrival<'a> {
    /// Half the length of the arriving step, ½h, s.
    pub half: f64,
    /// Momentum p that the step brings, without drag and constraint forces, kg m/s.
    pub momentum: Vec<Row>,
    /// First guess of v.
    pub guess: Vec<Row>,
    /// Constraint Jacobian A.
    pub gradients: &'a [Row],
}

/// Equations of v and −μ: their matrix \[\[M − ½h Q_v, Aᵀ\], \[A, 0\]\], stored without A, and their right-hand side.
struct Equations {
    mass: Vec<Row>,
    owed: Vec<Row>,
    drag: Vec<Row>,
    drag_v: Vec<Row>,
}

/// Parts of the inverse of the matrix of [`Equations`].
struct Inverse {
    /// Derivative ∂v/∂p.
    compliance: Vec<Row>,
    /// Derivative −∂v/∂(Av) for every rod.
    levers: Vec<Row>,
}

impl Arrival<'_> {
    /// Velocity of all samples that are not skipped, with the derivatives of drag if `derive` is set. Empty without drag.
    pub fn velocity(
        self,
        model: &mut RodModel,
        weights: &[f64],
        skip: Failures,
        derive: bool,
    ) -> (Velocity, Failures) {
        let RodModel { n, rods, momentum, drag: Some(drag), lu, .. } = model else {
            return Default::default();
        };
        let of = &mut [momentum, drag];
        let (mut v, mut mu) = (self.guess.clone(), vec![Row::default(); rods.count()]);
        let mut done = skip;
        let mut failures = Failures::default();
        let mut scale = max_abs(&self.momentum);
        for _ in 0..MAX_ITERATIONS {
            let equations = self.equations(of, weights, &v, &mu, &mut scale);
            for sample in (0..WIDTH).filter(|sample| !done.0[*sample]).collect::<Vec<_>>() {
                failures.0[sample] = !self.factor(lu, *n, &equations.mass, sample);
                let change = lu.solve(|i| equations.owed[i].0[sample]);
                v.iter_mut().zip(change).for_each(|(v, dv)| v.0[sample] += dv);
                mu.iter_mut().zip(&change[*n..]).for_each(|(mu, change)| mu.0[sample] -= change);
                let dp = equations.mass.chunks_exact(*n);
                let mut dp =
                    dp.map(|row| row.iter().zip(change).map(|(m, dv)| m.0[sample] * dv).sum::<f64>());
                done.0[sample] = failures.0[sample] || settled(&mut dp, SETTLED * scale.0[sample]);
            }
            if done.all() {
                break;
            }
        }
        failures = failures.or(Failures(done.0.map(|done| !done)));
        let equations = self.equations(of, weights, &v, &mu, &mut scale);
        let mut velocity = Velocity { v, drag: equations.drag.clone(), ..Velocity::default() };
        if derive {
            let inverse = self.inverse(lu, *n, &equations.mass, skip, &mut failures);
            let v_q = inverse.v_q(rods, &velocity.v, &mu);
            velocity.drag_p = product(&equations.drag_v, &inverse.compliance, *n);
            velocity.drag_q = product(&equations.drag_v, &v_q, *n);
        }
        (velocity, failures)
    }

    fn equations(
        &self,
        [momentum, drag]: &mut [&mut Gradient; 2],
        weights: &[f64],
        v: &[Row],
        mu: &[Row],
        scale: &mut Row,
    ) -> Equations {
        let (l_v, drag) = (momentum.at(weights, v), drag.at(weights, v));
        *scale = scale.zip(&max_abs(&l_v.value), f64::max);
        let mut mass = l_v.slope;
        add(&mut mass, -self.half, &drag.slope);
        let mut owed = self.momentum.clone();
        add(&mut owed, self.half, &drag.value);
        add(&mut owed, -1.0, &l_v.value);
        add(&mut owed, 1.0, &contracted(mu, self.gradients, v.len()));
        owed.extend(times(self.gradients, v).iter().map(|rate| rate.zip(rate, |rate, _| -rate)));
        Equations { mass, owed, drag: drag.value, drag_v: drag.slope }
    }

    fn factor(&self, lu: &mut Lu, n: usize, mass: &[Row], sample: usize) -> bool {
        let rods = self.gradients.len() / n;
        lu.factor(n + rods, |i, j| match (i < n, j < n) {
            (true, true) => mass[i * n + j].0[sample],
            (true, false) => self.gradients[(j - n) * n + i].0[sample],
            (false, true) => self.gradients[(i - n) * n + j].0[sample],
            (false, false) => 0.0,
        })
    }

    fn inverse(
        &self,
        lu: &mut Lu,
        n: usize,
        mass: &[Row],
        skip: Failures,
        failures: &mut Failures,
    ) -> Inverse {
        let mut inverse = Inverse {
            compliance: vec![Row::default(); n * n],
            levers: vec![Row::default(); self.gradients.len()],
        };
        for sample in (0..WIDTH).filter(|sample| !skip.0[*sample]) {
            failures.0[sample] |= !self.factor(lu, n, mass, sample);
            // The inverse is symmetric, so columns are rows.
            let rows = inverse.compliance.chunks_exact_mut(n).chain(inverse.levers.chunks_exact_mut(n));
            for (j, row) in rows.enumerate().filter(|_| !failures.0[sample]) {
                let column = lu.solve(|i| f64::from(u8::from(i == j)));
                row.iter_mut().zip(column).for_each(|(place, x)| place.0[sample] = *x);
            }
        }
        inverse
    }
}

impl Inverse {
    /// Derivative ∂v/∂q: as q moves, both Aᵀμ and the condition A v = 0 change.
    fn v_q(&self, rods: &Rods, v: &[Row], mu: &[Row]) -> Vec<Row> {
        let n = v.len();
        let mut v_q = product(&self.compliance, &rods.turned(mu, n), n);
        for (k, lever) in self.levers.chunks_exact(n).enumerate() {
            let rate = rods.gradient(k, v);
            for (row, lever) in v_q.chunks_exact_mut(n).zip(lever) {
                let lever = lever.zip(lever, |x, _| -x);
                row.iter_mut().zip(&rate).for_each(|(entry, rate)| entry.add_product(&lever, rate));
            }
        }
        v_q
    }
}
