//! Inertia of a body.

use super::Settings;
use super::body::Member;
use super::compiler::FromGeoms;
use super::values::{exactly, wrong};
use crate::tree::Inertia;
use crate::urdf::error::UrdfError;
use crate::urdf::parts::Link;
use nalgebra::{Matrix3, Vector3};
use roxmltree::Node;

impl Settings<'_> {
    /// The link of a body, in the frame of the body.
    pub fn link(&self, (node, name): (Node, &str), members: &[Member]) -> Result<Link, UrdfError> {
        let mut link = Link::empty(name, node.range());
        let inertial = members.iter().find(|member| member.node.has_tag_name("inertial"));
        let from_geoms = self.compiler.from_geoms;
        if let Some(inertial) = inertial.filter(|_| from_geoms != FromGeoms::Always) {
            link.has_inertial = true;
            link.inertia = self.inertial(inertial)?;
        } else if from_geoms != FromGeoms::Never {
            self.add_geoms(&mut link, members)?;
        }
        link.inertia = self.compiler.bounded(link.inertia);
        Ok(link)
    }

    fn add_geoms(&self, link: &mut Link, members: &[Member]) -> Result<(), UrdfError> {
        for geom in members.iter().filter(|member| member.node.has_tag_name("geom")) {
            match self.geom(geom)? {
                Ok(inertia) => link.inertia = link.inertia.with(&inertia),
                Err(unknown) => link.unknown = Some(unknown),
            }
        }
        Ok(())
    }

    fn inertial(&self, member: &Member) -> Result<Inertia, UrdfError> {
        let node = member.node;
        let needed = |what: &str| node.attribute(what).ok_or_else(|| wrong(node, format!("needs {what}")));
        let [mass] = exactly(node, ("mass", needed("mass")?))?;
        needed("pos")?;
        let about_centre = match (node.attribute("fullinertia"), node.attribute("diaginertia")) {
            (Some(text), _) => {
                let [xx, yy, zz, xy, xz, yz] = exactly(node, ("fullinertia", text))?;
                Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
            }
            (None, Some(text)) => Matrix3::from_diagonal(&exactly(node, ("diaginertia", text))?.into()),
            (None, None) => Matrix3::zeros(),
        };
        let pose = member.frame.then(&self.pose(node, None)?);
        let own = Inertia::of_centre(mass, Vector3::zeros(), about_centre);
        Ok(own.placed(&pose.rotation, &pose.translation))
    }
}
