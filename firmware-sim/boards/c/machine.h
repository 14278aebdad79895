/* The machine that every C template controls, as ../machine is for Rust: a plan is followed, and its end held. What is yours is marked CHANGE. */
#ifndef MACHINE_H
#define MACHINE_H

#include "leastaction.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { MACHINE_N = LEASTACTION_COORDINATES, MACHINE_WINDOW = 3 };

/* CHANGE 1: model and plan; model.sh writes model.c from their files. */
extern const uint8_t machine_model[], machine_plan[];
extern const size_t machine_model_bytes, machine_plan_bytes;

/* CHANGE 2: m or rad of an encoder's count, and its counts at q = 0: machine.c. */
extern const float machine_unit[MACHINE_N];
extern const int32_t machine_zero[MACHINE_N];

/* CHANGE 3: force of the drive at full duty, N or N m. CHANGE 4: the driven coordinate. CHANGE 5 is in the template: its pins. */
static const float machine_full = 12.0f;
enum { MACHINE_DRIVEN = 0 };

/* The loop's state; static storage, as it starts as zeros. */
typedef struct {
    leastaction_model model;
    leastaction_plan plan;
    leastaction_plan_description description;
    float turns[MACHINE_N];
    float past[MACHINE_WINDOW][MACHINE_N];
    uint32_t readings, tick;
} machine;

/* All counts of an encoder whose counter forgets rounds of `range` counts, from those before and a reading: it moved by less than half a round. */
int32_t machine_count(int32_t total, int32_t reading, int32_t range);

/* Loads model and plan; a status says what is wrong with them, leastaction_message in words. */
leastaction_status machine_begin(machine *it);

/* Length of a tick, s. */
float machine_period(const machine *it);

/* Takes the encoders' counts, `elapsed` ticks after the last call, and writes the drive's duty, from -1 to 1: 0 until the velocities are known,
 * and after an error, whose status is returned. A tick whose encoders did not answer is left out: call again with one tick more. */
leastaction_status machine_tick(machine *it, uint32_t elapsed, const int32_t *counts, float *duty);

#ifdef __cplusplus
}
#endif
#endif
