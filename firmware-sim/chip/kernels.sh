#!/usr/bin/env bash
# Checks on one or all emulated boards that the loops in the processor's own instructions give the bits of plain Rust, and counts the
# instructions of the building blocks of an evaluation: a layer of 32 x 32 forward and back with tangents, one unit of an activation, an
# elementary function, the checksum of 1024 bytes. Fails if a bit differs.
set -euo pipefail
cd "$(dirname "$0")"
source ./tools.sh

if [ $# -gt 0 ]; then
    [[ " ${boards[*]} " == *" $1 "* ]] || { echo "usage: kernels.sh [$(IFS='|'; echo "${boards[*]}")]" >&2; exit 2; }
    boards=("$1")
fi
for board in "${boards[@]}"; do
    build "$board" --bin kernels
    printf 'board %s\n' "$board"
    emulate "$board" "$(program "$board" kernels)" 0 2>&1 || { printf '%s failed\n' "$board" >&2; exit 1; }
done
