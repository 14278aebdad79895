use leastaction_firmware_sim::control::NODES;

/// State of the run after a tick, in numbers that the page reads in this order (page.js has the same list); the second coordinate is 0 where
/// there is none.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Number of coordinates.
    pub coordinates: f32,
    /// The tick, s.
    pub tick: f32,
    /// Largest commands of the drives, N or N m.
    pub limit: [f32; 2],
    /// Due time of the last tick, s; the numbers below are of that time.
    pub time: f32,
    /// True position, rad or m.
    pub q: [f32; 2],
    /// True velocity, rad/s or m/s.
    pub v: [f32; 2],
    /// Estimated position.
    pub q_estimate: [f32; 2],
    /// Estimated velocity.
    pub v_estimate: [f32; 2],
    /// Command of the firmware, N or N m.
    pub command: [f32; 2],
    /// Force that acts, N or N m.
    pub applied: [f32; 2],
    /// Number of [`Mode`](leastaction_firmware_sim::Mode).
    pub mode: f32,
    /// T and V of the model at the true state, J.
    pub model_energy: [f32; 2],
    /// T and V of the exact mechanism, J.
    pub plant_energy: [f32; 2],
    /// Number of decisions.
    pub decisions: f32,
    /// Time that the firmware took in the last tick, ms.
    pub milliseconds: f32,
    /// Number of nodes of the decided motion.
    pub nodes: f32,
    /// The decided motion, which the model predicts: positions, and their times after `time`, s.
    pub motion: [[f32; 3]; NODES],
}

impl View {
    /// Numbers before a run.
    pub const fn new() -> Self {
        let pair = [0.0; 2];
        Self {
            coordinates: 0.0,
            tick: 0.0,
            limit: pair,
            time: 0.0,
            q: pair,
            v: pair,
            q_estimate: pair,
            v_estimate: pair,
            command: pair,
            applied: pair,
            mode: 0.0,
            model_energy: pair,
            plant_energy: pair,
            decisions: 0.0,
            milliseconds: 0.0,
            nodes: 0.0,
            motion: [[0.0; 3]; NODES],
        }
    }
}

/// The first two numbers of an array; 0 where there are fewer.
pub fn pair<const N: usize>(x: &[f32; N]) -> [f32; 2] {
    core::array::from_fn(|i| x.get(i).copied().unwrap_or(0.0))
}
