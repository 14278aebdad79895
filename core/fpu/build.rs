//! Build script that decides which loops are compiled: `cfg(arm_instructions)` if the target's processors have what the loops need.

#[path = "src/choice.rs"]
mod choice;

use choice::{OPTION, Target, choose};
use std::env;

fn main() {
    println!("cargo:rustc-check-cfg=cfg(arm_instructions)");
    println!("cargo:rerun-if-changed=src/choice.rs");
    println!("cargo:rerun-if-env-changed={OPTION}");
    let variable = |name: &str| env::var(name).unwrap_or_default();
    let (triple, architecture) = (variable("TARGET"), variable("CARGO_CFG_TARGET_ARCH"));
    let (abi, features) = (variable("CARGO_CFG_TARGET_ABI"), variable("CARGO_CFG_TARGET_FEATURE"));
    let target = Target { triple: &triple, architecture: &architecture, abi: &abi, features: &features };
    match choose(&target, env::var(OPTION).ok().as_deref()) {
        Ok(true) => println!("cargo:rustc-cfg=arm_instructions"),
        Ok(false) => {}
        Err(message) => {
            eprintln!("{message}");
            std::process::exit(1);
        }
    }
}
