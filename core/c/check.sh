#!/usr/bin/env bash
# Builds the C library of every family for the host and for a Cortex-M4F, optimised for speed and for size; links the C example with it,
# which does not link if anything can panic; runs the example on the host and under qemu: both must print the hashes of the same steps in
# Rust and of the same plan followed there, and refuse every damaged file. Links two shapes into one image and runs both. The committed
# header must equal the generated one.
# `check.sh inertia-network` checks the named families only; without a name all five are checked, each with
# all its optional features.
set -euo pipefail
families=" ${*:-inertia-network modular graph bodies arm} "
cd "$(dirname "$0")"
target=thumbv7em-none-eabihf
out=${CARGO_TARGET_DIR:-$PWD/target}
work=$out/example
mkdir -p "$work"

source ../../firmware-sim/chip/compiler.sh
# GCC is useless without the headers of a C library, which come in another package.
if ! { command -v qemu-system-arm && command -v g++ && arm-none-eabi-gcc -E - <<<'#include <string.h>'; } >/dev/null 2>&1; then
    install g++ gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm
fi

compiler "$target"
chip=(env CARGO_TARGET_DIR="$out/chip" "${cargo[@]}" build --quiet --release --lib --target "$target")
# Host programs use the compiler that cargo finds.
host=(env CARGO_TARGET_DIR="$out" cargo)

tool() { "${host[@]}" run --quiet --manifest-path tools/Cargo.toml --bin "$@"; }

fail() {
    printf '%s\n' "$*" >&2
    exit 1
}

sources=(example/main.c example/trace.c example/errors.c example/follow.c example/plan_errors.c example/model.S)
adapting=(example/adapt.c example/adapt_errors.c)
warnings=(-Wall -Wextra -Wconversion -Wsign-conversion -Wpedantic -Werror)
strict=(-std=c11 -O2 "${warnings[@]}" -Wstrict-prototypes -Wmissing-prototypes -ffunction-sections -fdata-sections -Wl,--gc-sections)
m4=(-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16)

# Numbers as C's single-precision constants, separated by commas.
floats() {
    local x all=()
    for x in $1; do
        [[ $x == *.* ]] || x+=.0
        all+=("${x}f")
    done
    local IFS=,
    echo "${all[*]}"
}

# Checks the same sources with other compilers: as C with clang if it is installed, and the header as C++ with g++ and clang++.
other_compilers() {
    local file compilers=(g++)
    if command -v clang++ >/dev/null; then
        compilers+=(clang++)
        for file in "${sources[@]/%model.S/host.c}"; do
            clang -std=c11 "${warnings[@]}" -Wstrict-prototypes -Wmissing-prototypes -fsyntax-only "$@" "$file"
        done
    fi
    for compiler in "${compilers[@]}"; do
        for standard in c++11 c++20; do
            $compiler "-std=$standard" "${warnings[@]}" -fsyntax-only "$@" -x c++ - <<<'#include "leastaction.h"'
        done
    done
}

# Runs the example once and compares its output.
expect() {
    local name=$1 expected=$2
    shift 2
    local found
    found=$(timeout 300 "$@") || fail "$name failed: $found"
    [ "$found" = "$expected" ] || fail "$name: found $found, expected $expected"
    printf '%s: %s\n' "$name" "${found//$'\n'/; }"
}

check_host() {
    local family=$1 expected=$2
    shift 2
    other_compilers "$@"
    gcc "${strict[@]}" "$@" "${sources[@]}" example/host.c "$out/release/libleastaction.a" -o "$work/$family-host"
    expect "$family on the host" "$expected" "$work/$family-host"
}

