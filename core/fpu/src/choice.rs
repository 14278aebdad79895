//! Which loops a target takes: part of the build script, and of a test.

/// The environment variable that overrules the choice: `arm` or `portable`.
pub const OPTION: &str = "LEASTACTION_FPU";

/// A target as cargo describes it to a build script.
pub struct Target<'a> {
    /// Its name, such as `thumbv7em-none-eabihf`.
    pub triple: &'a str,
    /// `arm`, for 32 bits.
    pub architecture: &'a str,
    /// `eabihf` where numbers are passed in the registers of the floating-point unit.
    pub abi: &'a str,
    /// Features of the processor, separated by commas; a stable compiler names none for ARM.
    pub features: &'a str,
}

/// Whether a target takes the loops in ARM's instructions: processors that convert numbers in half precision (VFPv4, or VFPv3
/// with its half-precision extension), and have Thumb-2 or ARM's own instructions for the rest.
///
/// Every floating-point unit of a Cortex-M does (FPv4-SP, FPv5 and later), and a target with the calling convention `eabihf` has
/// one. Of the other profiles some do (Cortex-A7) and some do not (Cortex-A8, R4F, R5F), and their targets do not tell them apart;
/// a nightly compiler's list of features does.
///
/// # Errors
/// Another value of the option than `arm` and `portable`, and `arm` where the processor passes no numbers in those registers.
pub fn choose(target: &Target<'_>, option: Option<&str>) -> Result<bool, String> {
    let registers = target.architecture == "arm" && target.abi == "eabihf";
    let microcontroller = ["thumbv7em-", "thumbv8m.main-", "thumbv8.1m.main-"]
        .iter()
        .any(|name| target.triple.starts_with(name));
    let listed = target.features.split(',').any(|feature| feature == "vfp4");
    match option {
        None => Ok(registers && (microcontroller || listed)),
        Some("portable") => Ok(false),
        Some("arm") if registers => Ok(true),
        Some("arm") => Err(format!("{OPTION}=arm: {} is not an ARM target of the ABI eabihf", target.triple)),
        Some(other) => Err(format!("{OPTION} is `{other}`, but must be `arm` or `portable`")),
    }
}
