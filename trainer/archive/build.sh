#!/usr/bin/env bash
# Builds release archives in DIR, leastaction-VERSION-TARGET.tar.gz, with their checksums in DIR/SHA256SUMS.
#   trainer/archive/build.sh [--target x86_64|x86_64_v3|aarch64]... [--profile NAME] DIR
# --target   processor; by default this machine's. May be given several times. x86_64 is x86-64-v2, every processor since 2009; x86_64_v3 has
#            AVX2 and fused multiply-add, since 2013.
# --profile  profile of Cargo, by default "wheel"; "release" compiles faster, and searches of plans run slower.
# The command is linked statically with musl, by Rust's own linker, and runs on every Linux; Zig compiles its allocator, which is in C. The
# library of units is loaded by simulators, which have a glibc: cargo-zigbuild links it against an old one (2.17). Both tools are installed in
# a virtual environment of their own. Without them, or without Rust's target for musl, both are linked with this machine's glibc, and the
# archive's name says so.
# Equal sources, compilers and profiles give equal bytes: times of files are those of the commit, or SOURCE_DATE_EPOCH.
set -euo pipefail
# A failure within $( ) ends the script, too.
shopt -s inherit_errexit
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
targets=() profile=wheel to=
while [ $# -gt 0 ]; do
    case $1 in
        --target) targets+=("${2:?--target takes x86_64, x86_64_v3 or aarch64}") && shift 2 ;;
        --profile) profile=${2:?--profile takes a name} && shift 2 ;;
        -*) echo "$1 is unknown: build.sh [--target x86_64|x86_64_v3|aarch64]... [--profile NAME] DIR" >&2 && exit 2 ;;
        *) to=$1 && shift ;;
    esac
done
[ -n "$to" ] || { echo "name a folder for the archives" >&2 && exit 2; }
own=$(uname -m)
[ ${#targets[@]} -gt 0 ] || targets=("$own")
for target in "${targets[@]}"; do
    case $target in
        x86_64 | x86_64_v3 | aarch64) ;;
        *) echo "--target $target: there are x86_64, x86_64_v3 and aarch64" >&2 && exit 2 ;;
    esac
done
mkdir -p "$to" && to=$(cd "$to" && pwd)
cd "$root"
built=${CARGO_TARGET_DIR:-$root/target}/archives
version=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}
export SOURCE_DATE_EPOCH CARGO_INCREMENTAL=0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Whether Rust has a target, or rustup can install it.
has_target() {
    [ -d "$(rustc --print target-libdir --target "$1" 2>/dev/null)" ] ||
        { command -v rustup >/dev/null && timeout 120 rustup target add "$1" >/dev/null 2>&1; }
}

# Compiler's flags of a processor. Paths of this machine's folders stay out of the programs.
flags_of() {
    local cpu=
    case $1 in
        x86_64) cpu=-Ctarget-cpu=x86-64-v2 ;;
        x86_64_v3) cpu=-Ctarget-cpu=x86-64-v3 ;;
    esac
    echo "$cpu -Cstrip=symbols --remap-path-prefix=$root=leastaction --remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=cargo"
}

