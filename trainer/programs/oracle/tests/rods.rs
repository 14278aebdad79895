//! Losses with rods: comparison with core's RATTLE and accelerations, and of derivatives with differences.

mod common;

use common::losses::{check_derivatives, check_failures, evaluate};
use common::on_rods::{Case, H, ODD, PLAIN, SMOOTH, wave};
use leastaction_core::constraints::{Constrained, Constraints, Positions};
use leastaction_core::continuous::{Drive, constrained_acceleration, constrained_workspace};
use leastaction_core::discrete;
use leastaction_core::energy::inertia_network::{Coordinate, Inertia};
use leastaction_core::forces::ControlKind;
use leastaction_core::model::Rod;
use leastaction_core::network::Activation;
use leastaction_core::particles::Particles;
use leastaction_programs::dynamics::{Order, Rods};
use leastaction_programs::energies::InertiaNetworkEnergies;
use leastaction_programs::losses::{AccelerationLoss, Block, Derivatives, Loss, RodsLoss};
use leastaction_programs::{Row, System, WIDTH};

const ORDERS: [(Order, discrete::Order); 2] =
    [(Order::Two, discrete::Order::Two), (Order::Four, discrete::Order::Four)];

impl<const D: usize> Case<D> {
    fn check_steps(&self) {
        let mut moved = self.weights.clone();
        moved.iter_mut().enumerate().for_each(|(k, w)| *w += 0.1 * wave(3 * k));
        for ((order, of_core), kind) in ORDERS.into_iter().zip([ControlKind::Held, ControlKind::Linear]) {
            self.check_control(order, of_core);
            let block = self.stepped(of_core, kind);
            for next_position in [false, true] {
                let mut loss = self.loss(order, next_position);
                let found = largest(&evaluate(&mut loss, &self.weights, &block));
                assert!(
                    found < if next_position { 3e-15 } else { 3e-13 },
                    "{order:?} {next_position}: {found}"
                );
                // Steps of the other order give a different result.
                let other = if order == Order::Two { Order::Four } else { Order::Two };
                let other = largest(&evaluate(&mut self.loss(other, next_position), &self.weights, &block));
                assert!(other > 1e-7, "{other}");
                check_derivatives(&mut loss, &moved, &block, 1e-6);
            }
            self.check_displaced(order, &block);
        }
    }

    /// Checks that each kind of control explains its own motion but not that of the other kind.
    fn check_control(&self, order: Order, of_core: discrete::Order) {
        let kinds = [ControlKind::Held, ControlKind::Linear];
        for (kind, other) in [(kinds[0], kinds[1]), (kinds[1], kinds[0])] {
            let own = self.stepped(of_core, kind);
            let taken_for_other = Block { control: other, ..own.clone() };
            let mut loss = self.loss(order, true);
            let found = [&own, &taken_for_other].map(|b| largest(&evaluate(&mut loss, &self.weights, b)));
            assert!(found[0] < 3e-15 && found[1] > 1e-5, "{kind:?}: {found:?}");
        }
    }

    /// Checks that the next position does not depend on the logged one, and that the DEL residual is the change of
    /// momentum in the directions that the rods leave free.
    fn check_displaced(&self, order: Order, block: &Block) {
        let mut displaced = block.clone();
        let by = |i: usize, sample: usize| 1e-3 * wave(7 * i + 3 * sample);
        for (i, row) in displaced.states[2].iter_mut().enumerate() {
            row.0.iter_mut().enumerate().for_each(|(sample, x)| *x += by(i, sample));
        }
        let found = evaluate(&mut self.loss(order, true), &self.weights, &displaced);
        for (i, row) in found.iter().enumerate() {
            for sample in 0..WIDTH {
                assert!((row.0[sample] + by(i, sample)).abs() < 1e-14, "{} {}", row.0[sample], by(i, sample));
            }
        }
        if order == Order::Two {
            let found = evaluate(&mut self.loss(order, false), &self.weights, &displaced);
            for sample in 0..WIDTH {
                let expected = self.lost([block, &displaced], sample);
                for (row, expected) in found.iter().zip(&expected) {
                    assert!((row.0[sample] - expected).abs() < 1e-12, "{} {expected}", row.0[sample]);
                }
            }
        }
    }

