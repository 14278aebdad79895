# Sourced by the scripts of this folder, in it: boards, builds, emulators.
source ./compiler.sh

boards=(cortex-m4f cortex-m7 riscv32imac)
host_target=${CARGO_TARGET_DIR:-target}
# Separate from the host's, for builds of the standard library's source.
export CARGO_TARGET_DIR=${LEASTACTION_CHIP_TARGET:-$PWD/../../target/chip}

emulator_of() { [[ $1 == riscv32* ]] && echo qemu-system-riscv32 || echo qemu-system-arm; }

need_emulator() { need "$1:$([ "$1" = qemu-system-arm ] && echo qemu-system-arm || echo qemu-system-misc)"; }

target_of() {
    case $1 in
        riscv32*) echo "$1-unknown-none-elf" ;;
        cortex-m0) echo thumbv6m-none-eabi ;;
        *) echo thumbv7em-none-eabihf ;;
    esac
}

# Most loops here have few iterations: unrolled, they take a quarter more flash and are hardly faster.
flags_of() {
    local rolled=${LEASTACTION_CHIP_FLAGS--Cllvm-args=-unroll-runtime=0 -Cllvm-args=-unroll-max-upperbound=0}
    case $1 in
        cortex-m4f) echo "-Ctarget-cpu=cortex-m4 $rolled" ;;
        cortex-m7) echo "-Ctarget-cpu=cortex-m7 $rolled" ;;
        *) echo "" ;;
    esac
}

build() {
    local board=$1 target
    target=$(target_of "$board")
    compiler "$target"
    RUSTFLAGS=$(flags_of "$board") "${cargo[@]}" build --quiet --release --target "$target" \
        --target-dir "$CARGO_TARGET_DIR/$board" "${@:2}"
}

program() { echo "$CARGO_TARGET_DIR/$1/$(target_of "$1")/release/$2"; }

# Runs an image with a number placed in its flash; one instruction takes one virtual nanosecond.
emulate() {
    local board=$1 elf=$2 machine emulator slot=0x3f0000 bios=()
    emulator=$(emulator_of "$board")
    case $board in
        cortex-m4f) machine=mps2-an386 ;;
        cortex-m7) machine=mps2-an500 ;;
        cortex-m0) machine=microbit slot=0x30000 ;;
        *) machine=virt slot=0x803f0000 bios=(-bios none) ;;
    esac
    need_emulator $emulator
    timeout "${LEASTACTION_CHIP_TIMEOUT:-600}" $emulator -M $machine "${bios[@]}" -display none -monitor none -serial none \
        -semihosting-config enable=on,target=native -icount shift=0 -device "loader,addr=$slot,data=$3,data-len=4" \
        "${@:4}" -kernel "$elf"
}

# Prints the emulator's arguments that place a model file in the slot of a board's flash.
with_model() {
    local slot=0x3f0000
    [ "$1" != riscv32imac ] || slot=0x803f0000
    echo -device loader,addr=$((slot + 4)),data="$(stat -c %s "$2")",data-len=4 \
        -device loader,addr=$((slot + 8)),file="$2",force-raw=on
}

# Prints the bytes of code, of constants, and of static memory.
sections() {
    local text=0 rodata=0 ram=0 name size
    while read -r name _ _ _ size _; do
        case $name in
            .text) text=$((16#$size)) ;;
            .rodata) rodata=$((16#$size)) ;;
            .data | .bss) ram=$((ram + 16#$size)) ;;
        esac
    done < <(readelf -SW "$1" | sed -n 's/^ *\[ *[0-9]*\] //p')
    echo $text $rodata $ram
}

# Prints the value of a name in $output, the output of an image.
value() { sed -n "s/^$1 //p" <<<"$output"; }

# Prints the sizes and measurements of an image as JSON members.
measures() {
    printf '"text_bytes": %s, "rodata_bytes": %s, "ram_bytes": %s' $(sections "$1")
    printf ', "load_stack_bytes": %s, "acceleration_stack_bytes": %s, "stack_bytes": %s' \
        "$(value load_stack)" "$(value acceleration_stack)" "$(value step_stack)"
    printf ', "acceleration_instructions": %s, "step_instructions": %s, "step_instructions_worst": %s' \
        "$(value acceleration_instructions)" "$(value step_instructions)" "$(value step_instructions_worst)"
    local inverse
    inverse=$(value inverse_dynamics_instructions)
    [ -z "$inverse" ] || printf ', "inverse_dynamics_instructions": %s, "inverse_dynamics_stack_bytes": %s' "$inverse" "$(value inverse_dynamics_stack)"
}