check_chip() {
    local family=$1 level=$2 expected=$3 image=$work/$1-$2.elf
    shift 3
    "${chip[@]}" "${features[@]}" --config "profile.release.opt-level=$level"
    arm-none-eabi-gcc "${m4[@]}" "${strict[@]}" "$@" -nostdlib -Wl,-z,noexecstack -T example/chip.ld "${sources[@]}" example/chip.c \
        "$out/chip/$target/release/libleastaction.a" -lgcc -o "$image"
    # Functions that the example does not need must not panic either.
    if arm-none-eabi-nm "$out/chip/$target/release/libleastaction.a" 2>/dev/null | grep leastaction_panicked; then
        fail "$family holds a panic"
    fi
    # Double precision is emulated in software here, and would cost thousands of instructions.
    if arm-none-eabi-nm "$image" | grep -E ' __aeabi_(d|f2d)'; then fail "$family computes in double precision"; fi
    arm-none-eabi-size -A "$image" | awk '/^\.(text|rodata|data|bss) /{printf "%s %s  ", $1, $2} END {print ""}'
    expect "$family at opt-level $level on the chip" "$expected" qemu-system-arm -M mps2-an386 -display none \
        -monitor none -serial none -chardev stdio,id=out -semihosting-config enable=on,target=native,chardev=out -kernel "$image"
}

# A family: its golden file, the name in it, where it starts, and its sizes.
check() {
    local family=$1 golden=$2 name=$3 start=$4 hashes
    [[ $families == *" ${family%%,*} "* ]] || return 0
    shift 4
    features=(--no-default-features --features "$family")
    export "$@"
    tool bytes "${features[@]}" <"../tests/golden/$golden.hex" >"$work/$golden.bin"
    mkdir -p "$work/$family-include"
    tool header "${features[@]}" >"$work/$family-include/leastaction.h"
    # shellcheck disable=SC2086
    hashes=$(tool trace "${features[@]}" -- "$work/$golden.bin" "$name" "$work/$golden-plan.bin" $start)
    mapfile -t lines <<<"$hashes"
    local expected="${lines[0]}"$'\n''errors as they should be'$'\n'"${lines[1]}"$'\n''plans as they should be'
    local sources=("${sources[@]}")
    local defines=(-I "$work/$family-include" -I example "-DMODEL_FILE=\"$work/$golden.bin\"" "-DMODEL_Q=$(floats "$start")"
        "-DPLAN_FILE=\"$work/$golden-plan.bin\"")
    if [ "$golden" = cartpole ]; then
        tool bytes "${features[@]}" <../tests/golden/cartpole-whole.hex >"$work/cartpole-whole.bin"
        defines+=("-DWHOLE_FILE=\"$work/cartpole-whole.bin\"")
    fi
    if [[ $family == *adapt* ]]; then
        expected+=$'\n'"${lines[2]}"$'\n''adapters as they should be'
        sources+=("${adapting[@]}")
        defines+=("-DSETTINGS_FILE=\"$work/$golden-plan.settings\"" "-DMACHINE_FILE=\"$work/$golden-plan.machine\"")
    fi
    [ -z "$name" ] || defines+=("-DMODEL_NAME=\"$name\"")
    [ "$name" != ring ] || defines+=(-DRING)
    "${host[@]}" build --quiet --release --lib "${features[@]}"
    check_host "$family" "$expected" "${defines[@]}"
    for level in 3 '"s"'; do
        check_chip "$family" "$level" "$expected" "${defines[@]}"
    done
    unset "${@%%=*}"
}

