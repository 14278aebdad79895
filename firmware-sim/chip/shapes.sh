#!/usr/bin/env bash
# Measures models on the emulated chips: flash, RAM, stack and instructions of an image of exactly the model's sizes, one JSON line per board,
# model and order. `shapes.sh model.rs …` measures files from `leastaction export --rust`; without a file, the models of shapes.toml, to which
# the predictions of `leastaction inspect --target` are fitted and against which they are tested. `--board NAME` measures on one board.
set -euo pipefail
shopt -s inherit_errexit
files=() only=
while [ $# -gt 0 ]; do
    case $1 in
        --board) only=${2:?--board takes cortex-m4f, cortex-m7 or riscv32imac}; shift 2 ;;
        -*) echo "usage: shapes.sh [--board NAME] [MODEL.rs …]" >&2; exit 2 ;;
        *) files+=("$(realpath "$1")"); shift ;;
    esac
done
cd "$(dirname "$0")"
source ./tools.sh

folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
if [ ${#files[@]} = 0 ]; then
    (cd ../.. && CARGO_TARGET_DIR=$host_target cargo run --quiet --release --package leastaction-tests --example shapes "$folder") >"$folder/names"
    while read -r name; do files+=("$folder/$name.rs"); done <"$folder/names"
fi

for board in "${boards[@]}"; do
    case "$only" in "" | "$board") ;; *) continue ;; esac
    for file in "${files[@]}"; do
        for order in 2 4; do
            LEASTACTION_SHAPE=$file LEASTACTION_SHAPE_ORDER=$order build "$board" --features shape --bin shape
            elf=$(program "$board" shape)
            output=$(emulate "$board" "$elf" 2 2>&1) || { printf '%s on %s: %s\n' "$file" "$board" "$output" >&2; exit 1; }
            printf '{"board": "%s", "model": "%s", "order": %s, %s}\n' "$board" "$(basename "$file" .rs)" "$order" "$(measures "$elf")"
        done
    done
done
