#!/usr/bin/env bash
# Builds portable wheels for Linux in DIR, for every Python from 3.9 on, with their checksums in DIR/SHA256SUMS.
#   trainer/python/wheel.sh [--target x86_64|aarch64]... [--profile NAME] [--plain] DIR
# --target   processor; by default this machine's. May be given twice.
# --profile  profile of Cargo, by default "wheel"; "release" compiles faster, and searches of plans run slower.
# --plain    on x86_64 one build for x86-64-v2, without those for AVX2 and AVX-512 beside it.
# maturin and ziglang, which links against an old glibc (2.17) and for other processors, are installed in a virtual environment of their own,
# and so are auditwheel and twine, which check the wheels if they can be installed. A wheel for this machine is installed in a fresh environment
# and tried; one for aarch64 is tried in an emulator if qemu-aarch64 and a Python for aarch64 are at hand ($AARCH64_PYTHON), else it says
# that it was not run.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
targets=() profile=wheel levels=(3 4) to=
while [ $# -gt 0 ]; do
    case $1 in
        --target) targets+=("${2:?--target takes x86_64 or aarch64}") && shift 2 ;;
        --profile) profile=${2:?--profile takes a name} && shift 2 ;;
        --plain) levels=() && shift ;;
        -*) echo "$1 is unknown: wheel.sh [--target x86_64|aarch64]... [--profile NAME] [--plain] DIR" >&2 && exit 2 ;;
        *) to=$1 && shift ;;
    esac
done
[ -n "$to" ] || { echo "name a folder for the wheels" >&2 && exit 2; }
own=$(uname -m)
[ ${#targets[@]} -gt 0 ] || targets=("$own")
for target in "${targets[@]}"; do
    case $target in
        x86_64 | aarch64) ;;
        *) echo "--target $target: there are x86_64 and aarch64" >&2 && exit 2 ;;
    esac
    # Without rustup it is left to the compiler to say what is missing.
    if command -v rustup >/dev/null && ! rustup target list --installed | grep -qx "$target-unknown-linux-gnu"; then
        echo "no Rust for $target: rustup target add $target-unknown-linux-gnu" >&2 && exit 2
    fi
done
mkdir -p "$to" && to=$(cd "$to" && pwd)
build=${CARGO_TARGET_DIR:-$here/../../target}/wheels-portable
package=$here/python/leastaction
work=$(mktemp -d)
trap 'rm -rf "$work" "$package"/x86_64_v[34]' EXIT

python3 -m venv "$work/tools"
tools=$work/tools/bin
"$tools/python" -m pip install --quiet 'maturin>=1.9,<2' ziglang
for tool in auditwheel twine; do
    "$tools/python" -m pip install --quiet "$tool" || echo "$tool cannot be installed, so it does not check the wheels"
done
export PATH=$tools:$PATH

# Builds a wheel: folder, processor, and its instruction level or nothing.
build_wheel() {
    local flags=${3:+-Ctarget-cpu=$3}
    RUSTFLAGS="${RUSTFLAGS:-} $flags" CARGO_TARGET_DIR=$build/${3:-$2} maturin build --quiet --manifest-path "$here/Cargo.toml" \
        --profile "$profile" --target "$2-unknown-linux-gnu" --zig --compatibility manylinux2014 --out "$1"
}

made=()
for target in "${targets[@]}"; do
    level=
    if [ "$target" = x86_64 ]; then
        for number in ${levels[@]+"${levels[@]}"}; do
            build_wheel "$work/v$number" x86_64 "x86-64-v$number"
            mkdir -p "$package/x86_64_v$number"
            python3 -m zipfile -e "$work/v$number"/*.whl "$work/v$number/unpacked"
            cp "$work/v$number/unpacked/leastaction/_leastaction.abi3.so" "$package/x86_64_v$number/"
        done
        level=x86-64-v2
    fi
    rm -rf "$work/wheel"
    build_wheel "$work/wheel" "$target" "$level"
    rm -rf "$package"/x86_64_v[34]
    cp "$work/wheel"/*.whl "$to/"
    made+=("$to/$(basename "$work/wheel"/*.whl)")
done

# A wheel is tried with a model that is read from a robot description: no other file is needed.
cat >"$work/try.py" <<'PYTHON'
import platform
import numpy as np
import leastaction as la

MJCF = """<mujoco><worldbody><body><joint name="pivot" axis="0 -1 0"/>
<inertial pos="0 0 -0.5" mass="1" diaginertia="0.1 0.1 0.01"/></body></worldbody></mujoco>"""
open("pendulum.xml", "w").write(MJCF)
model = la.from_description("pendulum.xml")
found = model.inverse_dynamics([[0.5]], [[0.0]], [[0.0]])[0, 0]
assert abs(found - 9.81 * 0.5 * np.sin(0.5)) < 1e-5, found
q = model.rollout([0.5], [0.0], steps=100, h=0.01, order=2).q
energies = np.array([sum(model.energies(q[k], [0.0])) for k in (0, -1)])
assert la.from_bytes(model.to_bytes()).n == 1 and np.isfinite(q).all() and np.isfinite(energies).all()
assert '"parts":' in la.viewer.show(model, q, 0.01 * np.arange(101)).html
print(f"tried: leastaction {la.__version__} on {platform.machine()}, Python {platform.python_version()}, bits of q {q.tobytes().hex()[-16:]}")
PYTHON

try_wheel() {
    python3 -m venv "$work/fresh"
    "$work/fresh/bin/python" -m pip install --quiet "$1"
    (cd "$work" && "$work/fresh/bin/python" try.py)
}

for wheel in "${made[@]}"; do
    command -v auditwheel >/dev/null && { auditwheel show "$wheel" || echo "auditwheel does not read $wheel"; }
    case $wheel in
        *"$own".whl) try_wheel "$wheel" ;;
        *aarch64.whl)
            if command -v qemu-aarch64 >/dev/null && [ -n "${AARCH64_PYTHON:-}" ]; then
                python3 -m zipfile -e "$wheel" "$work/aarch64"
                (cd "$work" && PYTHONPATH=$work/aarch64 qemu-aarch64 "$AARCH64_PYTHON" try.py)
            else
                echo "not run: $(basename "$wheel"), since there is no emulator with a Python for aarch64"
            fi
            ;;
        *) echo "not run: $(basename "$wheel"), on a machine of another kind" ;;
    esac
done
if command -v twine >/dev/null; then twine check "${made[@]}"; fi
(cd "$to" && sha256sum ./*.whl | sed 's# \./# #' >SHA256SUMS && cat SHA256SUMS)
