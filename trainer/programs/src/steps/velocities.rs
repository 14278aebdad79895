use super::tangents::Tangents;
use super::{State, VariationalSteps};
use crate::dynamics::{Failures, times};
use crate::row::{Row, WIDTH};

impl VariationalSteps {
    /// Converts (q, p), the state that the steps use, into (q, v), together with its derivatives: the inverse of
    /// [`Steps::begin`](super::Steps::begin). From p = M v follows δv = M⁻¹(δp − ∂L_v/∂q δq − ∂L_v/∂θ). A sample with a
    /// singular mass matrix is NaN.
    pub fn finish(
        &mut self,
        weights: &[f64],
        state: &mut State,
        tangents: Option<&mut Tangents>,
    ) -> Failures {
        let (q, p) = state.split_at_mut(self.n);
        let none = vec![Row::default(); self.n];
        self.del.smooth().differentiate(weights, [q, &none, &none]);
        let compliance = self.compliance();
        p.copy_from_slice(&times(&compliance, p));
        if let Some(tangents) = tangents {
            self.carry_to_velocities(weights, [q, p], (&compliance, tangents));
        }
        let mut failures = Failures::default();
        failures.add_not_finite(state);
        failures
    }

    /// M⁻¹ at the point that was differentiated last, row by row.
    pub(super) fn compliance(&mut self) -> Vec<Row> {
        let n = self.n;
        let mut compliance = vec![Row::splat(f64::NAN); n * n];
        for sample in 0..WIDTH {
            let integrals = self.del.smooth();
            if !self.lu.factor(n, |i, j| integrals.momentum_columns(j)[1][i].0[sample]) {
                continue;
            }
            for j in 0..n {
                let column = self.lu.solve(|i| f64::from(u8::from(i == j)));
                column.iter().enumerate().for_each(|(i, x)| compliance[i * n + j].0[sample] = *x);
            }
        }
        compliance
    }

    fn carry_to_velocities(
        &mut self,
        weights: &[f64],
        [q, v]: [&[Row]; 2],
        (compliance, tangents): (&[Row], &mut Tangents),
    ) {
        let (n, learned) = (self.n, tangents.weights());
        let none = vec![Row::default(); n];
        self.del.smooth().differentiate(weights, [q, v, &none]);
        if learned > 0 {
            self.pull_momenta(weights, [q, v, &none]);
        }
        for (number, moved) in tangents.each_mut().enumerate() {
            let (positions, momenta) = moved.split_at_mut(n);
            if let Some(position) = self.learned.get(number).filter(|_| number < learned) {
                let own = self.gradients.iter().map(|row| &row[*position]);
                momenta.iter_mut().zip(own).for_each(|(place, own)| place.add_scaled(-1.0, own));
            }
            for (j, moved) in positions.iter().enumerate() {
                let [of_q, _] = self.del.smooth().momentum_columns(j);
                let lost = of_q.iter().map(|of| of.zip(moved, |of, moved| -of * moved));
                momenta.iter_mut().zip(lost).for_each(|(place, lost)| place.add_scaled(1.0, &lost));
            }
            momenta.copy_from_slice(&times(compliance, momenta));
        }
    }
}
