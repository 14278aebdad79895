//! Charts of numbers and residuals over time.

use super::page::Page;
use leastaction_adaptation::{Entry, Group, Label};
use leastaction_plot::page::picture;
use leastaction_plot::{NotDrawn, Panel, Series, Stroke, Vertical, stacked_svg};

/// Quantiles of the edges of a band between which it is shown in any case.
const SHOWN: f64 = 0.25;
/// Room beside the shown part of a band, as a share of it.
const ROOM: f64 = 0.25;
/// Standard errors from an estimate to the edge of its band.
const BAND: f64 = 2.0;

/// Labels of panels with their curves.
type Panels = Vec<(String, Vec<Series>)>;

/// Scale of a number in a chart: its values are offset + factor × distance.
#[derive(Clone, Copy)]
struct Scale {
    offset: f64,
    factor: f64,
}

/// A number, the labels of its estimate and of its value in use, and its scale.
type Curve = (usize, [&'static str; 2], Scale);

const DISTANCE: Scale = Scale { offset: 0.0, factor: 1.0 };

impl Page<'_> {
    /// Picture of the numbers of these groups, a panel each; empty without such numbers.
    pub(super) fn of_groups(&self, title: &str, groups: &[Group]) -> Result<String, NotDrawn> {
        let labels = self.labels.iter().enumerate().filter(|(_, label)| groups.contains(&label.group));
        let panel = |(j, label): (usize, &Label)| {
            (
                with_unit(&label.short_name(), label.unit),
                self.framed(&[(j, ["estimate", "in use"], DISTANCE)]),
            )
        };
        drawn(title, &labels.map(panel).collect(), Vertical::Linear)
    }

    /// Picture of the friction of every coordinate as a share of the model's.
    pub(super) fn friction(&self) -> Result<String, NotDrawn> {
        let panel = |i: usize| {
            let curves = self.framed(&self.friction_of(i));
            (!curves.is_empty()).then(|| (format!("q{i} (%)"), curves))
        };
        drawn("Friction, % of the model's", &(0..self.n()).filter_map(panel).collect(), Vertical::Linear)
    }

    /// Numbers of friction of a coordinate that the model has and that follow.
    fn friction_of(&self, i: usize) -> Vec<Curve> {
        let numbers = self.labels.iter().zip(&self.followed.choice.settings.numbers).enumerate();
        let of = numbers.filter_map(|(j, (label, following))| {
            let kind = match label.group {
                Group::Viscous => "viscous",
                Group::Dry => "dry",
                _ => return None,
            };
            let follows = usize::from(label.place) == i && following.prior > 0.0;
            let factor = 100.0 / f64::from(following.model);
            follows.then_some((j, [kind; 2], Scale { offset: 100.0, factor }))
        });
        of.collect()
    }

    /// Picture of the balance of every coordinate before and after.
    pub(super) fn balance(&self) -> Result<String, NotDrawn> {
        let panel = |i: usize| {
            let before = self.points(|entry| f64::from(entry.residuals[i]));
            let after =
                self.entries().iter().zip(&self.remaining).map(|(entry, of)| (entry.t, f64::from(of[i])));
            let mut curves = vec![
                Series::new("the model of the file", before),
                Series::new("with the numbers in use", after),
            ];
            curves.extend(self.marks(&curves));
            (format!("q{i} ({})", self.force_unit(i)), curves)
        };
        drawn("Balance of momentum over windows", &(0..self.n()).map(panel).collect(), Vertical::Linear)
    }

    /// Picture of the standard errors as shares of what they were before the log, a panel for each kind of number.
    pub(super) fn certainty(&self) -> Result<String, NotDrawn> {
        let kinds: [(&str, &[Group]); 6] = [
            ("mass, moments", &[Group::Mass, Group::Moments]),
            ("inertias", &[Group::Inertias]),
            ("viscous friction", &[Group::Viscous]),
            ("dry friction", &[Group::Dry]),
            ("potential", &[Group::Potential]),
            ("dissipation", &[Group::Dissipation]),
        ];
        let panel = |(kind, groups): (&str, &[Group])| {
            let curves = self.shares(groups);
            (!curves.is_empty()).then(|| (kind.to_owned(), curves))
        };
        let panels = kinds.into_iter().filter_map(panel).collect();
        drawn("Standard errors, as shares of what they were before the log", &panels, Vertical::Logarithmic)
    }

    fn shares(&self, groups: &[Group]) -> Vec<Series> {
        let numbers = self.labels.iter().zip(&self.followed.choice.settings.numbers).enumerate();
        let chosen = numbers.filter(|(_, (label, of))| groups.contains(&label.group) && of.prior > 0.0);
        let mut curves: Vec<Series> = chosen
            .map(|(j, (label, of))| {
                let share = |entry: &Entry| f64::from(entry.estimates[j].error / of.prior);
                Series::new(label.short_name(), self.points(share))
            })
            .collect();
        curves.extend(self.marks(&curves));
        curves
    }

    /// Curves of numbers within a common frame, with the marks.
    fn framed(&self, numbers: &[Curve]) -> Vec<Series> {
        let frames = numbers.iter().map(|(j, _, scale)| self.frame(*j, *scale));
        let Some(frame) = frames.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]) else { return Vec::new() };
        let mut curves: Vec<Series> =
            numbers.iter().flat_map(|of| self.curves(*of)).map(|curve| cut(curve, frame)).collect();
        curves.extend(self.marks(&curves));
        curves
    }

    /// Estimate, band and value in use of a number, with the labels of the estimate and of the value in use.
    fn curves(&self, (j, [estimate, in_use], scale): Curve) -> Vec<Series> {
        let edge = |side: f64| {
            let points = self.points(|entry| at(entry, j, scale, side));
            Series::new(estimate, points).with_stroke(Stroke::Thin)
        };
        let used = self.points(|entry| scale.offset + scale.factor * f64::from(entry.applied[j]));
        vec![
            Series::new(estimate, self.points(|entry| at(entry, j, scale, 0.0))),
            edge(-BAND),
            edge(BAND),
            Series::new(in_use, used).with_stroke(Stroke::Dashed),
        ]
    }

    /// Part of the vertical axis that is shown of a number: its values in use, its last estimate, and most of its band.
    fn frame(&self, j: usize, scale: Scale) -> [f64; 2] {
        let edges = |side: f64| {
            let mut edges: Vec<f64> = self.entries().iter().map(|entry| at(entry, j, scale, side)).collect();
            edges.sort_by(f64::total_cmp);
            edges
        };
        let quantile = |of: &[f64], part: f64| {
            of.get((part * of.len().saturating_sub(1) as f64).round() as usize).copied()
        };
        let last = self
            .entries()
            .last()
            .into_iter()
            .flat_map(|entry| [-BAND, BAND].map(|side| at(entry, j, scale, side)));
        let used =
            self.entries().iter().map(|entry| scale.offset + scale.factor * f64::from(entry.applied[j]));
        let most = [quantile(&edges(-BAND), SHOWN), quantile(&edges(BAND), 1.0 - SHOWN)];
        let all = used.chain(last).chain(most.into_iter().flatten()).chain([scale.offset]);
        let [low, high] = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
        [low - ROOM * (high - low), high + ROOM * (high - low)]
    }

    fn points(&self, of: impl Fn(&Entry) -> f64) -> Vec<(f64, f64)> {
        self.entries().iter().map(|entry| (entry.t, of(entry))).collect()
    }

    /// Vertical lines as high as these curves, at the announcement and at changes.
    fn marks(&self, curves: &[Series]) -> Vec<Series> {
        let values = curves.iter().flat_map(|curve| &curve.points).map(|(_, y)| *y).filter(|y| y.is_finite());
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], y| [a.min(y), b.max(y)]);
        let lines = |label: &str, times: Vec<f64>| {
            let points = times.into_iter().flat_map(|t| [(t, low), (t, high), (t, f64::NAN)]);
            Series::new(label, points)
        };
        let course = &self.followed.course;
        let announced: Vec<f64> = course.announced.iter().map(|(t, _)| *t).collect();
        let marks = [("announced", announced), ("changed", course.changes())];
        let drawn = marks.into_iter().filter(|(_, times)| !times.is_empty() && low < high);
        drawn.map(|(label, times)| lines(label, times)).collect()
    }
}

/// Value of a number at a window, some standard errors from its estimate.
fn at(entry: &Entry, j: usize, Scale { offset, factor }: Scale, errors: f64) -> f64 {
    let found = entry.estimates[j];
    offset + factor * (f64::from(found.estimate) + errors * f64::from(found.error))
}

/// Interrupts a curve where it is outside a frame.
fn cut(curve: Series, [low, high]: [f64; 2]) -> Series {
    let point = |(t, y): &(f64, f64)| (*t, if (low..=high).contains(y) { *y } else { f64::NAN });
    Series { points: curve.points.iter().map(point).collect(), ..curve }
}

fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") }
}

fn drawn(title: &str, panels: &Panels, vertical: Vertical) -> Result<String, NotDrawn> {
    if panels.is_empty() {
        return Ok(String::new());
    }
    let panels: Vec<_> =
        panels.iter().map(|(label, curves)| Panel::new(label, curves).with_vertical(vertical)).collect();
    Ok(picture(&stacked_svg(title, "time in the log (s)", &panels)?))
}
