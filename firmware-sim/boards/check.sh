#!/usr/bin/env bash
# Compiles every template for its chip, and runs their loop on the emulated boards, whose traces must be the desk's. Prints a line for each:
# what was compiled, what ran, and the bytes of flash. Installs what is missing.
#   check.sh [TEMPLATE]…
set -euo pipefail
cd "$(dirname "$0")"
asked=" $* "
wanted() { [ "$asked" = "  " ] || [[ $asked == *" $1 "* ]]; }
target=${CARGO_TARGET_DIR:-$PWD/../../target/boards}

# Prints the bytes that a program takes in flash.
flash() {
    local bytes=0 kind size
    while read -r kind _ _ _ size _; do
        [ "$kind" != LOAD ] || bytes=$((bytes + size))
    done < <(readelf -lW "$1")
    echo $bytes
}

# Compiles a template of Rust: folder, target, further arguments.
compile() {
    wanted "$1" || return 0
    (
        source ../chip/compiler.sh
        cd "$1"
        cargo fmt --check
        compiler "$2"
        "${cargo[@]}" build --quiet --release --target "$2" --target-dir "$target" "${@:3}"
        printf '%s: compiled, %d bytes of flash\n' "$*" "$(flash "$target/$2/release/leastaction-$1")"
    )
}

compile stm32 thumbv7em-none-eabihf --features nucleo-f446re
compile stm32 thumbv7em-none-eabihf --features nucleo-g474re
compile pico2 thumbv8m.main-none-eabihf
compile esp32c3 riscv32imc-unknown-none-elf

if wanted loop; then
    (
        cd ../chip
        source ./tools.sh
        for board in "${boards[@]}"; do
            build "$board" --bin board_loop
            output=$(emulate "$board" "$(program "$board" board_loop)" 0 2>&1)
            [ "$(value hash)" = "$(cat ../boards/expected.txt)" ] || { echo "the loop on $board: trace $(value hash)" >&2 && exit 1; }
            printf 'loop on %s: the trace of this machine, %s\n' "$board" "$(value hash)"
        done
    )
fi
