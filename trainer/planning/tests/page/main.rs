//! Pages of plans for the mechanisms on which solvers are compared.

use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_models::{Architecture, InertiaNetworkArchitecture, Model};
use leastaction_planning::{Machine, Plan, PlanConfig, Task, page, plan};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Plan of a problem on which solvers are compared, with some of its text replaced.
/// The search has this number of start guesses, and of iterations.
fn planned(name: &str, [starts, iterations]: [usize; 2], changes: &[(&str, &str)]) -> (Plan, Machine) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/peers/control");
    let mut text = std::fs::read_to_string(folder.join(format!("{name}.toml"))).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    text += &format!("\n[search]\nstarts = {starts}\niterations = {iterations}\n");
    let mut config = PlanConfig::parse(&text, Path::new(name)).unwrap();
    config.model = folder.join(&config.model);
    let machine = Machine::of_description(&config.model).unwrap();
    let task = Task::new(&config, &machine).unwrap();
    (plan(&machine, &task, None, (&AtomicBool::new(false), &())).unwrap(), machine)
}

/// Writes a page into the folder that `PLAN_PAGES` names, to be looked at.
fn kept(name: &str, html: String) -> String {
    if let Some(folder) = std::env::var_os("PLAN_PAGES") {
        std::fs::write(Path::new(&folder).join(format!("{name}.html")), &html).unwrap();
    }
    html
}

/// Plan of a problem with some of its text replaced, and its page, which is kept under the name `of`.
fn shown(name: &str, of: &str, search: [usize; 2], changes: &[(&str, &str)]) -> (Plan, String) {
    let (plan, machine) = planned(name, search, changes);
    let html = page(&plan, &machine).unwrap();
    (plan, kept(of, html))
}

/// Asserts that a page opens without any other file.
fn check_self_contained(html: &str) {
    for outside in ["src=", "href=", "@import", "url("] {
        assert!(!html.contains(outside), "{outside}");
    }
    assert!(html.len() < 1_000_000, "{} bytes", html.len());
}

/// Frames of the animation, as numbers.
fn frames(html: &str) -> Vec<Vec<f64>> {
    let data = html.split("\"frames\":[").nth(1).unwrap().split("]}").next().unwrap();
    let numbers = |frame: &str| frame.split(',').map(|x| x.parse().unwrap()).collect();
    data.split('[').skip(1).map(|frame| numbers(frame.split(']').next().unwrap())).collect()
}

/// Number of texts of the labels of a legend.
fn labelled(html: &str, label: &str) -> usize {
    html.matches(&format!(">\n{label}\n<")).count()
}

#[test]
fn a_cart_slides_within_its_rail() {
    let (plan, html) = shown("cartpole", "cartpole", [2, 80], &[]);
    check_self_contained(&html);
    assert!(html.contains("gravity points down") && html.contains("not driven"));
    assert_eq!(html.matches("<g opacity=").count(), 10);
    assert_eq!(html.matches("<rect data-p=").count(), 11);
    let frames = frames(&html);
    assert_eq!(frames.len(), plan.nodes.len().min(200) + 1);
    // Points: base, cart, pole, two ends of the rail, its middle, tip. The rail is 1.6 m long, the pole 1 m.
    for frame in &frames {
        let place = |point: usize| (frame[2 * point], frame[2 * point + 1]);
        let length = |a: usize, b: usize| (place(a).0 - place(b).0).hypot(place(a).1 - place(b).1);
        let metre = length(3, 4) / 1.6;
        assert!(
            place(3).0 < place(1).0 + 5.0
                && place(1).0 < place(4).0 + 5.0
                && (length(2, 6) - metre).abs() < 0.3
        );
    }
    let (first, last) = (&frames[0], &frames[frames.len() - 1]);
    assert!(first[13] > first[5] + 50.0 && last[13] < last[5] - 50.0);
    // Limits of the cart's position, of its speed and of the force.
    assert_eq!(labelled(&html, "limit"), 3);
}

