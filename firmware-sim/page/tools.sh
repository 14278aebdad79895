# Sourced by build.sh and check.sh, in this folder: the machines of the page, the command and the module.

# Names, in the module's order; models and options of `leastaction simulate --scenario mpc`, as in ../chip/hil.sh.
machines=(pendulum cartpole cartpole-dry acrobot pendubot)
declare -A model=([pendulum]=pendulum [cartpole]=cartpole [cartpole-dry]=cartpole-dry [acrobot]=acrobot [pendubot]=acrobot)
declare -A options=(
    [pendulum]="" [cartpole]="" [acrobot]="" [pendubot]="--limit 8,0"
    [cartpole-dry]="--coulomb 0.5,0 --width 0.05 --gain 0.9,1 --delay 8 --zeros 0.02 --noise 0.001 --learn-zeros 0.02"
)
root=$(cd ../.. && pwd)
source ../../.ci/needs.sh
host_target=$(cd "$root" && realpath -m "${CARGO_TARGET_DIR:-target}")
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

# Sets `leastaction` to the command, which LEASTACTION names, from the root of the repository, if it is already built.
command_of_host() {
    leastaction=${LEASTACTION:+$(cd "$root" && realpath "$LEASTACTION")}
    [ -z "$leastaction" ] || return 0
    (cd "$root" && CARGO_TARGET_DIR=$host_target cargo build --quiet --package leastaction)
    leastaction=$host_target/debug/leastaction
}

# Prints the hash of a machine's trace on this machine.
hash_of_host() {
    "$leastaction" simulate "../chip/models/${model[$1]}.postcard" --scenario mpc --seed "$2" ${options[$1]} --output "$folder" --json |
        sed -E 's/.*"trace_hash":"([^"]*)".*/\1/'
}

# Builds the module, and sets `module` to its file.
build_module() {
    source ../chip/compiler.sh
    compiler wasm32-unknown-unknown
    RUSTFLAGS= "${cargo[@]}" build --quiet --release --locked --target wasm32-unknown-unknown --target-dir "$host_target/page"
    module=$host_target/page/wasm32-unknown-unknown/release/leastaction_page.wasm
}
