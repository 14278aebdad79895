#!/usr/bin/env bash
# Makes the library's folder for the Arduino IDE or PlatformIO, with the compiled library and its header for a model's family and sizes
# (LEASTACTION_COORDINATES and the other variables of core/c/README.md):
#   build.sh FAMILY[,FEATURE]… FOLDER
set -euo pipefail
[ $# = 2 ] || { echo "usage: build.sh FAMILY[,FEATURE]… FOLDER" >&2 && exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
folder=$(realpath -m "$2")
target=thumbv7em-none-eabihf
mkdir -p "$folder"
cp -r "$here"/{library.properties,library.json,src,examples} "$folder"
cd "$here/../../../../core/c"
out=${CARGO_TARGET_DIR:-$PWD/target}
source ../../firmware-sim/chip/compiler.sh
(cd tools && cargo run --quiet --bin header --no-default-features --features "$1" --target-dir "$out") >"$folder/src/leastaction.h"
compiler $target
# Cores of Arduino name the folder by processor and floating-point unit.
RUSTFLAGS=-Ctarget-cpu=cortex-m4 "${cargo[@]}" build --quiet --release --lib --target $target --target-dir "$out/chip" --no-default-features \
    --features "$1"
mkdir -p "$folder/src/cortex-m4/fpv4-sp-d16-hard"
cp "$out/chip/$target/release/libleastaction.a" "$folder/src/cortex-m4/fpv4-sp-d16-hard"
