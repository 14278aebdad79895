//! Filter of a line search.

/// Pairs of gap θ and barrier cost φ that no later point may be worse than in both.
///
/// Source: Wächter and Biegler, "On the implementation of an interior-point filter line-search algorithm", 2006, section 2.3.
#[derive(Clone, Debug, Default)]
pub struct Filter {
    entries: Vec<[f64; 2]>,
    /// Gap of the first point, at least 1.
    scale: f64,
}

/// Relative fall of θ, and fall of φ per θ, that is enough.
const FALL: f64 = 1e-5;
/// Part of the expected fall of φ that is enough.
const ENOUGH: f64 = 1e-4;
/// Gaps, relative to the first one: below the first number φ must fall if it is expected to; above the second no point is accepted.
const GAPS: [f64; 2] = [1e-4, 1e4];

/// Point of a search: gap θ and barrier cost φ.
#[derive(Clone, Copy, Debug)]
pub struct Merit {
    /// Gap θ.
    pub gap: f64,
    /// Barrier cost φ.
    pub cost: f64,
}

impl Filter {
    /// Empty filter of a search that begins with a gap.
    pub fn new(gap: f64) -> Self {
        Self { entries: Vec::new(), scale: gap.max(1.0) }
    }

    /// Forgets all points, as φ changes.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Whether a trial is accepted after the point `now`, from which the part `part` of the step was taken along which φ has the slope
    /// `slope`. Remembers `now` unless φ fell as expected.
    pub fn accepts(&mut self, now: Merit, trial: Merit, (part, slope): (f64, f64)) -> bool {
        let worse = self.entries.iter().any(|[gap, cost]| trial.gap >= *gap && trial.cost >= *cost);
        if worse || !trial.cost.is_finite() || trial.gap.is_nan() || trial.gap > GAPS[1] * self.scale {
            return false;
        }
        let falls = slope < 0.0 && part * (-slope).powf(2.3) > now.gap.powf(1.1);
        if now.gap <= GAPS[0] * self.scale && falls {
            let rounding = 1e-10 * now.cost.abs();
            return trial.cost <= now.cost + ENOUGH * part * slope + rounding;
        }
        let better = [(1.0 - FALL) * now.gap, now.cost - FALL * now.gap];
        let accepted = trial.gap <= better[0] || trial.cost <= better[1];
        if accepted {
            self.entries.push(better);
        }
        accepted
    }
}
