//! Conversion of points to strokes: pieces without holes, no denser than the canvas.

use super::axis::Scale;

/// A point of the canvas.
pub(super) type Pixel = (i32, i32);

/// The unbroken pieces of a curve, in canvas coordinates and thinned.
pub(super) fn pieces(
    points: &[(f64, f64)],
    (x, y): (Scale, Scale),
    place: impl Fn((f64, f64)) -> Pixel,
) -> Vec<Vec<Pixel>> {
    points
        .split(|point| !(x.shows(point.0) && y.shows(point.1)))
        .filter(|piece| !piece.is_empty())
        .map(|piece| thinned(piece.iter().map(|&point| place(point))))
        .collect()
}

/// Thins points. Of neighbouring points in one column of the canvas only the first, lowest, highest and last are kept;
/// their lines cover the same pixels.
fn thinned(points: impl Iterator<Item = Pixel>) -> Vec<Pixel> {
    let mut kept = Vec::new();
    let mut column: Option<Column> = None;
    for (x, y) in points {
        match &mut column {
            Some(column) if column.x == x => column.extend(y),
            _ => {
                column.iter().for_each(|column| column.push_to(&mut kept));
                column = Some(Column { x, first: y, low: y, high: y, last: y });
            }
        }
    }
    column.iter().for_each(|column| column.push_to(&mut kept));
    kept
}

struct Column {
    x: i32,
    first: i32,
    low: i32,
    high: i32,
    last: i32,
}

impl Column {
    fn extend(&mut self, y: i32) {
        self.low = self.low.min(y);
        self.high = self.high.max(y);
        self.last = y;
    }

    fn push_to(&self, kept: &mut Vec<Pixel>) {
        let mut last = None;
        for y in [self.first, self.low, self.high, self.last] {
            if last != Some(y) {
                kept.push((self.x, y));
            }
            last = Some(y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place((x, y): (f64, f64)) -> Pixel {
        (x as i32, y as i32)
    }

    #[test]
    fn what_an_axis_cannot_show_breaks_the_curve() {
        let points = [(0.0, 1.0), (1.0, 0.0), (2.0, 3.0), (3.0, f64::NAN), (4.0, -1.0), (f64::INFINITY, 1.0)];
        let linear = pieces(&points, (Scale::Linear, Scale::Linear), place);
        assert_eq!(linear, [vec![(0, 1), (1, 0), (2, 3)], vec![(4, -1)]]);
        let logarithmic = pieces(&points, (Scale::Linear, Scale::Log), place);
        assert_eq!(logarithmic, [vec![(0, 1)], vec![(2, 3)]]);
        assert!(pieces(&[], (Scale::Log, Scale::Log), place).is_empty());
    }

    #[test]
    fn a_dense_curve_keeps_its_extremes_and_its_ends() {
        let points = (0..100_000).map(|k| (k / 1000, if k == 5500 { 900 } else { (k * 7) % 11 }));
        let kept = thinned(points);
        assert!(kept.len() <= 400, "{}", kept.len());
        assert!(kept.contains(&(5, 900)));
        assert_eq!((kept.first(), kept.last()), (Some(&(0, 0)), Some(&(99, (99_999 * 7) % 11))));
        for column in 0..100 {
            let ys: Vec<i32> = kept.iter().filter(|p| p.0 == column).map(|p| p.1).collect();
            assert_eq!((ys.iter().min(), ys.iter().max().map(|&y| y >= 10)), (Some(&0), Some(true)));
        }
    }

    #[test]
    fn a_sparse_curve_is_untouched() {
        let points = [(0, 1), (5, 2), (3, 9), (8, 8)];
        assert_eq!(thinned(points.into_iter()), points);
    }
}
