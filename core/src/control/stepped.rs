use super::{Plant, Transition};
use crate::discrete::{Control, Del, Interval, Path, State, StepDerivative, StepError};
use crate::forces::{Actuator, Forces, System};
use crate::lagrangian::{Energies, Lagrangian, Linearization};
use crate::linear::{
    Matrix, add_scaled, add_scaled_matrix, identity, multiply, product, solve_columns, transpose,
};
use crate::scalar::Real;

/// A mechanism under its integrator as a plant of N coordinates: x = (q, v), p = L_v(q, v), T quadratic in v; D is 2N.
///
/// A node of k ticks takes s = ⌈k/stride⌉ steps of hk/s each, over which u is held. Control j drives coordinate `inputs[j]` with the gain of the actuator,
/// τ_i = g_i u_j + o_i; an undriven coordinate has τ_i = o_i. The actuator's delay is not part of the plant: a controller steps the state
/// through the commands already sent, and decides from there. An [`Actuator`] has no lag.
#[derive(Clone, Copy, Debug)]
pub struct Stepped<'s, L, F, R, P, const N: usize, const M: usize> {
    /// Energies and forces.
    pub system: &'s System<L, F>,
    /// Integrator, whose step is the tick.
    pub del: Del<R, P>,
    /// Gain and offset between a command and the force.
    pub actuator: Actuator<R, N>,
    /// Coordinate that each control drives.
    pub inputs: [usize; M],
    /// Largest number of ticks that one step may cover, at least 1: more only for a system whose steps may be scaled, which a model that
    /// learned the error of its own step is not.
    pub stride: u16,
}

/// The derivative of a state, or of its controls, in the two halves (q, p) or (q, v).
type Halves<R, const N: usize, const C: usize> = [[[R; C]; N]; 2];

impl<L, F, R, P, const N: usize, const M: usize> Stepped<'_, L, F, R, P, N, M>
where
    R: Real,
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
    P: Path,
{
    /// Linearises the node that begins at rest at q, under a control that holds it there; D is 2N.
    ///
    /// The path of such a node is the point q, so that no step is taken: programs contain no code of one, and bounds of Newton's method do
    /// not matter. If the control does not hold the mechanism, the matrices are those of a mechanism that is held by what is missing.
    ///
    /// # Errors
    /// [`StepError`] if a matrix is singular or a number is not finite.
    pub fn linearise_rest<const D: usize>(
        &self,
        q: &[R; N],
        (ticks, u): (u16, &[R; M]),
    ) -> Result<Transition<R, D, M>, StepError<R>> {
        let rest = [R::zero(); N];
        let (steps, del) = self.steps(ticks);
        let step =
            Interval::<R, P, N>::new(*q, rest, del.h(), self.control(u)).end_derivative(self.system)?;
        let l = self.system.lagrangian.linearization(q, &rest);
        let mut moved = Moved::start(&l);
        for _ in 0..steps {
            moved.step(&step, |by_tau| self.driven(by_tau));
        }
        moved.end(&l)
    }

    /// Number of steps of a node, and the integrator of one.
    fn steps(&self, ticks: u16) -> (u16, Del<R, P>) {
        let steps = ticks.div_ceil(self.stride.max(1));
        if steps == ticks {
            return (steps, self.del);
        }
        let ticks_each = R::constant(f64::from(ticks)) / R::constant(f64::from(steps));
        (steps, self.del.with_step(self.del.h() * ticks_each))
    }

    /// Force over the node.
    fn control(&self, u: &[R; M]) -> Control<R, N> {
        let mut command = [R::zero(); N];
        for (input, u) in self.inputs.iter().zip(u) {
            if let Some(slot) = command.get_mut(*input) {
                *slot = *u;
            }
        }
        Control::held(self.actuator.output(&command))
    }

    /// Columns of the driven coordinates, through the gain.
    fn driven(&self, by_tau: &Matrix<R, N>) -> [[R; M]; N] {
        core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let entry = |input: usize| Some(*by_tau[i].get(input)? * *self.actuator.gain.get(input)?);
                self.inputs.get(j).and_then(|input| entry(*input)).unwrap_or_else(R::zero)
            })
        })
    }
}

/// Splits a state into q and v.
fn halves<R: Real, const N: usize, const D: usize>(x: &[R; D]) -> ([R; N], [R; N]) {
    const { assert!(D == 2 * N, "the state has N positions and N velocities") };
    (core::array::from_fn(|i| x[i]), core::array::from_fn(|i| x[N + i]))
}

/// Joins q and v.
fn joined<T: Copy, const N: usize, const D: usize>([q, v]: &[[T; N]; 2]) -> [T; D] {
    const { assert!(D == 2 * N, "the state has N positions and N velocities") };
    core::array::from_fn(|i| if i < N { q[i] } else { v[i - N] })
}

impl<L, F, R, P, const N: usize, const M: usize, const D: usize> Plant<R, D, M>
    for Stepped<'_, L, F, R, P, N, M>
