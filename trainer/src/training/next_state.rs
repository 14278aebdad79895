//! The loss of the next state under an explicit Runge–Kutta step (L-NODE).
//!
//! With y_k the adjoint of stage k's acceleration in a residual component, the component's derivative in θ is Σ y_k·∂v̇_k =
//! Σ ∂/∂θ [(F − d/dt L_v)·M⁻¹y_k] at the stages' states and accelerations. The adjoints need y·∂v̇ in q and v as well: the same
//! expression, differentiated forwards.

use super::Failed;
use super::loss::{Group, GroupLoss, Systems, Term, TermKind, equation, identity};
use super::samples::Samples;
use crate::architecture::{Family, FamilySystem};
use crate::dual::Dual;
use crate::runge_kutta::{RungeKutta, Stage, State};
use leastaction_core::linear::{add_scaled, dot, multiply, solve, solve_many};
use leastaction_core::scalar::{LANES, Lanes, Scalar};
use std::ops::Range;

/// The end of a step from a logged state, less the logged state there: positions, then velocities. The control at the start is
/// held during the step. Without constraints.
pub(super) struct NextStateLoss {
    /// The step, s.
    pub h: f64,
    /// How it is made.
    pub method: RungeKutta,
}

/// The steps of eight samples, as logged.
pub(crate) struct Steps<const N: usize> {
    /// (q, v).
    pub start: State<Lanes, N>,
    /// (q₊, v₊).
    pub end: State<Lanes, N>,
    /// u.
    pub control: [Lanes; N],
}

impl<const N: usize> Steps<N> {
    fn new(group: &Group<N>) -> Self {
        let state = |k: usize| side_by_side(|lane| group[lane].states[k]);
        Self {
            start: [state(0), state(1)],
            end: [state(2), side_by_side(|lane| group[lane].next_velocity)],
            control: side_by_side(|lane| group[lane].controls[0]),
        }
    }

    /// The steps of samples from `start` on; the last of `samples` fills the group up.
    pub fn from_samples(of: &Samples, start: usize, samples: &Range<usize>) -> Self {
        Self::new(&of.group(start, samples))
    }

    /// What a predicted end is off by.
    pub fn errors(&self, [q, v]: &State<Lanes, N>) -> State<Lanes, N> {
        let minus = -Lanes::one();
        [add_scaled(q, minus, &self.end[0]), add_scaled(v, minus, &self.end[1])]
    }
}

/// Row by row from lane by lane.
fn side_by_side<const N: usize>(of: impl Fn(usize) -> [f64; N]) -> [Lanes; N] {
    let rows: [[f64; N]; LANES] = std::array::from_fn(of);
    std::array::from_fn(|i| Lanes(std::array::from_fn(|lane| rows[lane][i])))
}

/// One lane of many numbers.
fn lane<const N: usize>(x: &[Lanes; N], lane: usize) -> [f64; N] {
    x.map(|x| x.0[lane])
}

/// The acceleration of a stage and how it moves with the state.
struct Tangent<const N: usize> {
    acceleration: [Lanes; N],
    /// M⁻¹, symmetric.
    compliance: [[Lanes; N]; N],
    /// For every coordinate and for every velocity ∂(F − d/dt L_v), the acceleration held.
    unbalanced: [[[Lanes; N]; N]; 2],
}

impl<const N: usize> Tangent<N> {
    fn new<F: Family<N>>(
        system: &FamilySystem<'_, F, Dual<Lanes>, N>,
        state: [&[Lanes; N]; 2],
        u: &[Lanes; N],
    ) -> Result<Self, Failed> {
        let u = u.map(Dual::fixed);
        // The same values whichever number of the state moves, and all slopes.
        let moved: [[_; N]; 2] = std::array::from_fn(|part| {
            std::array::from_fn(|i| {
                let [q, v] = moving(state, (part, i));
                equation(system, &q, &v, &u)
            })
        });
        let (mass, force) = moved[0].first().ok_or(Failed)?;
        let compliance = inverse(&mass.map(|row| row.map(Dual::value)))?;
        let acceleration = multiply(&compliance, &force.map(Dual::value));
        let unbalanced = moved.map(|moved| {
            moved.map(|(mass, force)| {
                let inertial = mass.map(|row| dot(&row.map(Dual::slope), &acceleration));
                std::array::from_fn(|i| force[i].slope() - inertial[i])
            })
        });
        Ok(Self { acceleration, compliance, unbalanced })
    }

