#!/usr/bin/env bash
# Builds the images for every board, runs them under QEMU and compares the hash of their steps with this machine's. The boards: a Cortex-M4F
# (mps2-an386), a Cortex-M7 (mps2-an500) and a RISC-V without floating-point unit (virt). Prints one JSON line per board, model and order,
# one for the code of each bare image, such as an acceleration or a step alone, and one each for the instructions of friction, of steps with friction that sticks, of laws
# with networks, of decisions over a receding horizon, of ticks that follow a plan, of ticks that decide, and of ticks whose model follows. `--steps N`: steps of every image (1,000); `--only NAME`: only one board, image or kind.
# `--budgets check` compares flash, RAM, stack and instructions with budgets.jsonl, within 2%; `--budgets write` writes it.
# `--build` only builds the images, as `leastaction simulate --on` needs them.
# Uses rustup's targets if available, else Debian's compiler with the standard library's source; installs what is missing.
set -euo pipefail
shopt -s inherit_errexit
cd "$(dirname "$0")"
source ./tools.sh

steps=1000 only= budgets= build_only=
while [ $# -gt 0 ]; do
    case $1 in
        --steps) steps=${2:?--steps takes a number}; shift 2 ;;
        --only) only=${2:?--only takes a name such as inertia-network_2 or cortex-m7}; shift 2 ;;
        --budgets) budgets=${2:?--budgets takes check or write}; shift 2 ;;
        --build) build_only=yes; shift ;;
        *) echo "usage: run.sh [--steps N] [--only IMAGE|BOARD] [--budgets check|write] | --build" >&2; exit 2 ;;
    esac
done

images=(inertia-network_2 inertia-network_4 modular_2 modular_4 graph_2 graph_4 bodies_2 bodies_4
    inertia-network-f16_2 inertia-network-dry_2 bodies-dry_2 bodies-dry_4 arm_2 arm_4 bodies-sticking_2 bodies-sticking_4)
bare_images=(bare_acceleration bare_step bare_constant-acceleration bare_constant-step bare_stepper)
case " ${boards[*]} ${images[*]} ${bare_images[*]} bare friction sticking receding following deciding adapting elementary " in
    *" ${only:-bare} "*) ;;
    *) printf -- '--only takes one of: %s\n' "${boards[*]} ${images[*]} ${bare_images[*]} bare friction sticking receding following deciding adapting elementary" >&2; exit 2 ;;
esac

if [ -n "$build_only" ]; then
    for board in "${boards[@]}"; do
        build "$board"
        program "$board" controller
    done
    exit
fi

# The same steps on this machine.
host=$(cd ../.. && CARGO_TARGET_DIR=$host_target cargo run --quiet --release --package leastaction-tests \
    --bin trajectory_hash "$steps")
expected() { sed -n "s/^$1 $2 //p" <<<"$host"; }

