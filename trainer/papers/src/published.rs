//! Numbers of the papers and of their authors' programs, for comparison with ours.

/// Published numbers of a row; `None` if they are unknown or failed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Published<const K: usize> {
    /// Number of weights.
    pub parameters: Option<usize>,
    /// Measures, in an order specific to the paper.
    pub measures: [Option<f64>; K],
}

/// A row of a table of published numbers: the case, the number of weights, and the measures; [`UNKNOWN`] stands for an
/// unknown measure.
pub(crate) type Row<T, const K: usize> = (T, Option<usize>, [f64; K]);

/// Stands for an unknown number in a [`Row`].
pub(crate) const UNKNOWN: f64 = f64::NAN;

impl<const K: usize> Default for Published<K> {
    fn default() -> Self {
        Self { parameters: None, measures: [None; K] }
    }
}

impl<const K: usize> Published<K> {
    /// Finds the row of a case; if there is none, all numbers are unknown.
    pub(crate) fn find<T: PartialEq>(table: &[Row<T, K>], case: &T) -> Self {
        let known = |measure: f64| Some(measure).filter(|measure| measure.is_finite());
        let row = table.iter().find(|row| row.0 == *case);
        row.map_or(Self::default(), |(_, parameters, measures)| Self {
            parameters: *parameters,
            measures: measures.map(known),
        })
    }
}