    /// M⁻¹y, and (y·∂v̇/∂q, y·∂v̇/∂v).
    fn pull(&self, y: &[Lanes; N]) -> ([Lanes; N], State<Lanes, N>) {
        let along = multiply(&self.compliance, y);
        (along, self.unbalanced.map(|moved| moved.map(|moved| dot(&moved, &along))))
    }
}

/// (q, v) of which one number moves.
fn moving<const N: usize>(state: [&[Lanes; N]; 2], number: (usize, usize)) -> State<Dual<Lanes>, N> {
    std::array::from_fn(|part| {
        std::array::from_fn(|i| {
            let slope = if (part, i) == number { Lanes::one() } else { Lanes::zero() };
            Dual::moving(state[part][i], slope)
        })
    })
}

/// A⁻¹ of a symmetric A, in every lane.
fn inverse<const N: usize>(a: &[[Lanes; N]; N]) -> Result<[[Lanes; N]; N], Failed> {
    let mut inverse = [[Lanes::zero(); N]; N];
    for k in 0..LANES {
        let own = solve_many(a.map(|row| lane(&row, k)), identity())?;
        for (entry, own) in inverse.as_flattened_mut().iter_mut().zip(own.as_flattened()) {
            entry.0[k] = *own;
        }
    }
    Ok(inverse)
}

/// v̇ in every lane.
fn acceleration<F: Family<N>, const N: usize>(
    system: &FamilySystem<'_, F, Lanes, N>,
    [q, v]: [&[Lanes; N]; 2],
    u: &[Lanes; N],
) -> Result<[Lanes; N], Failed> {
    let (mass, force) = equation(system, q, v, u);
    let mut accelerations = [[0.0; N]; LANES];
    for (k, own) in accelerations.iter_mut().enumerate() {
        *own = solve(mass.map(|row| lane(&row, k)), lane(&force, k))?;
    }
    Ok(side_by_side(|lane| accelerations[lane]))
}

/// Sample by sample.
fn by_sample<const N: usize>([q, v]: &State<Lanes, N>) -> [State<f64, N>; LANES] {
    std::array::from_fn(|k| [lane(q, k), lane(v, k)])
}

impl<F: Family<N>, const N: usize> GroupLoss<F, N> for NextStateLoss {
    type Residual = State<f64, N>;

    fn kinds(&self) -> &'static [TermKind] {
        match self.method {
            RungeKutta::Midpoint => &[TermKind::Residual; 2],
            RungeKutta::ThreeEighths => &[TermKind::Residual; 4],
        }
    }

    fn residuals(
        &self,
        systems: &Systems<F, N>,
        group: &Group<N>,
    ) -> Result<[Self::Residual; LANES], Failed> {
        let steps = Steps::new(group);
        let stages = self.method.stages(self.h, &steps.start, |q, v| {
            acceleration::<F, N>(&systems.eight, [q, v], &steps.control)
        })?;
        Ok(by_sample(&steps.errors(&self.method.end(self.h, &steps.start, &stages))))
    }

    fn linearise_group(
        &self,
        systems: &Systems<F, N>,
        group: &Group<N>,
        terms: &mut [Vec<Term<N>>; LANES],
    ) -> Result<[Self::Residual; LANES], Failed> {
        let steps = Steps::new(group);
        let system = systems.moving()?;
        let mut tangents = Vec::new();
        let stages = self.method.stages(self.h, &steps.start, |q, v| -> Result<_, Failed> {
            let tangent = Tangent::new::<F>(&system, [q, v], &steps.control)?;
            let acceleration = tangent.acceleration;
            tangents.push(tangent);
            Ok(acceleration)
        })?;
        for component in 0..2 * N {
            let mut end_bar = [[Lanes::zero(); N]; 2];
            end_bar.as_flattened_mut()[component] = Lanes::one();
            let mut weights = vec![[Lanes::zero(); N]; stages.len()];
            self.method.adjoint(self.h, &end_bar, |k, y| {
                let (along, bars) = tangents[k].pull(y);
                weights[k] = along;
                bars
            });
            stages.iter().zip(&weights).for_each(|(stage, along)| push_terms(stage, along, terms));
        }
        Ok(by_sample(&steps.errors(&self.method.end(self.h, &steps.start, &stages))))
    }
}

/// The term of a stage, with M⁻¹y.
fn push_terms<const N: usize>(
    Stage { state: [q, v], acceleration }: &Stage<Lanes, N>,
    along: &[Lanes; N],
    terms: &mut [Vec<Term<N>>; LANES],
) {
    for (k, terms) in terms.iter_mut().enumerate() {
        let [q, v, dq, dv] = [q, v, along, acceleration].map(|x| lane(x, k));
        terms.push(Term { q, v, dq, dv });
    }
}
