#!/usr/bin/env bash
# Swings up three machines from hanging under the conditions of real ones, each from nothing: logs of a simulated robot, a model that is
# learned from them, a plan by this model, and the firmware's program that follows it from 20 starts with noise of their own.
#   real_conditions.sh [--on BOARD]… [acrobot] [pendubot] [cartpole]
# Encoders have 12 bits a turn (the cart's count is as fine in logs, in m) and noise, joints have dry friction, and drives are 6 ms late,
# the cart-pole's 8 ms, with nine tenths of the commanded force, and encoder offsets. Prints a line for each machine: starts from which it
# comes up and stays, the largest errors of its coordinates thereafter, and the hash of the first start's trace. With --on, that start is
# also run on an emulated board (cortex-m4, cortex-m7 or riscv; `firmware-sim/chip/run.sh --build` builds their images), whose trace must be
# the same. Fails if a start fails or a trace differs. `LEASTACTION` names the command if it is already built, `STARTS` another number of
# starts, `SEED` other logs.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
boards=() machines=()
while [ $# -gt 0 ]; do
    case $1 in
        --on)
            [ $# -gt 1 ] || { echo "real_conditions.sh: --on needs a board: cortex-m4, cortex-m7 or riscv" >&2 && exit 2; }
            boards+=("$2") && shift
            ;;
        acrobot | pendubot | cartpole) machines+=("$1") ;;
        *) echo "real_conditions.sh: $1 is neither --on nor acrobot, pendubot or cartpole" >&2 && exit 2 ;;
    esac
    shift
done
[ ${#machines[@]} -gt 0 ] || machines=(acrobot pendubot cartpole)
starts=${STARTS:-20}

# Images of boards are found from within the repository.
leastaction=$(realpath -m "${LEASTACTION:-${CARGO_TARGET_DIR:-$root/target}/release/leastaction}")
cd "$root"
[ -n "${LEASTACTION:-}" ] || cargo build --quiet --release --package leastaction
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

count=0.0015339807878856412 # 2π/4096
# Options of the logs and of the loop, and the configurations of training and plan.
describe() {
    local links=(--coulomb 0.1,0.07 --width 0.05 --delay 6 --noise 0.001) demo=trainer/src/commands/demo models=firmware-sim/chip/models
    local swings=(acrobot --samples 301 --amplitude 1,5 --frequency 0.2,1.5 --spread 1.5)
    local cart=(--coulomb 0.5,0 --width 0.05 --delay 8 --noise 0.001 --zeros 0.02)
    case $1 in
        acrobot)
            logged=("${swings[@]}" --trajectories 6 --driven 0,1 "${links[@]}") looped=("${links[@]}")
            training=$demo/acrobot.toml planning=$demo/acrobot-plan.toml
            ;;
        pendubot)
            logged=("${swings[@]}" --trajectories 12 --driven 1,0 "${links[@]}") looped=("${links[@]}")
            training=$demo/acrobot.toml planning=tests/real_conditions/pendubot-plan.toml
            ;;
        cartpole)
            logged=(cartpole --trajectories 12 --samples 401 --amplitude 1,5 --frequency 0.3,2 --spread 0.5 "${cart[@]}" --gain 0.9)
            looped=("${cart[@]}" --gain 0.9,1 --learn-zeros 0.02)
            training=$models/cartpole-dry.toml planning=$models/swing-up.toml
            ;;
    esac
}

# Runs the command, and shows its output if it fails.
quietly() { "$leastaction" "$@" >"$home/output.txt" 2>&1 || { cat "$home/output.txt" >&2 && return 1; }; }

# Learns the machine in the folder $home, and plans its swing-up.
prepare() {
    mkdir "$home"
    quietly generate "${logged[@]}" --grid $count --seed "${SEED:-0}" --robot "$home/logs" -o "$home/log.npz"
    cp "$training" "$home/train.toml"
    cp "$planning" "$home/plan.toml"
    model=$home/$(sed -n 's/^model = "\(.*\)"/\1/p' "$planning")
    quietly train "$home/train.toml" -o "$home/run"
    quietly export "$home/run" -o "$model"
    quietly plan "$home/plan.toml" -o "$home/plan"
}

# Follows the plan from a start; the command fails if the machine does not come up or does not stay.
follow() {
    "$leastaction" simulate "$model" --scenario follow --plan "$home/plan/plan.postcard" "${looped[@]}" --output "$home/simulation" --seed "$@"
}
hash_of() { sed -n 's/^trace  *\([0-9a-f]*\) .*/\1/p' "$1"; }

failed=0
for name in "${machines[@]}"; do
    begin=$SECONDS home=$folder/$name up=0 same=()
    describe "$name"
    prepare
    for ((seed = 0; seed < starts; seed++)); do
        follow $seed >"$home/start-$seed.txt" 2>"$home/error.txt" && up=$((up + 1)) || cat "$home/error.txt" >&2
    done
    expected=$(hash_of "$home/start-0.txt")
    for board in "${boards[@]}"; do
        follow 0 --on "$board" >"$home/board.txt" || failed=1
        found=$(hash_of "$home/board.txt")
        [ "$found" != "$expected" ] || found="the same"
        [ "$found" = "the same" ] || failed=1
        same+=(", ${found:-none} on $board")
    done
    errors=$(sed -n 's/^error after it, largest (.*)  *//p' "$home"/start-*.txt |
        awk -F', ' '{for (i = 1; i <= NF; i++) if ($i + 0 > most[i] + 0) most[i] = $i} END {printf "%s and %s", most[1], most[2]}')
    printf '%s: %s of %s, then at most %s off, trace %s%s; %s s\n' "$name" $up "$starts" "$errors" "$expected" \
        "$(printf %s "${same[@]}")" $((SECONDS - begin))
    [ $up = "$starts" ] || failed=1
done
printf '%s s in all\n' $SECONDS
exit $failed
