#!/usr/bin/env bash
# Builds a portable wheel in DIR: for every x86-64-v2, with builds for AVX2 and AVX-512 beside it; on other processors one build.
#   trainer/python/wheel.sh DIR
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
to=${1:?name a folder for the wheel}
target=${CARGO_TARGET_DIR:-$here/../../target}
package=$here/python/leastaction
trap 'rm -rf "$package"/x86_64_v[34]' EXIT

if [ "$(uname -m)" = x86_64 ]; then
    for level in 3 4; do
        RUSTFLAGS="-Ctarget-cpu=x86-64-v$level" cargo build --manifest-path "$here/Cargo.toml" --profile wheel \
            --target-dir "$target/x86-64-v$level"
        mkdir -p "$package/x86_64_v$level"
        cp "$target/x86-64-v$level/wheel/lib_leastaction.so" "$package/x86_64_v$level/_leastaction.abi3.so"
    done
    export RUSTFLAGS="-Ctarget-cpu=x86-64-v2"
fi
CARGO_TARGET_DIR=$target/portable python3 -m pip wheel --no-deps --wheel-dir "$to" "$here"
