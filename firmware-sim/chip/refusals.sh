#!/usr/bin/env bash
# Loads damaged model files on emulated boards: every changed bit and every truncation of two small files in RAM, and the cart-pole in flash
# with one of 64 evenly spaced bits changed. All must be refused with the error that this machine gives. One JSON line per board.
set -euo pipefail
cd "$(dirname "$0")"
source ./tools.sh

samples=64
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
host() { (cd ../.. && CARGO_TARGET_DIR=$host_target cargo run --quiet --release --package leastaction-tests --bin refusals "$@"); }

# Copies a file with one bit changed.
changed() {
    local byte=$(($2 / 8))
    cp "$1" "$3"
    local old
    old=$(od -An -tu1 -j "$byte" -N 1 "$1")
    printf "\\x$(printf %02x $((old ^ 1 << $2 % 8)))" | dd of="$3" bs=1 seek="$byte" conv=notrunc status=none
}

whole=models/cartpole.postcard
bits=$((8 * $(stat -c %s $whole)))
files=()
for ((i = 0; i < samples; i++)); do
    files+=("$folder/$i.postcard")
    changed $whole $(((2 * i + 1) * bits / (2 * samples))) "${files[i]}"
done
expected=$(host)
host "${files[@]}" >"$folder/expected"
if grep -q accepted "$folder/expected"; then
    echo "this machine accepts a damaged cart-pole" >&2
    exit 1
fi

for board in "${boards[@]}"; do
    build "$board" --bin refusals
    image=$(program "$board" refusals)
    counted=$(emulate "$board" "$image" 0 2>&1) || { printf '%s: %s\n' "$board" "$counted" >&2; exit 1; }
    diff <(echo "$expected") <(echo "$counted") >&2 || { echo "$board: other refusals than on this machine" >&2; exit 1; }
    for file in "${files[@]}"; do
        emulate "$board" "$image" 0 $(with_model "$board" "$file") 2>&1
    done >"$folder/found"
    diff "$folder/expected" "$folder/found" >&2 || { echo "$board: other errors than on this machine" >&2; exit 1; }
    [ "$(emulate "$board" "$image" 0 $(with_model "$board" $whole) 2>&1)" = "flash accepted" ]
    printf '{"board": "%s", "in_ram_refused": %s, "in_flash_refused": %s}\n' "$board" \
        "$(awk '$1 != "accepted" && $2 ~ /^[0-9]+$/ && plain { sum += $2 } $2 ~ /^[a-z]/ { plain = $2 != "bit_under_checksum" } END { print sum }' \
            <<<"$counted")" "$(wc -l <"$folder/found")"
done
