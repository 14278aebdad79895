//! The slice interface of particles gives the same results as core's types, bit for bit.

mod common;

use common::{GRAPHS, GraphSample, Random, STEPS, aligned, bits, flash, step};
use leastaction_core::constraints::{Constrained, Holonomic};
use leastaction_core::continuous::{
    Baumgarte, Drive, constrained_acceleration, constrained_inverse_dynamics, constrained_workspace,
};
use leastaction_core::discrete::Order;
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::energy::graph::Edge;
use leastaction_core::model::GraphModel;
use leastaction_core::particles::Particles;
use leastaction_replica::{Control, ModelFile, Replica, Step};
use proptest::prelude::*;

/// Loads a graph both ways.
fn same_graph<const D: usize>(sample: &GraphSample, part: usize) {
    let bytes = sample.file(Order::Four);
    let words = aligned(&bytes);
    let unused = Holonomic::Anchor { node: 0, to: [0.0; D], length: 1.0 };
    let (mut edges, mut rods) = ([Edge::default(); 16], [unused; 16]);
    let name = GRAPHS[part];
    let core = GraphModel::<D, 2, 16, 2>::load(flash(&words, &bytes), name, &mut edges, &mut rods).unwrap();
    let system = core.system.constrained().unwrap();
    let file = ModelFile::new(&bytes).unwrap();
    let chip = file.replica(Some(name)).unwrap();
    let mut random = Random(sample.seed ^ 77);
    let n = chip.n();
    let [v, u, a] = [0.5, 1.0, 3.0].map(|size| random.vector(n, size));
    let q = sample.positions();
    same_evaluations(&chip, &system, [&q, &v, &u, &a]);
    same_rattle(&chip, &system, Order::Two, [&q, &v, &u]);
    same_rattle(&chip, &system, Order::Four, [&q, &v, &u]);
}

type OnRods<'a, S, const D: usize> = Constrained<'a, f32, S, [Holonomic<f32, D>], D>;

fn vectors<const D: usize>(x: &[f32]) -> Vec<[f32; D]> {
    x.as_chunks().0.to_vec()
}

/// Compares energies, accelerations and inverse dynamics of particles.
fn same_evaluations<S: Particles<f32, D>, const D: usize>(
    chip: &Replica,
    system: &OnRods<S, D>,
    [q, v, u, a]: [&[f32]; 4],
) {
    let mut workspace = vec![0.0; constrained_workspace(system)];
    let (mut evaluator, mut found) = (chip.evaluator().unwrap(), vec![0.0; q.len()]);
    let (mut expected, mut lambda) = (vectors::<D>(q), vec![0.0; system.equations()]);
    let ours = evaluator.energies(q, v).unwrap();
    let theirs = system.system().energies(&vectors(q), &vectors(v), &mut workspace);
    assert_eq!(bits(&[ours.kinetic, ours.potential]), bits(&[theirs.kinetic, theirs.potential]));

    let force = vectors(u);
    let drive = Drive { force: Some(&force), baumgarte: Baumgarte::none() };
    let to = (expected.as_mut_slice(), lambda.as_mut_slice());
    evaluator.acceleration(q, v, u, &mut found).unwrap();
    constrained_acceleration(system, (&vectors(q), &vectors(v)), &drive, &mut workspace, to).unwrap();
    assert_eq!(bits(&found), bits(expected.as_flattened()));

    let state = [q, v, a].map(vectors);
    evaluator.inverse_dynamics(q, v, a, &mut found).unwrap();
    let state = state.each_ref().map(Vec::as_slice);
    constrained_inverse_dynamics(system, state, &mut workspace, &mut expected).unwrap();
    assert_eq!(bits(&found), bits(expected.as_flattened()));

    let n = q.len();
    let mut masses = vec![f32::NAN; n * n];
    evaluator.mass_matrix(q, &mut masses).unwrap();
    for (k, mass) in masses.iter().enumerate() {
        let (row, column) = (k / n, k % n);
        let block = system.system().mass(row / D, &[0.0; D]);
        let theirs = if row / D == column / D { block[row % D][column % D] } else { 0.0 };
        assert_eq!(mass.to_bits(), theirs.to_bits());
    }
}

/// Compares motions of particles from both kinds of beginning.
fn same_rattle<S: Particles<f32, D>, const D: usize>(
    chip: &Replica,
    system: &OnRods<S, D>,
    order: Order,
    [q, v, u]: [&[f32]; 3],
) {
    let (step, force, nodes) = (Step::from(step(order)), vectors(u), q.len() / D);
    let rattle = Rattle::new(step.h, order);
    let mut workspace = vec![0.0; Rattle::workspace(system)];
    let mut memory = vec![0.0; ParticleState::<f32, D>::workspace(nodes, system.equations())];
    let mut theirs =
        ParticleState::new(system, &vectors(q), &vectors(v), &mut memory, &mut workspace).unwrap();
    let (mut ours, mut found) = (chip.motion_at(step, q, v).unwrap(), vec![0.0; q.len()]);
    let mut before = Vec::new();
    for _ in 0..STEPS {
        before = ours.q().to_vec();
        let report = ours.step(Control::held(u)).unwrap();
        assert_eq!(report, rattle.step(system, &mut theirs, Some(&force), &mut workspace).unwrap());
        assert_eq!(bits(ours.q()), bits(theirs.q().as_flattened()));
        assert_eq!(bits(ours.p()), bits(theirs.p().as_flattened()));
        ours.velocity(&mut found).unwrap();
        assert_eq!(bits(&found), bits(theirs.v().as_flattened()));
    }
    let ends = [vectors(&before), vectors(ours.q())];
    let theirs = rattle
        .start(system, ends.each_ref().map(Vec::as_slice), Some(&force), &mut memory, &mut workspace)
        .unwrap();
    let ours = chip.motion_between(step, [&before, ours.q()], Control::held(u)).unwrap();
    assert_eq!(bits(ours.p()), bits(theirs.p().as_flattened()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn graphs_have_the_bits_of_core(nodes in 2..9_u16, width in 1..16_u16, part in 0..2_usize, seed: u64) {
        same_graph::<2>(&GraphSample::row(2, nodes, width, seed), part);
        same_graph::<3>(&GraphSample::row(3, nodes, width, seed), part);
    }
}
