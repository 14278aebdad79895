//! Points of a mechanism, and what is drawn between them.

use leastaction_models::tree::{Body, Joint, Tree, reach};
use nalgebra::Vector3;

/// A point of the mechanism, at rest in the frame of a body or, without one, of the base.
struct Point {
    carrier: Option<usize>,
    at: Vector3<f64>,
}

/// Part of a drawing, between points with these numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Line of a link.
    Link(usize, usize),
    /// Line along which a body slides.
    Rail(usize, usize),
    /// Joint that turns.
    Pivot(usize),
    /// Sliding body at a point, on the rail between two others.
    Block(usize, [usize; 2]),
}

/// Points of a mechanism and the parts between them.
pub struct Skeleton {
    tree: Tree,
    points: Vec<Point>,
    /// Parts, from the back to the front.
    pub parts: Vec<Part>,
    /// Numbers of the points at the ends of the last links.
    pub tips: Vec<usize>,
}

impl Skeleton {
    /// Skeleton of a tree whose coordinates move within these ranges, which are the lengths of the rails.
    pub fn new(tree: Tree, ranges: &[[f64; 2]]) -> Self {
        let base = Point { carrier: None, at: Vector3::zeros() };
        let origin = |carrier| Point { carrier: Some(carrier), at: Vector3::zeros() };
        let points = std::iter::once(base).chain((0..tree.bodies().len()).map(origin)).collect();
        let mut own = Self { tree, points, parts: Vec::new(), tips: Vec::new() };
        for i in 0..own.tree.bodies().len() {
            own.add_body(i, ranges);
        }
        own.parts.sort_by_key(|part| match part {
            Part::Rail(..) => 0,
            Part::Link(..) => 1,
            Part::Block(..) => 2,
            Part::Pivot(..) => 3,
        });
        own
    }

    /// Gravity in the frame of the base.
    pub fn gravity(&self) -> Vector3<f64> {
        self.tree.gravity
    }

    /// All points in the frame of the base.
    pub fn at(&self, q: &[f64]) -> Vec<Vector3<f64>> {
        let poses = self.tree.poses(q);
        let place = |point: &Point| match point.carrier {
            Some(body) => poses[body].translation + poses[body].rotation * point.at,
            None => point.at,
        };
        self.points.iter().map(place).collect()
    }

    fn add(&mut self, carrier: Option<usize>, at: Vector3<f64>) -> usize {
        self.points.push(Point { carrier, at });
        self.points.len() - 1
    }

    fn add_body(&mut self, i: usize, ranges: &[[f64; 2]]) {
        let body = self.tree.bodies()[i].clone();
        let (before, origin) = (body.parent.map_or(0, |parent| parent + 1), i + 1);
        match body.joint {
            Joint::Revolute(_) => self.parts.extend([Part::Link(before, origin), Part::Pivot(origin)]),
            Joint::Prismatic(_) => self.add_slide(&body, (before, origin), ranges),
        }
        let is_last = self.tree.bodies().iter().all(|other| other.parent != Some(i));
        if is_last {
            self.add_tip(i, &body);
        }
    }

    /// Rail on the parent, with the block that slides on it.
    fn add_slide(&mut self, body: &Body, (before, origin): (usize, usize), ranges: &[[f64; 2]]) {
        let range = ranges.get(body.coordinate).copied().unwrap_or_default();
        let along = |q: f64| body.pose.translation + body.pose.rotation * body.joint.axis() * q;
        let ends = range.map(|q| self.add(body.parent, along(body.ratio * q + body.offset)));
        let foot = self.add(body.parent, along(0.0));
        self.parts.extend([
            Part::Link(before, foot),
            Part::Rail(ends[0], ends[1]),
            Part::Block(origin, ends),
        ]);
    }

    /// Adds the [end](reach) of a last link.
    fn add_tip(&mut self, i: usize, body: &Body) {
        let turns = matches!(body.joint, Joint::Revolute(_));
        let at = reach((body.inertia.mass(), body.inertia.moment()), turns);
        let tip = self.add(Some(i), at);
        self.parts.push(Part::Link(i + 1, tip));
        self.tips.push(tip);
    }
}
