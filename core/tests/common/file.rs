//! Writes model files, valid and not.

use leastaction_core::energy::rigid::Inertia;
use leastaction_core::model::{
    Discretisation, Document, FORMAT_VERSION, Family, Header, MAGIC, RigidHeader, checksum,
};
use leastaction_core::network::Activation;

/// Bytes at an address that is a multiple of 16, as a linker section gives it.
#[derive(Clone)]
pub struct Aligned {
    block: Vec<u128>,
    length: usize,
}

impl Aligned {
    pub fn new(bytes: &[u8]) -> Self {
        Self::shifted(bytes, 0)
    }

    /// The same `shift` bytes further on.
    pub fn shifted(bytes: &[u8], shift: usize) -> Self {
        let padded: Vec<u8> = [&vec![0; shift], bytes].concat();
        let block = padded
            .chunks(16)
            .map(|chunk| {
                let mut word = [0; 16];
                word[..chunk.len()].copy_from_slice(chunk);
                u128::from_ne_bytes(word)
            })
            .collect();
        Self { block, length: padded.len() }
    }

    pub fn bytes(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.block)[..self.length]
    }
}

/// The cart-pole of the golden file: 3 → 7 → 5 → 4, damped.
pub const CARTPOLE: RigidHeader<'static> = RigidHeader {
    coordinates: "ta",
    widths: [7, 5, 0, 0],
    activation: Activation::Tanh,
    inertia: Inertia::Cholesky { epsilon: 1e-3 },
    damped: true,
};

pub const HEADER: Header<'static> = Header {
    family: Family::Rigid(CARTPOLE),
    discretisation: Some(Discretisation { order: 4, h: 0.05 }),
    provenance: "golden: weights are multiples of 1/64",
};

/// Weights that are exact in any text, damping last.
pub fn weights(header: &RigidHeader) -> Vec<f32> {
    let count = header.parameters().unwrap();
    let damping = if header.damped { header.n() } else { 0 };
    let mut random = super::Random(2022);
    let network = (damping..count).map(|_| (random.bits() % 129) as f32 / 64.0 - 1.0).collect::<Vec<f32>>();
    [network, vec![0.125; damping]].concat()
}

/// The file of a header and a weight block given as bytes, closed with a valid checksum.
pub fn write_raw(header: Header, padding: Option<&[u8]>, weights: &[u8]) -> Vec<u8> {
    let with = |padding| {
        let document =
            Document { magic: MAGIC, version: FORMAT_VERSION, header, padding, weights, checksum: [0; 4] };
        let mut buffer = vec![0; 1024 + weights.len()];
        postcard::to_slice(&document, &mut buffer).unwrap().to_vec()
    };
    let aligned =
        || (0..4).map(|n| with(&[0; 3][..n])).find(|file| (file.len() - 4 - weights.len()).is_multiple_of(4));
    let file = padding.map_or_else(|| aligned().unwrap(), with);
    sealed(&file[..file.len() - 4])
}

/// A file body closed with its checksum.
pub fn sealed(body: &[u8]) -> Vec<u8> {
    [body, &checksum(body).to_le_bytes()].concat()
}

pub fn write(header: Header, weights: &[f32]) -> Vec<u8> {
    write_raw(header, None, bytemuck::cast_slice(weights))
}

/// The valid file that the tests damage.
pub fn golden() -> Vec<u8> {
    write(HEADER, &weights(&CARTPOLE))
}
