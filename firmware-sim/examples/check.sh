#!/usr/bin/env bash
# Builds the examples for their chips and runs them under qemu: each must print its expected.txt. Installs what is missing.
set -euo pipefail
cd "$(dirname "$0")"
target=thumbv7em-none-eabihf
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}

fail() {
    printf '%s\n' "$*" >&2
    exit 1
}

source ../chip/compiler.sh
need qemu-system-arm:qemu-system-arm
compiler "$target"

# The model must equal the golden file.
hexadecimal=$(grep -v '^#' ../../core/tests/golden/cartpole.hex | tr -d ' \n')
[ "$(od -An -v -tx1 cartpole.postcard | tr -d ' \n')" = "$hexadecimal" ] ||
    fail "cartpole.postcard is not core/tests/golden/cartpole.hex: in core/c/tools, cargo run --bin bytes < … > …"

for example in plain-loop rtic; do
    (
        cd "$example"
        cargo fmt --check
        found=$(timeout 600 "${cargo[@]}" run --quiet --release) || fail "$example failed: $found"
        diff expected.txt - <<<"$found" || fail "$example prints something else"
        printf '%s: %s\n' "$example" "$(tail -n 1 expected.txt)"
    )
done
