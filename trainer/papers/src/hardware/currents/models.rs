//! Models in the table of currents.

use super::super::arm::{Learned, least_squares};
use super::super::configured::{End, full, trained};
use super::{CUT_OFF, CurrentData, GAINS};
use crate::task::{TaskError, Tell};
use leastaction_learning::config::Config;
use leastaction_learning::data::Rows;
use leastaction_learning::torque::Samples;
use leastaction_learning::torque::linear::Terms;
use leastaction_learning::torques::widths_at_rest;
use leastaction_models::tree::Tree;

/// A row of the table.
#[derive(Clone, Copy)]
pub struct Model {
    /// Name in the table and, in small letters, in the names of tasks.
    pub name: &'static str,
    /// Whether it is the default model of a fit.
    pub is_default: bool,
    /// Whether it is our model.
    pub is_ours: bool,
    /// Rough learning time, s.
    pub expected_seconds: f64,
    /// Learns from the log to learn from; the result predicts currents.
    pub learn: fn(&CurrentData, &Tell) -> Result<Learned, TaskError>,
}

/// Terms of least squares besides the bodies; the width of dry friction is not learned, rad/s.
const TERMS: Terms = Terms { rotors: true, viscous: true, coulomb: Some(0.02), offsets: true };
/// Terms with friction that keeps at rest what it had in motion ([`Samples::with_friction_at_rest`]); the width turns its direction within
/// 0.1 mrad.
const AT_REST: Terms = Terms { coulomb: Some(WIDTH_AT_REST), ..TERMS };
const WIDTH_AT_REST: f64 = 0.003;
/// Factors of currents that are taken for torques.
const NO_GAINS: [f64; 6] = [1.0; 6];

const RIVAL: Model = Model {
    name: "constant: the mean",
    is_default: false,
    is_ours: false,
    expected_seconds: 1.0,
    learn: |data, _| Ok(mean(data.train())),
};

/// Rows of the table, in order.
pub const MODELS: [Model; 7] = [
    RIVAL,
    Model {
        name: "linear least squares",
        expected_seconds: 5.0,
        learn: |data, _| linear(data, NO_GAINS),
        ..RIVAL
    },
    Model {
        name: "linear least squares, gains of the drives known",
        expected_seconds: 5.0,
        learn: |data, _| linear(data, GAINS),
        ..RIVAL
    },
    Model {
        name: "linear least squares, gains known, friction kept at rest",
        expected_seconds: 5.0,
        learn: |data, _| linear_at_rest(data, GAINS),
        ..RIVAL
    },
    Model {
        name: "leastaction, one TOML",
        is_default: true,
        is_ours: true,
        expected_seconds: 60.0,
        learn: |data, tell| ours(data, Ours::DEFAULT, tell),
    },
    Model {
        name: "… offsets of the drives not learned",
        is_ours: true,
        expected_seconds: 60.0,
        learn: |data, tell| ours(data, Ours { offsets: false, ..Ours::DEFAULT }, tell),
        ..RIVAL
    },
    Model {
        name: "… friction that does not stick",
        is_ours: true,
        expected_seconds: 60.0,
        learn: |data, tell| ours(data, Ours { coulomb: "learned", ..Ours::DEFAULT }, tell),
        ..RIVAL
    },
];

/// The mean of every current.
fn mean(train: &Samples) -> Learned {
    let means: Vec<f64> =
        (0..train.tau.width()).map(|i| train.tau.column(i).sum::<f64>() / train.count() as f64).collect();
    let parameters = means.len();
    let predict = move |samples: &Samples| means.repeat(samples.count());
    Learned { predict: Box::new(predict), parameters, rank: None, consistency: None }
}

/// Choices of our configuration.
#[derive(Clone, Copy)]
struct Ours {
    /// Whether the offsets of the drives are learned.
    offsets: bool,
    /// Value of the key `coulomb`.
    coulomb: &'static str,
}

impl Ours {
    const DEFAULT: Self = Self { offsets: true, coulomb: "sticking" };
}

/// Least squares for the currents times these gains.
fn linear(data: &CurrentData, gains: [f64; 6]) -> Result<Learned, TaskError> {
    least(data.tree.clone(), (data.train().clone(), gains), TERMS)
}

/// Least squares with friction that keeps at rest what it had in motion.
fn linear_at_rest(data: &CurrentData, gains: [f64; 6]) -> Result<Learned, TaskError> {
    let at_rest = |samples: &Samples| samples.clone().with_friction_at_rest(&[WIDTH_AT_REST; 6]);
    let found = least(data.tree.clone(), (at_rest(data.train()), gains), AT_REST)?;
    let predict = found.predict;
    Ok(Learned { predict: Box::new(move |samples| predict(&at_rest(samples))), ..found })
}

