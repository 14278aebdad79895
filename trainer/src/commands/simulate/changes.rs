//! Changes of the mechanism while it runs: loads that it carries, and friction that grows.

use super::over_time::OverTime;
use super::{Plant, Request, Scenario};
use clap::Args;
use leastaction::cli::Failure;
use leastaction::cli::arguments::{finite, not_negative, positive};
use leastaction_core::energy::trigonometric::Trigonometric;
use leastaction_ground_truth::{Mechanism, Waves};
use leastaction_models::{ChangeError, Model, PointMass};
use serde::Serialize;
use std::str::FromStr;

/// Changes of the mechanism while it runs, of which the firmware knows nothing.
#[derive(Args, Clone, Default)]
#[command(next_help_heading = "Changes of the mechanism while it runs (unknown to the firmware)")]
pub struct Changes {
    /// A load that the mechanism carries, as a point mass: KG from the beginning, KG@S from a time on (as 2.5@3s), KG@S@X,Y,Z at a place
    /// in the frame of its body, m [default place: the end of the body, twice as far from its joint as its centre of mass, or the centre of
    /// one that slides]. Given several times, each load takes the place of the one before; 0@S puts it down, a negative mass is a part that
    /// the body loses. Velocities are continuous: the load already moves with the hand.
    #[arg(long, value_name = "KG[@S[@X,Y,Z]]", allow_hyphen_values = true)]
    payload: Vec<Payload>,
    /// The body that carries the load, counted from 0 [default: the last one].
    #[arg(long, value_name = "BODY", requires = "payload")]
    payload_body: Option<usize>,
    /// All friction of the mechanism, viscous and dry, grows linearly within S seconds to FACTOR times what it was, and then stays; as
    /// 1.5@60s.
    #[arg(long, value_name = "FACTOR@S")]
    friction_drift: Option<FrictionDrift>,
}

/// A load from a time on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Payload {
    mass: f64,
    since: f64,
    place: Option<[f64; 3]>,
}

impl FromStr for Payload {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts = text.split('@');
        let mass = finite(parts.next().unwrap_or_default())?;
        let since = parts.next().map_or(Ok(0.0), |time| not_negative(seconds(time)))?;
        let place = parts.next().map(place).transpose()?;
        match parts.next() {
            None => Ok(Self { mass, since, place }),
            Some(_) => Err("it must be a mass, a time and a place, as 2.5@3s@0,0,0.1".to_owned()),
        }
    }
}

/// Growth of all friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrictionDrift {
    /// Factor of all friction at the end.
    factor: f64,
    /// Time of that, s.
    until: f64,
}

impl FromStr for FrictionDrift {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (factor, until) = text.split_once('@').ok_or("it must be a factor and a time, as 1.5@60s")?;
        Ok(Self { factor: not_negative(factor)?, until: positive(seconds(until))? })
    }
}

/// The number of a time, whose unit may be left out.
fn seconds(text: &str) -> &str {
    text.strip_suffix('s').unwrap_or(text)
}

/// Three lengths.
fn place(text: &str) -> Result<[f64; 3], String> {
    let lengths = text.split(',').map(finite).collect::<Result<Vec<_>, _>>()?;
    lengths.try_into().map_err(|_| "the place must be three lengths, as 0,0,0.1".to_owned())
}

/// Time for which friction that grows is taken as constant, s, as long as there are no more than [`MOST_STEPS`].
const STEP: f64 = 0.1;
/// Largest number of times that friction grows.
const MOST_STEPS: f64 = 1000.0;

impl FrictionDrift {
    /// Times at which the friction grows, s.
    fn times(&self) -> impl Iterator<Item = f64> + use<> {
        let (steps, until) = ((self.until / STEP).ceil().min(MOST_STEPS), self.until);
        (1..=steps as u32).map(move |k| until * f64::from(k) / steps)
    }

    /// The mean factor between two times, s.
    fn between(&self, begin: f64, end: f64) -> f64 {
        let passed = (0.5 * (begin + end) / self.until).min(1.0);
        1.0 + passed * (self.factor - 1.0)
    }
}

