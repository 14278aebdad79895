//! Choice of the loops for a target: part of the build script, and of a test.

/// Environment variable that overrules the choice: `arm` or `portable`.
pub const OPTION: &str = "LEASTACTION_FPU";

/// Description of a target that cargo gives a build script.
pub struct Target<'a> {
    /// Name of the target, such as `thumbv7em-none-eabihf`.
    pub triple: &'a str,
    /// Architecture; `arm` for 32 bits.
    pub architecture: &'a str,
    /// ABI; `eabihf` if numbers are passed in the registers of the floating-point unit.
    pub abi: &'a str,
    /// Features of the processor, separated by commas; a stable compiler names none for ARM.
    pub features: &'a str,
}

/// Whether a target takes the loops in ARM's instructions: its processors must convert numbers in half precision (VFPv4, or VFPv3 with its
/// half-precision extension), and have Thumb-2 or ARM's own instructions for the rest.
///
/// Every floating-point unit of a Cortex-M qualifies (FPv4-SP, FPv5 and later), and a target with the calling convention `eabihf` has such
/// a unit. In the other profiles some units qualify (Cortex-A7) and some do not (Cortex-A8, R4F, R5F), and their
/// targets do not distinguish them; a nightly compiler's list of features does.
///
/// # Errors
/// An error for a value of the option other than `arm` and `portable`, and for `arm` if the target passes no numbers
/// in the registers of the floating-point unit.
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