fn least(tree: Tree, (train, gains): (Samples, [f64; 6]), terms: Terms) -> Result<Learned, TaskError> {
    let torques = Samples { tau: times(&train.tau, gains), ..train };
    let found = least_squares(tree, &torques, terms)?;
    let predict = found.predict;
    Ok(Learned { predict: Box::new(move |samples| currents(predict(samples), gains)), ..found })
}

fn times(rows: &Rows, gains: [f64; 6]) -> Rows {
    let scaled = rows.as_flat().iter().zip(gains.iter().cycle()).map(|(current, gain)| current * gain);
    Rows::from_flat(rows.width(), scaled.collect()).unwrap_or_else(|| rows.clone())
}

fn currents(mut torques: Vec<f64>, gains: [f64; 6]) -> Vec<f64> {
    torques.iter_mut().zip(gains.iter().cycle()).for_each(|(torque, gain)| *torque /= gain);
    torques
}

/// The model that `leastaction train` learns from the file of the log.
fn ours(data: &CurrentData, with: Ours, tell: &Tell) -> Result<Learned, TaskError> {
    let folder = tempfile::tempdir()?;
    let text = configuration(data, with);
    let config = Config::parse(&text, &folder.path().join("machine.toml"))?;
    let End { parameters, trained, .. } = trained(config, (folder.path(), false), tell)?;
    let parameters = parameters + if with.offsets { data.tree.coordinates() } else { 0 };
    let model = trained.model();
    // Torques that cannot be computed have no error; they are not numbers.
    let widths = widths_at_rest(&model.architecture, &model.weights);
    let predict = move |samples: &Samples| {
        let samples = samples.clone().with_friction_at_rest(&widths);
        let torques = model.inverse_dynamics([&samples.q, &samples.v, &samples.a].map(Rows::as_flat));
        currents(torques.unwrap_or_else(|_| vec![f64::NAN; samples.tau.as_flat().len()]), GAINS)
    };
    Ok(Learned { predict: Box::new(predict), parameters, rank: None, consistency: None })
}

/// The whole configuration, with columns by their numbers.
fn configuration(data: &CurrentData, Ours { offsets, coulomb }: Ours) -> String {
    let offset = if offsets { "\"learned\"" } else { "0.0" };
    let n = data.tree.coordinates();
    let list = |first: usize| format!("{:?}", (first..first + n).collect::<Vec<_>>());
    let torque = |(k, gain): (usize, &f64)| format!("{{ name = {}, scale = {gain} }}", 2 + 2 * n + k);
    let torques = GAINS.iter().enumerate().map(torque).collect::<Vec<_>>().join(", ");
    let path = |file| serde_json::Value::from(full(file).display().to_string());
    let [file, urdf] = [&data.logs[data.learned].file, &data.urdf].map(|file| path(file));
    let [q, v] = [2, 2 + n].map(list);
    format!(
        "training.cut_off = {CUT_OFF:?}\n\
         calibration.offset = {offset}\n\n\
         [data]\nfile = {file}\ncontrol = \"linear\"\nvalidation = 0\n\n\
         [data.columns]\nt = 1\nq = {q}\nv = {v}\nu = [{torques}]\n\n\
         [model]\nfamily = \"arm\"\nurdf = {urdf}\n\
         friction = {{ viscous = \"learned\", coulomb = {coulomb:?} }}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// A user copies it from the page, so it stays short.
    #[test]
    fn the_configuration_is_valid_and_has_at_most_fifteen_lines() {
        let urdf = "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"><inertial><mass value=\"1\"/>\
            <inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>\
            <joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>";
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("ur10e.urdf");
        std::fs::write(&file, urdf).unwrap();
        let tree: Tree = leastaction_models::urdf::parse(urdf, Default::default()).unwrap();
        let rows = Rows::from_flat(1, vec![0.0]).unwrap();
        let samples = Samples { t: vec![0.0], q: rows.clone(), v: rows.clone(), a: rows.clone(), tau: rows };
        let log = super::super::CurrentLog { file: "log.csv".into(), name: "log".into(), samples };
        let data =
            CurrentData { folder: folder.path().to_owned(), urdf: file, tree, logs: vec![log], learned: 0 };
        let text = configuration(&data, Ours::DEFAULT);
        assert!(text.lines().filter(|line| !line.is_empty()).count() <= 15, "{text}");
        Config::parse(&text, Path::new("machine.toml")).unwrap();
    }
}
