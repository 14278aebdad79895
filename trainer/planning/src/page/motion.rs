//! The motion drawn over time: an animation, and stills laid over each other.

use super::drawing::{Places, bar, pose, svg, trace};
use super::schematic::Schematic;
use super::skeleton::Skeleton;
use super::view::View;
use crate::{Machine, Plan};
use leastaction_models::tree::Tree;
use leastaction_plot::page::{number, paragraph};
use nalgebra::Vector3;

/// Largest number of intervals between the frames of an animation.
const FRAMES: usize = 200;
/// Number of stills.
const STILLS: usize = 10;
/// Opacity of the first still; that of the last is 1.
const PALEST: f64 = 0.12;
/// Script that moves the mechanism.
const SCRIPT: &str = include_str!("motion.js");

/// A mechanism that can be drawn.
struct Drawn {
    skeleton: Skeleton,
    view: View,
    frames: Vec<Places>,
    about: String,
}

/// Animation and stills of a plan; a sentence if the mechanism cannot be drawn.
pub fn motion(plan: &Plan, machine: &Machine) -> Vec<String> {
    let Some(drawn) = Drawn::new(plan, machine) else {
        return vec![paragraph("The model does not know its geometry, so that only its curves are drawn.")];
    };
    let figures = [drawn.animation(plan.seconds()), drawn.stills(plan.seconds())].concat();
    vec![
        paragraph(&drawn.about),
        format!("<div style=\"display:flex;flex-wrap:wrap;gap:1rem\">\n{figures}</div>\n"),
        drawn.script(plan.seconds()),
    ]
}

impl Drawn {
    fn new(plan: &Plan, machine: &Machine) -> Option<Self> {
        let path = path(plan, machine.n());
        if let Some(tree) = tree(machine) {
            let mut own = Self::of_tree(tree, &path, &ranges(plan, &path));
            own.about = own.side().to_owned();
            return Some(own);
        }
        let schematic = Schematic::new(&machine.model)?;
        let ranges = ranges(plan, &path);
        let joints: Vec<_> = path.iter().map(|q| schematic.joints(q)).collect();
        let about = schematic.about();
        Some(Self { about, ..Self::of_tree(schematic.tree, &joints, &ranges) })
    }

    fn of_tree(tree: Tree, path: &[Vec<f64>], ranges: &[[f64; 2]]) -> Self {
        let skeleton = Skeleton::new(tree, ranges);
        let points: Vec<Vec<Vector3<f64>>> = path.iter().map(|q| skeleton.at(q)).collect();
        let view = View::new(&points.concat(), &skeleton.gravity());
        let frames = points.iter().map(|points| points.iter().map(|point| view.place(point)).collect());
        Self { frames: frames.collect(), view, skeleton, about: String::new() }
    }

    fn side(&self) -> &'static str {
        if self.view.from_above {
            "Joints and the lines between them, seen from above."
        } else {
            "Joints and the lines between them, from the side that shows most of the motion; gravity points down."
        }
    }

    fn animation(&self, seconds: f64) -> String {
        let traces: String = self.skeleton.tips.iter().map(|tip| trace(&self.frames, *tip)).collect();
        let inside = traces + &pose(&self.skeleton.parts, &self.frames[0]) + &bar(&self.view);
        let picture = svg(&self.view, &inside);
        let controls = format!(
            "<div id=\"controls\" hidden><button id=\"play\">Play</button> <input id=\"time\" type=\"range\" min=\"0\" \
             max=\"{seconds:.4}\" step=\"any\" value=\"0\" aria-label=\"time\"> <span id=\"clock\"></span></div>"
        );
        format!(
            "<figure id=\"motion\" style=\"margin:0\">{picture}{controls}<noscript><small>The start: scripts are off.</small></noscript>\
             </figure>\n"
        )
    }

    /// Poses at equal distances in time, the later ones darker.
    fn stills(&self, seconds: f64) -> String {
        let last = self.frames.len() - 1;
        let count = STILLS.min(last + 1);
        let share = |k: usize| k as f64 / (count - 1).max(1) as f64;
        let still = |k: usize| {
            let frame = &self.frames[(share(k) * last as f64).round() as usize];
            let opacity = PALEST + (1.0 - PALEST) * share(k).powi(2);
            format!("<g opacity=\"{opacity:.2}\">{}</g>", pose(&self.skeleton.parts, frame))
        };
        let stills: String = (0..count).map(still).collect();
        let picture = svg(&self.view, &(stills + &bar(&self.view)));
        let apart = number(seconds / (count - 1).max(1) as f64);
        format!(
            "<figure style=\"margin:0\">{picture}<small>{count} stills, {apart} s apart; the later, the darker.</small></figure>\n"
        )
    }

    /// Frames as numbers, and the script that shows them.
    fn script(&self, seconds: f64) -> String {
        let frame = |places: &Places| {
            let numbers: Vec<_> = places.iter().flatten().map(|x| format!("{x:.1}")).collect();
            format!("[{}]", numbers.join(","))
        };
        let frames: Vec<_> = self.frames.iter().map(frame).collect();
        let data = format!("{{\"seconds\":{seconds:.4},\"frames\":[{}]}}", frames.join(",\n"));
        format!(
            "<script type=\"application/json\" id=\"frames\">{data}</script>\n<script>\n{SCRIPT}</script>\n"
        )
    }
}

/// Tree of a model that knows its geometry.
fn tree(machine: &Machine) -> Option<Tree> {
    let (family, weights) = (&machine.model.architecture.family, &machine.model.weights);
    let arm = family.arm().and_then(|arm| arm.host_tree(weights));
    arm.or_else(|| family.bodies()?.host_tree(weights))
}

/// Positions at equal distances in time, between nodes on straight lines.
fn path(plan: &Plan, n: usize) -> Vec<Vec<f64>> {
    let states: Vec<&[f64]> = plan.nodes.iter().chain([&plan.end]).map(|node| &node.x[..n]).collect();
    let last = states.len() - 1;
    let count = last.min(FRAMES);
    let at = |k: usize| {
        let place = k as f64 * last as f64 / count.max(1) as f64;
        let (before, part) = (place.floor() as usize, place.fract());
        let after = states[(before + 1).min(last)];
        states[before].iter().zip(after).map(|(a, b)| a + part * (b - a)).collect()
    };
    (0..=count).map(at).collect()
}

/// Ranges in which the coordinates move: their limits, or else 0 and a little more than the motion.
fn ranges(plan: &Plan, path: &[Vec<f64>]) -> Vec<[f64; 2]> {
    let range = |(i, limits): (usize, &[f64; 2])| {
        let along = || path.iter().map(|q| q[i]);
        let (least, most) =
            (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
        let beyond = 0.1 * (most - least).max(0.5);
        let moved = [(least - beyond).min(0.0), (most + beyond).max(0.0)];
        if limits.iter().all(|x| x.is_finite()) { *limits } else { moved }
    };
    plan.task.limits.x.iter().take(path.first().map_or(0, Vec::len)).enumerate().map(range).collect()
}
