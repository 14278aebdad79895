use super::Tolerance;
use super::regulator::joined;
use crate::devices::Drive;
use crate::error::{Range, SetupError, require, require_finite};
use crate::observer::OtherStep;
use crate::wire::array;
use leastaction_core::control::Cost;
use leastaction_core::linear::identity;
use leastaction_core::model::TrainedStep;
use serde::{Deserialize, Serialize};

/// Settings of decisions over a receding horizon ([`Mpc`](super::Mpc)), whose motions have [`NODES`](super::NODES) nodes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MpcSettings<const N: usize> {
    /// Goal: a posture at rest, rad or m.
    #[serde(with = "array")]
    pub goal: [f32; N],
    /// Deviations of equal cost, of positions, velocities and forces beyond those that hold the goal; costs are per second.
    pub tolerance: Tolerance<N>,
    /// Number of ticks of a node, at least 1.
    pub ticks: u16,
    /// Largest number of ticks of a step in a decision, at least 1; 1 for a model that learned its own step, unless other steps are accepted.
    pub stride: u16,
    /// Number of iterations of a decision, at least 1.
    pub iterations: u16,
    /// Maximum number of trials of an iteration's line search, at least 1.
    pub trials: u16,
    /// Number of decisions from one that proposes commands at random to the next; 0 if none does.
    pub sample_every: u16,
    /// Number of nodes of one random command, at least 1.
    pub piece: u16,
    /// Drag where no motion can be computed, as in [`Float::drag`](super::Float::drag), 1/s.
    pub drag: f32,
    /// Conversion between the commands and the forces of a plan that decisions may take; `None` without a plan.
    pub plan: Option<Drive<N>>,
}

impl<const N: usize> MpcSettings<N> {
    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        let Self { goal, tolerance, ticks, stride, iterations, trials, piece, drag, plan, .. } = self;
        require_finite("goal posture", goal)?;
        tolerance.validate()?;
        let counts = [
            ("ticks of a node", ticks),
            ("stride", stride),
            ("iterations of a decision", iterations),
            ("trials of a line search", trials),
            ("nodes of a random command", piece),
        ];
        for (what, count) in counts {
            require(what, f32::from(*count), *count >= 1, "at least 1")?;
        }
        require("drag", *drag, drag.is_finite() && *drag >= 0.0, "finite and not negative, 1/s")?;
        plan.as_ref().map_or(Ok(()), Drive::validate)
    }

    /// Checks that a model that learned its own step is stepped by it.
    pub(super) fn check_stride(
        &self,
        trained: Option<TrainedStep>,
        other: OtherStep,
    ) -> Result<(), SetupError> {
        if trained.is_none() || other == OtherStep::Accepted || self.stride == 1 {
            return Ok(());
        }
        let range = Range::Only(1.0, "the step that the model was trained for");
        Err(SetupError::OutOfRange { what: "stride", value: self.stride.into(), range })
    }

    /// Cost of a tick of `h` seconds, without that of the end; `turns` marks the angles. Controls are commands, which `drive` converts to forces.
    pub(super) fn cost<const D: usize>(&self, h: f32, turns: [bool; N], drive: &Drive<N>) -> Cost<f32, D, N> {
        let Tolerance { q, v, u } = &self.tolerance;
        let weight = |tolerance: f32| h / (tolerance * tolerance);
        Cost {
            goal: joined(&self.goal, &[0.0; N]),
            turns: joined(&turns, &[false; N]),
            x: joined(&q.map(weight), &v.map(weight)),
            u: drive.gain.map(|gain| weight(u / gain)),
            end: identity(),
        }
    }
}
