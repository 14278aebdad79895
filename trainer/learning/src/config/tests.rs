use super::*;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::energy::inertia_network::Inertia;
use leastaction_core::network::Activation;
use leastaction_models::config::{Coordinates, FamilyConfig, InertiaKind, InertiaNetworkConfig, ModelConfig};

fn parse(text: &str) -> Result<Config, ConfigError> {
    Config::parse(text, Path::new("c.toml"))
}

fn error(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

fn defaults() -> Config {
    Config::new("data.npz", Coordinates(vec![Coordinate::Translation, Coordinate::Angle]))
}

fn inertia_network(config: &Config) -> &InertiaNetworkConfig {
    match &config.model {
        ModelConfig::InertiaNetwork(inertia_network) => inertia_network,
        ModelConfig::Modular(_) | ModelConfig::Graph(_) | ModelConfig::Bodies(_) | ModelConfig::Arm(_) => {
            panic!("not an inertia network")
        }
    }
}

const LEAST: &str = "[data]\nfile = \"data.npz\"\n[model]\ncoordinates = \"ta\"\n";

#[test]
fn printed_defaults_are_the_defaults() {
    assert_eq!(parse(InertiaNetworkConfig::defaults()).unwrap(), defaults());
    assert_eq!(parse(LEAST).unwrap(), defaults());
}

#[test]
fn printed_keys_that_are_off_can_be_switched_on() {
    let is_key =
        |line: &str| line.split(" = ").next().is_some_and(|key| !key.is_empty() && !key.contains(' '));
    // A model to start from would have to exist, and `rows` only applies to a factor.
    let is_of_this_text = |line: &&str| !line.starts_with("# start_from") && !line.starts_with("# rows");
    let switched: String = InertiaNetworkConfig::defaults()
        .lines()
        .filter(is_of_this_text)
        .map(|line| {
            line.strip_prefix("# ").filter(|rest| rest.contains(" = ") && is_key(rest)).unwrap_or(line)
        })
        .flat_map(|line| [line, "\n"])
        .collect();
    let config = parse(&switched).unwrap();
    assert_eq!(config.data.trajectories, Some(32));
    assert_eq!(inertia_network(&config).inertia, Some(InertiaKind::Cholesky));
    let TrainingConfig { target, patience, max_seconds, .. } = config.training;
    assert_eq!((target, patience, max_seconds), (Some(1e-12), Some(50), Some(600.0)));
}

#[test]
fn every_key_is_printed() {
    let table: toml::Table = toml::from_str(&defaults().to_toml()).unwrap();
    for (section, keys) in &table {
        for key in keys.as_table().unwrap().keys() {
            assert!(
                InertiaNetworkConfig::defaults().contains(&format!("\n{key} = ")) || key == "adam",
                "[{section}] {key}"
            );
        }
    }
}

#[test]
fn toml_round_trips() {
    let mut config = defaults();
    config.training.target = Some(1e-9);
    config.model = InertiaNetworkConfig {
        activation: Activation::Isru,
        inertia: Some(InertiaKind::Diagonal),
        ..inertia_network(&config).clone()
    }
    .into();
    assert_eq!(parse(&config.to_toml()).unwrap(), config);
}

#[test]
fn errors_name_line_and_key_and_what_to_do() {
    let unknown = error(&format!("{LEAST}[training]\niteratons = 5\n"));
    assert!(unknown.starts_with("c.toml:6: \"iteratons = 5\": unknown field `iteratons`"), "{unknown}");
    assert!(unknown.ends_with("did you mean `iterations`?"), "{unknown}");
    let section = error(&format!("{LEAST}[trainin]\n"));
    assert!(section.contains("did you mean `training`?") && section.contains(":5:"), "{section}");
    let loss = error(&format!("{LEAST}[training]\nloss = \"next-positon\"\n"));
    assert!(loss.contains(":6:") && loss.ends_with("did you mean `next-position`?"), "{loss}");
    let missing = error("[data]\nfile = \"a\"\n[model]\n");
    assert!(
        missing.contains("missing field `coordinates`") && missing.contains("--print-defaults"),
        "{missing}"
    );
    let syntax = error("[data\n");
    assert!(syntax.starts_with("c.toml:1:"), "{syntax}");
}

#[test]
fn values_out_of_range_are_refused_with_their_line() {
    let cases = [
        ("[training]\norder = 3", "2 or 4"),
        ("[training]\ncheckpoint_iterations = 0", "1 or above"),
        ("[training]\nmax_seconds = -1.0", "above 0"),
        ("[training]\ntarget = nan", "above 0"),
        ("[training]\niterations = -5", "-5"),
        ("[training.adam]\nplateau_factor = 1.5", "at most 1"),
        ("[training.adam]\nlearning_rate = \"fast\"", "invalid type"),
    ];
    for (text, expected) in cases {
        let message = error(&format!("{LEAST}{text}\n"));
        assert!(message.starts_with("c.toml:6: ") && message.contains(expected), "{message}");
    }
    for (key, value) in [("hidden", "[]"), ("hidden", "[8, 0]"), ("hidden", "[1999]"), ("epsilon", "-1.0")] {
        let message = error(&format!("{LEAST}{key} = {value}\n"));
        assert!(message.starts_with("c.toml:5: ") && message.contains("expected"), "{message}");
    }
    for value in ["\"tx\"", "[\"angel\"]", "[]", "\"ttttttttttttttttt\"", "3"] {
        let message = error(&format!("[data]\nfile = \"a\"\n[model]\ncoordinates = {value}\n"));
        assert!(message.starts_with("c.toml:4: "), "{message}");
    }
    assert!(error(&LEAST.replace("file", "validation = 1.0\nfile")).starts_with("c.toml:2: "));
}

fn inertia(architecture: &Architecture) -> Inertia {
    architecture.family.inertia_network().unwrap().inertia
}

#[test]
fn the_shape_follows_the_coordinates() {
    let two = parse(LEAST).unwrap().beginning().unwrap().0;
    assert_eq!(inertia(&two), Inertia::Cholesky { epsilon: 1e-9 });
    assert_eq!(two.parameters().unwrap(), 796);
    let one = parse(&LEAST.replace("\"ta\"", "[\"angle\"]")).unwrap().beginning().unwrap().0;
    assert_eq!((inertia(&one), one.coordinates().as_str()), (Inertia::Diagonal, "a"));
    let explicit = parse(&format!("{LEAST}inertia = \"diagonal\"\n")).unwrap().beginning().unwrap().0;
    assert_eq!(inertia(&explicit), Inertia::Diagonal);
}

#[test]
fn identity_ignores_when_to_stop_but_not_what_is_learned() {
    let config = defaults();
    let mut later = config.clone();
    later.training.iterations = 9;
    later.training.threads = 2;
    later.data.file = "elsewhere.npz".into();
    assert_eq!(config.identity(), later.identity());
    later.training.order = 2;
    assert_ne!(config.identity(), later.identity());
}

#[test]
fn sensors_and_actuators_are_learned_or_known() {
    use crate::windows::Setting;
    let with = |lines: &str| parse(&format!("{LEAST}[calibration]\n{lines}\n"));
    assert!(
        !parse(LEAST).unwrap().to_toml().contains("lag"),
        "a configuration without a lag keeps its identity"
    );
    let lagging = with("lag = \"learned\"").unwrap();
    assert_eq!(lagging.calibration.calibration().lag, Setting::Learned);
    assert_eq!(parse(&lagging.to_toml()).unwrap(), lagging);
    let config = with("zero = \"learned\"\ngain = \"learned\"\ndelay = 0.008").unwrap();
    let calibration = config.calibration.calibration();
    assert!(calibration.zero && calibration.gain == Setting::Learned);
    assert_eq!((calibration.delay, calibration.offset), (Setting::Known(0.008), Setting::Known(0.0)));
    assert_eq!(parse(&config.to_toml()).unwrap(), config);
    for (lines, expected) in [
        (
            "gain = 0.0",
            "c.toml:6: \"gain = 0.0\": `gain` must be \"learned\" or a finite number other than 0",
        ),
        ("\ndelay = -1", "c.toml:7: \"delay = -1\": `delay` must be"),
        ("lag = -0.005", "`lag` must be \"learned\" or a finite number of seconds, 0 or above"),
        ("lag = inf", "`lag` must be"),
        ("zero = 0.1", "subtract a known one from the column"),
        ("offset = \"learnt\"", "expected \"learned\" or a number"),
    ] {
        let said = with(lines).unwrap_err().to_string();
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn intervals_and_further_files_of_recordings() {
    let with = |data: &str| LEAST.replace("[model]", &format!("{data}\n[model]"));
    let config = parse(&with(
        "leave_out = [[0.5, 1], { file = \"b.csv\", from = 2.0, to = inf }]\n[data.columns]\nq = [\"a\", \"b\"]\nu = [\"tau:x\", \"y\"]\nt = \"now\"\n[data.join]\ntau = { replace = [\"q\", \"u\"] }",
    ))
    .unwrap();
    let reading = config.data.reading();
    assert_eq!((reading.leave_out[0].to, reading.leave_out[1].to), (1.0, f64::INFINITY));
    assert_eq!(reading.leave_out[1].file.as_deref(), Some(Path::new("b.csv")));
    assert_eq!((reading.joins[0].name.as_str(), reading.joins[0].t.name.as_str()), ("tau", "now"));
    assert_eq!(parse(&config.to_toml()).unwrap(), config);
    for (data, said) in [
        ("leave_out = [[2.0, 1.0]]", "it begins before it ends"),
        ("leave_out = [[nan, 1.0]]", "it begins before it ends"),
        ("leave_out = [[1.0, 2.0, 3.0]]", "an interval is [from, to] in s"),
        ("leave_out = [{ from = 1.0, to = 2.0, fil = \"a\" }]", "an interval is [from, to] in s"),
        ("[data.join]\ntau = { replace = [\"q\", \"u\"] }", "columns of \"tau\" need names"),
        ("[data.join]\ntau = { replace = [\"q\"] }", "expected an array of length 2"),
    ] {
        let message = error(&with(data));
        assert!(message.contains(said), "{message}");
    }
}

#[test]
fn columns_by_number_sums_offsets_and_rates() {
    let with = |data: &str| LEAST.replace("[model]", &format!("{data}\n[model]"));
    let config = parse(&with(
        "rate = 100.0\n[data.columns]\nq = [2, { name = 3, scale = 2.0, sign = -1, offset = 1.5 }]\nu = { sum = [{ name = \"a\", scale = 0.5 }, \"b\"], offset = 1 }",
    ))
    .unwrap();
    let reading = config.data.reading();
    let columns = reading.columns.unwrap();
    assert_eq!((reading.rate, columns.q[0].name.as_str()), (Some(100.0), "#2"));
    assert_eq!((columns.q[1].scale, columns.q[1].offset), (-2.0, 3.0));
    assert_eq!((columns.u[0].plus[0].name.as_str(), columns.u[0].offset), ("b", 1.0));
    assert_eq!(parse(&config.to_toml()).unwrap(), config);
    let one = parse(&with("[data.columns]\nt = { sec = 1, nanosec = \"ns\" }\nq = 3")).unwrap();
    assert_eq!(one.data.reading().columns.unwrap().t.plus[0].scale, 1e-9);
    assert_eq!(parse(&one.to_toml()).unwrap(), one);
    for (data, said) in [
        ("rate = 0.0", "rate"),
        ("rate = 10.0\n[data.columns]\nt = \"now\"\nq = 1", "rate is for logs without time"),
        ("[data.columns]\nq = 0", "counted from 1"),
        ("[data.columns]\nq = { sum = [] }", "a sum needs at least one column"),
        ("[data.columns]\nq = { sum = [1], unit = \"deg\" }", "a column has a name"),
        ("[data.columns]\nq = { sec = 1 }", "a column has a name"),
    ] {
        let message = error(&with(data));
        assert!(message.contains(said), "{message}");
    }
}

#[test]
fn the_pages_ways_to_name_logs_are_read() {
    const PAGE: &str = include_str!("../../../../docs/book/src/logs.md");
    let blocks = PAGE.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next());
    let logs: Vec<String> = blocks
        .filter(|block| block.starts_with("[data]"))
        .map(|block| format!("{block}[model]\ncoordinates = \"aa\"\n"))
        .collect();
    let read: Vec<_> = logs.iter().map(|text| parse(text).unwrap().data.reading()).collect();
    assert!(read.iter().any(|reading| reading.joins.len() == 1));
    assert!(read.iter().any(|reading| reading.leave_out.len() == 2));
}

#[test]
fn noise_of_states_is_checked() {
    let parse = |noise: &str| {
        let text = format!(
            "[data]\nfile = \"a.csv\"\n[model]\ncoordinates = \"a\"\n[training]\nstate_noise = {noise}\n"
        );
        Config::parse(&text, Path::new("c.toml"))
    };
    assert_eq!(
        parse("{ q = 0.01 }").unwrap().training.state_noise,
        Some(StateNoise { q: 0.01, ..StateNoise::default() })
    );
    for wrong in ["{ a = 1.0 }", "{ q = -1.0 }", "{ q = inf }", "{}", "{ q = 1.0, u = 1.0 }"] {
        let error = parse(wrong).unwrap_err().to_string();
        assert!(error.contains("c.toml:6"), "{error}");
    }
}
