#!/usr/bin/env bash
# Compiles the ROS 2 package against the interfaces in stated/, with and without sanitizers, and runs its tests on fake hardware, with an arm
# that is learned here; installs it, and loads its plugins by pluginlib. Installs what is missing.
#   check.sh [LEASTACTION]     (a compiled command; without it cargo builds one)
set -euo pipefail
command=${1:+$(realpath "$1")}
cd "$(dirname "$0")"
root=$(cd .. && pwd)
source ../.ci/needs.sh
out=$(realpath -m "${CARGO_TARGET_DIR:-$root/target}")/ros2
files=$out/files
mkdir -p "$files"

packages=()
[ -e /usr/include/pluginlib/pluginlib/class_loader.hpp ] || packages+=(pluginlib-dev libclass-loader-dev)
[ -e /usr/share/ament_cmake/cmake/ament_cmakeConfig.cmake ] || packages+=(ament-cmake)
[ -e /usr/include/eigen3/Eigen/Core ] || packages+=(libeigen3-dev)
command -v cmake >/dev/null || packages+=(cmake)
command -v g++ >/dev/null || packages+=(g++)
command -v xmllint >/dev/null || packages+=(libxml2-utils)
[ ${#packages[@]} = 0 ] || install "${packages[@]}"

leastaction() {
    if [ -n "$command" ]; then "$command" "$@"; else cargo run --quiet --release --manifest-path "$root/Cargo.toml" --package leastaction -- "$@"; fi
}

# A file with one byte inverted.
damaged() {
    local at=$(($(stat -c %s "$1") / 2)) byte
    byte=$(od -An -tu1 -j $at -N1 "$1")
    cp "$1" "$2"
    # shellcheck disable=SC2059
    printf "\\x$(printf %02x $((byte ^ 255)))" | dd of="$2" bs=1 seek=$at conv=notrunc status=none
}

# The arm of the demo, a plan for it, and one for the arm that it was learned from.
rm -rf "$files/demo"
leastaction demo arm --out "$files/demo" >"$files/demo.log" 2>&1 || { cat "$files/demo.log" >&2 && exit 1; }
cp "$files/demo/arm.postcard" leastaction_ros2/test/reach.toml "$files"
leastaction plan "$files/reach.toml" -o "$files/reach" --quiet >"$files/reach.log"
sed 's/^model = .*/model = "demo\/plant.postcard"/; s/^q = .*/q = [0.0, 0.4, -0.8, 0.0, 0.5, 0.0]/; s/^seconds = .*/seconds = 0.1/' \
    "$files/reach.toml" >"$files/rest.toml"
leastaction plan "$files/rest.toml" -o "$files/rest" --quiet >"$files/rest.log"
cp "$files/reach/plan.postcard" "$files/reach.postcard"
cp "$files/rest/plan.postcard" "$files/other-plan.postcard"
damaged "$files/arm.postcard" "$files/damaged.postcard"
damaged "$files/reach.postcard" "$files/damaged-plan.postcard"
: >"$files/empty.postcard"
models=$root/firmware-sim/chip/models
cp "$models/cartpole-dry.postcard" "$files/cartpole.postcard"
cp "$models/swing-up.postcard" "$files"
cp "$models/arm.postcard" "$files/seven.postcard"

# Debian's ament is for Debian's Python, whatever else is installed.
configure() {
    cmake -S leastaction_ros2 -B "$1" -DLEASTACTION_ROS2_STATED=ON -DTEST_FILES="$files" -DCMAKE_INSTALL_PREFIX="$out/installed" \
        -DPython3_EXECUTABLE=/usr/bin/python3 -DCMAKE_CXX_FLAGS="-Wconversion -Werror $3" -DCMAKE_BUILD_TYPE="$2" "${@:4}"
}

# Configures, compiles and tests in a folder.
tested() {
    { configure "$@" && cmake --build "$1" --parallel 2; } >"$1.log" 2>&1 || { cat "$1.log" >&2 && exit 1; }
    ctest --test-dir "$1" --output-on-failure >"$1.log" 2>&1 || { cat "$1.log" >&2 && exit 1; }
    grep -c '^ *[0-9]*/[0-9]* Test.*Passed' "$1.log" | sed "s|^|$(basename "$1"): passed |"
}

sanitizers="-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer"
tested "$out/plain" Release "" -DLEASTACTION_COORDINATES=6
tested "$out/sanitized" Debug "$sanitizers" -DLEASTACTION_COORDINATES=6
tested "$out/cartpole" Debug "$sanitizers" -DLEASTACTION_COORDINATES=2 "-DLEASTACTION_FEATURES=bodies;friction" -DTESTS=cartpole
for test in plain/test/solver plain/test/controller cartpole/test/cartpole; do "$out/$test" "$files"; done

# The installation is what a workspace has: plugins are found by the index of ament. The stated interfaces are no part of it.
rm -rf "$out/installed"
cmake --install "$out/plain" >"$out/installed.log"
if find "$out/installed" -name '*.hpp' | grep .; then echo "headers were installed" >&2 && exit 1; fi
# The index must also name the packages of the base classes, which are not installed here.
index=$out/upstream/share/ament_index/resource_index/packages
mkdir -p "$index"
touch "$index/inverse_dynamics_solver" "$index/controller_interface"
AMENT_PREFIX_PATH=$out/installed:$out/upstream "$out/plain/test/plugins"
! nm -D --defined-only "$out/installed/lib/libleastaction_ros2.so" | grep ' leastaction_load$' ||
    { echo "the C library's names are visible" >&2 && exit 1; }
xmllint --noout leastaction_ros2/*.xml

# Sizes are needed, rods and position servos refused, with words.
refused() {
    local said
    said=$(cmake -S leastaction_ros2 -B "$out/refused" -DLEASTACTION_ROS2_STATED=ON "${@:2}" 2>&1) && { echo "accepted: $1" >&2 && exit 1; }
    [[ $said == *"$1"* ]] || { printf '%s\n' "$said" >&2 && exit 1; }
    rm -rf "$out/refused"
}
refused "LEASTACTION_COORDINATES"
refused "feature rods" -DLEASTACTION_COORDINATES=6 "-DLEASTACTION_FEATURES=graph;rods"
refused "feature servo" -DLEASTACTION_COORDINATES=6 "-DLEASTACTION_FEATURES=arm;servo"
python3 - leastaction_ros2/launch/*.py <<'END'
import ast, sys
for path in sys.argv[1:]:
    ast.parse(open(path).read(), path)
END
printf 'the ROS 2 package is well\n'
