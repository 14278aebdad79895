#!/usr/bin/env bash
# Flips bits in the memory of a controller on an emulated Cortex-M4F while it follows a motion of the learned cart-pole, which is simulated on
# this machine: a third each in its state, its stack and its weights, at any instruction of a tick. Prints a table of what became of the faults
# and of what found them; with --json one JSON object. With all guards, a fault that is none of masked, detected, transient and safe fails the script.
# `docs/book/src/while-it-runs.md` explains the table. Minutes for 10,000 faults on two processors.
#   faults.sh [--faults 10000] [--seed 0] [--guards none|state|weights|all] [--json]
set -euo pipefail
cd "$(dirname "$0")"
source ./tools.sh

need_emulator qemu-system-arm
build cortex-m4f --features faults --bin faults
cd ../..
CARGO_TARGET_DIR=$host_target cargo run --quiet --release --package leastaction-tests --bin faults \
    "$(program cortex-m4f faults)" firmware-sim/chip/models/cartpole-16.postcard "$@"
