#!/usr/bin/env bash
# Writes model and plan as a source file of C: model.sh MODEL PLAN > model.c
set -euo pipefail
array() {
    printf 'LEASTACTION_ALIGNED const uint8_t %s[] = {\n' "$1"
    od -An -v -tu1 -w24 "$2" | sed 's/  *\([0-9]\)/\1/; s/  *\([0-9]\)/, \1/g; s/$/,/'
    printf '};\nconst size_t %s_bytes = sizeof %s;\n' "$1" "$1"
}
cat <<'END'
/* Model and plan, in flash, at multiples of 4. Written by model.sh. */
#include "machine.h"
#if defined(__GNUC__)
#define LEASTACTION_ALIGNED __attribute__((aligned(4)))
#else
#define LEASTACTION_ALIGNED _Alignas(4)
#endif
END
array machine_model "$1"
array machine_plan "$2"
