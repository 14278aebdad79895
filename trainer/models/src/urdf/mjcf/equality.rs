//! Equality constraints of joints, which are followers.

use super::Found;
use super::values::{line, numbers, wrong};
use crate::urdf::error::{MOST_LINKS, UrdfError};
use crate::urdf::note::DescriptionNote;
use roxmltree::Node;

/// Reads all active constraints; those that no follower can be are noted.
pub(super) fn read(root: Node, found: &mut Found) {
    let all = root.children().filter(|node| node.has_tag_name("equality"));
    let active = all.flat_map(|all| all.children()).filter(|node| is_active(*node));
    for (k, node) in active.enumerate() {
        if k >= MOST_LINKS {
            found
                .faults
                .push(wrong(node, format!("is one constraint more than the {MOST_LINKS} that are read")));
            return;
        }
        let done = if node.has_tag_name("joint") { found.follow(node) } else { found.pass_over(node) };
        found.faults.take(done);
    }
}

fn is_active(node: Node) -> bool {
    node.is_element() && node.attribute("active") != Some("false")
}

impl Found {
    fn pass_over(&mut self, node: Node) -> Result<(), UrdfError> {
        let tag = node.tag_name().name();
        self.notes.push(DescriptionNote::NotRead {
            what: format!(
                "the constraint <{tag}> of line {}, which closes a loop or ties what moves together",
                line(node)
            ),
        });
        Ok(())
    }

    /// Makes a joint follow another one: y = y₀ + a₀ + a₁ (x − x₀).
    fn follow(&mut self, node: Node) -> Result<(), UrdfError> {
        let name = node.attribute("joint1").ok_or_else(|| wrong(node, "needs joint1"))?;
        let zero = |name: &str| self.zeros.get(name).copied();
        let y = zero(name).ok_or_else(|| wrong(node, format!("joint1: no joint is called {name:?}")))?;
        let mut factors = [0.0, 1.0, 0.0, 0.0, 0.0];
        if let Some(text) = node.attribute("polycoef") {
            let given = numbers(node, ("polycoef", text), 1..=5)?;
            factors.iter_mut().zip(given).for_each(|(factor, given)| *factor = given);
        }
        let [a, b, curved @ ..] = factors;
        let leader = node.attribute("joint2").map(|leader| (leader.to_owned(), zero(leader).unwrap_or(0.0)));
        if curved != [0.0; 3] {
            let what = format!(
                "the curve by which joint {name} follows another one (line {}); its tangent is",
                line(node)
            );
            self.notes.push(DescriptionNote::NotRead { what });
        }
        let mimic = leader.map(|(leader, x)| (leader, b, y + a - b * x));
        let Some(joint) = self.joints.iter_mut().find(|joint| joint.name == name) else { return Ok(()) };
        match mimic {
            Some(mimic) => joint.mimic = Some(mimic),
            None => joint.rests = Some(y + a),
        }
        Ok(())
    }
}
