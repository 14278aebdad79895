//! Arrays that the papers' programs computed, and how near ours come.

use ndarray::ArrayD;
use ndarray_npy::{ReadNpyExt, ReadableElement};
use safetensors::tensor::{Dtype, TensorView};
use std::fs::File;
use std::path::{Path, PathBuf};
use zip::ZipArchive;

/// Agreement in double precision, relative to the largest entry.
pub const EXACT: f64 = 1e-10;

/// The folder of a paper's reference data.
pub fn data(paper: &str) -> PathBuf {
    let folder =
        std::env::var("LEASTACTION_REFERENCE").expect("LEASTACTION_REFERENCE names the reference data");
    // An absolute path replaces what it is joined to.
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder).join(paper)
}

/// The arrays of an `.npz` file.
pub struct Arrays(ZipArchive<File>);

impl Arrays {
    pub fn open(path: &Path) -> Self {
        Self(ZipArchive::new(File::open(path).expect("arrays")).expect("npz"))
    }

    pub fn array<T: ReadableElement>(&mut self, key: &str) -> ArrayD<T> {
        let file = self.0.by_name(&format!("{key}.npy")).unwrap_or_else(|error| panic!("{key}: {error}"));
        ArrayD::read_npy(file).unwrap_or_else(|error| panic!("{key}: {error}"))
    }

    pub fn get(&mut self, key: &str) -> Vec<f64> {
        self.array(key).iter().copied().collect()
    }

    /// The arrays under this prefix as a file of weights: importing a gradient as if it were weights puts it in the order of
    /// our weight block.
    pub fn as_weights(&mut self, prefix: &str) -> Vec<u8> {
        let names: Vec<String> = self.0.file_names().map(|name| name.expect("name").into_owned()).collect();
        let names = names.iter().filter_map(|name| name.trim_end_matches(".npy").strip_prefix(prefix));
        let tensors: Vec<(&str, Vec<usize>, Vec<u8>)> = names
            .map(|name| {
                let array = self.array::<f64>(&format!("{prefix}{name}"));
                let bytes = array.iter().flat_map(|x| x.to_le_bytes()).collect();
                (name, array.shape().to_vec(), bytes)
            })
            .collect();
        let views = tensors.iter().map(|(name, shape, bytes)| {
            (name, TensorView::new(Dtype::F64, shape.clone(), bytes).expect("tensor"))
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

/// The same, relative to their largest entry.
pub fn assert_close(what: &str, ours: &[f64], theirs: &[f64], bound: f64) {
    assert_within(what, ours, theirs, scale(theirs), bound);
}
