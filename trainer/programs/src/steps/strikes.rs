//! Derivatives of a motion across the strike of an end stop.

use super::VariationalSteps;
use super::tangents::Tangents;
use crate::dynamics::{Strike, times};
use crate::row::Row;

impl VariationalSteps {
    /// Carries derivatives at the end (q, p) of a step, which know no stops, across the strikes of that step.
    ///
    /// A strike of coordinate i turns its velocity v_i into −e v_i: with c the column i of M⁻¹, p_i⁺ = p_i − (1 + e) v_i/c_i. A motion beside
    /// this one strikes earlier or later by δq_i/v_i (the saltation matrix; Leine and Nijmeijer, "Dynamics and bifurcations of non-smooth
    /// mechanical systems", 2004, section 7): with the acceleration a_i, and with u the velocities if coordinate i stopped,
    ///
    /// δq⁺ = δq − (1 + e) δq_i c/c_i, δp_i⁺ = δp_i − (1 + e) (cᵀ(δp − δM u) − a_i δq_i/v_i)/c_i.
    ///
    /// A coordinate that stays on the stop has e = 0 and no acceleration.
    pub(super) fn carry_across_strikes(
        &mut self,
        weights: &[f64],
        [q, p]: [&[Row]; 2],
        tangents: &mut Tangents,
    ) {
        let strikes = std::mem::take(&mut self.last.strikes);
        if strikes.is_empty() {
            return;
        }
        let (n, none) = (self.n, vec![Row::default(); self.n]);
        self.del.smooth().differentiate(weights, [q, &none, &none]);
        let compliance = self.compliance();
        let v = times(&compliance, p);
        for i in 0..n {
            let own: Vec<Strike> = strikes.iter().filter(|strike| strike.coordinate == i).copied().collect();
            if !own.is_empty() {
                let column: Vec<Row> = (0..n).map(|k| compliance[k * n + i]).collect();
                let stopped: Vec<Row> =
                    (0..n).map(|k| stopped([&v[k], &v[i]], [&column[k], &column[i]])).collect();
                self.differentiate_momenta(weights, [q, &stopped, &none], tangents.weights() > 0);
                self.carry_across(&own, &column, tangents);
            }
        }
    }

    /// Computes the derivatives of L_v with respect to q and, on demand, to the weights.
    fn differentiate_momenta(&mut self, weights: &[f64], at: [&[Row]; 3], with_weights: bool) {
        self.del.smooth().differentiate(weights, at);
        if with_weights {
            self.pull_momenta(weights, at);
        }
    }

    /// Carries derivatives across strikes of one coordinate, whose column of M⁻¹ is given.
    fn carry_across(&mut self, strikes: &[Strike], column: &[Row], tangents: &mut Tangents) {
        let (n, h, learned) = (self.n, self.del.h(), tangents.weights());
        let integrals = self.del.smooth();
        let by_q: Vec<Vec<Row>> = (0..n).map(|j| integrals.momentum_columns(j)[0].to_vec()).collect();
        for (number, moved) in tangents.each_mut().enumerate() {
            let position = self.learned.get(number).filter(|_| number < learned);
            let (dq, dp) = moved.split_at_mut(n);
            for Strike { coordinate, sample, restitution, gain } in strikes.iter().copied() {
                let (own, c) = (dq[coordinate].0[sample], |k: usize| column[k].0[sample]);
                let share = (1.0 + restitution) / c(coordinate);
                let of_inertia = |k: usize| {
                    let of_weight = position.map_or(0.0, |position| self.gradients[k][*position].0[sample]);
                    let of_q = |j: usize| by_q[j][k].0[sample] * dq[j].0[sample];
                    of_weight + (0..n).map(of_q).sum::<f64>()
                };
                let impulse: f64 = (0..n).map(|k| c(k) * (dp[k].0[sample] - of_inertia(k))).sum();
                dp[coordinate].0[sample] -= share * (impulse - gain / h * own);
                dq.iter_mut().enumerate().for_each(|(k, dq)| dq.0[sample] -= share * own * c(k));
                // To the last bit, as the position is.
                if restitution == 0.0 {
                    dq[coordinate].0[sample] = 0.0;
                }
            }
        }
    }
}

/// Velocity of a coordinate if another one stopped, from the velocities of both and their entries in the other's column of M⁻¹.
fn stopped([v, other]: [&Row; 2], [own, others]: [&Row; 2]) -> Row {
    Row(std::array::from_fn(|k| v.0[k] - other.0[k] * own.0[k] / others.0[k]))
}
