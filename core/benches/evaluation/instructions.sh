#!/usr/bin/env bash
# Counts the instructions of one acceleration and one DEL step of order 2 and 4 in f32, for chains of 2 to 8 learned pendulums, by
# valgrind (apt-get install valgrind): the difference between 101 calls and one, divided by 100. The counts are exact and reproducible.
# The table is comma-separated, for `cargo run --release -p leastaction-plot --example plot_table`.
set -euo pipefail
cd "$(dirname "$0")/../../.."

# Instruction set that valgrind knows, the same on every machine.
export RUSTFLAGS=-Ctarget-cpu=x86-64
program=$(cargo bench --package leastaction-core --bench evaluation --no-run 2>&1 | sed -n 's/.*(\(.*\)).*/\1/p' | tail -n 1)

instructions() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" --calls "$@" 2>&1 | sed -n 's/.*Collected : //p'
}

echo "pendulums,acceleration,DEL order 2,DEL order 4"
for pendulums in 2 3 4 6 8; do
    printf '%s' "$pendulums"
    for what in acceleration order-2 order-4; do
        one=$(instructions "$what" "$pendulums" 1)
        many=$(instructions "$what" "$pendulums" 101)
        printf ',%s' $(((many - one) / 100))
    done
    printf '\n'
done
