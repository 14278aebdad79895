//! The page on the course of numbers along a log.

use super::{Adapted, NumberReport, verdict};
use leastaction_adaptation::{AdaptationError, Entry, Followed, Group, Label, remaining};
use leastaction_learning::report::{force_unit, unit_of};
use leastaction_plot::NotDrawn;
use leastaction_plot::page::{cell, escaped, facts, folded, number, page, paragraph, section, table};

/// Contents of the page.
pub struct Page<'a> {
    of: &'a Adapted<'a>,
    pub(super) followed: &'a Followed,
    pub(super) labels: Vec<Label>,
    pub(super) letters: String,
    /// Balance of every window with the numbers in use, N or N m.
    pub(super) remaining: Vec<Vec<f32>>,
}

impl<'a> Page<'a> {
    /// Collects the contents; computes what the numbers in use leave unexplained.
    pub fn new(of: &'a Adapted<'a>) -> Result<Self, AdaptationError> {
        let (model, followed) = (of.of.model, &of.followed);
        let letters = model.architecture.coordinates();
        let labels = followed.choice.labels(&letters);
        let remaining = remaining(model, &followed.choice, &of.log.data, &followed.course)?;
        Ok(Self { of, followed, labels, letters, remaining })
    }

    /// Renders the page.
    pub fn html(&self) -> Result<String, NotDrawn> {
        let report = &self.of.report;
        let title = format!("{} along {}", report.model.display(), report.log.display());
        let inertias = self.of_groups("Inertias", &[Group::Inertias])?;
        let inertias =
            if inertias.is_empty() { inertias } else { folded("moments and products of inertia", &inertias) };
        let attached = [self.of_groups("Mass and moments", &[Group::Mass, Group::Moments])?, inertias];
        let weights = self.of_groups("Potential: last layer of its network", &[Group::Potential])?;
        let weights =
            if weights.is_empty() { weights } else { folded("weights of the potential's network", &weights) };
        let strengths =
            self.of_groups("Dissipation: changed strength of its columns", &[Group::Dissipation])?;
        let networks = [strengths, weights];
        let body = [
            verdict::sentences(report, &self.followed.course),
            self.facts(),
            verdict::about_charts(),
            section("What is attached", &attached),
            section("Friction", &[self.friction()?]),
            section("Networks", &networks),
            section("What the model does not explain", &self.unexplained()?),
            section("What the log shows", &[self.shown(), self.certainty()?]),
            section("Numbers at the end of the log", &[self.numbers()]),
        ];
        Ok(page(&title, &body.concat()))
    }

    pub(super) fn n(&self) -> usize {
        self.of.log.data.n
    }

    /// Unit of the force on a coordinate.
    pub(super) fn force_unit(&self, i: usize) -> &'static str {
        force_unit(unit_of(&self.letters, i))
    }

    pub(super) fn entries(&self) -> &[Entry] {
        &self.followed.course.entries
    }

    fn facts(&self) -> String {
        let Adapted { of, log, report, .. } = self.of;
        let (architecture, facts_of) = (&of.model.architecture, &of.model.facts);
        let data = &log.data;
        let uncertain = if self.of.is_measured {
            "measured on the log that it learned from"
        } else {
            "taken from this log, after the numbers have followed it"
        };
        facts(&[
            ("model", named(architecture.name(), &facts_of.provenance)),
            (
                "log",
                format!(
                    "{}: {}, {} s, a sample every {} s",
                    report.log.display(),
                    trajectories(data.trajectories.len()),
                    number(report.seconds),
                    number(data.h)
                ),
            ),
            (
                "windows",
                format!(
                    "{}, {} s long, overlapping by half; {} s are remembered",
                    self.entries().len(),
                    number(self.followed.choice.window()),
                    number(of.request.memory)
                ),
            ),
            ("uncertainty of the model", uncertain.to_owned()),
            ("program", format!("leastaction {}", env!("CARGO_PKG_VERSION"))),
        ])
    }

    /// Balance of momentum before and after.
    fn unexplained(&self) -> Result<Vec<String>, NotDrawn> {
        let about = "Forces that are missing from the balance of momentum, mean over a window. The numbers in use at the end of a window follow \
                     from those before it, so their balance is a prediction. The last column is the standard deviation that the filter assumes: \
                     errors of a model last longer than a window, so it is greater than their root mean square.";
        let head = ["coordinate", "the model of the file", "with the numbers in use", "assumed"];
        let rows: Vec<_> = (0..self.n()).map(|i| self.spread(i)).collect();
        let spread = [paragraph("Root mean squares:"), table(&head, &[0], &rows)].concat();
        Ok(vec![paragraph(about), spread, self.balance()?])
    }

    fn spread(&self, i: usize) -> Vec<String> {
        let before = rms(self.entries().iter().map(|entry| entry.residuals[i]));
        let after = rms(self.remaining.iter().map(|of| of[i]));
        let taken = self.followed.choice.settings.deviation[i];
        let name = cell(format!("q{i}"), self.force_unit(i));
        vec![name, number(before), number(after), number(taken.into())]
    }

    fn shown(&self) -> String {
        let numbers = &self.of.report.numbers;
        let found = numbers.iter().filter(|number| number.is_found()).count();
        paragraph(&format!(
            "A standard error that falls says that the motion excites the number; one that stays says that the log shows nothing of it. At \
             the end {found} of {} numbers are known to better than half of what was open before.",
            numbers.len()
        ))
    }

    fn numbers(&self) -> String {
        let about = "Distances are from the model of the file, ± a standard error; the share is that of the standard error before the log.";
        let head = ["number", "in the model", "distance", "", "in use", "share", ""];
        let rows: Vec<_> = self.of.report.numbers.iter().map(row).collect();
        [paragraph(about), table(&head, &[0, 6], &rows)].concat()
    }
}

fn row(of: &NumberReport) -> Vec<String> {
    let share = of.share().map_or_else(|| "–".to_owned(), |share| format!("{:.0}%", 100.0 * share));
    let remark = match of.share() {
        None => "stays",
        Some(_) if !of.is_found() => "hardly shown by this log",
        Some(_) => "",
    };
    vec![
        cell(escaped(&of.name), of.unit),
        number(of.model.into()),
        format!("<b>{}</b>", number(of.distance.into())),
        format!("± {}", number(of.standard_error.into())),
        number(of.used.into()),
        share,
        remark.to_owned(),
    ]
}

fn named(family: &str, provenance: &str) -> String {
    if provenance.is_empty() { family.to_owned() } else { format!("{family}; {provenance}") }
}

fn trajectories(count: usize) -> String {
    if count == 1 { "a trajectory".to_owned() } else { format!("{count} trajectories") }
}

/// Root mean square.
fn rms(of: impl Iterator<Item = f32>) -> f64 {
    let (sum, count) = of.fold((0.0, 0), |(sum, count), x| (sum + f64::from(x).powi(2), count + 1));
    (sum / f64::from(count.max(1))).sqrt()
}