/// State of the mechanism: its load, and the factor of its friction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    load: Option<PointMass>,
    friction: f64,
}

/// A load that was carried, for the report.
#[derive(Clone, Debug, Serialize)]
pub struct Carried {
    /// Mass, kg.
    mass: f64,
    /// Time from which it was carried, s.
    since: f64,
    /// Body that carried it, from 0.
    body: usize,
    /// Place in the frame of the body, m.
    place: [f64; 3],
}

impl Changes {
    /// Whether nothing changes.
    pub fn are_none(&self) -> bool {
        self.payload.is_empty() && self.friction_drift.is_none()
    }

    /// Refuses these options for a scenario without a firmware, and several loads at a time.
    pub fn check(&self, request: &Request) -> Result<(), Failure> {
        if request.scenario == Scenario::Predict && !self.are_none() {
            let reason = "predict compares mechanisms that stay as they are; leave out --payload and --friction-drift, or take track or \
                          gravity";
            return Err(Failure::Input(reason.to_owned()));
        }
        let loads = self.loads();
        if let Some(twice) = loads.windows(2).find(|two| two[0].since == two[1].since) {
            let since = twice[0].since;
            return Err(Failure::Input(format!(
                "--payload is given twice from {since} s on; give one load at a time"
            )));
        }
        Ok(())
    }

    /// The loads in the order of their times.
    fn loads(&self) -> Vec<Payload> {
        let mut loads = self.payload.clone();
        loads.sort_by(|one, other| one.since.total_cmp(&other.since));
        loads
    }

    fn point_mass(&self, payload: &Payload) -> PointMass {
        PointMass { body: self.payload_body, mass: payload.mass, place: payload.place }
    }

    /// States of the mechanism.
    fn pieces(&self) -> OverTime<Piece> {
        let loads = self.loads();
        let of_friction = self.friction_drift.iter().flat_map(FrictionDrift::times);
        let changes = loads.iter().map(|load| load.since).filter(|since| *since > 0.0);
        let mut times: Vec<f64> = changes.chain(of_friction).chain([f64::INFINITY]).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let piece = |since: f64, end: f64| {
            let load = loads.iter().rfind(|load| load.since <= since);
            let load = load.filter(|load| load.mass != 0.0).map(|load| self.point_mass(load));
            Piece { load, friction: self.friction_drift.map_or(1.0, |drift| drift.between(since, end)) }
        };
        let later = times.iter().zip(times.iter().skip(1));
        let later = later.map(|(since, end)| (*since as f32, piece(*since, *end))).collect();
        OverTime::new(piece(0.0, times[0]), later)
    }

    /// The models of a mechanism.
    pub(super) fn models(&self, model: &Model) -> Result<OverTime<Model>, Failure> {
        self.pieces().map(|Piece { load, friction }| {
            let mut own = model.clone();
            if let Some(load) = load {
                own = own.with_load(load).map_err(unloaded)?;
            }
            if self.friction_drift.is_some() {
                own = own.with_friction(*friction).map_err(undrifted)?;
            }
            Ok(own)
        })
    }

    /// The Lagrangians of an exact mechanism, with factors of its friction.
    pub(super) fn waves<const N: usize>(
        &self,
        mechanism: Mechanism,
        own: &Trigonometric<N>,
    ) -> Result<OverTime<(Waves<N>, f64)>, Failure> {
        self.pieces().map(|Piece { load, friction }| {
            let waves = mechanism.waves(own, load.as_ref()).map_err(unloaded)?;
            Ok((waves, *friction))
        })
    }

    /// The loads that the plant carries; one that it cannot carry is left out.
    pub(super) fn carried(&self, plant: &Plant) -> Vec<Carried> {
        let of = |payload: &Payload| {
            let load = self.point_mass(payload);
            let (place, bodies) = match plant {
                Plant::Exact(mechanism) => (mechanism.place_of(&load), mechanism.coordinates().len()),
                Plant::Model { model, .. } => (model.place_of(&load), model.n()),
            };
            let (place, body) = (place.ok()?, load.body_of(bodies).ok()?);
            Some(Carried { mass: payload.mass, since: payload.since, body, place })
        };
        self.loads().iter().filter_map(of).collect()
    }

