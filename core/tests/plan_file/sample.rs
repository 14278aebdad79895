//! Plans that the tests write, whole and wrong.

use crate::common::Random;
use crate::common::file::Aligned;
use leastaction_core::plan::{self, PlanError, PlanFile, PlanHeader};

/// Fingerprint of the model of all samples.
pub const MODEL: u32 = 0x89ab_cdef;

/// Parts of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    pub driven: Vec<u8>,
    pub angles: Vec<u8>,
    pub h: f32,
    pub ticks_per_node: u32,
    pub nodes: u32,
    pub limits: Vec<[f32; 2]>,
    pub records: Vec<f32>,
}

impl Sample {
    /// The plan of the golden file: an angle, and a driven length.
    pub fn golden() -> Self {
        let exact = |i: usize| (37 * i % 129) as f32 / 64.0 - 1.0;
        Self {
            driven: vec![1],
            angles: vec![1, 0],
            h: 0.05,
            ticks_per_node: 3,
            nodes: 2,
            limits: vec![[-6.0, 5.5]],
            records: (0..27).map(exact).collect(),
        }
    }

    /// Three coordinates, of which the first and the last are driven; records in ±1.
    pub fn random(seed: u64) -> Self {
        let records = Random(seed).vector(6 * (6 + 2 + 12), 1.0);
        Self {
            driven: vec![0, 2],
            angles: vec![0, 1, 1],
            h: 0.01,
            ticks_per_node: 4,
            nodes: 5,
            limits: vec![[-100.0, 100.0]; 2],
            records: records.into_iter().map(|x| x as f32).collect(),
        }
    }

    pub fn header(&self) -> PlanHeader<'_> {
        PlanHeader {
            model: MODEL,
            driven: &self.driven,
            angles: &self.angles,
            h: self.h,
            ticks_per_node: self.ticks_per_node,
            nodes: self.nodes,
            limits: &self.limits,
        }
    }

    /// The bytes that core writes.
    pub fn bytes(&self) -> Vec<u8> {
        let mut memory = vec![0xaa; 4 * (self.records.len() + 2 * self.limits.len()) + 700];
        plan::write(&self.header(), &self.records, &mut memory).unwrap().to_vec()
    }

    /// The file in memory, as a linker would place it.
    pub fn file(&self) -> Aligned {
        Aligned::new(&self.bytes())
    }
}

/// Reason why a plan is refused.
pub fn refusal(bytes: &[u8]) -> PlanError {
    PlanFile::parse(Aligned::new(bytes).bytes()).map(|_| ()).expect_err("the plan must be refused")
}
