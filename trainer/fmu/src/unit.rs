use crate::{FmuError, RESOURCE};
use leastaction_core::discrete::Order;
use leastaction_core::lagrangian::Energies;
use leastaction_core::model::fingerprint;
use leastaction_replica::{Control, ModelFile, Motion, Replica, ReplicaError, Step, SystemOf, Visitor};
use std::path::Path;

self_cell::self_cell!(
    /// A model with the file from which it borrows.
    struct OnChip {
        owner: ModelFile,
        #[covariant]
        dependent: Replica,
    }
);

/// The model of a unit, which never changes.
pub struct Unit {
    model: OnChip,
    fingerprint: u32,
    n: usize,
}

impl Unit {
    /// Step of a model that was trained without one, unless the parameter `h` says otherwise, s.
    pub const DEFAULT_H: f64 = 1e-3;

    /// Order of the steps of a model that was trained without one.
    const DEFAULT_ORDER: Order = Order::Four;

    /// Reads a model file; of several trees it takes the first.
    ///
    /// # Errors
    /// [`FmuError::Model`] for a damaged file, [`FmuError::Core`] for one that core is not compiled for, [`FmuError::OfGraph`].
    pub fn new(bytes: &[u8]) -> Result<Self, FmuError> {
        let fingerprint = fingerprint(bytes).map_err(FmuError::Model)?;
        let model = OnChip::try_new(ModelFile::new(bytes)?, |file| file.replica(None))?;
        if model.borrow_dependent().visit(IsGraph) {
            return Err(FmuError::OfGraph);
        }
        let n = model.borrow_dependent().n();
        Ok(Self { model, fingerprint, n })
    }

    /// Reads the model file in a folder of resources.
    ///
    /// # Errors
    /// [`FmuError::Resource`] if there is none, and see [`Unit::new`].
    pub fn read(resources: &Path) -> Result<Self, FmuError> {
        let file = resources.join(RESOURCE);
        match std::fs::read(&file) {
            Ok(bytes) => Self::new(&bytes),
            Err(error) => Err(FmuError::Resource { file, error }),
        }
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Checksum of the model file.
    pub fn fingerprint(&self) -> u32 {
        self.fingerprint
    }

    /// Text by which description and model file recognise each other.
    pub fn token(&self) -> String {
        format!("{{leastaction-{:08x}-{}}}", self.fingerprint, self.n)
    }

    /// Step of the model: the shortest decimal number that means its step in single precision; `None` if it was trained without one.
    pub fn h(&self) -> Option<f64> {
        self.replica().trained_step().and_then(|step| step.h.to_string().parse().ok())
    }

    /// Order of the steps.
    pub fn order(&self) -> Order {
        self.replica().trained_step().map_or(Self::DEFAULT_ORDER, |step| step.order)
    }

    /// Energies T(q, v) and V(q), J.
    pub(crate) fn energies(&self, q: &[f64], v: &[f64]) -> Result<Energies<f32>, FmuError> {
        Ok(self.replica().evaluator()?.energies(&single("q", q)?, &single("v", v)?)?)
    }

    /// Accelerations v̇(q, v, u), m/s² or rad/s².
    pub(crate) fn acceleration(&self, q: &[f64], v: &[f64], u: &[f64]) -> Result<Vec<f64>, FmuError> {
        let mut a = vec![0.0; self.n];
        let (q, v, u) = (single("q", q)?, single("v", v)?, single("u", u)?);
        self.replica().evaluator()?.acceleration(&q, &v, &u, &mut a)?;
        Ok(double(&a))
    }

    /// Begins a motion.
    pub(crate) fn begin(&self, h: f64, q: &[f64], v: &[f64]) -> Result<Moved, FmuError> {
        let motion = self.replica().motion_at(self.step(h), &single("q", q)?, &single("v", v)?)?;
        Ok(self.moved(&*motion)?)
    }

    /// Advances a motion by steps under a constant force; also returns the number of steps taken before an error.
    pub(crate) fn advance(
        &self,
        (h, saved): (f64, &[f32]),
        u: &[f64],
        steps: u64,
    ) -> Result<Moved, (u64, FmuError)> {
        let failed = |taken: u64| move |error: ReplicaError| (taken, FmuError::from(error));
        let u = single("u", u).map_err(|error| (0, error))?;
        let mut motion = self.replica().motion_resumed(self.step(h), saved).map_err(failed(0))?;
        for taken in 0..steps {
            motion.step(Control::held(&u)).map_err(failed(taken))?;
        }
        self.moved(&*motion).map_err(failed(steps))
    }

    fn moved(&self, motion: &dyn Motion) -> Result<Moved, ReplicaError> {
        let mut v = vec![0.0; self.n];
        motion.velocity(&mut v)?;
        Ok(Moved { q: double(motion.q()), v: double(&v), saved: motion.saved() })
    }

    fn step(&self, h: f64) -> Step {
        Step { order: self.order(), h: h as f32 }
    }

    fn replica(&self) -> &Replica<'_> {
        self.model.borrow_dependent()
    }
}

/// A motion between steps.
pub(crate) struct Moved {
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    /// Numbers from which the motion continues.
    pub saved: Vec<f32>,
}

/// Rounds numbers to single precision.
fn single(what: &str, numbers: &[f64]) -> Result<Vec<f32>, FmuError> {
    let rounded = numbers.iter().enumerate().map(|(i, value)| {
        let not_finite = || FmuError::NotFinite { what: format!("{what}[{}]", i + 1), value: *value };
        Some(*value as f32).filter(|rounded| rounded.is_finite()).ok_or_else(not_finite)
    });
    rounded.collect()
}

fn double(numbers: &[f32]) -> Vec<f64> {
    numbers.iter().copied().map(f64::from).collect()
}

/// Visitor that recognises graphs.
struct IsGraph;

impl Visitor<'_> for IsGraph {
    type Output = bool;

    fn coordinates<const N: usize>(self, _: &SystemOf<N>) -> bool {
        false
    }

    fn particles<const D: usize>(self, _: &leastaction_replica::ParticleSystem<D>) -> bool {
        true
    }
}