where
    R: Real,
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
    P: Path,
{
    type Motion = State<R, N>;
    type Frame = Linearization<R, N>;

    fn begin(&self, x: &[R; D]) -> Result<State<R, N>, StepError<R>> {
        let (q, v) = halves(x);
        State::new(&self.system.lagrangian, q, v)
    }

    fn advance(
        &self,
        motion: &mut State<R, N>,
        (ticks, u): (u16, &[R; M]),
        course: &mut [R; D],
    ) -> Result<[R; D], StepError<R>> {
        let (control, (steps, del)) = (self.control(u), self.steps(ticks));
        for _ in 0..steps {
            del.step(self.system, motion, &control)?;
        }
        *course = joined(&[motion.last_increment(), motion.last_bubble()]);
        Ok(joined(&[motion.q(), motion.velocity(&self.system.lagrangian)?]))
    }

    fn frame(&self, x: &[R; D]) -> Linearization<R, N> {
        let (q, v) = halves(x);
        self.system.lagrangian.linearization(&q, &v)
    }

    fn linearise(
        &self,
        [(x, start), (_, end)]: [(&[R; D], &Linearization<R, N>); 2],
        (ticks, u): (u16, &[R; M]),
        course: &[R; D],
    ) -> Result<Transition<R, D, M>, StepError<R>> {
        let ((q, v), control, (steps, del)) = (halves::<R, N, D>(x), self.control(u), self.steps(ticks));
        let mut moved = Moved::start(start);
        if steps == 1 {
            let (w, s) = halves(course);
            let path = Interval::<R, P, N>::new(q, w, del.h(), control).moved(&[R::zero(); N], &s);
            moved.step(&path.end_derivative(self.system)?, |by_tau| self.driven(by_tau));
        } else {
            let mut state = State::with_momentum(q, start.l_v, v)?;
            for _ in 0..steps {
                let step = del.step_with_derivative(self.system, &mut state, &control)?;
                moved.step(&step, |by_tau| self.driven(by_tau));
            }
        }
        moved.end(end)
    }

    /// T + V, whose slope is −L_q + L_qv v in q and M v in v.
    fn energy(&self, x: &[R; D]) -> Option<(R, [R; D])> {
        let (q, v) = halves::<R, N, D>(x);
        let Energies { kinetic, potential } = self.system.energies(&q, &v);
        let Linearization { l_q, l_vq, l_vv, .. } = self.system.lagrangian.linearization(&q, &v);
        let by_q = add_scaled(&multiply(&transpose(&l_vq), &v), -R::one(), &l_q);
        let rest = [R::zero(); N];
        // A force at rest is that of a potential: friction needs motion.
        let by_q = add_scaled(&by_q, -R::one(), &self.system.forces.force(&q, &rest, &rest));
        Some((kinetic + potential, joined(&[by_q, multiply(&l_vv, &v)])))
    }
}

/// Derivatives of (q, p) with respect to the node's (q, v) and u.
struct Moved<R, const N: usize, const M: usize> {
    by_q: Halves<R, N, N>,
    by_v: Halves<R, N, N>,
    by_u: Halves<R, N, M>,
}

impl<R: Real, const N: usize, const M: usize> Moved<R, N, M> {
    /// At the start: δp = L_vq δq + M δv.
    fn start(l: &Linearization<R, N>) -> Self {
        let none = [[R::zero(); N]; N];
        Self { by_q: [identity(), l.l_vq], by_v: [none, l.l_vv], by_u: [[[R::zero(); M]; N]; 2] }
    }

    /// Passes through a step; `driven` takes the columns of the driven coordinates.
    fn step(&mut self, step: &StepDerivative<R, N>, driven: impl Fn(&Matrix<R, N>) -> [[R; M]; N]) {
        let held = step.by_held();
        self.by_q = through(step, &self.by_q);
        self.by_v = through(step, &self.by_v);
        let [q, p] = through(step, &self.by_u);
        self.by_u = [(q, &held.q), (p, &held.p)]
            .map(|(through, by_tau)| add_scaled_matrix(&through, R::one(), &driven(by_tau)));
    }

    /// At the end: δv = M⁻¹(δp − L_vq δq).
    fn end<const D: usize>(&self, l: &Linearization<R, N>) -> Result<Transition<R, D, M>, StepError<R>> {
        let inverse = solve_columns(l.l_vv, &identity())?;
        let (by_q, by_v) = (velocities(&inverse, l, &self.by_q), velocities(&inverse, l, &self.by_v));
        let rows = |half: usize| core::array::from_fn(|i| joined::<R, N, D>(&[by_q[half][i], by_v[half][i]]));
        let a = joined::<[R; D], N, D>(&[rows(0), rows(1)]);
        Ok(Transition { a, b: joined(&velocities(&inverse, l, &self.by_u)) })
    }
}

/// Passes derivatives of (q, p) through a step.
fn through<R: Real, const N: usize, const C: usize>(
    StepDerivative { by_q, by_p, .. }: &StepDerivative<R, N>,
    [q, p]: &Halves<R, N, C>,
) -> Halves<R, N, C> {
    [(&by_q.q, &by_p.q), (&by_q.p, &by_p.p)]
        .map(|(of_q, of_p)| add_scaled_matrix(&product(of_q, q), R::one(), &product(of_p, p)))
}

/// Derivatives of (q, v) from those of (q, p).
fn velocities<R: Real, const N: usize, const C: usize>(
    inverse_mass: &Matrix<R, N>,
    l: &Linearization<R, N>,
    [q, p]: &Halves<R, N, C>,
) -> Halves<R, N, C> {
    let right = add_scaled_matrix(p, -R::one(), &product(&l.l_vq, q));
    [*q, product(inverse_mass, &right)]
}
