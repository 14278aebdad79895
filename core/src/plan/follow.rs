use super::{CommandError, PlanError, PlanFile, Reference};
use crate::expected::expected;
use crate::scalar::Real;

/// Bound of the rounding of a time that is a product of ticks and h, relative to it.
const ROUNDING: f32 = 4.0 * f32::EPSILON;

/// A plan for a mechanism with `N` coordinates of which `M` are driven, and the law that follows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan<'a, const N: usize, const M: usize> {
    file: PlanFile<'a>,
}

impl<'a, const N: usize, const M: usize> Plan<'a, N, M> {
    /// Reads and validates a plan for the model with this [fingerprint](crate::model::fingerprint).
    ///
    /// `bytes` must be 4-aligned and is borrowed, not copied.
    ///
    /// # Errors
    /// See [`PlanError`].
    pub fn load(bytes: &'a [u8], fingerprint: u32) -> Result<Self, PlanError> {
        let file = PlanFile::parse(bytes)?;
        file.check_model(fingerprint)?;
        Self::new(file)
    }

    /// Creates the plan of a file, for any model.
    ///
    /// # Errors
    /// [`PlanError::Shape`] unless it has `N` coordinates, `M` of them driven.
    pub fn new(file: PlanFile<'a>) -> Result<Self, PlanError> {
        same("coordinates", file.header().n(), N)?;
        same("driven coordinates", file.header().commands(), M)?;
        Ok(Self { file })
    }

    /// Creates the plan of a file in which at most `M` coordinates are driven, for any model: commands and gains beyond those are 0.
    ///
    /// # Errors
    /// [`PlanError::Shape`] unless it has `N` coordinates, and if more than `M` of them are driven.
    pub fn at_most(file: PlanFile<'a>) -> Result<Self, PlanError> {
        same("coordinates", file.header().n(), N)?;
        same("driven coordinates", file.header().commands().max(M), M)?;
        Ok(Self { file })
    }

