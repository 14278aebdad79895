#[cfg(feature = "rods")]
use crate::config::LEASTACTION_DIMENSIONS;
use crate::status::Status;
use core::ffi::c_char;
#[cfg(feature = "adapt")]
use leastaction_core::adapt::{PatchError, SettingsError, Unfit};
#[cfg(feature = "rods")]
use leastaction_core::constraints::ConstraintError;
use leastaction_core::discrete::StepError;
use leastaction_core::energy::graph::GraphError;
use leastaction_core::linear::SolveError;
use leastaction_core::model::{Coded, ModelError};
use leastaction_core::plan::{CommandError, PlanError};

/// Reason why a call failed, with numbers. Every function that can fail fills one in, unless its last argument is NULL; after success the
/// status is LEASTACTION_STATUS_OK and all else is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Error {
    /// Status that the function returned.
    pub status: Status,
    /// Numbers that the status defines; all others are 0. Numbers beyond 32 bits are cut to UINT32_MAX.
    pub numbers: [u32; 3],
    /// Relative residual, if the status defines it; else 0.
    pub residual: f32,
    /// Subject of the error, in words, if the status defines it; else NULL. Not ended by a zero: print it with "%.*s".
    pub what: *const c_char,
    /// Length of `what`, bytes.
    pub what_bytes: usize,
}

impl Error {
    pub(crate) const NONE: Self = Self::of(Status::Ok, [0; 3]);

    /// Creates an error with all its numbers, the unused ones 0.
    pub(crate) const fn of(status: Status, numbers: [u32; 3]) -> Self {
        Self { status, numbers, residual: 0.0, what: core::ptr::null(), what_bytes: 0 }
    }

    pub(crate) fn new<const K: usize>(status: Status, numbers: [usize; K]) -> Self {
        let mut all = [0; 3];
        for (slot, number) in all.iter_mut().zip(numbers) {
            *slot = u32::try_from(number).unwrap_or(u32::MAX);
        }
        Self::of(status, all)
    }

    fn about(self, what: &'static str) -> Self {
        Self { what: what.as_ptr().cast(), what_bytes: what.len(), ..self }
    }
}

impl From<Status> for Error {
    fn from(status: Status) -> Self {
        Self::of(status, [0; 3])
    }
}

impl From<Coded> for Error {
    fn from(Coded { code, numbers, what }: Coded) -> Self {
        let error = Self::new(Status::of_file(code), numbers);
        what.map_or(error, |what| error.about(what))
    }
}

impl From<ModelError> for Error {
    fn from(error: ModelError) -> Self {
        error.coded().into()
    }
}

impl From<GraphError> for Error {
    fn from(error: GraphError) -> Self {
        error.coded().into()
    }
}

impl From<PlanError> for Error {
    fn from(error: PlanError) -> Self {
        error.coded().into()
    }
}

#[cfg(feature = "adapt")]
impl From<Unfit> for Error {
    fn from(error: Unfit) -> Self {
        error.coded().into()
    }
}

#[cfg(feature = "adapt")]
impl From<SettingsError> for Error {
    fn from(error: SettingsError) -> Self {
        error.coded().into()
    }
}

#[cfg(feature = "adapt")]
impl From<PatchError> for Error {
    fn from(error: PatchError) -> Self {
        error.coded().into()
    }
}

impl From<CommandError> for Error {
    fn from(error: CommandError) -> Self {
        match error {
            CommandError::NotFinite { .. } => Status::NotFinite.into(),
            CommandError::Overflow { coordinate } => Self::new(Status::TooFarFromPlan, [coordinate.into()]),
        }
    }
}

impl From<SolveError> for Error {
    fn from(error: SolveError) -> Self {
        StepError::from(error).into()
    }
}

impl From<StepError<f32>> for Error {
    fn from(error: StepError<f32>) -> Self {
        match error {
            StepError::Singular { column } => Self::new(Status::Singular, [column.into()]),
            StepError::NotFinite => Status::NotFinite.into(),
            StepError::NotConverged(report) => Self {
                residual: report.residual,
                ..Self::new(Status::NotConverged, [report.iterations.into()])
            },
        }
    }
}

