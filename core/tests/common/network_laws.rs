//! Laws of force with networks, and their formulas.

use super::Random;
use super::shapes::naive_network;
use leastaction_core::energy::MAX_HIDDEN;
use leastaction_core::forces::{Dissipation, PotentialCorrection};
use leastaction_core::model::{Law, LawNetwork};
use leastaction_core::network::Activation;
use leastaction_core::scalar::WeightFormat;

/// Compiled limits above the layers and units that the networks have.
const H: usize = 6;
const L: usize = 3;
const WIDTHS: [u16; MAX_HIDDEN] = [5, 4, 0, 0];

pub type Laws<'w, W, const N: usize> = (Dissipation<'w, W, N, H, L>, PotentialCorrection<'w, W, N, H, L>);

/// A dissipation and a potential of some coordinates, with their numbers.
pub struct NetworkLaws {
    pub dissipation: LawNetwork<'static>,
    pub potential: LawNetwork<'static>,
    /// The scales of the velocities, then the network.
    pub of_dissipation: Vec<f64>,
    pub of_potential: Vec<f64>,
}

impl NetworkLaws {
    /// Laws of `n` coordinates in which no two sizes are equal.
    pub fn of(n: usize, seed: u64) -> Self {
        let letters = [("a", "t"), ("ca", "-a"), ("t-a", "-at"), ("-act", "a-t")];
        let (dissipation, potential) = letters[n - 1];
        let network = |coordinates, activation| LawNetwork { coordinates, widths: WIDTHS, activation };
        let dissipation = network(dissipation, Activation::Tanh);
        let potential = network(potential, Activation::Softplus);
        let mut random = Random(seed);
        let mut numbers = |network: &LawNetwork, law| {
            random.vector(network.network(law).unwrap().parameters().unwrap(), 1.5)
        };
        let scales = (0..dissipation.count()).map(|k| 0.7 + 0.4 * k as f64);
        let of_network = numbers(&dissipation, Law::Dissipation);
        let of_dissipation = scales.chain(of_network).collect();
        let of_potential = numbers(&potential, Law::Potential);
        Self { dissipation, potential, of_dissipation, of_potential }
    }

    /// The laws with the weights of their networks multiplied by `c`; dissipation grows with the square of `c`.
    pub fn scaled(mut self, c: f64) -> Self {
        let of_network = self.of_dissipation.iter_mut().skip(self.dissipation.count());
        of_network.chain(&mut self.of_potential).for_each(|weight| *weight *= c);
        self
    }

    /// The laws over these numbers, which are [`NetworkLaws::numbers`] as another type.
    pub fn over<'w, W: WeightFormat, const N: usize>(&self, [d, p]: [&'w [W]; 2]) -> Laws<'w, W, N> {
        let (mut d, mut p) = (d, p);
        let dissipation = Dissipation::take(
            &mut d,
            self.dissipation.seen().unwrap(),
            &self.dissipation.network(Law::Dissipation).unwrap(),
        );
        let potential = PotentialCorrection::take(
            &mut p,
            self.potential.seen().unwrap(),
            &self.potential.network(Law::Potential).unwrap(),
        );
        assert!(d.is_empty() && p.is_empty(), "numbers are left");
        (dissipation.unwrap().unwrap(), potential.unwrap().unwrap())
    }

    pub fn in_f64<const N: usize>(&self) -> Laws<'_, f64, N> {
        self.over([&self.of_dissipation, &self.of_potential])
    }

    /// The numbers of both laws as another type.
    pub fn numbers<W>(&self, as_type: impl Fn(f64) -> W) -> [Vec<W>; 2] {
        [&self.of_dissipation, &self.of_potential]
            .map(|numbers| numbers.iter().map(|x| as_type(*x)).collect())
    }

    /// −LLᵀv, written down with a matrix.
    pub fn naive_force(&self, q: &[f64], v: &[f64]) -> Vec<f64> {
        self.force_of(q, v, &vec![1.0; self.dissipation.count()])
    }

    /// −L diag(s) Lᵀv for strengths s of the columns, written down with a matrix.
    pub fn force_of(&self, q: &[f64], v: &[f64], strengths: &[f64]) -> Vec<f64> {
        let seen: Vec<usize> = seen(&self.dissipation).collect();
        let (scales, numbers) = self.of_dissipation.split_at(seen.len());
        let mut x = features(&self.dissipation, q);
        x.extend(seen.iter().zip(scales).map(|(i, scale)| v[*i] / scale));
        let outputs = seen.len() * (seen.len() + 1) / 2;
        let o = naive_network(numbers, x, widths(), Activation::Tanh, outputs);
        let entry = |i: usize, j: usize| if j <= i { o[i * (i + 1) / 2 + j] } else { 0.0 };
        let mut force = vec![0.0; q.len()];
        for (i, row) in seen.iter().enumerate() {
            for (k, column) in seen.iter().enumerate() {
                let d: f64 = (0..seen.len()).map(|j| strengths[j] * entry(i, j) * entry(k, j)).sum();
                force[*row] -= d * v[*column];
            }
        }
        force
    }

    /// Potential V_c.
    pub fn naive_potential(&self, q: &[f64]) -> f64 {
        let x = features(&self.potential, q);
        naive_network(&self.of_potential, x, widths(), Activation::Softplus, 1)[0]
    }
}

fn widths() -> impl Iterator<Item = usize> {
    WIDTHS.into_iter().map(usize::from).take_while(|width| *width > 0)
}

fn seen<'n>(network: &'n LawNetwork) -> impl Iterator<Item = usize> + use<'n> {
    network.coordinates.char_indices().filter(|(_, letter)| *letter != '-').map(|(i, _)| i)
}

/// Lengths, cosines of angles, sines of angles.
fn features(network: &LawNetwork, q: &[f64]) -> Vec<f64> {
    let of = |kind: char| {
        let places = network.coordinates.char_indices().filter(move |(_, letter)| *letter == kind);
        places.map(|(i, _)| q[i]).collect::<Vec<f64>>()
    };
    let angles = of('a');
    let sines = angles.iter().map(|angle| angle.sin());
    of('t').into_iter().chain(angles.iter().map(|angle| angle.cos())).chain(sines).collect()
}
