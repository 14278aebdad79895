#!/usr/bin/env bash
# Runs the controller on emulated boards against the plant on this machine; every trace must equal, bit for bit, that of a run on this
# machine alone. Scenarios: swing-up and tracking of the learned cart-pole; the swing-up of a cart-pole with friction, a weak and late drive
# and encoder offsets, by a model of its own logs (docs/book/src/swing-up.md), and a plan of one; decisions at every tick for both, and for a
# pendulum, an acrobot and a pendubot; and seven joints that follow a motion at 1 kHz, also while numbers of their
# model follow what they take up. Prints one JSON line per board, model and scenario. `LEASTACTION` names the command if it is already built; `STARTS=20 hil.sh` swings up the
# cart-pole with friction from 20 starts instead of 1 on the first board.
set -euo pipefail
cd "$(dirname "$0")"
source ./tools.sh
export LEASTACTION_CHIP_TARGET=$CARGO_TARGET_DIR

# Names of the boards for `simulate --on`.
declare -A option=([cortex-m4f]=cortex-m4 [cortex-m7]=cortex-m7 [riscv32imac]=riscv)
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

leastaction=${LEASTACTION:-$host_target/release/leastaction}
[ -n "${LEASTACTION:-}" ] || (cd ../.. && CARGO_TARGET_DIR=$host_target cargo build --quiet --release --package leastaction)
simulate() {
    (cd ../.. && "$leastaction" simulate "firmware-sim/chip/models/$1.postcard" --output "$folder" --json "${@:2}")
}
value() { sed -E "s/.*\"$1\":(\"[^\"]*\"|\[[^]]*\]|[^,}]*).*/\1/" <<<"$report"; }

need_emulator qemu-system-arm
need_emulator qemu-system-riscv32
for board in "${boards[@]}"; do
    build "$board" --bin controller --bin arm_controller
done

# Runs a model on this machine and on the given boards, and compares the traces.
on_boards() {
    local boards=($1) model=$2 run=("${@:3}") image=controller expected board begin
    [ "$model" != arm ] || image=arm_controller
    report=$(simulate "$model" "${run[@]}")
    expected=$(value trace_hash)
    for board in "${boards[@]}"; do
        begin=$(date +%s%N)
        report=$(simulate "$model" "${run[@]}" --on "${option[$board]}")
        if [ "$(value trace_hash)" != "$expected" ]; then
            printf '%s on %s: trace %s, on the host %s\n' "$model" "$board" "$(value trace_hash)" "$expected" >&2
            exit 1
        fi
        printf '{"board": "%s", "model": "%s", "scenario": %s, "seed": %s, "success": %s, "trace_hash": %s, "ticks": %s' "$board" \
            "$model" "$(value scenario)" "$(value seed)" "$(value success)" "$(value trace_hash)" "$(value ticks)"
        printf ', "tick_instructions": %s, "text_bytes": %s, "rodata_bytes": %s, "ram_bytes": %s' \
            "$(value tick_instructions)" $(sections "$(program "$board" "$image")")
        printf ', "milliseconds": %s}\n' $((($(date +%s%N) - begin) / 1000000))
    done
}

# The swing-up needs 10 s; without a floating-point unit, emulating one second of the loop takes several.
on_boards "${boards[*]}" cartpole --scenario swing-up --seconds 10
on_boards "${boards[*]}" cartpole --scenario track --seconds 3
devices=(--coulomb 0.5,0 --width 0.05 --gain 0.9,1 --delay 8 --zeros 0.02 --noise 0.001 --learn-zeros 0.02)
dry=(--scenario swing-up "${devices[@]}")
on_boards "${boards[*]}" cartpole-dry "${dry[@]}"
on_boards "${boards[*]}" cartpole-dry --scenario follow --plan firmware-sim/chip/models/swing-up.postcard "${devices[@]}"
# Decisions at every tick, the first with plans; those over the network would take minutes without a floating-point unit.
swing_up=firmware-sim/chip/models/swing-up.postcard
on_boards "${boards[*]}" cartpole-dry --scenario mpc --plan $swing_up --plan $swing_up "${devices[@]}" --seconds 5
on_boards "${boards[*]:0:2}" cartpole-dry --scenario mpc "${devices[@]}"
on_boards "${boards[*]:0:2}" cartpole --scenario mpc
on_boards "${boards[0]}" acrobot --scenario mpc
on_boards "${boards[0]}" acrobot --scenario mpc --limit 8,0
on_boards "${boards[0]}" pendulum --scenario mpc
for ((seed = 1; seed < ${STARTS:-1}; seed++)); do
    on_boards "${boards[0]}" cartpole-dry "${dry[@]}" --seed $seed
done
# Seven joints, from rest to full speed of the motion on the first board, a tenth as long on the others.
arm=(--scenario track --plant firmware-sim/chip/models/arm.postcard --trajectory firmware-sim/chip/models/arm-motion.toml --bandwidth 30)
on_boards "${boards[0]}" arm "${arm[@]}" --seconds 1
on_boards "${boards[*]:1}" arm "${arm[@]}" --seconds 0.1
# Numbers that follow: the board must save those of this machine, too. The motion begins after half a second.
carrying=("${arm[@]}" --payload 1.5@0.6s)
on_boards "${boards[0]}" arm "${carrying[@]}" --seconds 1.2 --adapt
