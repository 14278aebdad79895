# Sourced by all scripts that build for a chip. `compiler TARGET` sets `cargo` to a command: rustup's target if it is installed or can be,
# else the same compiler with the standard library's source, a component of rustup; where neither can be had, the script is skipped.
source "$(dirname "${BASH_SOURCE[0]}")/../../.ci/needs.sh"

added() { command -v rustup >/dev/null && timeout 120 rustup "$@" >/dev/null 2>&1; }

compiler() {
    local target=$1
    cargo=(cargo)
    if [ -d "$(rustc --print target-libdir --target "$target")" ] || added target add "$target"; then return; fi
    if ! [ -d "$(rustc --print sysroot)/lib/rustlib/src/rust/library/core" ] && ! added component add rust-src; then
        skip "no Rust for $target: rustup target add $target, or rustup component add rust-src"
    fi
    cargo=(env RUSTC_BOOTSTRAP=1 cargo -Zbuild-std=core)
}
