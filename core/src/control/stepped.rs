use super::{Plant, Transition};
use crate::discrete::{Control, Del, EndDerivative, Path, State, StepError};
use crate::forces::{Actuator, Forces, System};
use crate::lagrangian::{Lagrangian, Linearization};
use crate::linear::{Matrix, add_scaled_matrix, identity, product, solve_columns};
use crate::scalar::Real;

/// A mechanism under its integrator as a plant of N coordinates: x = (q, v), p = L_v(q, v), T quadratic in v; D is 2N.
///
/// A node lasts `ticks` steps, over which u is held. Control j drives coordinate `inputs[j]` with the gain of the actuator,
/// τ_i = g_i u_j + o_i; an undriven coordinate has τ_i = o_i. The actuator's delay is not part of the plant: a controller steps the state
/// through the commands already sent, and decides from there.
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
    /// Number of ticks in a node, at least 1.
    pub ticks: u16,
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

    /// Passes derivatives of (q, p) through a step.
    fn through<const C: usize>(
        [by_q, by_p]: [&EndDerivative<R, N>; 2],
        [q, p]: &Halves<R, N, C>,
    ) -> Halves<R, N, C> {
        [(&by_q.q, &by_p.q), (&by_q.p, &by_p.p)]
            .map(|(of_q, of_p)| add_scaled_matrix(&product(of_q, q), R::one(), &product(of_p, p)))
    }

    fn position_and_velocity(&self, state: &State<R, N>) -> Result<([R; N], [R; N]), StepError<R>> {
        Ok((state.q(), state.velocity(&self.system.lagrangian)?))
    }

    /// Derivatives of (q, v) from those of (q, p): δv = M⁻¹(δp − L_vq δq).
    fn of_velocity<const C: usize>(
        l: &Linearization<R, N>,
        [q, p]: &Halves<R, N, C>,
    ) -> Result<Halves<R, N, C>, StepError<R>> {
        let right = add_scaled_matrix(p, -R::one(), &product(&l.l_vq, q));
        let inverse = solve_columns(l.l_vv, &identity())?;
        Ok([*q, product(&inverse, &right)])
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

    fn begin(&self, x: &[R; D]) -> Result<State<R, N>, StepError<R>> {
        let (q, v) = halves(x);
        State::new(&self.system.lagrangian, q, v)
    }

    fn advance(&self, motion: &mut State<R, N>, u: &[R; M]) -> Result<[R; D], StepError<R>> {
        let control = self.control(u);
        for _ in 0..self.ticks {
            self.del.step(self.system, motion, &control)?;
        }
        let (q, v) = self.position_and_velocity(motion)?;
        Ok(joined(&[q, v]))
    }

    fn linearise(&self, x: &[R; D], u: &[R; M]) -> Result<Transition<R, D, M>, StepError<R>> {
        let ((q, v), control) = (halves::<R, N, D>(x), self.control(u));
        let start = self.system.lagrangian.linearization(&q, &v);
        let mut state = State::with_momentum(q, start.l_v, v)?;
        let mut a: [Halves<R, N, N>; 2] = [[identity(), start.l_vq], [[[R::zero(); N]; N], start.l_vv]];
        let mut b: Halves<R, N, M> = [[[R::zero(); M]; N]; 2];
        for _ in 0..self.ticks {
            let step = self.del.step_with_derivative(self.system, &mut state, &control)?;
            let by = [&step.by_q, &step.by_p];
            let held = step.by_held();
            a = a.map(|columns| Self::through(by, &columns));
            let [q, p] = Self::through(by, &b);
            b = [(q, &held.q), (p, &held.p)]
                .map(|(through, by_tau)| add_scaled_matrix(&through, R::one(), &self.driven(by_tau)));
        }
        let (q, v) = self.position_and_velocity(&state)?;
        let end = self.system.lagrangian.linearization(&q, &v);
        let [by_q, by_v] = [Self::of_velocity(&end, &a[0])?, Self::of_velocity(&end, &a[1])?];
        let rows = |half: usize| core::array::from_fn(|i| joined::<R, N, D>(&[by_q[half][i], by_v[half][i]]));
        Ok(Transition {
            a: joined::<[R; D], N, D>(&[rows(0), rows(1)]),
            b: joined(&Self::of_velocity(&end, &b)?),
        })
    }
}