report() {
    local board=$1 image=$2 elf
    elf=$(program "$board" "$image")
    output=$(emulate "$board" "$elf" "$steps" 2>&1) || { printf '%s on %s: %s\n' "$image" "$board" "$output" >&2; return 1; }
    if [ "$(expected "${image%_*}" "${image##*_}")" != "$(value hash)" ]; then
        printf '%s on %s: hash %s, on the host %s\n' "$image" "$board" "$(value hash)" "$(expected "${image%_*}" "${image##*_}")" >&2
        return 1
    fi
    printf '{"board": "%s", "family": "%s", "order": %s, "hash": "%s", "steps": %s' \
        "$board" "${image%_*}" "${image##*_}" "$(value hash)" "$(value steps)"
    printf ', %s}\n' "$(measures "$elf")"
}

# Measures an image that holds only the cart-pole and one thing to do: the flash that it costs a firmware.
bare() {
    local board=$1 image=$2 elf
    elf=$(program "$board" "$image")
    emulate "$board" "$elf" "$steps" || { printf '%s on %s failed\n' "$image" "$board" >&2; return 1; }
    printf '{"board": "%s", "family": "inertia-network", "only": "%s", "text_bytes": %s, "rodata_bytes": %s, "ram_bytes": %s}\n' \
        "$board" "${image#bare_}" $(sections "$elf")
}

# Measures damping and load-dependent dry friction of one coordinate: at most 150 instructions on a Cortex-M4F.
friction() {
    local board=$1
    output=$(emulate "$board" "$(program "$board" kernels)" 0 2>&1) || { printf 'kernels on %s: %s\n' "$board" "$output" >&2; return 1; }
    printf '{"board": "%s", "only": "friction", "damping_instructions": %s, "friction_instructions": %s' \
        "$board" "$(value viscous)" "$(value friction)"
    printf ', "friction_with_derivatives_instructions": %s}\n' "$(value friction_with_derivatives)"
    # Laws with networks of 8 units: dissipation of one angle and of two, a potential of two; whole laws, not per coordinate.
    printf '{"board": "%s", "only": "networks", "dissipation_instructions": %s, "dissipation_with_derivatives_instructions": %s' \
        "$board" "$(value dissipation_of_one)" "$(value dissipation_of_one_with_derivatives)"
    printf ', "dissipation_of_two_instructions": %s, "dissipation_of_two_with_derivatives_instructions": %s' \
        "$(value dissipation_of_two)" "$(value dissipation_of_two_with_derivatives)"
    printf ', "potential_instructions": %s, "potential_with_derivatives_instructions": %s}\n' \
        "$(value potential_of_two)" "$(value potential_of_two_with_derivatives)"
    if [ "$board" = cortex-m4f ] && [ "$(value friction)" -gt 150 ]; then
        echo "friction on $board: more than 150 instructions a coordinate" >&2
        return 1
    fi
}

# Measures a step with friction that sticks, sliding and stuck, against a step with smooth friction from the same state, for one and for two
# coordinates: on a Cortex-M4F at most 250 instructions more for each coordinate. Braking is a slide that friction halves within the step, and
# whose end is therefore solved on its own.
sticking() {
    local board=$1 n
    output=$(emulate "$board" "$(program "$board" sticking)" 0 2>&1) || { printf 'sticking on %s: %s\n' "$board" "$output" >&2; return 1; }
    printf '{"board": "%s", "only": "sticking"' "$board"
    for n in 1 2; do
        printf ', "smooth_step_instructions_%s": %s, "sliding_step_instructions_%s": %s' $n "$(value smooth_$n)" $n "$(value sliding_$n)"
        printf ', "smooth_rest_instructions_%s": %s, "stuck_step_instructions_%s": %s' $n "$(value smooth_rest_$n)" $n "$(value stuck_$n)"
    done
    printf ', "smooth_braking_instructions_2": %s, "braking_step_instructions_2": %s}\n' "$(value smooth_braking_2)" "$(value braking_2)"
    [ "$board" = cortex-m4f ] || return 0
    for n in 1 2; do
        if [ $(($(value sliding_$n) - $(value smooth_$n))) -gt $((250 * n)) ] ||
            [ $(($(value stuck_$n) - $(value smooth_rest_$n))) -gt $((250 * n)) ]; then
            echo "sticking on $board: more than 250 instructions a coordinate beside smooth friction" >&2
            return 1
        fi
    done
}

# Measures decisions over a receding horizon of 25 nodes: of two links, and of a cart-pole whose network has two hidden layers of 16. On a
# Cortex-M4F an iteration of the links takes at most 400,000 instructions; each has at most 16 KB of RAM, and its slowest iteration takes at
# most 1.2 times the median.
receding() {
    local board=$1 model most ram
    for model in links cartpole; do
        output=$(emulate "$board" "$(program "$board" receding_$model)" 0 2>&1) ||
            { printf 'receding %s on %s: %s\n' $model "$board" "$output" >&2; return 1; }
        ram=$(($(value nodes_bytes) + $(value controller_bytes) + $(value decision_stack)))
        printf '{"board": "%s", "family": "%s", "only": "receding", "nodes_bytes": %s, "controller_bytes": %s, "stack_bytes": %s' \
            "$board" $model "$(value nodes_bytes)" "$(value controller_bytes)" "$(value decision_stack)"
        printf ', "follow_instructions": %s, "iteration_instructions": %s, "iteration_instructions_worst": %s}\n' \
            "$(value follow_instructions)" "$(value iteration_instructions)" "$(value iteration_instructions_worst)"
        most=400000
        [ $model = links ] || most=$(value iteration_instructions)
        if [ "$board" = cortex-m4f ] && { [ "$(value iteration_instructions)" -gt "$most" ] || [ "$ram" -gt 16384 ] ||
            [ $((5 * $(value iteration_instructions_worst))) -gt $((6 * $(value iteration_instructions))) ]; }; then
            echo "receding $model on $board: too many instructions or too much RAM ($ram bytes)" >&2
            return 1
        fi
    done
}

# Measures ticks that follow a plan, and ticks that only estimate the state along the same readings, which the former may take 1.3 times.
following() {
    local board=$1 model follow observe
    output=$(emulate "$board" "$(program "$board" following)" 0 2>&1) || { printf 'following on %s: %s\n' "$board" "$output" >&2; return 1; }
    for model in cartpole double; do
        follow=$(value ${model}_follow_instructions) observe=$(value ${model}_observe_instructions)
        printf '{"board": "%s", "family": "%s", "only": "following", "follow_tick_instructions": %s, "observe_tick_instructions": %s' \
            "$board" $model "$follow" "$observe"
        printf ', "follow_to_observe": %s}\n' "$(awk "BEGIN { printf \"%.3f\", $follow / $observe }")"
        if [ $((10 * follow)) -gt $((13 * observe)) ]; then
            echo "following by the $model on $board: more than 1.3 times the instructions of a tick that only observes" >&2
            return 1
        fi
    done
}

# Measures ticks of the learned cart-pole that decide: instructions, stack, and memory.
deciding() {
    local board=$1
    output=$(emulate "$board" "$(program "$board" deciding)" 0 2>&1) || { printf 'deciding on %s: %s\n' "$board" "$output" >&2; return 1; }
    printf '{"board": "%s", "only": "deciding", "nodes_bytes": %s, "firmware_bytes": %s, "stack_bytes": %s' \
        "$board" "$(value nodes_bytes)" "$(value firmware_bytes)" "$(value tick_stack)"
    printf ', "decide_tick_instructions": %s, "decide_tick_instructions_worst": %s}\n' \
        "$(value tick_instructions)" "$(value tick_instructions_worst)"
}

# Measures ticks of an arm whose model follows, for one body and seven frictions, beside ticks whose model stays what it is: on a Cortex-M4F
# at most 45,000 instructions and 3 KB of RAM more. The motion and the numbers have the bits of this machine.
adapting() {
    local board=$1 ram
    output=$(emulate "$board" "$(program "$board" adapting)" "$steps" 2>&1) || { printf 'adapting on %s: %s\n' "$board" "$output" >&2; return 1; }
    if [ "$(expected adapting 2)" != "$(value hash)" ]; then
        printf 'adapting on %s: hash %s, on the host %s\n' "$board" "$(value hash)" "$(expected adapting 2)" >&2
        return 1
    fi
    ram=$(($(value adapting_bytes) + $(value adapting_stack) - $(value plain_bytes) - $(value plain_stack)))
    printf '{"board": "%s", "only": "adapting", "hash": "%s", "adapting_bytes": %s, "plain_bytes": %s' \
        "$board" "$(value hash)" "$(value adapting_bytes)" "$(value plain_bytes)"
    printf ', "stack_bytes": %s, "plain_stack_bytes": %s' "$(value adapting_stack)" "$(value plain_stack)"
    printf ', "adapting_instructions": %s, "adapting_instructions_worst": %s, "plain_instructions": %s, "plain_instructions_worst": %s}\n' \
        "$(value adapting)" "$(value adapting_worst)" "$(value plain)" "$(value plain_worst)"
    if [ "$board" = cortex-m4f ] && { [ $(($(value adapting_worst) - $(value plain_worst))) -gt 45000 ] || [ "$ram" -gt 3072 ]; }; then
        echo "adapting on $board: more than 45,000 instructions or 3 KB more ($ram bytes)" >&2
        return 1
    fi
}

# Checks every elementary function at thousands of inputs.
elementary() {
    local board=$1
    output=$(emulate "$board" "$(program "$board" elementary_0)" 0 2>&1) || { printf 'elementary functions on %s: %s\n' "$board" "$output" >&2; return 1; }
    if [ "$(expected elementary 0)" != "$(value hash)" ]; then
        printf 'elementary functions on %s: hash %s, on the host %s\n' "$board" "$(value hash)" "$(expected elementary 0)" >&2
        return 1
    fi
    printf 'elementary functions on %s: the bits of this machine, %s\n' "$board" "$(value hash)" >&2
}

run() {
    local board image
    for board in "${boards[@]}"; do
        build "$board"
        for image in "${images[@]}"; do
            case "$only" in "" | "$board" | "$image") report "$board" "$image" ;; esac
        done
        for image in "${bare_images[@]}"; do
            case "$only" in "" | "$board" | "$image" | bare) bare "$board" "$image" ;; esac
        done
        case "$only" in "" | "$board" | friction) friction "$board" ;; esac
        case "$only" in "" | "$board" | sticking) sticking "$board" ;; esac
        case "$only" in "" | "$board" | receding) receding "$board" ;; esac
        case "$only" in "" | "$board" | following) following "$board" ;; esac
        case "$only" in "" | "$board" | deciding) deciding "$board" ;; esac
        case "$only" in "" | "$board" | adapting) adapting "$board" ;; esac
        case "$only" in "" | "$board" | elementary) elementary "$board" ;; esac
    done
}

compiler thumbv7em-none-eabihf
version=$(rustc --version)
case $budgets in
    "") run ;;
    write) { echo "$version"; run; } | tee budgets.jsonl ;;
    check)
        if [ "$version" != "$(head -n 1 budgets.jsonl)" ]; then
            echo "budgets.jsonl is of $(head -n 1 budgets.jsonl), this is $version: not compared" >&2
            run
        else
            lines=$(run)
            printf '%s\n' "$lines"
            (cd ../.. && CARGO_TARGET_DIR=$host_target cargo run --quiet --release --package leastaction-tests --bin budgets \
                firmware-sim/chip/budgets.jsonl <<<"$lines")
        fi
        ;;
    *) echo "--budgets takes check or write" >&2; exit 2 ;;
esac