# Builds one of two libraries for one image, given the prefix of its names, family, golden file, name in the file, start and sizes; prints
# the hash of its trace.
part() {
    local prefix=$1 family=$2 golden=$3 name=$4 start=$5
    shift 5
    local features=(--no-default-features --features "$family") parts=$work/$prefix
    export "$@" LEASTACTION_PREFIX=${prefix}_
    mkdir -p "$parts"
    tool bytes "${features[@]}" <"../tests/golden/$golden.hex" >"$work/$golden.bin"
    tool header "${features[@]}" >"$parts/leastaction.h"
    # shellcheck disable=SC2086
    tool trace "${features[@]}" -- "$work/$golden.bin" "$name" "" $start
    for file in trace.c model.S example.h; do
        sed "s/leastaction_/${prefix}_/g; s/LEASTACTION_/${prefix^^}_/g" "example/$file" >"$parts/$file"
    done
    local own=("-Dtrace=${prefix}_trace" "-Dmodel_file=${prefix}_model_file" "-Dmodel_file_end=${prefix}_model_file_end"
        "-DMODEL_FILE=\"$work/$golden.bin\"" "-DMODEL_Q=$(floats "$start")" -I "$parts")
    [ -z "$name" ] || own+=("-DMODEL_NAME=\"$name\"")
    "${host[@]}" build --quiet --release --lib "${features[@]}"
    cp "$out/release/libleastaction.a" "$parts/host.a"
    # Assembly functions keep their mangled names, which must differ too.
    "${chip[@]}" "${features[@]}" --config "target.$target.rustflags=['-Cmetadata=$prefix']"
    cp "$out/chip/$target/release/libleastaction.a" "$parts/chip.a"
    for file in trace.c model.S; do
        gcc "${strict[@]}" "${own[@]}" -c "$parts/$file" -o "$parts/host-$file.o"
        arm-none-eabi-gcc "${m4[@]}" "${strict[@]}" "${own[@]}" -c "$parts/$file" -o "$parts/chip-$file.o"
    done
    unset LEASTACTION_PREFIX "${@%%=*}"
}

# Checks that two shapes link into one image and that each gives the hash that it gives alone.
check_two() {
    local expected
    {
        part cart inertia-network cartpole "" "$cart" LEASTACTION_COORDINATES=2 LEASTACTION_HIDDEN=7 LEASTACTION_LAYERS=2
        part arm modular arm arm "$arm" LEASTACTION_COORDINATES=3 LEASTACTION_HIDDEN=5 LEASTACTION_LAYERS=2 LEASTACTION_TYPES=3
    } >"$work/two"
    expected=$(<"$work/two")
    # Shared code is compiled with either header.
    mkdir -p "$work/both"
    sed '/^int main/,$d' example/main.c >"$work/both/put.c"
    local shared=(-I "$work/cart" -I example "-DMODEL_Q=$(floats "$cart")" "$work/both/put.c" example/two.c)
    gcc "${strict[@]}" "${shared[@]}" example/host.c "$work"/{cart,arm}/host-*.o "$work"/{cart,arm}/host.a -o "$work/both/host"
    expect "two shapes on the host" "$expected" "$work/both/host"
    arm-none-eabi-gcc "${m4[@]}" "${strict[@]}" -nostdlib -Wl,-z,noexecstack -T example/chip.ld "${shared[@]}" example/chip.c \
        "$work"/{cart,arm}/chip-*.o "$work"/{cart,arm}/chip.a -lgcc -o "$work/both/chip.elf"
    expect "two shapes on the chip" "$expected" qemu-system-arm -M mps2-an386 -display none \
        -monitor none -serial none -chardev stdio,id=out -semihosting-config enable=on,target=native,chardev=out \
        -kernel "$work/both/chip.elf"
}

# The committed header is that of the default family and sizes.
tool header | diff include/leastaction.h - ||
    fail "the header is not up to date: in core/c/tools, cargo run --bin header > ../include/leastaction.h"
"${host[@]}" fmt --check
"${host[@]}" fmt --check --manifest-path tools/Cargo.toml
checked=${families/ graph / graph graph,rods }
checked=${checked/ bodies / bodies bodies,friction bodies,networks,servo bodies,adapt }
checked=${checked/ arm / arm arm,friction arm,networks arm,friction,servo,axes,adapt }
for family in ${checked/ inertia-network / inertia-network inertia-network,friction inertia-network,axes inertia-network,friction,networks,axes }; do
    features=(--no-default-features --features "$family")
    "${host[@]}" test --quiet --lib "${features[@]}"
    # Whatever their sizes, contents fit their structs where pointers have 32 bits.
    for size in 2 8 64; do
        LEASTACTION_COORDINATES=$size LEASTACTION_NUMBERS=$size CARGO_TARGET_DIR="$out/chip" \
            "${cargo[@]}" check --quiet --lib --target "$target" "${features[@]}"
    done
    "${host[@]}" clippy --version >/dev/null 2>&1 || continue
    "${host[@]}" clippy --quiet "${features[@]}" -- -D warnings
    "${host[@]}" clippy --quiet --manifest-path tools/Cargo.toml "${features[@]}" -- -D warnings
