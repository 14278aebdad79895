# Sourced by all scripts that build for a chip. `compiler TARGET` sets `cargo` to a command and `rustc` to its compiler: rustup's target if
# it is installed or can be, else Debian's compiler with the standard library's source, which it installs if missing; where neither can be
# had, the script is skipped.
source "$(dirname "${BASH_SOURCE[0]}")/../../.ci/needs.sh"

# LEASTACTION_CHIP_PACKAGED tells later scripts that rustup lacks the target, because asking may take a minute.
compiler() {
    local target=$1
    if [ -z "${LEASTACTION_CHIP_PACKAGED:-}" ]; then
        if [ -d "$(rustc --print target-libdir --target "$target")" ] ||
            { command -v rustup >/dev/null && timeout 60 rustup target add "$target" >/dev/null 2>&1; }; then
            cargo=(cargo) rustc=rustc
            return
        fi
        export LEASTACTION_CHIP_PACKAGED=1
    fi
    if ! [ -x /usr/bin/rustc ] || ! [ -d /usr/lib/rustlib/src/rust/library/core ] || ! [ -x /usr/bin/ld.lld ]; then
        install rustc-web rust-web-src lld
    fi
    # Debian's compiler comes without the linker that it asks for.
    local linker=CARGO_TARGET_$(tr a-z- A-Z_ <<<"$target")_LINKER=/usr/bin/ld.lld
    rustc=/usr/bin/rustc
    cargo=(env RUSTC=$rustc RUSTC_BOOTSTRAP=1 "$linker" cargo -Zbuild-std=core)
}
