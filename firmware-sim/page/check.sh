#!/usr/bin/env bash
# Builds the page and checks it: the module's trace of every machine, run by Node, has the hash of this machine that is in the page; the file
# has at most 300 KB; Chromium, if it is installed or can be, shows frames without an error, verifies every machine, is dragged, and refuses a
# broken model. Prints one JSON line per trace, and one of the page.
#   check.sh [--page FILE] [PICTURES]     FILE is a page that build.sh just made, PICTURES a folder for pictures of the page
# `LEASTACTION` names the command if it is already built.
set -euo pipefail
page=
[ "${1:-}" != --page ] || { page=$(realpath "${2:?--page takes a file}") && shift 2; }
pictures=${1:+$(realpath -m "$1")}
cd "$(dirname "$0")"
source ./tools.sh

need node:nodejs

[ -n "$page" ] || { page=$folder/live.html && ./build.sh -o "$page"; }
build_module
for number in "${!machines[@]}"; do
    machine=${machines[number]}
    line=$(node trace.mjs "$module" "$number" "../chip/models/${model[$machine]}.postcard" 0)
    expected=$(grep -oE '"hashes": \{[^}]*' "$page" | sed -E "s/.*\"$machine\": \"([^\"]*).*/\1/")
    if [[ $line != *"\"trace_hash\":\"$expected\""* ]]; then
        printf '%s: on this machine %s, in WebAssembly %s\n' "$machine" "$expected" "$line" >&2
        exit 1
    fi
    printf '{"machine":"%s",%s\n' "$machine" "${line#\{}"
done

bytes=$(stat -c %s "$page")
if [ "$bytes" -gt 300000 ]; then
    echo "the page has $bytes bytes, more than 300,000" >&2
    exit 1
fi
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$chromium" ]; then
    (install chromium) || true
    chromium=$(command -v chromium || true)
fi
if [ -z "$chromium" ]; then
    echo "skipped: no Chromium to show the page" >&2
    exit 0
fi
measured=$(timeout 120 node browser.mjs "$chromium" "$page" ${pictures:+"$pictures"})
printf '{"bytes":%s,%s\n' "$bytes" "${measured#\{}"
