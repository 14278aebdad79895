//! Friction plots: the model's friction force against the velocity of every coordinate.

use super::pictures::MOST;
use super::shape::column;
use super::{force_unit, unit_of};
use crate::evaluate::horizons::{Predictions, Predictor};
use crate::evaluate::percentile;
use leastaction_core::model::ModelError;
use leastaction_models::forces::Driven;
use leastaction_plot::page::number;
use leastaction_plot::{NotDrawn, Series, Stroke, Vertical, curves_svg};

/// Number of points per curve.
const POINTS: usize = 201;
/// Quantiles of a coordinate's positions at which position-dependent friction is drawn.
const PLACES: [f64; 3] = [0.5, 0.1, 0.9];
/// Curves that differ by less than this fraction of the largest force are drawn as one.
const APART: f64 = 0.01;

/// Ranges over which the curves of a coordinate are drawn.
struct Ranges {
    /// Median position of every coordinate, m or rad.
    middle: Vec<f64>,
    /// Positions of this coordinate at the quantiles [`PLACES`].
    places: [f64; 3],
    /// Largest velocity of this coordinate, m/s or rad/s.
    fastest: f64,
    /// Drive force that is rarely exceeded, N or N m.
    load: f64,
}

/// A curve for one position and load.
struct Curve {
    label: String,
    place: f64,
    load: f64,
    stroke: Stroke,
}

/// One plot for each of the first coordinates on which a force besides the control acts.
pub(super) fn pictures(
    predictor: &Predictor,
    predictions: &Predictions,
) -> Result<Vec<Result<String, NotDrawn>>, ModelError> {
    let n = predictor.logs.n;
    let place = |i: usize| {
        let positions = column(predictor.logs, i);
        PLACES.map(|part| percentile(&positions, part))
    };
    let places: Vec<[f64; 3]> = (0..n).map(place).collect();
    let ranges = |i: usize| Ranges {
        middle: places.iter().map(|[middle, ..]| *middle).collect(),
        places: places[i],
        fastest: predictions.fastest(i),
        load: predictor.largest_force(i),
    };
    let drawn = (0..n.min(MOST)).map(|i| ranges(i).picture(i, predictor));
    Ok(drawn.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

impl Ranges {
    fn picture(
        &self,
        i: usize,
        predictor: &Predictor,
    ) -> Result<Option<Result<String, NotDrawn>>, ModelError> {
        let letters = predictor.model.architecture.coordinates();
        let unit = unit_of(&letters, i);
        let force = force_unit(unit);
        let mut curves = Vec::<(Curve, Vec<f64>)>::new();
        for curve in self.curves(i, (unit, force)) {
            let values = self.forces(i, predictor, &curve)?;
            let largest = values.iter().chain(curves.iter().flat_map(|(_, values)| values));
            let apart = APART * largest.fold(0.0, |most, x| x.abs().max(most));
            let is_like = |other: &[f64]| other.iter().zip(&values).all(|(a, b)| (a - b).abs() <= apart);
            // The first curve, which `is_like` compares with, is drawn if any force acts.
            if !curves.iter().any(|(_, other)| is_like(other)) && values.iter().any(|x| *x != 0.0) {
                curves.push((curve, values));
            }
        }
        if curves.is_empty() {
            return Ok(None);
        }
        let alone = curves.len() == 1;
        let series = curves.into_iter().map(|(curve, values)| {
            let points = (0..POINTS).map(|k| self.velocity(k)).zip(values);
            Series::new(if alone { String::new() } else { curve.label }, points).with_stroke(curve.stroke)
        });
        let (velocity, label) = (format!("v{i} ({unit}/s)"), format!("friction ({force})"));
        let series: Vec<Series> = series.collect();
        Ok(Some(curves_svg(&format!("Friction of q{i}"), (&velocity, &label), Vertical::Linear, &series)))
    }

    fn curves(&self, i: usize, (unit, force): (&str, &str)) -> Vec<Curve> {
        let curve = |place: f64, load: f64, stroke: Stroke| {
            let label = format!("q{i} = {} {unit}, drive {} {force}", number(place), number(load));
            Curve { label, place, load, stroke }
        };
        let unloaded = self.places.iter().map(|place| curve(*place, 0.0, Stroke::Solid));
        let loaded = (self.load > 0.0).then(|| curve(self.places[0], self.load, Stroke::Dashed));
        unloaded.chain(loaded).collect()
    }

    fn velocity(&self, k: usize) -> f64 {
        self.fastest * (2.0 * k as f64 / (POINTS - 1) as f64 - 1.0)
    }

    /// Friction −Q_i: positive if it opposes a positive velocity. The other coordinates are at rest.
    fn forces(&self, i: usize, predictor: &Predictor, curve: &Curve) -> Result<Vec<f64>, ModelError> {
        let n = self.middle.len();
        let only = |x: f64| (0..n).map(|j| if j == i { x } else { 0.0 }).collect::<Vec<f64>>();
        let state = |k: usize| {
            let mut q = self.middle.clone();
            q[i] = curve.place;
            Driven { q, v: only(self.velocity(k)), tau: only(curve.load) }
        };
        let states: Vec<Driven> = (0..POINTS).map(state).collect();
        let forces = predictor.model.forces_at(&states)?;
        Ok(forces.iter().map(|force| -force[i]).collect())
    }
}
