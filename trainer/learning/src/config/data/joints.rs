//! Comparison of column names with the joint names of a robot description.

use super::columns::ColumnsConfig;
use crate::data::Column;

/// Columns that name the joints of a model in another order than the model has them.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherOrder {
    /// Key under `[data.columns]`.
    pub key: &'static str,
    /// Problem and remedy.
    pub message: String,
}

impl ColumnsConfig {
    /// The first list of columns that names these joints in another order; `None` if there is none. Drives behind an
    /// actuation matrix have an order of their own.
    pub(in crate::config) fn in_other_order(&self, joints: &[&str]) -> Option<OtherOrder> {
        let forces = if self.columns.actuation.is_none() { &self.columns.u[..] } else { &[] };
        let others = self.other_u.iter().filter(|_| self.columns.actuation.is_none());
        let lists = [("q", &self.columns.q[..]), ("v", &self.columns.v), ("u", forces)];
        let mut lists = lists.into_iter().chain(others.map(|other| ("other_u", &other[..])));
        lists.find_map(|(key, columns)| in_other_order(key, columns, joints))
    }
}

/// Complains only if the columns name all joints: other names may count from 0 where the joints count from 1.
fn in_other_order(key: &'static str, columns: &[Column], joints: &[&str]) -> Option<OtherOrder> {
    let named: Vec<usize> =
        columns.iter().map(|column| joint_of(&column.name, joints)).collect::<Option<_>>()?;
    let place = named.iter().enumerate().find_map(|(k, joint)| (k != *joint).then_some(k))?;
    let of = |k: usize| named.iter().position(|joint| *joint == k).map(|at| columns[at].name.as_str());
    let right = (0..joints.len()).map(of).collect::<Option<Vec<&str>>>()?;
    let message = format!(
        "column {:?} is given for joint {:?}; the coordinates of the model are the joints {}, in this order: write {key} = {right:?}",
        columns[place].name,
        joints[place],
        joints.join(", "),
    );
    Some(OtherOrder { key, message })
}

/// The joint whose name stands in the name of a column as whole words; of several the one with the longest name.
fn joint_of(column: &str, joints: &[&str]) -> Option<usize> {
    let named = (0..joints.len()).filter(|k| has_words(column, joints[*k]));
    named.max_by_key(|k| joints[*k].len())
}

/// Whether a text contains these words, upper or lower case, between its ends or characters that are neither letters nor
/// digits.
fn has_words(text: &str, words: &str) -> bool {
    let (text, words) = (text.to_lowercase(), words.to_lowercase());
    let is_end = |c: Option<char>| !c.is_some_and(char::is_alphanumeric);
    let stands = |(at, found): (usize, &str)| {
        is_end(text[..at].chars().next_back()) && is_end(text[at + found.len()..].chars().next())
    };
    !words.is_empty() && text.match_indices(&words).any(stands)
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOINTS: [&str; 3] = ["shoulder_pan_joint", "elbow_joint", "pan_joint"];

    fn columns(q: [&str; 3]) -> ColumnsConfig {
        let all = |names: [&str; 3]| names.map(Column::si).to_vec();
        let columns = crate::data::Columns {
            t: Column::si("t"),
            q: all(q),
            v: Vec::new(),
            u: all(["tau_a", "tau_b", "tau_c"]),
            actuation: None,
        };
        ColumnsConfig { columns, other_u: Vec::new() }
    }

    #[test]
    fn columns_in_the_order_of_the_joints_are_fine() {
        for q in [
            ["shoulder_pan_joint_position", "elbow_joint_position", "pan_joint_position"],
            ["/js/shoulder_pan_joint/position", "/js/elbow_joint/position", "/js/pan_joint/position"],
            ["q1", "q2", "q3"],
            ["elbow_joint.pos", "q2", "q3"],
            ["elbow_jointed", "my_elbow_joint2", "elbow_joints"],
        ] {
            assert_eq!(columns(q).in_other_order(&JOINTS), None, "{q:?}");
        }
    }

    #[test]
    fn columns_in_another_order_are_named_with_the_right_one() {
        let found = columns(["elbow_joint/pos", "pan_joint/pos", "shoulder_pan_joint/pos"]);
        let OtherOrder { key, message } = found.in_other_order(&JOINTS).unwrap();
        assert_eq!(key, "q");
        let right = r#"write q = ["shoulder_pan_joint/pos", "elbow_joint/pos", "pan_joint/pos"]"#;
        assert!(message.contains(right) && message.contains("elbow_joint/pos"), "{message}");
    }

    #[test]
    fn torques_in_another_order_are_found_unless_drives_have_their_own() {
        let mut own = columns(["a", "b", "c"]);
        own.columns.u = ["ELBOW_JOINT", "Shoulder_Pan_Joint", "pan_joint"].map(Column::si).to_vec();
        assert_eq!(own.in_other_order(&JOINTS).unwrap().key, "u");
        own.other_u = vec![own.columns.u.clone()];
        own.columns.u = ["a", "b", "c"].map(Column::si).to_vec();
        assert_eq!(own.in_other_order(&JOINTS).unwrap().key, "other_u");
        own.columns.actuation = Some(vec![vec![1.0; 3]; 3]);
        assert_eq!(own.in_other_order(&JOINTS), None);
    }
}