done

# An invalid size gives a clear error.
wrong=$(LEASTACTION_HIDDEN=many "${host[@]}" check --quiet --lib 2>&1) && fail "a wrong size was accepted"
[[ $wrong == *"LEASTACTION_HIDDEN must be a whole number from 1 to 1024"* ]] || fail "$wrong"

cart='0.125 0.25' arm='0.125 0.25 0.375'
check inertia-network cartpole "" "$cart" LEASTACTION_COORDINATES=2 LEASTACTION_HIDDEN=7 LEASTACTION_LAYERS=2
check inertia-network,half cartpole-f16 "" "$cart" LEASTACTION_COORDINATES=2 LEASTACTION_HIDDEN=7 LEASTACTION_LAYERS=2
check inertia-network,friction cartpole-friction "" "$cart" LEASTACTION_COORDINATES=2 LEASTACTION_HIDDEN=7 LEASTACTION_LAYERS=2
# A library with the feature `friction` must give, for a file without dry friction, the hash of the library without
# the feature.
check inertia-network,friction cartpole "" "$cart" LEASTACTION_COORDINATES=2 LEASTACTION_HIDDEN=7 LEASTACTION_LAYERS=2
# Likewise for the laws of axes: friction that sticks, friction by direction, end stops.
for golden in cartpole-axes cartpole; do
    check inertia-network,axes $golden "" "$cart" LEASTACTION_COORDINATES=2 LEASTACTION_HIDDEN=7 LEASTACTION_LAYERS=2
done
# The library with every law, on a file with network laws and on one without.
for golden in cartpole-networks cartpole; do
    check inertia-network,friction,networks $golden "" "$cart" LEASTACTION_COORDINATES=2 LEASTACTION_HIDDEN=7 LEASTACTION_LAYERS=2 \
        LEASTACTION_LAW_HIDDEN=4 LEASTACTION_LAW_LAYERS=1
done
check modular arm arm "$arm" LEASTACTION_COORDINATES=3 LEASTACTION_HIDDEN=5 LEASTACTION_LAYERS=2 LEASTACTION_TYPES=3
check bodies crane "" "$arm" LEASTACTION_COORDINATES=3
check bodies,friction crane-friction "" "$arm" LEASTACTION_COORDINATES=3
check arm manipulator "" "$arm" LEASTACTION_COORDINATES=3
check arm,friction manipulator-friction "" "$arm" LEASTACTION_COORDINATES=3
# Numbers that follow: the inertia of the last body and all frictions.
check bodies,adapt crane "" "$arm" LEASTACTION_COORDINATES=3
check bodies,friction,adapt crane-friction "" "$arm" LEASTACTION_COORDINATES=3
for golden in manipulator manipulator-friction; do
    check arm,friction,adapt $golden "" "$arm" LEASTACTION_COORDINATES=3 LEASTACTION_NUMBERS=16
done
for with in graph graph,rods; do
    check $with web pair '0.125 0.25 0.375 0.5' LEASTACTION_COORDINATES=4 LEASTACTION_HIDDEN=5 LEASTACTION_LAYERS=1 \
        LEASTACTION_NETWORKS=6
done
# A graph with rods of 0.5 m and 2 m, and room for a third rod.
check graph,rods web ring '0.3 -0.4 1 1 1.5 -2' LEASTACTION_COORDINATES=6 LEASTACTION_HIDDEN=5 LEASTACTION_LAYERS=1 \
    LEASTACTION_NETWORKS=6 LEASTACTION_EDGES=3 LEASTACTION_RODS=3
[[ $families != *" inertia-network "* || $families != *" modular "* ]] || check_two
printf 'the C interface is well\n'