#[test]
fn an_arm_has_a_small_page() {
    let (plan, html) = shown("arm", "arm", [4, 2], &[]);
    check_self_contained(&html);
    let frames = frames(&html);
    assert_eq!(frames.len(), plan.nodes.len().min(200) + 1);
    assert!(frames.iter().all(|frame| frame.len() == 2 * (1 + 7 + 1)));
    assert_eq!(labelled(&html, "limit"), 3 * 7);
    assert!(html.contains("joint7") && html.contains("<h2>Reach of the feedback</h2>"));
}

/// Page of a model that does not know its geometry, moved a little in a second.
fn without_geometry(of: &str, kinds: &[Coordinate]) -> String {
    let architecture = Architecture::from(InertiaNetworkArchitecture::new(kinds, 4));
    let weights = architecture.initial_weights(1);
    let machine = Machine::new(Model::new(architecture, weights));
    let each = |text: &str| vec![text; kinds.len()].join(", ");
    let text = format!(
        "model = \"\"\ntick = 0.02\nseconds = 1.0\n[start]\nq = [{}]\n[goal]\nq = [{}]\n[limits]\nu = [{}]\n\
         [search]\nstarts = 1\niterations = 3\n",
        each("0.5"),
        each("0.6"),
        each("2.0")
    );
    let task = Task::new(&PlanConfig::parse(&text, Path::new(of)).unwrap(), &machine).unwrap();
    let plan = plan(&machine, &task, None, (&AtomicBool::new(false), &())).unwrap();
    kept(of, page(&plan, &machine).unwrap())
}

#[test]
fn models_without_geometry_have_a_schematic_or_curves_alone() {
    use Coordinate::{Angle, Translation};
    let (cart, rods) =
        (without_geometry("cart", &[Translation, Angle]), without_geometry("rods", &[Angle, Angle]));
    assert!(cart.contains("A schematic:") && rods.contains("A schematic:"));
    assert_eq!((frames(&cart).len(), frames(&rods).len()), (51, 51));
    assert_eq!((cart.matches("<rect data-p=").count(), rods.matches("<rect data-p=").count()), (11, 0));
    let slides = without_geometry("slides", &[Translation, Translation]);
    assert!(slides.contains("only its curves are drawn") && !slides.contains("id=\"frames\""));
    check_self_contained(&slides);
}

#[test]
fn a_pendulum_at_its_limits_is_told_to_keep_a_reserve() {
    let (plan, html) = shown("pendulum", "pendulum", [2, 100], &[]);
    check_self_contained(&html);
    assert!(
        plan.is_feasible() && html.contains("Limits and goal are met.") && !html.contains("NOT FEASIBLE")
    );
    assert!(plan.tube.widths[0].iter().all(|width| *width == 0.0));
    assert!(html.contains("may be off by nothing at the start (pivot)"));
    assert!(html.contains("reserve = 0.1") && html.contains("The command of pivot is at a limit in "));
    assert!(html.contains("100% of -1.50 … 1.50") && html.contains("a rest that the drives hold"));
}

#[test]
fn a_reserve_gives_a_tube() {
    let (plan, html) = shown("pendulum", "reserve", [2, 100], &[("u = [1.5]", "u = [1.5]\nreserve = 0.1")]);
    assert!(plan.tube.widths[0].iter().all(|width| *width > 0.0));
    assert!(!html.contains("reserve = 0.1") && html.contains("10% of the range of every command is kept"));
    assert!(html.contains("less the reserve") && html.contains(">\ntube\n<"));
}

#[test]
fn a_plan_that_misses_the_goal_says_so() {
    let (plan, html) = shown("pendulum", "short", [1, 30], &[("seconds = 4.0", "seconds = 1.0")]);
    assert!(!plan.is_feasible());
    assert!(
        html.contains("NOT FEASIBLE: q of pivot ends ") && html.contains("<td class=\"text\">NOT met</td>")
    );
    assert!(!html.contains("Limits and goal are met."));
}
