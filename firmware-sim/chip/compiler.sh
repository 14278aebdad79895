# Sourced by all scripts that build for a chip. `compiler TARGET` sets `cargo` to a command: rustup's target if it is installed or can be,
# else the same compiler with the standard library's source, a component of rustup; where neither can be had, the script is skipped.
source "$(dirname "${BASH_SOURCE[0]}")/../../.ci/needs.sh"

# Sets `cargo`, or fails. LEASTACTION_TARGETS_FROM_SOURCE tells later scripts which targets rustup lacks, because asking may take minutes.
find_compiler() {
    local target=$1
    cargo=(cargo)
    if [[ " ${LEASTACTION_TARGETS_FROM_SOURCE:-} " != *" $target "* ]]; then
        if has_target "$target"; then return; fi
        export LEASTACTION_TARGETS_FROM_SOURCE="${LEASTACTION_TARGETS_FROM_SOURCE:-} $target"
    fi
    cargo=(env RUSTC_BOOTSTRAP=1 cargo -Zbuild-std=core)
    [ -d "$(rustc --print sysroot)/lib/rustlib/src/rust/library/core" ] || rustup_add component rust-src
}

compiler() { find_compiler "$1" || skip "no Rust for $1: rustup target add $1, or rustup component add rust-src"; }
