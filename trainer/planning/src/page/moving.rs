//! A moving picture of a motion: an SVG file that needs no script, for pages that show pictures alone.

use super::drawing::{Places, bar, dressed, slope, svg, trace};
use super::scene::Scene;
use super::skeleton::Part;
use leastaction_models::Model;

/// Frames per second.
const RATE: f64 = 25.0;
/// Largest number of frames.
const MOST_FRAMES: usize = 400;
/// Time for which the end is shown before the motion begins anew, s.
const REST: f64 = 1.5;

/// A motion of a model whose coordinates take the positions of `path` (\[samples\]\[n\], m or rad), `h` seconds apart, as an SVG that moves
/// in the motion's own time, over and over; `None` if the mechanism cannot be drawn ([`Scene::new`]), or if the path is shorter than
/// two samples.
pub fn moving_picture(model: &Model, path: &[Vec<f64>], h: f64) -> Option<String> {
    let seconds = h * path.len().checked_sub(1).filter(|last| *last > 0)? as f64;
    let count = ((RATE * seconds).ceil() as usize).clamp(1, MOST_FRAMES);
    let sample = |k: usize| ((k as f64 / count as f64) * (path.len() - 1) as f64).round() as usize;
    let frames: Vec<Vec<f64>> = (0..=count).filter_map(|k| path.get(sample(k)).cloned()).collect();
    let scene = Scene::new(model, &frames, &[])?;
    let places = |q: &Vec<f64>| scene.at(q).iter().map(|point| scene.view.place(point)).collect();
    let film = Film { frames: frames.iter().map(places).collect(), seconds };
    let traces: String = scene.tips().iter().map(|tip| trace(&film.frames, *tip)).collect();
    let parts: String = scene.parts().iter().map(|part| film.part(*part)).collect();
    Some(svg(&scene.view, &(traces + &parts + &bar(&scene.view))))
}

/// Places of all points at equal distances in time.
struct Film {
    frames: Vec<Places>,
    seconds: f64,
}

impl Film {
    fn part(&self, part: Part) -> String {
        let at = |point: usize, axis: usize| move |places: &Places| places[point][axis];
        let of = |name: &str, point: usize, axis: usize| self.attribute(name, at(point, axis));
        match part {
            Part::Link(a, b) | Part::Rail(a, b) => {
                let ends = [of("x1", a, 0), of("y1", a, 1), of("x2", b, 0), of("y2", b, 1)];
                dressed(part, &self.frames[0], &ends.concat())
            }
            Part::Pivot(point) => {
                let centre = [of("cx", point, 0), of("cy", point, 1)].concat();
                dressed(part, &self.frames[0], &centre)
            }
            Part::Block(point, [a, b]) => {
                let moved = self.transform("translate", |places| {
                    format!("{:.1} {:.1}", places[point][0], places[point][1])
                });
                let turned = self.transform("rotate", |places| format!("{:.1}", slope(places[a], places[b])));
                // A turn comes after the move only if the two belong to nested elements.
                format!("<g>{moved}{}</g>", dressed(part, &vec![[0.0; 2]; self.frames[0].len()], &turned))
            }
        }
    }

    /// Course of an attribute; nothing if it stays.
    fn attribute(&self, name: &str, of: impl Fn(&Places) -> f64) -> String {
        let values: Vec<String> = self.frames.iter().map(|places| format!("{:.1}", of(places))).collect();
        if values.iter().all(|value| *value == values[0]) {
            return String::new();
        }
        format!("<animate attributeName=\"{name}\" {}/>", self.course(&values))
    }

    fn transform(&self, kind: &str, of: impl Fn(&Places) -> String) -> String {
        let values: Vec<String> = self.frames.iter().map(of).collect();
        format!("<animateTransform attributeName=\"transform\" type=\"{kind}\" {}/>", self.course(&values))
    }

    /// Values at equal distances in time, then the last one for a while.
    fn course(&self, values: &[String]) -> String {
        let whole = self.seconds + REST;
        let last = (values.len() - 1).max(1) as f64;
        let time = |k: usize| format!("{:.4}", self.seconds / whole * k as f64 / last);
        let times: Vec<String> = (0..values.len()).map(time).collect();
        let end = values.last().map_or("", String::as_str);
        format!(
            "dur=\"{whole:.2}s\" repeatCount=\"indefinite\" values=\"{};{end}\" keyTimes=\"{};1\"",
            values.join(";"),
            times.join(";")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Machine;
    use std::path::Path;

    fn model(name: &str) -> Model {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/peers/control");
        Machine::of_description(&folder.join(name)).unwrap().model
    }

    fn path(n: usize) -> Vec<Vec<f64>> {
        (0..=200).map(|k| (0..n).map(|i| (0.02 * k as f64 + i as f64).sin()).collect()).collect()
    }

    #[test]
    fn every_moving_end_has_its_course_in_the_time_of_the_motion() {
        let picture = moving_picture(&model("acrobot.urdf"), &path(2), 0.01).unwrap();
        assert!(picture.contains("dur=\"3.50s\""), "two seconds, then a rest");
        // The first link moves at one end, the second at both; one joint moves.
        assert_eq!(picture.matches("<animate attributeName=\"x1\"").count(), 1);
        assert_eq!(picture.matches("<animate attributeName=\"x2\"").count(), 2);
        let values = picture.split("values=\"").nth(1).unwrap().split('"').next().unwrap();
        assert_eq!(values.split(';').count(), 52, "51 frames, and the last once more");
        assert!(picture.len() < 20_000, "{} bytes", picture.len());
    }

    #[test]
    fn a_cart_slides_and_a_point_does_not_move() {
        let picture = moving_picture(&model("cartpole.urdf"), &path(2), 0.01).unwrap();
        assert_eq!(picture.matches("type=\"translate\"").count(), 1);
        assert_eq!(moving_picture(&model("acrobot.urdf"), &path(2)[..1], 0.01), None);
        assert_eq!(moving_picture(&model("acrobot.urdf"), &[], 0.01), None);
    }
}
