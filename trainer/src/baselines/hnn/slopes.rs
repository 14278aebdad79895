//! Squared errors of what is linear in the gradient of a learned Hamiltonian: of its rates, and of its accelerations.

use super::{DEPTH, Hnn, MAX_WIDTH, Network};
use crate::baselines::features::{first, group, inputs, moving, squares};
use crate::training::{ChunkRows, Failed, NormalEquations, Residuals, Samples};
use leastaction_core::network::{Jet, Tape};
use leastaction_core::scalar::{LANES, Lanes};
use std::ops::Range;

/// Residuals r_k = d_k·(H_q, H_p) − t_k at given states (q, p), directions d_k and targets t_k.
pub(super) struct Slopes {
    hnn: Hnn,
    /// Residual components of a sample.
    components: usize,
    /// (q, p): \[samples\]\[2n\], flat.
    states: Vec<f64>,
    /// d: \[samples\]\[components\]\[2n\], flat.
    directions: Vec<f64>,
    /// t: \[samples\]\[components\], flat.
    targets: Vec<f64>,
}

/// A sample as (q, v, v̇).
type Row<'s> = [&'s [f64]; 3];

impl Slopes {
    /// H_p − q̇ and −H_q − ṗ.
    pub fn rates(hnn: Hnn, samples: &Samples) -> Self {
        let (n, momenta) = (hnn.n(), hnn.momenta);
        let directions: Vec<f64> = (0..2 * n).flat_map(|k| rate_direction(k, n)).collect();
        Self::new(hnn, 2 * n, samples, |[q, v, a]| {
            let rates = momenta.momenta(q, a).into_iter().zip(momenta.convection(q, v)).map(|(a, b)| a + b);
            (directions.clone(), v.iter().copied().chain(rates).collect())
        })
    }

    /// M⁻¹(−H_q − Ṁv) − v̇; not a number where M is singular.
    pub fn accelerations(hnn: Hnn, samples: &Samples) -> Self {
        let (n, momenta) = (hnn.n(), hnn.momenta);
        Self::new(hnn, n, samples, |[q, v, a]| {
            let Some(mobility) = momenta.mobility(q) else {
                return (vec![f64::NAN; 2 * n * n], a.to_vec());
            };
            let convection = momenta.convection(q, v);
            let row = |i: usize| (0..2 * n).map(|j| if j < n { -mobility[(i, j)] } else { 0.0 }).collect();
            let directions: Vec<Vec<f64>> = (0..n).map(row).collect();
            let bent = |i: usize| (0..n).map(|j| mobility[(i, j)] * convection[j]).sum::<f64>();
            (directions.concat(), (0..n).map(|i| a[i] + bent(i)).collect())
        })
    }

    fn new(
        hnn: Hnn,
        components: usize,
        samples: &Samples,
        terms: impl Fn(Row) -> (Vec<f64>, Vec<f64>),
    ) -> Self {
        let [q, v, a] = samples.states.each_ref().map(|rows| rows.chunks_exact(hnn.n()));
        let (states, directions, targets) = Default::default();
        let mut slopes = Self { hnn, components, states, directions, targets };
        for ((q, v), a) in q.zip(v).zip(a) {
            let (directions, targets) = terms([q, v, a]);
            slopes.states.extend_from_slice(q);
            slopes.states.extend(slopes.hnn.momenta.momenta(q, v));
            slopes.directions.extend(directions);
            slopes.targets.extend(targets);
        }
        slopes
    }

    /// Numbers of a state.
    fn width(&self) -> usize {
        2 * self.hnn.n()
    }

