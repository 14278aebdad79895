//! Problems with MATLAB files.

use thiserror::Error;

/// Problem with a `.mat` file. The message says what to do about it.
#[derive(Debug, Error)]
pub enum MatProblem {
    /// A file of MATLAB's version 7.3.
    #[error(
        "it is of version 7.3 (HDF5), which is not read; save it in MATLAB as version 7: save(\"log.mat\", \"-v7\")"
    )]
    Hdf5,
    /// A file of MATLAB's version 4.
    #[error(
        "it is of version 4, which is not read; save it in MATLAB as version 7: save(\"log.mat\", \"-v7\")"
    )]
    Version4,
    /// An unreadable file.
    #[error("not a readable .mat file: {0}; save it anew in MATLAB: save(\"log.mat\", \"-v7\")")]
    NotMat(&'static str),
    /// A file that unpacks to more than is plausible for its size.
    #[error("it unpacks to more than {most} bytes, the most that are read of a file of its size")]
    Unpacked {
        /// Limit.
        most: u64,
    },
}