# Makes Zig the compiler of C for a target.
c_compiler() {
    local variable=${1//-/_}
    printf '#!/bin/sh\nexec cargo-zigbuild zig cc -- "$@" -target %s-linux-musl -g0\n' "${1%%-*}" >"$work/cc-$1"
    printf '#!/bin/sh\nexec cargo-zigbuild zig ar "$@"\n' >"$work/ar"
    chmod +x "$work/cc-$1" "$work/ar"
    export "CC_$variable=$work/cc-$1" "AR_$variable=$work/ar"
}

# Builds the command of a processor, and prints its file.
build_command() {
    local triple=$2 flags
    flags=$(flags_of "$1")
    if [[ $triple == *musl ]]; then
        flags+=" -Clinker=rust-lld"
        c_compiler "$triple"
    fi
    RUSTFLAGS=$flags cargo build --quiet --locked --profile "$profile" --package leastaction --target "$triple" --target-dir "$built/$1"
    echo "$built/$1/$triple/$profile/leastaction"
}

# Builds the library of units of a processor, and prints its file.
build_library() {
    local triple=${1%_v3}-unknown-linux-gnu build=(cargo build) glibc=
    if command -v cargo-zigbuild >/dev/null; then build=(cargo zigbuild) glibc=.2.17; fi
    has_target "$triple" || { echo "no Rust for $triple, which the library of units needs: rustup target add $triple" >&2 && return 2; }
    RUSTFLAGS=$(flags_of "$1") "${build[@]}" --quiet --locked --profile "$profile" --package leastaction-fmu --lib --target "$triple$glibc" \
        --target-dir "$built/$1-units"
    echo "$built/$1-units/$triple/$profile/libleastaction_fmu.so"
}

# Runs the command of a processor on this machine, if it can.
run() {
    local target=${1%_v3} emulator=()
    [ "$target" = "$own" ] || emulator=("qemu-$target")
    "${emulator[@]}" "${@:2}"
}

# What every archive has beside its programs: completions, manual pages, the sample, and the licences of all that is linked.
write_documents() {
    local share=$work/documents/share
    mkdir -p "$share"/{man/man1,bash-completion/completions,zsh/site-functions,fish/vendor_completions.d,powershell,leastaction}
    run "$@" completions bash >"$share/bash-completion/completions/leastaction"
    run "$@" completions zsh >"$share/zsh/site-functions/_leastaction"
    run "$@" completions fish >"$share/fish/vendor_completions.d/leastaction.fish"
    run "$@" completions powershell >"$share/powershell/leastaction.ps1"
    run "$@" man "$share/man/man1" >/dev/null
    run "$@" generate pendulum --robot "$share/leastaction/logs" --trajectories 6 --samples 501 --amplitude 2,8 --frequency 0.3,2 \
        --spread 0.5 --coulomb 0.2 --viscous 0.05 --width 0.05 --gain 0.9 --delay 8 --zeros 0.01 --noise 0.001 >/dev/null
    cp "$here/pendulum.toml" "$share/leastaction/"
    cp "$here/README.md" LICENSE-APACHE LICENSE-MIT "$work/documents/"
    cargo metadata --locked --format-version 1 --filter-platform "${1%_v3}-unknown-linux-gnu" | python3 "$here/licences.py" "$root" >"$work/documents/LICENSES-OF-PARTS"
}

# Packs a folder; owner, modes, order and times are the same everywhere.
pack() {
    find "$work/$1" -type d -exec chmod 755 {} + -o -type f -exec chmod 644 {} +
    chmod 755 "$work/$1"/bin/* "$work/$1"/lib/*
    tar -C "$work" --sort=name --format=ustar --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" -cf - "$1" | gzip -9n >"$to/$1.tar.gz"
    echo "$to/$1.tar.gz: $(stat -c %s "$to/$1.tar.gz") bytes"
}

# Archive of a processor.
build_archive() {
    local target=$1 triple=${1%_v3}-unknown-linux-musl name command library
    if ! has_target "$triple" || ! command -v cargo-zigbuild >/dev/null; then
        echo "no $triple (rustup target add $triple) or no cargo-zigbuild: linked with this machine's $(ldd --version | head -1)" >&2
        triple=${1%_v3}-unknown-linux-gnu
    fi
    name=leastaction-$version-$target-${triple#*-}
    command=$(build_command "$target" "$triple")
    library=$(build_library "$target")
    [ -d "$work/documents" ] || write_documents "$target" "$command"
    mkdir "$work/$name"
    cp -r "$work/documents/." "$work/$name"
    mkdir "$work/$name"/{bin,lib}
    cp "$command" "$work/$name/bin/"
    cp "$library" "$work/$name/lib/"
    pack "$name"
}

# The first archive's command writes the documents, so it is one that runs here without an emulator, if there is one.
mapfile -t targets < <(printf '%s\n' "${targets[@]}" | awk -v own="$own" 'index($0, own) == 1; index($0, own) != 1 {rest = rest $0 "\n"} END {printf "%s", rest}')
if python3 -m venv "$work/tools" && "$work/tools/bin/python" -m pip install --quiet ziglang==0.17.1 cargo-zigbuild==0.24.1; then
    export PATH=$work/tools/bin:$PATH
else
    echo "cargo-zigbuild cannot be installed" >&2
fi
for target in "${targets[@]}"; do build_archive "$target"; done
(cd "$to" && sha256sum leastaction-*.tar.gz >SHA256SUMS && cat SHA256SUMS)
