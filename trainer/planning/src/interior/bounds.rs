use leastaction_core::control::{Diagonal, Limits};

/// A box with a multiplier z > 0 for each of its finite ends. A component with equal ends is not part of it: it does not move, or is an
/// equation.
#[derive(Clone, Copy, Debug)]
pub struct Bounds<const N: usize> {
    limits: Limits<f64, N>,
    /// Multipliers of the lower and of the upper ends.
    multipliers: [[f64; N]; 2],
}

/// Distance of the first point from an end, as a part of the box's width; absolute if the width is infinite.
const MARGIN: f64 = 0.01;
/// Largest factor between a multiplier and μ/s.
const RATIO: f64 = 1e10;

/// An end of the box: x = `end` + `sign` s with the slack s > 0.
struct End {
    i: usize,
    side: usize,
    sign: f64,
    slack: f64,
    z: f64,
}

impl End {
    /// Change of the multiplier that keeps s z = μ to first order.
    fn change(&self, dx: f64, mu: f64) -> f64 {
        (mu - self.z * self.sign * dx) / self.slack - self.z
    }
}

impl<const N: usize> Bounds<N> {
    /// Moves a point into the box, and gives every end the multiplier μ/s.
    pub fn new(limits: Limits<f64, N>, x: &mut [f64; N], mu: f64) -> Self {
        let mut new = Self { limits, multipliers: [[0.0; N]; 2] };
        for (i, x) in x.iter_mut().enumerate() {
            *x = moved_inside(*x, limits.least[i], limits.most[i]);
        }
        let empty = new;
        for End { i, side, slack, .. } in empty.ends(x) {
            new.multipliers[side][i] = mu / slack;
        }
        new
    }

    fn ends<'a>(&'a self, x: &'a [f64; N]) -> impl Iterator<Item = End> + 'a {
        let Limits { least, most } = &self.limits;
        let ends = move |i: usize| [(0, 1.0, least[i]), (1, -1.0, most[i])].map(|end| (i, end));
        let finite = move |(i, (side, sign, end)): (usize, (usize, f64, f64))| {
            let end = End { i, side, sign, slack: sign * (x[i] - end), z: self.multipliers[side][i] };
            (least[i] < most[i] && end.slack < f64::INFINITY).then_some(end)
        };
        (0..N).flat_map(ends).filter_map(finite)
    }

    /// Barrier −Σ ln s; infinite or NaN outside the box.
    pub fn barrier(&self, x: &[f64; N]) -> f64 {
        self.ends(x).map(|end| -end.slack.ln()).sum()
    }

    /// Slope of the barrier times μ, and curvature z/s of the primal-dual equations.
    pub fn terms(&self, x: &[f64; N], mu: f64) -> Diagonal<f64, N> {
        let (mut slope, mut curvature) = ([0.0; N], [0.0; N]);
        for End { i, sign, slack, z, .. } in self.ends(x) {
            slope[i] -= sign * mu / slack;
            curvature[i] += z / slack;
        }
        (slope, curvature)
    }

    /// Multiplier of every component, positive at its upper end.
    pub fn multiplier(&self) -> [f64; N] {
        let [least, most] = &self.multipliers;
        std::array::from_fn(|i| most[i] - least[i])
    }

    /// Sum and number of the multipliers.
    pub fn sum(&self, x: &[f64; N]) -> (f64, usize) {
        self.ends(x).fold((0.0, 0), |(sum, count), end| (sum + end.z, count + 1))
    }

    /// Largest |s z − μ|.
    pub fn unbalance(&self, x: &[f64; N], mu: f64) -> f64 {
        self.ends(x).map(|end| (end.slack * end.z - mu).abs()).fold(0.0, f64::max)
    }

    /// Largest parts, up to 1, of the changes of x and of the multipliers that leave the part 1 − τ of every slack and multiplier.
    pub fn reach(&self, x: &[f64; N], dx: &[f64; N], (mu, tau): (f64, f64)) -> [f64; 2] {
        let longest = |value: f64, change: f64| if change < 0.0 { -tau * value / change } else { 1.0 };
        self.ends(x).fold([1.0, 1.0], |[of_x, of_z], end| {
            let dx = dx[end.i];
            [of_x.min(longest(end.slack, end.sign * dx)), of_z.min(longest(end.z, end.change(dx, mu)))]
        })
    }

    /// Takes a part of the change of the multipliers, as x passes to `next`.
    pub fn advance(&mut self, (x, dx, next): (&[f64; N], &[f64; N], &[f64; N]), mu: f64, part: f64) {
        let before = *self;
        for (old, new) in before.ends(x).zip(before.ends(next)) {
            let z = old.z + part * old.change(dx[old.i], mu);
            let balanced = mu / new.slack;
            self.multipliers[old.side][old.i] = z.clamp(balanced / RATIO, balanced * RATIO);
        }
    }
}

/// The nearest point that keeps a margin from the ends.
fn moved_inside(x: f64, least: f64, most: f64) -> f64 {
    if least >= most {
        return least;
    }
    let width = most - least;
    let margin = if width.is_finite() { MARGIN * width } else { MARGIN };
    x.max(least + margin).min(most - margin)
}
