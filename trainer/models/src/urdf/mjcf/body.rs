//! Elements inside a body.

use super::Settings;
use crate::tree::Pose;
use crate::urdf::error::UrdfError;
use roxmltree::Node;

/// An element of a body, with the pose of the `<frame>` around it and the class that holds for it.
pub(super) struct Member<'a, 'i> {
    pub node: Node<'a, 'i>,
    pub frame: Pose,
    pub class: Option<&'a str>,
}

/// Elements of a body in the order of the file, those inside frames included.
pub(super) fn members<'a, 'i>(
    body: Node<'a, 'i>,
    class: Option<&'a str>,
    settings: &Settings,
) -> Result<Vec<Member<'a, 'i>>, UrdfError> {
    let (mut found, mut open) = (Vec::new(), within(body, Pose::identity(), class));
    while let Some(member) = open.pop() {
        if member.node.has_tag_name("frame") {
            let pose = member.frame.then(&settings.pose(member.node, None)?);
            let class = member.node.attribute("childclass").or(member.class);
            open.extend(within(member.node, pose, class));
        } else {
            found.push(member);
        }
    }
    Ok(found)
}

/// Elements directly inside a body or frame, the last one first.
fn within<'a, 'i>(node: Node<'a, 'i>, frame: Pose, class: Option<&'a str>) -> Vec<Member<'a, 'i>> {
    let elements = node.children().filter(Node::is_element);
    let mut members: Vec<Member> = elements.map(|node| Member { node, frame, class }).collect();
    members.reverse();
    members
}
