#!/usr/bin/env bash
# The controller on emulated boards against the plant on this machine: swing-up and tracking of the learned cart-pole must leave
# the trace of a run on this machine alone, bit for bit. One JSON line a board and scenario. `LEASTACTION` names the command where it is
# built already.
set -euo pipefail
cd "$(dirname "$0")"
source ./tools.sh
export LEASTACTION_CHIP_TARGET=$CARGO_TARGET_DIR

# As `simulate --on` calls them.
declare -A option=([cortex-m4f]=cortex-m4 [cortex-m7]=cortex-m7 [riscv32imac]=riscv)
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

leastaction=${LEASTACTION:-$host_target/release/leastaction}
[ -n "${LEASTACTION:-}" ] || (cd ../.. && CARGO_TARGET_DIR=$host_target cargo build --quiet --release --package leastaction)
simulate() {
    (cd ../.. && "$leastaction" simulate firmware-sim/chip/models/cartpole.postcard --output "$folder" --json "$@")
}
value() { sed -E "s/.*\"$1\":(\"[^\"]*\"|\[[^]]*\]|[^,}]*).*/\1/" <<<"$report"; }

need qemu-system-arm qemu-system-arm
need qemu-system-riscv32 qemu-system-misc
for board in "${boards[@]}"; do
    build "$board" --bin controller
done
# The swing-up takes its 10 s; without a floating-point unit a second of the loop is several of emulation.
declare -A seconds=([swing-up]=10 [track]=3)
for scenario in swing-up track; do
    run=(--scenario $scenario --seconds "${seconds[$scenario]}")
    report=$(simulate "${run[@]}")
    expected=$(value trace_hash)
    for board in "${boards[@]}"; do
        begin=$(date +%s%N)
        report=$(simulate "${run[@]}" --on "${option[$board]}")
        if [ "$(value trace_hash)" != "$expected" ]; then
            printf '%s on %s: trace %s, on the host %s\n' $scenario "$board" "$(value trace_hash)" "$expected" >&2
            exit 1
        fi
        printf '{"board": "%s", "scenario": "%s", "trace_hash": %s, "ticks": %s, "tick_instructions": %s' \
            "$board" $scenario "$(value trace_hash)" "$(value ticks)" "$(value tick_instructions)"
        printf ', "text_bytes": %s, "rodata_bytes": %s, "ram_bytes": %s' $(sections "$(program "$board" controller)")
        printf ', "milliseconds": %s}\n' $((($(date +%s%N) - begin) / 1000000))
    done
done