    /// Growth of the friction.
    pub(super) fn drift(&self) -> Option<FrictionDrift> {
        self.friction_drift
    }
}

impl Carried {
    /// The load in words.
    pub(super) fn told(&self) -> String {
        let Self { mass, since, body, place } = self;
        if *mass == 0.0 {
            return format!("nothing from {since} s on");
        }
        let place = place.map(|x| format!("{x:.3}")).join(", ");
        format!("{mass} kg from {since} s on, at ({place}) m of body {body}")
    }
}

impl FrictionDrift {
    /// The growth in words.
    pub(super) fn told(&self) -> String {
        format!("grows to {} times at {} s", self.factor, self.until)
    }
}

fn unloaded(error: ChangeError) -> Failure {
    Failure::Input(format!("--payload: {error}"))
}

/// The failure to let friction grow.
pub(super) fn undrifted(error: ChangeError) -> Failure {
    Failure::Input(format!("--friction-drift: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_and_growth_are_read() {
        let load = |mass, since, place| Ok(Payload { mass, since, place });
        assert_eq!("2.5".parse(), load(2.5, 0.0, None));
        assert_eq!("-0.4@3s".parse(), load(-0.4, 3.0, None));
        assert_eq!("2.5@0.5@0.1,-0.2,3e-2".parse(), load(2.5, 0.5, Some([0.1, -0.2, 0.03])));
        assert_eq!("1.5@60s".parse(), Ok(FrictionDrift { factor: 1.5, until: 60.0 }));
        for wrong in [
            "",
            "@3s",
            "2@",
            "2@s",
            "2@-1",
            "2@inf",
            "nan",
            "2@1@0,0",
            "2@1@0,0,0,0",
            "2@1@0,0,x",
            "2@1@0,0,0@1",
        ] {
            assert!(wrong.parse::<Payload>().is_err(), "{wrong}");
        }
        for wrong in ["", "1.5", "1.5@0", "-1@3s", "1.5@3@4", "@3", "inf@3"] {
            assert!(wrong.parse::<FrictionDrift>().is_err(), "{wrong}");
        }
    }

    /// Times and states, with masses of 0 for no load.
    fn pieces(changes: &Changes) -> Vec<(f32, f64, f64)> {
        let pieces = changes.pieces();
        let state =
            |since: f32, piece: &Piece| (since, piece.load.map_or(0.0, |load| load.mass), piece.friction);
        let later = pieces.later.iter().map(|(since, piece)| state(*since, piece));
        [state(0.0, &pieces.first)].into_iter().chain(later).collect()
    }

    #[test]
    fn loads_follow_each_other_while_friction_grows() {
        let payload = ["0@0.25", "2@0.1s", "1"].map(|text| text.parse().unwrap()).to_vec();
        let mut changes = Changes { payload, ..Changes::default() };
        assert_eq!(pieces(&Changes::default()), [(0.0, 0.0, 1.0)]);
        assert_eq!(pieces(&changes), [(0.0, 1.0, 1.0), (0.1, 2.0, 1.0), (0.25, 0.0, 1.0)]);
        changes.friction_drift = Some("3@0.2s".parse().unwrap());
        let grown = pieces(&changes);
        let expected = [(0.0, 1.0, 1.5), (0.1, 2.0, 2.5), (0.2, 2.0, 3.0), (0.25, 0.0, 3.0)];
        assert_eq!(grown.len(), expected.len());
        for ((since, mass, factor), expected) in grown.into_iter().zip(expected) {
            assert_eq!((since, mass), (expected.0, expected.1));
            assert!((factor - expected.2).abs() < 1e-12, "{factor}");
        }
    }

    #[test]
    fn friction_that_grows_for_long_grows_in_a_thousand_steps() {
        let drift: FrictionDrift = "0.5@36000s".parse().unwrap();
        let pieces = pieces(&Changes { friction_drift: Some(drift), ..Changes::default() });
        assert_eq!((pieces.len(), pieces.last()), (1001, Some(&(36_000.0, 0.0, 0.5))));
        assert!(pieces.windows(2).all(|two| two[1].2 < two[0].2));
    }
}
