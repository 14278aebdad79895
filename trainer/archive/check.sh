#!/usr/bin/env bash
# Tries release archives as a user does who has no compiler: unpacks each into an empty folder, and runs its command there in an empty
# environment. An archive for another processor runs in QEMU's user-mode emulator. Prints the seconds from unpacking to a model file, and the
# trace's hash of one simulation, which must be that of all archives.
#   check.sh ARCHIVE...
# With LEASTACTION_REFERENCE=DIR, also learns from the logs of a real machine, DIR/hardware/double-pendulum.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source "$here/../../.ci/needs.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
logs=${LEASTACTION_REFERENCE:+$(realpath "$LEASTACTION_REFERENCE")/hardware/double-pendulum}
model=$here/../../firmware-sim/chip/models/pendulum.postcard
own=$(uname -m) trace=

fail() {
    printf '%s\n' "$*" >&2
    exit 1
}

# Runs the command of the unpacked archive, in an empty environment but for the folder in which it lies.
leastaction() { env -i PATH="$top/bin" HOME="$work" "${emulator[@]}" "$top/bin/leastaction" "$@"; }

# Whether a file exists and is not empty.
written() {
    local file
    for file in "$@"; do [ -s "$file" ] || fail "$name: no $file was written"; done
}

check_documents() {
    local shell page
    for shell in bash:bash-completion/completions/leastaction zsh:zsh/site-functions/_leastaction fish:fish/vendor_completions.d/leastaction.fish \
        powershell:powershell/leastaction.ps1; do
        leastaction completions "${shell%%:*}" | cmp - "$top/share/${shell#*:}"
    done
    bash -n "$top/share/bash-completion/completions/leastaction"
    if ! command -v man >/dev/null; then echo "$name: no man, which would render the manual pages"; fi
    for page in "$top"/share/man/man1/*.1; do
        ! command -v man >/dev/null || MANPAGER=cat man --warnings -l "$page" 2>&1 | grep -q leastaction || fail "$page does not render"
    done
    written "$top"/{README.md,LICENSE-MIT,LICENSE-APACHE,LICENSES-OF-PARTS}
}

# The three minutes of README.md.
check_sample() {
    local held
    cp -r "$top/share/leastaction" "$work/mine"
    cd "$work/mine"
    leastaction generate pendulum --robot generated --trajectories 2 --samples 101 >/dev/null
    leastaction look "generated/*.csv" >/dev/null
    leastaction look "logs/*.csv" -o guessed.toml >/dev/null
    leastaction train pendulum.toml -o run --quiet >/dev/null 2>&1
    leastaction export run -o m.postcard --rust model.rs >/dev/null
    leastaction export m.postcard --fmu pendulum.fmu >/dev/null 2>&1
    leastaction evaluate m.postcard --data logs/05.csv --config pendulum.toml >/dev/null
    held=$(leastaction inspect m.postcard)
    written guessed.toml run/report.html m.postcard model.rs pendulum.fmu
    [[ $held == *"bodies"* ]] || fail "$name: the model is not one of bodies: $held"
    printf '%s: model %s\n' "$name" "$(sha256sum <m.postcard | cut -c1-16)"
}

# Simulates a learned pendulum; all archives give the same trace.
check_trace() {
    local found
    found=$(leastaction simulate "$model" --scenario swing-up --seed 3 --json | sed -n 's/.*"trace_hash":"\([^"]*\)".*/\1/p')
    [ -n "$found" ] || fail "$name: the simulation has no trace"
    [ "${trace:=$found}" = "$found" ] || fail "$name: trace $found, others $trace"
    printf '%s: trace %s\n' "$name" "$found"
}

# Calls the library of units as simulators do, if it is this machine's.
check_library() {
    [ ${#emulator[@]} = 0 ] || return 0
    python3 -c 'import ctypes, sys; f = ctypes.CDLL(sys.argv[1]).fmi3GetVersion; f.restype = ctypes.c_char_p; assert f() == b"3.0", f()' \
        "$top/lib/libleastaction_fmu.so" || fail "$name: the library of units does not load"
    readelf -V "$top/lib/libleastaction_fmu.so" | grep -o 'GLIBC_[0-9.]*' | sort -Vu | tail -1 | sed "s/^/$name: library of units needs /"
}

# Learns from the logs of a real machine.
check_machine() {
    local begun=$SECONDS
    mkdir "$work/machine"
    cd "$work/machine"
    tar -C "$work/machine" -xzf "$archive"
    leastaction look "$logs/*.csv" -o robot.toml >/dev/null 2>&1
    leastaction train robot.toml -o run --quiet >/dev/null 2>&1
    leastaction export run -o m.postcard >/dev/null
    written m.postcard run/report.html
    printf '%s: from the archive to a model of logs of a real machine and its page, %s s\n' "$name" $((SECONDS - begun))
}

check() {
    local begun=$SECONDS
    archive=$(realpath "$1") name=$(basename "$1" .tar.gz)
    rm -rf "${work:?}"/*
    tar -C "$work" -xzf "$archive"
    top=$work/$name emulator=()
    if [[ $name != leastaction-*-"$own"* ]]; then
        machine=${name#leastaction-*-} && machine=${machine%%-*} && machine=${machine%_v3}
        need "qemu-$machine:qemu-user"
        emulator=("$(command -v "qemu-$machine")")
    fi
    [[ $name != *musl ]] || ! readelf -lW "$top/bin/leastaction" | grep INTERP || fail "$name: the command is not static"
    [ "$(leastaction --version)" = "$(sed 's/^\(leastaction\)-\([^-]*\)-.*/\1 \2/' <<<"$name")" ] || fail "$name: $(leastaction --version)"
    check_sample
    printf '%s: from the archive to models in every format, %s s\n' "$name" $((SECONDS - begun))
    check_trace
    check_documents
    check_library
    if [ -d "$logs" ] && [ ${#emulator[@]} = 0 ]; then check_machine; fi
}

[ $# != 0 ] || { echo "name archives: check.sh ARCHIVE..." >&2 && exit 2; }
files=()
for file in "$@"; do files+=("$(realpath "$file")"); done
for file in "${files[@]}"; do check "$file"; done
