#!/usr/bin/env bash
# Compiles every template for its chip, and runs their loop on the emulated boards, whose traces must be the desk's. Prints a line for each:
# what was compiled, what ran, and the bytes of flash. Installs what is missing (.ci/needs.sh).
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

# The C templates: their loop on this machine and on an emulated Cortex-M4F, the hook of Arduino's library, and the CMake project.
if wanted c; then
    (
        source ../chip/compiler.sh
        chip=thumbv7em-none-eabihf features=(--no-default-features --features bodies,friction) out=$target/c
        need arm-none-eabi-gcc:gcc-arm-none-eabi qemu-system-arm:qemu-system-arm cmake:cmake
        mkdir -p "$out/include"
        export LEASTACTION_COORDINATES=2 CARGO_TARGET_DIR=$target
        library=(build --quiet --release --lib --manifest-path ../../core/c/Cargo.toml "${features[@]}")
        cargo "${library[@]}" --target-dir "$out"
        cargo run --quiet --manifest-path ../../core/c/tools/Cargo.toml "${features[@]}" --target-dir "$out" --bin header >"$out/include/leastaction.h"
        models=../chip/models
        c/model.sh $models/cartpole-dry.postcard $models/swing-up.postcard >"$out/model.c"
        strict=(-std=c11 -O2 -Wall -Wextra -Wconversion -Wpedantic -Werror -DMODEL_Q=0 -I "$out/include" -I c -I ../../core/c/example)
        sources=(c/emulated/main.c c/machine.c "$out/model.c")
        gcc "${strict[@]}" "${sources[@]}" ../../core/c/example/host.c "$out/release/libleastaction.a" -o "$out/loop"
        expected=$("$out/loop")
        printf 'loop in C on this machine: %s\n' "${expected//$'\n'/, }"

        compiler $chip
        "${cargo[@]}" "${library[@]}" --target $chip --target-dir "$out" --config "target.$chip.rustflags=['-Ctarget-cpu=cortex-m4']"
        m4=(-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -ffreestanding -ffp-contract=off)
        arm-none-eabi-gcc "${m4[@]}" "${strict[@]}" -nostdlib -Wl,-z,noexecstack -T ../../core/c/example/chip.ld "${sources[@]}" ../../core/c/example/chip.c \
            "$out/$chip/release/libleastaction.a" -lgcc -o "$out/loop.elf"
        found=$(timeout 300 qemu-system-arm -M mps2-an386 -display none -monitor none -serial none -chardev stdio,id=out \
            -semihosting-config enable=on,target=native,chardev=out -kernel "$out/loop.elf")
        [ "$found" = "$expected" ] || { echo "the loop in C on cortex-m4f: $found" >&2 && exit 1; }
        printf 'loop in C on cortex-m4f: the same\n'

        gcc -c "${strict[@]}" "$out/model.c" -o "$out/model.o"
        g++ -std=c++11 -Wall -Wextra -Wconversion -Wpedantic -Werror -I "$out/include" -I c/arduino/src c/arduino/check.cpp "$out/model.o" \
            "$out/release/libleastaction.a" -o "$out/arduino"
        printf 'arduino: %s\n' "$("$out/arduino")"
        c/arduino/build.sh bodies,friction "$out/LeastAction"
        arm-none-eabi-g++ "${m4[@]}" -std=c++11 -Wall -Wextra -Werror -fsyntax-only -x c++ "$out/LeastAction/src/LeastAction.h"

        rm -rf "$out/cmake"
        cmake -S c/cmake -B "$out/cmake" -DCMAKE_TOOLCHAIN_FILE=arm-none-eabi.cmake >/dev/null
        cmake --build "$out/cmake" >"$out/cmake.log" 2>&1 || { cat "$out/cmake.log" >&2 && exit 1; }
        printf 'cmake: compiled, %d bytes of flash\n' "$(flash "$out/cmake/machine.elf")"
    )
fi

if wanted loop; then
    (
        cd ../chip
        source ./tools.sh
        need_emulator qemu-system-arm
        need_emulator qemu-system-riscv32
        for board in "${boards[@]}"; do
            build "$board" --bin board_loop
            output=$(emulate "$board" "$(program "$board" board_loop)" 0 2>&1)
            [ "$(value hash)" = "$(cat ../boards/expected.txt)" ] || { echo "the loop on $board: trace $(value hash)" >&2 && exit 1; }
            printf 'loop on %s: the trace of this machine, %s\n' "$board" "$(value hash)"
        done
    )
fi
