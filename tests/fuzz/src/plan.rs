//! Plans, and the law that follows them.

use crate::model::File;
use crate::{PLAN_HEAD, Random};
use leastaction_core::plan::{self, FORMAT_VERSION, MAGIC, Plan, PlanError, PlanFile, PlanHeader};

/// Maximum number of coordinates and of nodes of a plan that is written.
const MOST: u8 = 8;
/// Number of ticks that are followed, besides the end.
const TICKS: u32 = 40;

/// Reads the contents of a plan, or writes a plan of the sizes and numbers in the input, as the first byte chooses.
///
/// A plan that is written must be read as it was written, or refused for its values. Whatever is read must be what its parts are
/// written as; every node must begin with its record, and every command must be within its limits.
pub fn plan(input: &[u8]) {
    let Some((choice, rest)) = input.split_first() else { return };
    if choice & 1 == 0 {
        let file = File::with(MAGIC, FORMAT_VERSION, rest);
        match PlanFile::parse(file.bytes()) {
            Ok(plan) => read(&plan, *choice),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    } else if let Some((head, numbers)) = rest.split_first_chunk() {
        sized(head, numbers, *choice);
    }
}

/// The positions of the bits that are set, below n.
fn bits(mask: u8, n: u8) -> Vec<u8> {
    (0..n).filter(|i| mask >> i & 1 == 1).collect()
}

/// Writes a plan of these sizes, with numbers that are repeated as often as necessary, and reads it.
fn sized([n, driven, angles, ticks_per_node, nodes, h @ ..]: &[u8; PLAN_HEAD], numbers: &[u8], choice: u8) {
    let n = n % (MOST + 1);
    let (driven, nodes) = (bits(*driven, n), u32::from(nodes % (MOST + 1)));
    let mut numbers = numbers.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).cycle();
    let mut next = || numbers.next().unwrap_or(0.5);
    let limits: Vec<[f32; 2]> = driven.iter().map(|_| [next(), next()]).collect();
    let angles: Vec<u8> = (0..n).map(|i| angles >> i & 1).collect();
    let header = PlanHeader {
        model: u32::from_le_bytes(*h),
        driven: &driven,
        angles: &angles,
        h: f32::from_le_bytes(*h),
        ticks_per_node: u32::from(*ticks_per_node),
        nodes,
        limits: &limits,
    };
    let records: Vec<f32> = (0..(nodes as usize + 1) * header.record_length()).map(|_| next()).collect();
    let file = written(&header, &records);
    match PlanFile::parse(file.bytes()) {
        Ok(plan) => {
            assert_eq!((plan.header(), plan.records()), (&header, &records[..]));
            read(&plan, choice);
        }
        Err(PlanError::OutOfRange { .. } | PlanError::NotFinite { .. } | PlanError::Limits { .. }) => {}
        Err(error) => panic!("{header:?}: {error:?}"),
    }
}

/// A plan as core writes it.
fn written(header: &PlanHeader, records: &[f32]) -> File {
    let mut memory = vec![0; 4 * records.len() + 1024];
    let bytes = plan::write(header, records, &mut memory).expect("memory for a plan");
    File::with(MAGIC, FORMAT_VERSION, &bytes[5..bytes.len() - 4])
}

/// Checks a plan that was read against the one written from its parts, and follows it.
fn read(plan: &PlanFile, choice: u8) {
    let file = written(plan.header(), plan.records());
    assert_eq!(PlanFile::parse(file.bytes()), Ok(*plan));
    match (plan.header().n(), plan.header().commands()) {
        (1, 1) => follow::<1, 1>(plan, choice),
        (2, 1) => follow::<2, 1>(plan, choice),
        (2, 2) => follow::<2, 2>(plan, choice),
        (3, 2) => follow::<3, 2>(plan, choice),
        _ => assert!(matches!(Plan::<1, 1>::new(*plan), Err(PlanError::Shape { .. }))),
    }
}

fn follow<const N: usize, const M: usize>(file: &PlanFile, choice: u8) {
    let plan = Plan::<N, M>::new(*file).expect("a plan of this size");
    let m = file.header().ticks_per_node;
    for node in 0..=file.header().nodes.min(TICKS) {
        let (found, record) = (plan.reference(node * m), file.record(node).expect("a node of the plan"));
        let gain: Vec<f32> = found.gain.iter().flat_map(|row| [row.q, row.v]).flatten().collect();
        assert_eq!((&found.q[..], &found.v[..]), (record.q, record.v));
        assert_eq!((&found.u[..], &gain[..]), (record.u, record.gain));
    }
    let mut random = Random(choice.into());
    let end = plan.ticks();
    for tick in (0..end.min(TICKS)).chain([end - 1, end, u32::MAX]) {
        let size = [1e-3, 1.0, 100.0, 1e10, 1e38, f32::INFINITY][random.below(6)];
        let mut state = || core::array::from_fn(|_| size * random.signed());
        command(&plan, tick, &state(), &state());
    }
}

fn command<const N: usize, const M: usize>(plan: &Plan<N, M>, tick: u32, q: &[f32; N], v: &[f32; N]) {
    match (plan.command(tick, q, v), plan.force(tick, q, v)) {
        (Ok(command), Ok(force)) => {
            let header = plan.file().header();
            let mut expected = [0.0; N];
            for ((coordinate, u), [least, most]) in header.driven.iter().zip(command).zip(header.limits) {
                assert!(*least <= u && u <= *most, "{least} <= {u} <= {most}");
                expected[usize::from(*coordinate)] = u;
            }
            assert_eq!(force, expected);
        }
        (Err(error), Err(_)) => assert!(!error.to_string().is_empty()),
        (command, force) => panic!("{command:?}, but {force:?}"),
    }
}
