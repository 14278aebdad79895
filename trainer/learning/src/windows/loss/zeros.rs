//! Zero offsets of sensors, of which every log has its own.

use super::WindowLoss;
use crate::windows::logs::Window;
use std::ops::Range;

/// Zero offset of a coordinate's sensor in one log, among windows side by side.
pub(super) struct Zero {
    /// Position among the shared numbers.
    pub position: usize,
    pub coordinate: usize,
    /// Windows of the log.
    pub windows: Range<usize>,
}

impl WindowLoss {
    /// The learned zeros of the logs of these windows.
    pub(super) fn zeros_of(&self, windows: &[Window]) -> Vec<Zero> {
        let mut first = 0;
        let of_log = |part: &[Window]| {
            let windows = first..first + part.len();
            first = windows.end;
            let zero = |coordinate: usize| Zero {
                position: self.layout.zero(part[0].log, coordinate),
                coordinate,
                windows: windows.clone(),
            };
            (0..self.n()).map(zero).collect::<Vec<_>>()
        };
        let all = windows.chunk_by(|a, b| a.log == b.log).flat_map(of_log);
        all.filter(|zero| !self.fixed.contains(&zero.position)).collect()
    }
}