    /// L_v of the last increment of one block minus that of the other, without the part in the constrained directions
    /// at the middle position.
    fn lost(&self, blocks: [&Block; 2], sample: usize) -> Vec<f64> {
        let [p, other] = blocks.map(|block| {
            let ends = block.states[1].iter().zip(&block.states[2]);
            let w: Vec<f64> = ends.map(|(a, b)| (b.0[sample] - a.0[sample]) / H).collect();
            let mut p = vec![[0.0; D]; self.nodes.len()];
            self.graph(&self.weights).momenta(0, w.as_chunks().0, &mut p);
            p.concat()
        });
        let mut lost: Vec<f64> = p.iter().zip(&other).map(|(p, other)| p - other).collect();
        let q: Vec<f64> = blocks[0].states[1].iter().map(|q| q.0[sample]).collect();
        let (rods, x) = (self.constraints(), Positions::new(q.as_chunks().0));
        // Gram–Schmidt orthogonalisation.
        let mut across: Vec<Vec<f64>> = Vec::new();
        for k in 0..rods.len() {
            let mut direction = vec![[0.0; D]; self.nodes.len()];
            let ends = rods[..].nodes(k).iter().enumerate();
            ends.for_each(|(slot, node)| direction[*node] = rods[..].gradient(k, slot, x));
            let mut direction = direction.concat();
            across.iter().for_each(|other| take(&mut direction, other));
            let size = dot(&direction, &direction).sqrt();
            across.push(direction.iter().map(|x| x / size).collect());
        }
        across.iter().for_each(|direction| take(&mut lost, direction));
        lost
    }

    fn check_accelerations(&self) {
        let (block, system) = (self.disturbed(), self.system());
        let mut loss = AccelerationLoss::with_rods(&system, self.rods(), true);
        let found = evaluate(&mut loss, &self.weights, &block);
        let (graph, rods) = (self.graph(&self.weights), self.constraints());
        let mechanism = Constrained::new(&graph, &rods[..]).expect("rods");
        let mut workspace = vec![0.0; constrained_workspace(&mechanism)];
        for sample in 0..WIDTH {
            let of = |rows: &[Row]| -> Vec<f64> { rows.iter().map(|row| row.0[sample]).collect() };
            let [q, v, logged] = block.states.each_ref().map(|rows| of(rows));
            let tau = of(&block.controls[0]);
            let drive = Drive { force: Some(tau.as_chunks().0), ..Drive::none() };
            let mut a = vec![[0.0; D]; self.nodes.len()];
            let mut lambda = vec![0.0; rods.len()];
            let (q, v) = (q.as_chunks().0, v.as_chunks().0);
            constrained_acceleration(&mechanism, (q, v), &drive, &mut workspace, (&mut a, &mut lambda))
                .expect("an acceleration");
            for (i, (a, logged)) in a.as_flattened().iter().zip(&logged).enumerate() {
                let error = (found[i].0[sample] - (a - logged)).abs();
                assert!(error < 1e-12 * (1.0 + a.abs()), "{} {}", found[i].0[sample], a - logged);
            }
        }
        check_derivatives(&mut loss, &self.weights, &block, 1e-6);
    }

