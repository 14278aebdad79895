# Sourced by checks. A check that this machine cannot run is skipped, not failed: it ends with code 77, as tests of Automake do, after a line
# "skipped: REASON" on stderr. `.ci/release` lists it apart; for whoever calls the check alone it has not passed.

# Ends the check as skipped, with a reason.
skip() {
    printf 'skipped: %s\n' "$*" >&2
    exit 77
}

# Installs Debian's packages, or skips the check.
install() {
    local reason="$* cannot be installed here"
    if ! command -v apt-get >/dev/null; then skip "$reason: no apt-get"; fi
    if [ "$(id -u)" != 0 ]; then skip "$reason: not root; apt-get install $*"; fi
    echo "installing $*" >&2
    # An old list names versions that are gone, and a new one needs the network.
    { apt-get install -y -qq --no-install-recommends "$@" || { apt-get update -qq && apt-get install -y -qq --no-install-recommends "$@"; }; } >&2 ||
        skip "$reason"
}

# Installs the packages of commands that are missing, each COMMAND:PACKAGE, or skips the check.
need() {
    local pair missing=()
    for pair in "$@"; do
        command -v "${pair%%:*}" >/dev/null || missing+=("${pair#*:}")
    done
    [ ${#missing[@]} = 0 ] || install "${missing[@]}"
}

# Adds something to the compiler by rustup, if that can be had.
rustup_add() { command -v rustup >/dev/null && timeout 120 rustup "$1" add "$2" >/dev/null 2>&1; }

# Whether the compiler has a target, which is added if it can be.
has_target() { [ -d "$(rustc --print target-libdir --target "$1" 2>/dev/null)" ] || rustup_add target "$1"; }

# Makes sure of a target of rustup, or skips the check.
need_target() { has_target "$1" || skip "no Rust for $1: rustup target add $1"; }
