//! Which targets take the loops in ARM's instructions.

#[path = "../src/choice.rs"]
mod choice;

use choice::{Target, choose};

fn target<'a>(triple: &'a str, features: &'a str) -> Target<'a> {
    let architecture = if triple.starts_with("riscv32") {
        "riscv32"
    } else if triple.starts_with("x86_64") {
        "x86_64"
    } else {
        "arm"
    };
    let abi = ["eabihf", "eabi"].into_iter().find(|abi| triple.ends_with(abi)).unwrap_or("");
    Target { triple, architecture, abi, features }
}

fn chosen(triple: &str, features: &str) -> bool {
    choose(&target(triple, features), None).unwrap()
}

#[test]
fn every_cortex_m_with_a_floating_point_unit_takes_the_instructions() {
    for triple in ["thumbv7em-none-eabihf", "thumbv8m.main-none-eabihf", "thumbv8m.main-nuttx-eabihf"] {
        assert!(chosen(triple, ""), "{triple}");
    }
}

/// A Cortex-R5F has registers for numbers but no instruction for half precision: it would stop at the first.
#[test]
fn processors_without_half_precision_take_the_portable_loops() {
    let without = [
        "armv7r-none-eabihf",
        "armv8r-none-eabihf",
        "armv6-none-eabihf",
        "armv7a-none-eabihf",
        "armv7-unknown-linux-gnueabihf",
        "arm-unknown-linux-gnueabihf",
        "thumbv7em-none-eabi",
        "thumbv7m-none-eabi",
        "thumbv6m-none-eabi",
        "thumbv8m.main-none-eabi",
        "riscv32imac-unknown-none-elf",
        "x86_64-unknown-linux-gnu",
    ];
    for triple in without {
        assert!(!chosen(triple, "dsp,fpregs,vfp2,vfp3"), "{triple}");
    }
}

#[test]
fn a_compiler_that_lists_vfpv4_is_believed() {
    assert!(chosen("armv8r-none-eabihf", "d32,neon,vfp2,vfp3,vfp4"));
    assert!(!chosen("armv7-unknown-linux-gnueabi", "vfp4"));
}

#[test]
fn the_option_overrules() {
    let (m4, r5) = (target("thumbv7em-none-eabihf", ""), target("armv7r-none-eabihf", ""));
    assert_eq!(choose(&m4, Some("portable")), Ok(false));
    assert_eq!(choose(&r5, Some("arm")), Ok(true));
    assert!(choose(&target("thumbv7em-none-eabi", ""), Some("arm")).is_err());
    assert!(choose(&m4, Some("fast")).unwrap_err().contains("LEASTACTION_FPU"));
}