    fn check_failures(&self) {
        let mut losses: Vec<Box<dyn Loss>> =
            vec![Box::new(AccelerationLoss::with_rods(&self.system(), self.rods(), true))];
        for (order, _) in ORDERS {
            for next_position in [false, true] {
                losses.push(Box::new(self.loss(order, next_position)));
            }
        }
        let good = self.stepped(discrete::Order::Two, ControlKind::Linear);
        let mut bad = good.clone();
        bad.states.iter_mut().for_each(|state| state[1].0[3] = 1e200);
        bad.states[0][0].0[7] = f64::NAN;
        // A rod without a direction.
        bad.states.iter_mut().flatten().for_each(|row| row.0[12] = 0.0);
        for mut loss in losses {
            check_failures(&mut *loss, &self.weights, [&good, &bad], &[3, 7, 12]);
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Removes the part along a unit vector from another vector.
fn take(of: &mut [f64], along: &[f64]) {
    let part = dot(of, along);
    of.iter_mut().zip(along).for_each(|(x, along)| *x -= part * along);
}

fn largest(rows: &[Row]) -> f64 {
    rows.iter().flat_map(|row| row.0).fold(0.0, |largest, x| largest.max(x.abs()))
}

const fn rod(from: Option<u16>, to: u16, length: f32) -> Rod {
    Rod { from, to, length }
}

/// Two nodes on rods and a third on a spring.
fn in_the_plane() -> Case<2> {
    let rods = [rod(None, 1, 0.75), rod(Some(1), 0, 1.25)];
    Case::new(&[ODD, PLAIN], &[0, 1, 1], &[[0, 2]], &rods)
}

/// A pendulum of three bobs.
fn chain() -> Case<2> {
    let rods = [rod(None, 0, 1.0), rod(Some(0), 1, 0.75), rod(Some(1), 2, 0.5)];
    Case::new(&[PLAIN, ODD], &[0, 0, 1], &[], &rods)
}

/// A pendulum of two bobs with another node on a spring.
fn in_space() -> Case<3> {
    let rods = [rod(None, 1, 0.75), rod(Some(1), 0, 0.5)];
    Case::new(&[ODD, PLAIN], &[0, 1, 1], &[[1, 2]], &rods)
}

/// A pendulum of two bobs without drag.
fn without_drag() -> Case<2> {
    Case::new(&[SMOOTH], &[0, 0], &[], &[rod(None, 0, 1.0), rod(Some(0), 1, 0.75)])
}

#[test]
fn steps_in_the_plane() {
    in_the_plane().check_steps();
}

#[test]
fn steps_of_a_chain() {
    chain().check_steps();
}

#[test]
fn steps_in_space() {
    in_space().check_steps();
}

#[test]
fn steps_without_drag() {
    without_drag().check_steps();
}

/// Without constraints, the method is that of Störmer and Verlet.
#[test]
fn steps_without_rods() {
    Case::<2>::new(&[PLAIN, ODD], &[0, 1], &[[0, 1]], &[]).check_steps();
}

#[test]
fn accelerations() {
    in_the_plane().check_accelerations();
    chain().check_accelerations();
    in_space().check_accelerations();
    without_drag().check_accelerations();
}

#[test]
fn what_fails_fails_alone() {
    in_the_plane().check_failures();
    in_space().check_failures();
    without_drag().check_failures();
}

/// A kinetic energy that depends on positions is refused.
#[test]
fn only_separable_systems() {
    let inertia = Inertia::Cholesky { epsilon: 0.7 };
    let model =
        InertiaNetworkEnergies::new(vec![Coordinate::Angle; 2], (&[6], Activation::Tanh), inertia, true);
    assert!(RodsLoss::new(&System::new(&model), Rods::default(), H, Order::Two, true).is_none());
}

/// A negative mass has an acceleration only if `definite` is not set.
#[test]
fn only_definite_masses_where_it_is_asked() {
    let mut case = without_drag();
    let numbers = case.weights.len() - 2 - 4;
    case.weights[numbers] = -1.0;
    let block = case.disturbed();
    for definite in [true, false] {
        let mut loss = AccelerationLoss::with_rods(&case.system(), case.rods(), definite);
        let mut residual = vec![Row::default(); loss.components()];
        let failures = loss.evaluate(&case.weights, &block, &mut residual, Derivatives::None);
        assert_eq!((failures.all(), failures.any(WIDTH)), (definite, definite));
    }
}
