//! Writes the arm of `tests/days.py`, its description and a model file of the true arm: `two_links FILE.urdf FILE.postcard`.

use leastaction_models::urdf::{Inertias, parse};
use leastaction_models::{Architecture, ArmArchitecture, GroupLaws, Model, Number};
use std::error::Error;

/// An upper arm of 3 kg, whose axis leans, and a forearm of 1.5 kg.
const DESCRIPTION: &str = r#"<robot name="two links"><link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 0.2"/><mass value="3"/>
<inertia ixx="0.03" iyy="0.03" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0 0.15"/><mass value="1.5"/>
<inertia ixx="0.02" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="yaw" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.3" rpy="0.4 0 0"/><axis xyz="0 0.6 0.8"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/></joint></robot>
"#;
/// Inertia of the rotors, kg m².
const ROTOR: f64 = 0.1;
/// Viscous friction, N m s/rad.
const VISCOUS: [f64; 2] = [0.4, 0.3];
/// Coulomb friction (N m), its part that grows with the load, the largest of that, and its width (rad/s).
const COULOMB: [[f64; 4]; 2] = [[0.8, 0.0, 1.0, 0.05], [0.5, 0.0, 1.0, 0.05]];

fn main() -> Result<(), Box<dyn Error>> {
    let mut paths = std::env::args().skip(1);
    let mut path = || paths.next().ok_or("usage: two_links FILE.urdf FILE.postcard");
    std::fs::write(path()?, DESCRIPTION)?;
    let tree = parse(DESCRIPTION, Inertias::Required)?;
    let arm = ArmArchitecture::new(&tree, |_| false, |_| Number::known(ROTOR)).ok_or("the tree is no arm")?;
    let dry = COULOMB.map(|law| law.map(Number::known)).to_vec();
    let group_laws = GroupLaws::of_friction(VISCOUS.map(Number::known).to_vec(), dry);
    let architecture = Architecture { group_laws, ..arm.into() };
    let weights = architecture.initial_weights(0);
    Ok(std::fs::write(path()?, Model::new(architecture, weights).to_bytes()?)?)
}
