//! Models that are refused, each with the line and the reason.

use super::{MASS, world};
use leastaction_models::urdf::{Inertias, parse, read};
use std::fs;

fn error(text: &str) -> String {
    parse(text, Inertias::Required).unwrap_err().to_string()
}

fn refused(text: &str, words: &[&str]) {
    let error = error(text);
    assert!(words.iter().all(|word| error.contains(word)), "{error}");
}

#[test]
fn models_that_cannot_be_read_say_why() {
    let one = |inside: &str| world(&format!("\n<body name='a'>\n<joint name='j'/>{inside}</body>"));
    refused(
        &one("<geom name='shell' type='mesh' mesh='m'/>"),
        &["link a", "joint j", "shell is a mesh", "<inertial>"],
    );
    refused(&one("<geom type='box' size='1 1'/>"), &["line 3", "<geom> size", "3 number"]);
    refused(&one("<geom type='egg' size='1'/>"), &["line 3", "egg"]);
    refused(&one("<geom size='1' pos='0 x 0'/>"), &["line 3", "pos", "0 x 0"]);
    refused(&one(&format!("{MASS}<joint axis='0 0 0'/>")), &["<joint> axis"]);
    refused(&one(&format!("{MASS}<joint type='screw'/>")), &["screw"]);
    refused(&one(&format!("{MASS}<joint class='none'/>")), &["class", "none"]);
    refused(&one(&format!("{MASS}<joint name='j'/>")), &["joint j stands twice"]);
    refused(&one("<inertial mass='1'/>"), &["<inertial> needs pos"]);
    refused(&one("<replicate count='3'><geom size='1'/></replicate>"), &["<replicate>", "mj_saveLastXML"]);
    refused(&one("<include file='x.xml'/>"), &["<include>"]);
    refused(&one(""), &["link a", "no mass"]);
    refused(
        &world(&format!("<body quat='1 0 0 0' euler='1 0 0'>{MASS}<joint/></body>")),
        &["both quat and euler"],
    );
    refused(&one(MASS).replace("radian'", "radian' coordinate='global'"), &["coordinate"]);
    refused(&one(MASS).replace("radian'", "radian' eulerseq='xyq'"), &["eulerseq", "xyq"]);
    refused("<mujoco><worldbody/></mujoco>", &["no body moves"]);
    refused("<sdf/>", &["<sdf>", "<robot>", "<mujoco>"]);
}

#[test]
fn deep_models_are_read_without_recursion() {
    let depth = 2000;
    let body = format!("<body>{MASS}<joint/>");
    let text = world(&(body.repeat(depth) + &"</body>".repeat(depth)));
    assert_eq!(parse(&text, Inertias::Required).unwrap().coordinates(), depth);
}

#[test]
fn included_files_stand_in_their_places() {
    let folder = std::env::temp_dir().join(format!("leastaction-include-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let file = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    file("arm.xml", &world(&format!("<body name='a'>{MASS}<joint name='j'/><include file='b.xml'/></body>")));
    file("b.xml", &format!("<mujocoinclude><body name='b'>{MASS}<joint name='k'/></body></mujocoinclude>"));
    file("scene.xml", "<mujoco><include file='arm.xml'/><option gravity='0 0 -1.5'/></mujoco>");
    file("itself.xml", "<mujoco><include file='itself.xml'/></mujoco>");
    file("lost.xml", "<mujoco>\n<include file='nowhere.xml'/></mujoco>");
    let of = |name: &str| read(&folder.join(name), Inertias::Required);
    let tree = of("scene.xml").unwrap();
    assert_eq!((tree.coordinates(), tree.gravity.z), (2, -1.5));
    assert!(of("itself.xml").unwrap_err().to_string().contains("include itself"));
    assert!(of("lost.xml").unwrap_err().to_string().contains("nowhere.xml"));
    fs::remove_dir_all(&folder).unwrap();
}
