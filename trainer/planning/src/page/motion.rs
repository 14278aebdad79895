//! The motion drawn over time: an animation, and stills laid over each other.

use super::drawing::{Places, bar, pose, svg, trace};
use super::scene::Scene;
use crate::{Machine, Plan};
use leastaction_plot::page::{number, paragraph};

/// Largest number of intervals between the frames of an animation.
const FRAMES: usize = 200;
/// Number of stills.
const STILLS: usize = 10;
/// Opacity of the first still; that of the last is 1.
const PALEST: f64 = 0.12;
/// Script that moves the mechanism.
const SCRIPT: &str = include_str!("motion.js");

/// A mechanism drawn at every frame.
struct Drawn {
    scene: Scene,
    frames: Vec<Places>,
}

/// Animation and stills of a plan; a sentence if the mechanism cannot be drawn.
pub fn motion(plan: &Plan, machine: &Machine) -> Vec<String> {
    let Some(drawn) = Drawn::new(plan, machine) else {
        return vec![paragraph("The model does not know its geometry, so that only its curves are drawn.")];
    };
    let figures = [drawn.animation(plan.seconds()), drawn.stills(plan.seconds())].concat();
    vec![
        paragraph(&drawn.scene.about),
        format!("<div style=\"display:flex;flex-wrap:wrap;gap:1rem\">\n{figures}</div>\n"),
        drawn.script(plan.seconds()),
    ]
}

impl Drawn {
    fn new(plan: &Plan, machine: &Machine) -> Option<Self> {
        let path = path(plan, machine.n());
        let scene = Scene::new(&machine.model, &path, &plan.task.limits.x)?;
        let places = |q: &Vec<f64>| scene.at(q).iter().map(|point| scene.view.place(point)).collect();
        Some(Self { frames: path.iter().map(places).collect(), scene })
    }

    fn animation(&self, seconds: f64) -> String {
        let traces: String = self.scene.tips().iter().map(|tip| trace(&self.frames, *tip)).collect();
        let inside = traces + &pose(self.scene.parts(), &self.frames[0]) + &bar(&self.scene.view);
        let picture = svg(&self.scene.view, &inside);
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
            format!("<g opacity=\"{opacity:.2}\">{}</g>", pose(self.scene.parts(), frame))
        };
        let stills: String = (0..count).map(still).collect();
        let picture = svg(&self.scene.view, &(stills + &bar(&self.scene.view)));
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