    /// The file of the plan.
    pub const fn file(&self) -> &PlanFile<'a> {
        &self.file
    }

    /// Length of the motion in ticks; from this tick on the plan is its goal.
    pub const fn ticks(&self) -> u32 {
        self.file.header().ticks()
    }

    /// Length of the motion, s.
    pub const fn seconds(&self) -> f32 {
        self.file.header().seconds()
    }

    /// The plan at a tick, from 0. A node begins with its record; within the node the motion is the cubic polynomial through its ends,
    /// the command is held and the gain is linear. From the end on the plan is its last record.
    pub fn reference(&self, tick: u32) -> Reference<N, M> {
        let header = self.file.header();
        if tick >= self.ticks() {
            return self.record(header.nodes);
        }
        let m = header.ticks_per_node;
        let (node, within) = expected(tick.checked_div(m).zip(tick.checked_rem(m)), (0, 0));
        self.between(node, within as f32 / m as f32)
    }

    /// The plan at the time t after the start, s: [`Plan::reference`] for a loop whose ticks are not the plan's. Before the start it is the
    /// first record. A time that is short of a node by no more than the rounding of a product of ticks and h counts as that node.
    pub fn reference_at(&self, t: f32) -> Reference<N, M> {
        let (x, nodes) = (t / self.node_seconds(), self.file.header().nodes);
        let node = (x + ROUNDING * x) as u32;
        if node >= nodes { self.record(nodes) } else { self.between(node, (x - node as f32).max(0.0)) }
    }

    /// The plan at the fraction s of a node.
    fn between(&self, node: u32, s: f32) -> Reference<N, M> {
        let start = self.record(node);
        if s == 0.0 {
            return start;
        }
        start.towards(&self.record(node.saturating_add(1)), s, self.node_seconds())
    }

    /// Duration of a node, s.
    const fn node_seconds(&self) -> f32 {
        let header = self.file.header();
        header.ticks_per_node as f32 * header.h
    }

    /// Planned position, velocity and acceleration at the time t after the start, s, on ticks and between them. Before the start and from the
    /// end on they are those of the first and of the last record, without acceleration.
    pub fn motion(&self, t: f32) -> [[f32; N]; 3] {
        let header = self.file.header();
        let node_seconds = self.node_seconds();
        let x = t / node_seconds;
        let node = x as u32;
        let start = self.record(node.min(header.nodes));
        if !(x > 0.0 && node < header.nodes) {
            return [start.q, start.v, [0.0; N]];
        }
        start.motion(&self.record(node.saturating_add(1)), x - node as f32, node_seconds)
    }

    fn record(&self, node: u32) -> Reference<N, M> {
        let record = self.file.record(node).and_then(|record| Reference::read(&record));
        expected(record, Reference::ZERO)
    }

    /// Command of every driven coordinate at a tick and a measured state, N or N m: u = ū − K (x − x̄), x = (q, v), within its limits.
    ///
    /// # Errors
    /// [`CommandError`] for a state that is not finite, or too far from the plan.
    pub fn command(&self, tick: u32, q: &[f32; N], v: &[f32; N]) -> Result<[f32; M], CommandError> {
        self.feedback(self.reference(tick), q, v)
    }

    /// [`Plan::command`] about the plan at some time.
    fn feedback(
        &self,
        reference: Reference<N, M>,
        q: &[f32; N],
        v: &[f32; N],
    ) -> Result<[f32; M], CommandError> {
        check_finite('q', q)?;
        check_finite('v', v)?;
        let Reference { q: q_bar, v: v_bar, mut u, gain } = reference;
        let (q, v) = (self.position_difference(q, q_bar), difference(v, v_bar));
        let header = self.file.header();
        let ranges = header.driven.iter().zip(header.limits);
        for ((u, gain), (coordinate, [least, most])) in u.iter_mut().zip(&gain).zip(ranges) {
            *u -= gain.times(&q, &v);
            if u.is_nan() {
                return Err(CommandError::Overflow { coordinate: *coordinate });
            }
            *u = u.max(*least).min(*most);
        }
        Ok(u)
    }

    /// [`Plan::command`] spread over all coordinates: 0 for those that are not driven.
    ///
    /// # Errors
    /// See [`Plan::command`].
    pub fn force(&self, tick: u32, q: &[f32; N], v: &[f32; N]) -> Result<[f32; N], CommandError> {
        Ok(self.spread(&self.command(tick, q, v)?))
    }

    /// [`Plan::force`] about another planned command, which is ū + `added` (N or N m, one for every coordinate): where the model that the plan
    /// was made for is not the machine any more.
    ///
    /// # Errors
    /// See [`Plan::command`].
    pub fn force_with(
        &self,
        tick: u32,
        q: &[f32; N],
        v: &[f32; N],
        added: &[f32; N],
    ) -> Result<[f32; N], CommandError> {
        let mut reference = self.reference(tick);
        for (u, coordinate) in reference.u.iter_mut().zip(self.file.header().driven) {
            *u += added.get(usize::from(*coordinate)).copied().unwrap_or(0.0);
        }
        Ok(self.spread(&self.feedback(reference, q, v)?))
    }

    /// [`Plan::force`] at the time t after the start, s, about [`Plan::reference_at`].
    ///
    /// # Errors
    /// See [`Plan::command`].
    pub fn force_at(&self, t: f32, q: &[f32; N], v: &[f32; N]) -> Result<[f32; N], CommandError> {
        Ok(self.spread(&self.feedback(self.reference_at(t), q, v)?))
    }

    /// Planned command at a tick, spread over all coordinates, N or N m: that of a state on the plan.
    pub fn planned_force(&self, tick: u32) -> [f32; N] {
        self.spread(&self.reference(tick).u)
    }

    /// Commands of the driven coordinates spread over all coordinates: 0 for those that are not driven.
    pub fn spread(&self, command: &[f32; M]) -> [f32; N] {
        let mut force = [0.0; N];
        for (coordinate, u) in self.file.header().driven.iter().zip(command) {
            if let Some(force) = force.get_mut(usize::from(*coordinate)) {
                *force = *u;
            }
        }
        force
    }

    /// Whole turns, rad, by which a measured position is off the plan's start in the coordinates that `angle` marks; 0 in the others. Encoders
    /// forget whole turns, of which the plan knows the right ones: a loop subtracts those of its first measurement from every one.
    pub fn turns(&self, q: &[f32; N], angle: &[bool; N]) -> [f32; N] {
        let mut turns = difference(q, self.record(0).q);
        for (apart, angle) in turns.iter_mut().zip(angle) {
            *apart = if *angle { *apart - apart.short_way() } else { 0.0 };
        }
        turns
    }

    /// q − q̄, for angles the short way.
    fn position_difference(&self, q: &[f32; N], q_bar: [f32; N]) -> [f32; N] {
        let mut difference = difference(q, q_bar);
        for (difference, angle) in difference.iter_mut().zip(self.file.header().angles) {
            if *angle == 1 {
                *difference = difference.short_way();
            }
        }
        difference
    }
}

fn difference<const N: usize>(x: &[f32; N], mut x_bar: [f32; N]) -> [f32; N] {
    for (x_bar, x) in x_bar.iter_mut().zip(x) {
        *x_bar = x - *x_bar;
    }
    x_bar
}

fn check_finite<const N: usize>(quantity: char, x: &[f32; N]) -> Result<(), CommandError> {
    let bad = x.iter().enumerate().find(|(_, x)| !x.is_finite());
    bad.map_or(Ok(()), |(coordinate, value)| {
        Err(CommandError::NotFinite { quantity, coordinate, value: *value })
    })
}

fn same(what: &'static str, found: usize, compiled: usize) -> Result<(), PlanError> {
    if found == compiled { Ok(()) } else { Err(PlanError::Shape { what, found, compiled }) }
}
