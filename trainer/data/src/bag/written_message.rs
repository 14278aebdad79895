//! `sensor_msgs/JointState` in CDR, to be written: XCDR version 1, little-endian.

use super::writing::JointSample;

/// Name of the type.
pub(super) const TYPE: &str = "sensor_msgs/msg/JointState";

/// Definition of the type and of those within it, as ROS 2 stores it in a bag.
pub(super) const DEFINITION: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// A message at this stamp.
pub(super) fn cdr(nanoseconds: u64, joints: &[String], sample: &JointSample) -> Vec<u8> {
    let mut body = Body::default();
    body.count((nanoseconds / 1_000_000_000) as usize);
    body.count((nanoseconds % 1_000_000_000) as usize);
    body.text("");
    body.count(joints.len());
    joints.iter().for_each(|joint| body.text(joint));
    [&sample.position, &sample.velocity, &sample.effort].into_iter().for_each(|values| body.reals(values));
    [&[0, 1, 0, 0][..], &body.0].concat()
}

/// The fields of a message, each at a multiple of its size.
#[derive(Default)]
struct Body(Vec<u8>);

impl Body {
    fn align(&mut self, to: usize) {
        self.0.resize(self.0.len().next_multiple_of(to), 0);
    }

    fn count(&mut self, count: usize) {
        self.align(4);
        self.0.extend((count as u32).to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    fn reals(&mut self, values: &[f64]) {
        self.count(values.len());
        if !values.is_empty() {
            self.align(8);
        }
        values.iter().for_each(|value| self.0.extend(value.to_le_bytes()));
    }
}
