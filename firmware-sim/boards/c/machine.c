/* The loop: counts in, duty out. */
#include "machine.h"

const float machine_unit[MACHINE_N] = {1.0f / 20000.0f, 6.2831853f / 4096.0f};
const int32_t machine_zero[MACHINE_N] = {0, 0};

/* Encoders that forget whole turns: none here, as counters keep them. */
static const uint8_t forgets_turns[MACHINE_N] = {0};

int32_t machine_count(int32_t total, int32_t reading, int32_t range) {
    int32_t moved = (reading - total) % range;
    if (moved < -range / 2) moved += range;
    if (moved >= range / 2) moved -= range;
    return total + moved;
}

leastaction_status machine_begin(machine *it) {
    leastaction_status status =
        leastaction_load(&it->model, sizeof it->model, LEASTACTION_ABI, machine_model, machine_model_bytes, NULL, NULL);
    if (status == LEASTACTION_STATUS_OK) {
        status = leastaction_plan_load(&it->plan, sizeof it->plan, LEASTACTION_ABI, machine_plan, machine_plan_bytes, &it->model, NULL);
    }
    if (status == LEASTACTION_STATUS_OK) {
        status = leastaction_plan_describe(&it->plan, &it->description, NULL);
    }
    it->readings = it->tick = 0;
    return status;
}

float machine_period(const machine *it) {
    return it->description.h;
}

/* Takes a reading. Velocities are differences over the window, whose ticks must all be there: a gap begins it anew. */
static void take(machine *it, uint32_t elapsed, const float *q) {
    if (elapsed != 1) it->readings = 0;
    for (int i = 0; i < MACHINE_N; i++) {
        for (int k = MACHINE_WINDOW - 1; k > 0; k--) it->past[k][i] = it->past[k - 1][i];
        it->past[0][i] = q[i];
    }
    it->readings += it->readings < MACHINE_WINDOW;
}

/* The command for the present state, by the plan. */
static leastaction_status decide(machine *it, const float *q, float *duty) {
    float x[MACHINE_N], v[MACHINE_N], u[MACHINE_N];
    leastaction_status status = LEASTACTION_STATUS_OK;
    if (it->tick == 0) status = leastaction_plan_turns(&it->plan, q, forgets_turns, MACHINE_N, it->turns, NULL);
    for (int i = 0; i < MACHINE_N; i++) {
        v[i] = (q[i] - it->past[MACHINE_WINDOW - 1][i]) / (it->description.h * (MACHINE_WINDOW - 1));
        x[i] = q[i] - it->turns[i];
    }
    if (status == LEASTACTION_STATUS_OK) status = leastaction_plan_command(&it->plan, it->tick, x, v, MACHINE_N, u, NULL);
    if (status == LEASTACTION_STATUS_OK) *duty = u[MACHINE_DRIVEN] / machine_full;
    return status;
}

leastaction_status machine_tick(machine *it, uint32_t elapsed, const int32_t *counts, float *duty) {
    float q[MACHINE_N];
    leastaction_status status = LEASTACTION_STATUS_OK;
    *duty = 0;
    for (int i = 0; i < MACHINE_N; i++) q[i] = (float)(counts[i] - machine_zero[i]) * machine_unit[i];
    if (it->tick > 0) it->tick += elapsed;
    take(it, elapsed, q);
    if (it->readings < MACHINE_WINDOW) return status;
    status = decide(it, q, duty);
    /* The plan's ticks count from the first command. */
    if (it->tick == 0) it->tick = status == LEASTACTION_STATUS_OK;
    if (*duty > 1) *duty = 1;
    if (*duty < -1) *duty = -1;
    return status;
}