    fn network<'w>(&self, weights: &'w [f64]) -> Result<Network<'w>, Failed> {
        self.hnn.network(weights).ok_or(Failed)
    }

    fn group(&self, network: &Network, start: usize, end: usize) -> Group {
        let state = group(&self.states, self.width(), start, end);
        let gradient = self.hnn.gradient(network, state.clone());
        let directions = group(&self.directions, self.width() * self.components, start, end);
        let targets = group(&self.targets, self.components, start, end);
        let along =
            |d: &[Lanes]| d.iter().zip(&gradient).fold(Lanes([0.0; LANES]), |sum, (d, g)| sum + *d * *g);
        let rows = directions.chunks_exact(self.width()).zip(targets);
        let residuals = rows.map(|(d, target)| along(d) - target).collect();
        Group { state, directions, residuals }
    }

    /// Adds ∂/∂θ of d·(H_q, H_p) at a state.
    fn add(&self, network: &Network, state: &[Lanes], direction: &[Lanes], row: &mut [Lanes]) {
        let x = inputs(&self.hnn.coordinates, &moving(state, direction));
        let mut tape = Tape::<Lanes, 1, MAX_WIDTH, DEPTH>::default();
        network.forward(&x, &mut tape, &mut [Jet::zero()]);
        let mut start = network.len();
        network.layer_adjoints(
            &tape,
            &x,
            &[Jet::<Lanes, 1>::constant(Lanes([1.0; LANES]))],
            |layer, x, bar| {
                start -= layer.len();
                layer.tangent_gradient(x, bar, |i, value| row[start + i] += value);
            },
        );
    }
}

/// Rates are (H_p, −H_q).
fn rate_direction(k: usize, n: usize) -> Vec<f64> {
    let mut direction = vec![0.0; 2 * n];
    let (entry, sign) = if k < n { (n + k, 1.0) } else { (k - n, -1.0) };
    direction[entry] = sign;
    direction
}

/// Eight samples side by side.
struct Group {
    state: Vec<Lanes>,
    directions: Vec<Lanes>,
    residuals: Vec<Lanes>,
}

impl Residuals for Slopes {
    fn parameters(&self) -> usize {
        self.hnn.parameters()
    }

    fn samples(&self) -> usize {
        self.states.len() / self.width()
    }

    fn components(&self) -> usize {
        self.components
    }

    fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed> {
        let network = self.network(weights)?;
        let of_group = |start: usize| {
            let group = self.group(&network, start, samples.end);
            group.residuals.iter().map(|r| squares(r, samples.end - start)).sum::<f64>()
        };
        Ok(samples.clone().step_by(LANES).map(of_group).sum())
    }

    fn linearise(&self, weights: &[f64], samples: Range<usize>, rows: &mut ChunkRows) -> Result<(), Failed> {
        let network = self.network(weights)?;
        let count = samples.len();
        rows.reset(count * self.components, weights.len());
        for start in samples.clone().step_by(LANES) {
            let group = self.group(&network, start, samples.end);
            let own = (samples.end - start).min(LANES);
            let terms = group.directions.chunks_exact(self.width()).zip(&group.residuals);
            for (i, (direction, residual)) in terms.enumerate() {
                rows.fill((i * count + start - samples.start, own), residual, |row| {
                    self.add(&network, &group.state, direction, row);
                    Ok(())
                })?;
            }
        }
        Ok(())
    }

    /// Without the Jacobian: residuals are linear in their directions, so these are added first, weighed by the residuals.
    fn add_gradient(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        rows: &mut ChunkRows,
        sum: &mut NormalEquations,
    ) -> Result<(), Failed> {
        let network = self.network(weights)?;
        rows.reset_buffer(weights.len());
        for start in samples.clone().step_by(LANES) {
            let group = self.group(&network, start, samples.end);
            let own = samples.end - start;
            let mut direction = vec![Lanes([0.0; LANES]); self.width()];
            for (d, residual) in group.directions.chunks_exact(self.width()).zip(&group.residuals) {
                let residual = first(residual, own);
                sum.squares += squares(&residual, LANES);
                direction.iter_mut().zip(d).for_each(|(sum, d)| *sum += residual * *d);
            }
            self.add(&network, &group.state, &direction, &mut rows.buffer);
        }
        sum.add_lanes(&rows.buffer, samples.len() * self.components);
        Ok(())
    }
}
