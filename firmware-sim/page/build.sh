#!/usr/bin/env bash
# Builds the page that runs the firmware's program, one file of HTML that needs no network: module, models, and for each machine the hash of its
# standard run on this machine, to which ../chip/hil.sh compares the boards' traces.
#   build.sh [-o FILE]      FILE is live.html in the target folder by default
# `LEASTACTION` names the command if it is already built.
set -euo pipefail
here=$PWD
cd "$(dirname "$0")"
source ./tools.sh
case $# in
    0) output=$host_target/live.html ;;
    2) [ "$1" = -o ] || { echo "build.sh takes -o FILE" >&2; exit 2; }; output=$(cd "$here" && realpath -m "$2") ;;
    *) echo "build.sh takes -o FILE" >&2; exit 2 ;;
esac

build_module
command_of_host
for machine in "${machines[@]}"; do
    echo "$machine ../chip/models/${model[$machine]}.postcard $(hash_of_host "$machine" 0)"
done >"$folder/machines"
python3 - "$module" "$folder/machines" page.html "$output" <<'PYTHON'
import base64, gzip, json, sys
from pathlib import Path

module, machines, page, output = map(Path, sys.argv[1:])
text = lambda data: base64.b64encode(data).decode()
data = {"module": text(gzip.compress(module.read_bytes(), 9, mtime=0)), "models": {}, "hashes": {}}
for line in machines.read_text().splitlines():
    name, model, data["hashes"][name] = line.split()
    data["models"][name] = text(Path(model).read_bytes())
output.write_text(page.read_text().replace("/*DATA*/null", json.dumps(data), 1))
PYTHON
printf '%s: %s bytes\n' "$output" "$(stat -c %s "$output")"
