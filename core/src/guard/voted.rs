use core::fmt;

/// Three copies of a state S, each with its own copy of the constants C that a tick reads, such as a model.
///
/// A tick is computed from two copies, one after the other. If outcomes and states agree, the third copy takes over the state. If they differ,
/// the tick is computed from the third copy, which has still the state before. If it agrees with one of them, both take over its constants and
/// its state.
///
/// A tick so takes twice its time, three times after a fault, and three times its memory. Outcomes and states are compared by [`PartialEq`];
/// constants are not, so a damaged constant is found by its first effect. Each copy has an input of its own, too: a reading that is
/// damaged once is in no other. What all share is not guarded, such as weights in flash, for which there is [`Sweep`](super::Sweep).
///
/// Source: R. E. Lyons and W. Vanderkulk, "The use of triple-modular redundancy to improve computer reliability", IBM Journal of Research and
/// Development 6(2), 1962.
///
/// ```
/// use leastaction_core::guard::Voted;
///
/// // A sum of 0.5 x, with 0.5 as a constant.
/// let mut sum = Voted::new(0.5, 0.0);
/// for x in [1.0, 2.0] {
///     sum.run(&[x; 3], |gain, sum, x| *sum += gain * x)?;
/// }
/// assert_eq!(sum.state(), &1.5);
/// # Ok::<(), leastaction_core::guard::Disagreed>(())
/// ```
#[derive(Clone, Debug)]
pub struct Voted<C, S> {
    copies: [Replica<C, S>; 3],
}

#[derive(Clone, Debug)]
struct Replica<C, S> {
    constants: C,
    state: S,
}

/// Outcome on which at least two of three copies agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Agreed<O> {
    /// The outcome.
    pub outcome: O,
    /// Whether a copy was outvoted: a fault was found and repaired.
    pub outvoted: bool,
}

/// Error that no two of three copies agree: the state is lost and must be made anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Disagreed;

impl fmt::Display for Disagreed {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "no two of three copies agree: start anew")
    }
}

impl core::error::Error for Disagreed {}

impl<C: Clone, S: Clone + PartialEq> Voted<C, S> {
    /// Creates three copies of constants and state.
    pub fn new(constants: C, state: S) -> Self {
        let replica = || Replica { constants: constants.clone(), state: state.clone() };
        Self { copies: [replica(), replica(), replica()] }
    }

    /// The state.
    pub fn state(&self) -> &S {
        let [Replica { state, .. }, ..] = &self.copies;
        state
    }

    /// Computes a tick on inputs, which should be read three times, or copied from the devices as early as can be. `work` is called two or three
    /// times, and may change nothing but its state.
    ///
    /// # Errors
    /// [`Disagreed`] if no two copies agree.
    pub fn run<I, O: PartialEq>(
        &mut self,
        inputs: &[I; 3],
        mut work: impl FnMut(&C, &mut S, &I) -> O,
    ) -> Result<Agreed<O>, Disagreed> {
        let [first, second, third] = &mut self.copies;
        // Equal inputs are not one input to the compiler.
        let [i, j, k] = core::hint::black_box(inputs);
        let (one, two) = (once(&mut work, first, i), once(&mut work, second, j));
        if one == two && first.state == second.state {
            third.state.clone_from(&first.state);
            return Ok(Agreed { outcome: one, outvoted: false });
        }
        let three = once(&mut work, third, k);
        let agrees_with = |outcome: &O, state: &S| three == *outcome && third.state == *state;
        if !agrees_with(&one, &first.state) && !agrees_with(&two, &second.state) {
            return Err(Disagreed);
        }
        // The fault is in one of the two. Of the third nothing was read before, so it is whole; a damaged one of the others may even seem to equal
        // it, because values that no type allows compare as they like.
        first.clone_from(third);
        second.clone_from(third);
        Ok(Agreed { outcome: three, outvoted: true })
    }
}

/// Computes a tick from one copy. A program has its code once, whatever the number of copies.
#[inline(never)]
fn once<C, S, I, O>(work: &mut impl FnMut(&C, &mut S, &I) -> O, copy: &mut Replica<C, S>, input: &I) -> O {
    work(&copy.constants, &mut copy.state, input)
}
