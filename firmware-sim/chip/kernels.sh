#!/usr/bin/env bash
# Instructions of the parts that evaluations are made of, on an emulated board: of a layer of 32 x 32 forward and back with tangents,
# of one unit of an activation, of an elementary function.
set -euo pipefail
cd "$(dirname "$0")"
source ./tools.sh

board=${1:-cortex-m4f}
[[ " ${boards[*]} " == *" $board "* ]] || { echo "usage: kernels.sh [$(IFS='|'; echo "${boards[*]}")]" >&2; exit 2; }
build "$board" --bin kernels
emulate "$board" "$(program "$board" kernels)" 0
