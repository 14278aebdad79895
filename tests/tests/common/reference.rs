//! Arrays computed by the papers' programs, and their comparison with ours.

use leastaction_learning::data::{ShapedArray, read_arrays};
use safetensors::tensor::{Dtype, TensorView};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Agreement in double precision, relative to the largest entry.
pub const EXACT: f64 = 1e-10;

/// Folder of a paper's reference data.
pub fn data(paper: &str) -> PathBuf {
    let folder =
        std::env::var("LEASTACTION_REFERENCE").expect("LEASTACTION_REFERENCE names the reference data");
    // An absolute path replaces what it is joined to.
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder).join(paper)
}

/// Arrays of an `.npz` file.
pub struct Arrays(BTreeMap<String, ShapedArray>);

impl Arrays {
    pub fn open(path: &Path) -> Self {
        Self(read_arrays(path).unwrap_or_else(|error| panic!("{error}")))
    }

    pub fn get(&self, key: &str) -> Vec<f64> {
        self.0.get(key).unwrap_or_else(|| panic!("{key}")).1.clone()
    }

    /// Returns the arrays under this prefix as a file of weights: importing a gradient as if it were weights puts it in the order of our
    /// weight block.
    pub fn as_weights(&self, prefix: &str) -> Vec<u8> {
        let arrays = self.0.iter().filter_map(|(name, array)| Some((name.strip_prefix(prefix)?, array)));
        let tensors: Vec<(&str, &Vec<usize>, Vec<u8>)> = arrays
            .map(|(name, (shape, numbers))| {
                (name, shape, numbers.iter().flat_map(|x| x.to_le_bytes()).collect())
            })
            .collect();
        let views = tensors.iter().map(|(name, shape, bytes)| {
            (name, TensorView::new(Dtype::F64, shape.to_vec(), bytes).expect("tensor"))
        });
        safetensors::serialize(views, None).expect("safetensors")
    }
}

/// The nearest weights in single precision.
pub fn in_single(weights: &[f64]) -> Vec<f32> {
    weights.iter().map(|w| *w as f32).collect()
}

/// The largest entry.
pub fn scale(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// The largest difference, relative to `scale`.
pub fn assert_within(what: &str, ours: &[f64], theirs: &[f64], scale: f64, bound: f64) {
    assert_eq!(ours.len(), theirs.len());
    assert!(ours.iter().all(|x| x.is_finite()), "{what}: {ours:?}");
    let difference = ours.iter().zip(theirs).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / scale;
    println!("{what}: {difference:.1e}");
    assert!(difference <= bound, "{what}: {difference:e} > {bound:e}");
}

/// Checks the largest difference, relative to the largest of their entries.
pub fn assert_close(what: &str, ours: &[f64], theirs: &[f64], bound: f64) {
    assert_within(what, ours, theirs, scale(theirs), bound);
}
