#!/usr/bin/env bash
# Fuzzes: `run.sh` every target for a minute, `run.sh TARGET SECONDS` one of them. Stable Rust and a C++ compiler are enough.
#   load        model files of every family, their checksum corrected
#   steps       like load, then accelerations and ten steps of either order
#   plan        files of plans, their checksum corrected, followed from many states
#   link        bytes and requests sent to a processor
#   csv npz mcap db3 mat toml urdf safetensors checkpoint   the other readers
# A target begins with inputs from our own writers and from earlier runs (corpus/TARGET, which grows), and ends with a line of executions,
# seconds, covered branches and peak memory. It fails, with the input in found/, if a reader panics, takes longer than 10 s or uses more
# than 1 GB (`MEMORY`, in MB). Further options are libFuzzer's: `run.sh load 60 -jobs=2`.
set -euo pipefail
cd "$(dirname "$0")"
targets=(load steps plan link csv npz mcap db3 mat toml urdf safetensors checkpoint)
target=${1:-all} seconds=${2:-60}
shift $(($# < 2 ? $# : 2))

host=$(rustc -vV | sed -n 's/^host: //p')
out=${CARGO_TARGET_DIR:-$PWD/target}
# Coverage by LLVM's own pass, with cargo-fuzz's options; without a sanitizer, which stable Rust lacks: memory is safe without unsafe code,
# and a failed assertion ends the process.
export RUSTFLAGS="--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
-Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
-Cllvm-args=-sanitizer-coverage-trace-compares -Ctarget-cpu=native"
features_of() {
    case $1 in
        link | steps) echo "$1" ;;
        csv | npz | mcap | db3 | mat) echo logs ;;
        urdf) echo arms ;;
        toml | safetensors | checkpoint) echo learning ;;
    esac
}
build() { cargo build --quiet --release --target "$host" --target-dir "$out/fuzz" "$@"; }
export CXXFLAGS=-O2

# Maximum length of inputs, bytes.
longest() {
    case $1 in
        load | steps | checkpoint) echo 4096 ;;
        link | plan) echo 1024 ;;
        csv) echo 512 ;;
        db3) echo 16384 ;;
        *) echo 8192 ;;
    esac
}

fuzz() {
    local name=$1 log status=0 features=()
    shift
    [ -z "$(features_of "$name")" ] || features=(--features "$(features_of "$name")")
    build "${features[@]}" --bin seeds --bin "$name"
    "$out/fuzz/$host/release/seeds" corpus
    mkdir -p "corpus/$name" found
    log=$(mktemp)
    "$out/fuzz/$host/release/$name" "corpus/$name" -max_total_time="$seconds" -max_len="$(longest "$name")" -timeout=10 \
        -rss_limit_mb="${MEMORY:-1024}" -artifact_prefix="found/$name-" -print_final_stats=1 "$@" >"$log" 2>&1 || status=$?
    awk -v name="$name" '
        /cov: /{for (i = 1; i < NF; i++) if ($i == "cov:") branches = $(i + 1)}
        /number_of_executed_units/{executions = $2}
        /average_exec_per_sec/{rate = $2}
        /peak_rss_mb/{memory = $2}
        /^Done /{for (i = 1; i < NF; i++) if ($i == "in") seconds = $(i + 1)}
        END {printf "%s: %s executions in %s s (%s/s), %s branches, %s MB\n", name, executions, seconds, rate, branches, memory}' "$log"
    if [ $status -ne 0 ]; then
        grep -E "panicked|ERROR|assert|left:|right:|Test unit written" -A1 "$log" | head -40 >&2
        printf '%s: failed; the input is in found/\n' "$name" >&2
    fi
    rm "$log"
    return $status
}

[ "$target" != all ] || target=${targets[*]}
for name in $target; do fuzz "$name" "$@"; done
