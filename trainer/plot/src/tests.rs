//! Tests of the files as a viewer sees them.

use std::fs;
use std::path::Path;

use super::*;

/// A chart drawn into a fresh file.
fn drawn(draw: impl FnOnce(&Path) -> Result<(), PlotError>) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chart.svg");
    draw(&path).unwrap();
    fs::read_to_string(path).unwrap()
}

/// The value of an attribute in a tag.
fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    tag.split_once(&format!(" {name}=\""))?.1.split_once('"').map(|(value, _)| value)
}

/// A written text: its characters and the box it takes in a font of ordinary width.
#[derive(Debug)]
struct Written {
    text: String,
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

impl Written {
    fn parse(element: &str) -> Self {
        let (tag, text) = element.split_once('>').unwrap();
        let number = |name| attribute(tag, name).unwrap().parse::<f64>().unwrap();
        let (x, y, size) = (number("x"), number("y"), number("font-size"));
        let text = text.split_once('<').unwrap().0.trim();
        let text =
            text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
        let width = 0.55 * size * text.chars().count() as f64;
        let from = match attribute(tag, "text-anchor") {
            Some("start") => 0.0,
            Some("middle") => -width / 2.0,
            _ => -width,
        };
        let (along, across) = ((from, from + width), (-0.4 * size, 0.4 * size));
        let turned = attribute(tag, "transform").is_some();
        let ((l, r), (t, b)) = if turned { (across, (-along.1, -along.0)) } else { (along, across) };
        Self { text, left: x + l, top: y + t, right: x + r, bottom: y + b }
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }
}

fn texts(svg: &str) -> Vec<Written> {
    svg.split("<text").skip(1).map(Written::parse).collect()
}

/// Checks that every text is on the canvas and clear of the others, and that nothing external is referenced.
fn check_layout(svg: &str) {
    let canvas = attribute(svg, "viewBox").unwrap();
    let size: Vec<f64> = canvas.split(' ').map(|part| part.parse().unwrap()).collect();
    let texts = texts(svg);
    for (index, text) in texts.iter().enumerate() {
        assert!(
            text.left >= 0.0 && text.right <= size[2] && text.top >= 0.0 && text.bottom <= size[3],
            "{text:?}"
        );
        let other = texts[..index].iter().find(|other| text.overlaps(other));
        assert!(other.is_none(), "{text:?} over {other:?}");
    }
    for foreign in ["href", "url(", "<script", "<style", "<image"] {
        assert!(!svg.contains(foreign), "{foreign}");
    }
    assert_eq!((svg.matches("<svg").count(), svg.trim_end().ends_with("</svg>")), (1, true));
}

fn line(label: &str, f: impl Fn(f64) -> f64) -> Series {
    Series::new(label, (0..200).map(|k| f64::from(k) / 20.0).map(|t| (t, f(t))))
}

fn polylines(svg: &str) -> usize {
    svg.matches("<polyline").count()
}

#[test]
fn loss_curves_skip_what_a_logarithm_cannot_show() {
    let train: Vec<(f64, f64)> = (0..100).map(|k| (f64::from(k), 0.9_f64.powi(k))).collect();
    let mut test = train.clone();
    (test[30].1, test[60].1, test[80].1) = (f64::NAN, 0.0, -1.0);
    let whole = drawn(|path| loss_curve(path, "Loss", &[("train", &train), ("test", &train)]));
    let broken = drawn(|path| loss_curve(path, "Loss", &[("train", &train), ("test", &test)]));
    check_layout(&broken);
    assert_eq!(polylines(&broken), polylines(&whole) + 3);
    let written: Vec<String> = texts(&broken).into_iter().map(|text| text.text).collect();
    for expected in ["Loss", "train", "test", "iteration", "loss", "10⁻²"] {
        assert!(written.iter().any(|text| text == expected), "{expected} in {written:?}");
    }
}

#[test]
fn a_chart_of_nothing_says_so() {
    for losses in [&[][..], &[("a", &[][..])], &[("a", &[(0.0, f64::NAN), (f64::INFINITY, 1.0)])]] {
        let svg = drawn(|path| loss_curve(path, "Loss", losses));
        check_layout(&svg);
        assert!(svg.contains("no values to show"));
    }
    check_layout(&drawn(|path| time_series(path, "", &[])));
    check_layout(&drawn(|path| log_log(path, "", ("", ""), &[], &[2.0])));
}

#[test]
fn any_text_is_escaped_and_kept_apart() {
    let long = "a title with <tags> & \"quotes\" that goes on \u{7} and on ".repeat(4);
    let series: Vec<_> = (0..12).map(|k| line(&format!("a lengthy label, number {k}"), |t| t)).collect();
    let phase = Phase { x_label: &long, y_label: &long, angle: Angle::No };
    let svg = drawn(|path| phase_portrait(path, &long, phase, &series));
    check_layout(&svg);
    assert!(svg.contains("with &lt;tags&gt; &amp; &quot;quotes&quot;") && !svg.contains('\u{7}'));
}

#[test]
fn portraits_of_a_spinning_pendulum() {
    let spin = [
        line("truth", |t| t).with_stroke(Stroke::Wide),
        line("model", |t| t + 0.1).with_stroke(Stroke::Dashed),
    ];
    let phase = |angle| Phase { x_label: "θ (rad)", y_label: "θ̇ (rad/s)", angle };
    let draw = |angle| drawn(|path| phase_portrait(path, "Phase", phase(angle), &spin));
    let (unwrapped, wrapped) = (draw(Angle::Unwrapped), draw(Angle::Wrapped));
    check_layout(&unwrapped);
    check_layout(&wrapped);
    let ticks =
        |svg: &str| texts(svg).into_iter().map(|t| t.text).filter(|t| t.contains('π')).collect::<Vec<_>>();
    assert_eq!(ticks(&unwrapped), ["π/2", "π", "3π/2", "2π", "5π/2", "3π"]);
    assert_eq!(ticks(&wrapped), ["−π", "−π/2", "π/2", "π"]);
}

#[test]
fn curves_of_one_label_share_a_colour_and_a_legend_entry() {
    let phase = Phase { x_label: "θ (rad)", y_label: "θ̇ (rad/s)", angle: Angle::No };
    let pair = [line("truth", f64::sin), line("model", f64::cos)];
    let four = [pair.clone(), pair.clone()].concat();
    let svg = drawn(|path| phase_portrait(path, "Phase", phase, &four));
    check_layout(&svg);
    assert_eq!((svg.matches("truth").count(), svg.matches("model").count()), (1, 1));
    let colours = |svg: &str| -> std::collections::BTreeSet<String> {
        svg.split(" stroke=\"").skip(1).map(|rest| rest.chars().take(7).collect()).collect()
    };
    assert_eq!(colours(&svg), colours(&drawn(|path| phase_portrait(path, "Phase", phase, &pair))));
}

#[test]
fn panels_share_one_time_axis() {
    let (a, b) = ([line("angle", f64::sin), line("model", f64::cos)], [line("", |t| 1e-7 * (1.1 + t.sin()))]);
    let residual = Panel::new("residual (N·s)", &b).with_vertical(Vertical::Logarithmic);
    let svg = drawn(|path| time_series(path, "Run", &[Panel::new("angle (rad)", &a), residual]));
    check_layout(&svg);
    assert_eq!(svg.matches("time (s)").count(), 1);
    let tall = drawn(|path| time_series(path, "Run", &[Panel::new("angle (rad)", &a), residual, residual]));
    let height = |svg: &str| attribute(svg, "height").unwrap().parse::<f64>().unwrap();
    assert!(height(&tall) > height(&svg) + 100.0);
}

#[test]
fn reference_slopes_go_with_the_nearest_curve() {
    let order = |label: &str, p: i32| {
        let steps = (0..6).map(|k| 0.2 * 0.5_f64.powi(k));
        Series::new(label, steps.map(|h| (h, h.powi(p)))).with_stroke(Stroke::Dotted)
    };
    let curves = [order("order 2", 2), order("order 4", 4)];
    let svg = drawn(|path| log_log(path, "Order", ("h (s)", "error (rad)"), &curves, &[4.0, 2.0]));
    check_layout(&svg);
    assert!(svg.contains("slope 4") && svg.contains("slope 2"));
    let first = |label: &str| svg.find(label).unwrap();
    assert!(first("slope 4") < first("slope 2"));
}

#[test]
fn curves_of_a_panel_with_one_label_have_one_colour() {
    let at = |label: &str, y: f64, stroke| Series::new(label, [(0.0, y), (1.0, y)]).with_stroke(stroke);
    let curves =
        [at("u", 0.0, Stroke::Solid), at("limit", -1.0, Stroke::Thin), at("limit", 1.0, Stroke::Thin)];
    let svg = stacked_svg("Commands", "time (s)", &[Panel::new("u (N)", &curves)]).unwrap();
    check_layout(&svg);
    // Two lines and the swatch of the legend.
    assert_eq!(svg.matches("stroke=\"#D55E00\" stroke-width=\"3\"").count(), 3, "{svg}");
    assert!(!svg.contains("#009E73"));
}

#[test]
fn points_in_no_order_are_dots_without_a_line() {
    let svg = |stroke| {
        let series = Series::new("", [(0.0, 0.0), (2.0, 1.0), (1.0, 2.0)]).with_stroke(stroke);
        let phase = Phase { x_label: "x", y_label: "y", angle: Angle::No };
        drawn(|path| phase_portrait(path, "Points", phase, &[series]))
    };
    let [points, dotted] = [Stroke::Points, Stroke::Dotted].map(svg);
    let count = |svg: &str, tag: &str| svg.matches(tag).count();
    assert_eq!((count(&points, "<circle"), count(&dotted, "<circle")), (3, 3));
    assert_eq!(count(&points, "<polyline") + 1, count(&dotted, "<polyline"));
}

#[test]
fn a_long_run_makes_a_small_file() {
    let run = Series::new("", (0..300_000).map(|k| (f64::from(k) * 1e-3, (f64::from(k) * 0.37).sin())));
    let svg = drawn(|path| time_series(path, "Run", &[Panel::new("x (m)", std::slice::from_ref(&run))]));
    assert!(svg.len() < 150_000, "{}", svg.len());
}

#[test]
fn a_failed_write_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("no/such/chart.svg");
    let error = loss_curve(&path, "", &[]).unwrap_err();
    assert!(matches!(&error, PlotError::Write { file, .. } if *file == path));
    assert!(error.to_string().contains("chart.svg: "));
}