#[cfg(feature = "rods")]
impl From<ConstraintError<f32>> for Error {
    fn from(error: ConstraintError<f32>) -> Self {
        match error {
            ConstraintError::Redundant { constraint } => Self::new(Status::RodRedundant, [constraint]),
            ConstraintError::Off { constraint, residual } => {
                Self { residual, ..Self::new(Status::RodViolated, [constraint]) }
            }
            ConstraintError::Mass { node } => Self::new(Status::Singular, [node * LEASTACTION_DIMENSIONS]),
            ConstraintError::NotFinite => Status::NotFinite.into(),
            ConstraintError::NotConverged(report) => StepError::NotConverged(report).into(),
            // None of these can occur with a loaded graph, which has no friction that sticks, and workspaces of the right size.
            ConstraintError::Node { .. }
            | ConstraintError::Length { .. }
            | ConstraintError::Shape { .. }
            | ConstraintError::Workspace { .. }
            | ConstraintError::Grip { .. }
            | ConstraintError::Width { .. }
            | ConstraintError::Backward { .. } => Status::OtherGraphError.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_core::discrete::Report;
    use leastaction_core::energy::modular::TreeError;

    #[test]
    fn every_error_of_a_file_has_its_status_and_numbers() {
        let table = [
            (ModelError::TooShort { bytes: 3 }, Status::TooShort, [3, 0, 0]),
            (ModelError::Magic, Status::NotAModel, [0; 3]),
            (ModelError::Version { found: 9 }, Status::Version, [9, 0, 0]),
            (ModelError::Checksum { stored: 1, computed: u32::MAX }, Status::Checksum, [1, u32::MAX, 0]),
            (ModelError::Malformed, Status::Malformed, [0; 3]),
            (ModelError::TrailingBytes { bytes: 4 }, Status::TrailingBytes, [4, 0, 0]),
            (ModelError::Unaligned { offset: 3 }, Status::Unaligned, [3, 0, 0]),
            (ModelError::BigEndian, Status::BigEndian, [0; 3]),
            (ModelError::WeightCount { found: 5, needed: 6 }, Status::WeightCount, [5, 6, 0]),
            (ModelError::NotFinite { index: usize::MAX }, Status::WeightNotFinite, [u32::MAX, 0, 0]),
            (ModelError::OutOfRange { what: "order" }, Status::OutOfRange, [0; 3]),
            (ModelError::Names { of: "trees" }, Status::Names, [0; 3]),
            (ModelError::NoSuchTree { trees: 2 }, Status::NoSuchTree, [2, 0, 0]),
            (ModelError::NoSuchGraph { graphs: 2 }, Status::NoSuchGraph, [2, 0, 0]),
            (ModelError::OtherFamily { found: "graph" }, Status::OtherFamily, [0; 3]),
            (ModelError::Shape { what: "types", found: 3, compiled: 2 }, Status::Shape, [3, 2, 0]),
            (ModelError::Section { number: 9 }, Status::Section, [9, 0, 0]),
            (ModelError::Law { number: 7 }, Status::Law, [7, 0, 0]),
            (ModelError::NoStep, Status::NoStep, [0; 3]),
            (ModelError::Order { found: 4, compiled: 2 }, Status::Order, [4, 2, 0]),
            (ModelError::Tree(TreeError::Parent { element: 1, parent: 2 }), Status::TreeParent, [1, 2, 0]),
            (ModelError::Graph(GraphError::Loop { edge: 4, node: 1 }), Status::GraphLoop, [4, 1, 0]),
        ];
        for (error, status, numbers) in table {
            let found = Error::from(error);
            assert_eq!((found.status, found.numbers), (status, numbers), "{error}");
        }
    }

    #[test]
    fn errors_of_plans_have_their_statuses_and_numbers() {
        let other = Error::from(PlanError::OtherModel { planned: 7, given: u32::MAX });
        assert_eq!((other.status, other.numbers), (Status::PlanOtherModel, [7, u32::MAX, 0]));
        let limits = Error::from(PlanError::Limits { coordinate: 2, least: 2.0, most: 1.0 });
        let bits = [2, 2.0_f32.to_bits(), 1.0_f32.to_bits()];
        assert_eq!((limits.status, limits.numbers), (Status::PlanLimits, bits));
        assert!(!Error::from(PlanError::OutOfRange { what: "tick h" }).what.is_null());
        let far = Error::from(CommandError::Overflow { coordinate: 3 });
        assert_eq!((far.status, far.numbers), (Status::TooFarFromPlan, [3, 0, 0]));
    }

    #[test]
    fn words_are_those_of_the_error() {
        let error = Error::from(ModelError::OtherFamily { found: "graph" });
        // SAFETY: the string has `what_bytes` bytes and lives for ever.
        let words = unsafe { core::slice::from_raw_parts(error.what.cast::<u8>(), error.what_bytes) };
        assert_eq!(words, b"graph");
        assert!(Error::from(ModelError::Magic).what.is_null());
    }

    #[test]
    fn every_error_of_a_step_has_its_status_and_numbers() {
        let slow = Error::from(StepError::NotConverged(Report { iterations: 8, residual: 0.5 }));
        assert_eq!((slow.status, slow.numbers, slow.residual), (Status::NotConverged, [8, 0, 0], 0.5));
        let singular = Error::from(StepError::Singular { column: 1 });
        assert_eq!((singular.status, singular.numbers), (Status::Singular, [1, 0, 0]));
        assert_eq!(Error::from(StepError::NotFinite), Error::from(Status::NotFinite));
    }

    #[cfg(feature = "rods")]
    #[test]
    fn every_error_of_rods_has_its_status_and_numbers() {
        let report = Report { iterations: 8, residual: 0.5 };
        let column = 3 * LEASTACTION_DIMENSIONS as u32;
        let table = [
            (ConstraintError::Redundant { constraint: 1 }, Status::RodRedundant, [1, 0, 0], 0.0),
            (ConstraintError::Off { constraint: 2, residual: 0.25 }, Status::RodViolated, [2, 0, 0], 0.25),
            (ConstraintError::Mass { node: 3 }, Status::Singular, [column, 0, 0], 0.0),
            (ConstraintError::NotFinite, Status::NotFinite, [0; 3], 0.0),
            (ConstraintError::NotConverged(report), Status::NotConverged, [8, 0, 0], 0.5),
        ];
        for (error, status, numbers, residual) in table {
            let found = Error::from(error);
            assert_eq!((found.status, found.numbers, found.residual), (status, numbers, residual), "{error}");
        }
    }
}
