/// A mechanism as a function of time: systems, each from a time on, as a robot that takes up a load or whose friction grows.
///
/// A mechanism that does not change is one too: `Timeline::from(&mechanism)`.
#[derive(Debug)]
pub struct Timeline<'a, M> {
    first: &'a M,
    later: &'a [(f32, &'a M)],
}

impl<'a, M> Timeline<'a, M> {
    /// Creates a timeline that begins with `first`; each of `later` acts from its time on, s, and their times ascend.
    pub const fn new(first: &'a M, later: &'a [(f32, &'a M)]) -> Self {
        Self { first, later }
    }

    /// The mechanism at time t, s.
    pub fn at(&self, t: f32) -> &'a M {
        let begun = self.later.partition_point(|(since, _)| *since <= t);
        begun
            .checked_sub(1)
            .and_then(|last| self.later.get(last))
            .map_or(self.first, |(_, mechanism)| mechanism)
    }
}

impl<M> Clone for Timeline<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M> Copy for Timeline<'_, M> {}

impl<'a, M> From<&'a M> for Timeline<'a, M> {
    fn from(mechanism: &'a M) -> Self {
        Self::new(mechanism, &[])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_one_that_has_begun_acts() {
        let later = [(1.0, &'b'), (2.5, &'c')];
        let timeline = Timeline::new(&'a', &later);
        let acting = [0.0, 0.9, 1.0, 2.4, 2.5, 9.0].map(|t| *timeline.at(t));
        assert_eq!(acting, ['a', 'a', 'b', 'b', 'c', 'c']);
        assert_eq!(*Timeline::from(&'a').at(9.0), 'a');
    }
}
