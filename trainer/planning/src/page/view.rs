//! The side from which a motion is seen, and its scale.

use nalgebra::{Matrix2, Vector2, Vector3};

/// Largest width and height of the mechanism in a drawing, pixels.
const SIZE: [f64; 2] = [420.0, 360.0];
/// Smallest width of a drawing, pixels.
const NARROWEST: f64 = 220.0;
/// Margin around the mechanism, pixels.
const MARGIN: f64 = 28.0;
/// Spread along gravity, relative to that across the direction of sight, below which the motion is seen from above.
const FLAT: f64 = 0.25;

/// A direction of sight with a scale.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Direction that is drawn to the right, of length 1.
    pub right: Vector3<f64>,
    /// Direction that is drawn upwards, of length 1.
    pub up: Vector3<f64>,
    /// Whether the motion is seen from above.
    pub from_above: bool,
    /// Least coordinates to the right and upwards, m.
    least: [f64; 2],
    /// Pixels per metre.
    pub scale: f64,
    /// Width and height of the drawing, pixels.
    pub size: [f64; 2],
}

impl View {
    /// View of points that shows the largest part of their spread, with gravity pointing down if it is not seen from above.
    pub fn new(points: &[Vector3<f64>], gravity: &Vector3<f64>) -> Self {
        let vertical = -gravity.try_normalize(1e-9).unwrap_or(-Vector3::z());
        let level = level_axes(&vertical);
        let (right, across) = principal(points, level);
        let heights = spread(points, &vertical);
        let from_above = heights < FLAT * spread(points, &across);
        let up = if from_above { across } else { vertical };
        let (least, most) = bounds(points, [right, up]);
        let extent: [f64; 2] = std::array::from_fn(|c| (most[c] - least[c]).max(1e-6));
        let scale = (SIZE[0] / extent[0]).min(SIZE[1] / extent[1]);
        let [width, height] = extent.map(|x| x * scale + 2.0 * MARGIN);
        let widened = width.max(NARROWEST);
        let least = [least[0] - (widened - width) / (2.0 * scale), least[1]];
        Self { right, up, from_above, least, scale, size: [widened, height] }
    }

    /// Place of a point in the drawing, pixels from the upper left corner.
    pub fn place(&self, point: &Vector3<f64>) -> [f64; 2] {
        let [x, y] = [self.right.dot(point) - self.least[0], self.up.dot(point) - self.least[1]];
        [MARGIN + x * self.scale, self.size[1] - MARGIN - y * self.scale]
    }
}

/// Two level directions, the first one as near to an axis of the base as they can be.
fn level_axes(vertical: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let steepness = |axis: &Vector3<f64>| vertical.dot(axis).abs();
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let first = axes.into_iter().min_by(|a, b| steepness(a).total_cmp(&steepness(b))).unwrap_or_default();
    let first = (first - vertical * vertical.dot(&first)).normalize();
    [first, vertical.cross(&first)]
}

/// Principal axes of the points in a plane, that of the larger spread first.
fn principal(points: &[Vector3<f64>], [x, y]: [Vector3<f64>; 2]) -> (Vector3<f64>, Vector3<f64>) {
    let flat = |point: &Vector3<f64>| Vector2::new(x.dot(point), y.dot(point));
    let mean = points.iter().map(flat).sum::<Vector2<f64>>() / points.len().max(1) as f64;
    let moments =
        points.iter().map(|point| flat(point) - mean).map(|d| d * d.transpose()).sum::<Matrix2<f64>>();
    let angle = 0.5 * (2.0 * moments[(0, 1)]).atan2(moments[(0, 0)] - moments[(1, 1)]);
    let (sin, cos) = angle.sin_cos();
    (x * cos + y * sin, y * cos - x * sin)
}

/// Mean square distance of points from their mean along a direction.
fn spread(points: &[Vector3<f64>], direction: &Vector3<f64>) -> f64 {
    let along = || points.iter().map(|point| direction.dot(point));
    let count = points.len().max(1) as f64;
    let mean = along().sum::<f64>() / count;
    along().map(|x| (x - mean).powi(2)).sum::<f64>() / count
}

fn bounds(points: &[Vector3<f64>], axes: [Vector3<f64>; 2]) -> ([f64; 2], [f64; 2]) {
    let along = |axis: Vector3<f64>| points.iter().map(move |point| axis.dot(point));
    let least = axes.map(|axis| along(axis).fold(f64::INFINITY, f64::min));
    (least, axes.map(|axis| along(axis).fold(f64::NEG_INFINITY, f64::max)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on an ellipse with these half-axes.
    fn ellipse(a: Vector3<f64>, b: Vector3<f64>) -> Vec<Vector3<f64>> {
        (0..36).map(|k| (f64::from(k) * 0.1745).sin_cos()).map(|(sin, cos)| a * cos + b * sin).collect()
    }

    #[test]
    fn the_widest_side_is_seen_with_gravity_down() {
        let aslant = Vector3::new(1.0, 1.0, 0.0);
        let view = View::new(&ellipse(aslant, Vector3::z()), &(-9.81 * Vector3::z()));
        assert!(!view.from_above && (view.right.dot(&aslant) - 2_f64.sqrt()).abs() < 1e-9);
        let [top, bottom] = [1.0, -1.0].map(|z| view.place(&Vector3::new(0.0, 0.0, z))[1]);
        assert!(top < bottom);
    }

    #[test]
    fn a_level_motion_is_seen_from_above() {
        let view = View::new(&ellipse(Vector3::x(), Vector3::y() * 2.0), &(-9.81 * Vector3::z()));
        assert!(view.from_above && view.right.dot(&Vector3::y()).abs() > 0.999);
    }

    #[test]
    fn a_planar_model_is_seen_in_its_plane() {
        let view = View::new(&ellipse(Vector3::x(), Vector3::y()), &Vector3::new(0.0, -9.81, 0.0));
        assert!(!view.from_above && view.up == Vector3::y() && view.right == Vector3::x());
    }

    #[test]
    fn all_points_are_in_the_drawing() {
        for points in [
            ellipse(Vector3::x() * 3.0, Vector3::z()),
            ellipse(Vector3::x() * 0.1, Vector3::z()),
            vec![Vector3::x()],
        ] {
            let view = View::new(&points, &(-9.81 * Vector3::z()));
            for point in &points {
                let [x, y] = view.place(point);
                assert!(
                    (20.0..=view.size[0] - 20.0).contains(&x) && (20.0..=view.size[1] - 20.0).contains(&y)
                );
            }
        }
    }
}
