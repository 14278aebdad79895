/* The templates' loop around a simulated machine, on a desk and on an emulated Cortex-M4F: the model itself, stepped by the library, with
 * encoders whose counters have 16 bits, a drive that acts one tick late, and a start 2 cm and 0.02 rad off the plan's. Prints a hash of all numbers. */
#include "../machine.h"
#include "example.h"

#define SECONDS 6

static machine loop;
static leastaction_state simulated;

static void put_hash(uint64_t hash) {
    char text[] = "hash 0000000000000000\n";
    for (int i = 20; i > 4; i--, hash >>= 4) text[i] = "0123456789abcdef"[hash & 15];
    put(text);
}

static int refused(const char *what, leastaction_status status) {
    put(what);
    put(": ");
    put(leastaction_message(status));
    put("\n");
    return 1;
}

static int32_t count(float x) {
    return (int32_t)(x + (x < 0 ? -0.5f : 0.5f));
}

static leastaction_status begin(void) {
    float q[MACHINE_N], v[MACHINE_N], u[MACHINE_N];
    leastaction_status status = machine_begin(&loop);
    if (status == LEASTACTION_STATUS_OK) status = leastaction_plan_reference(&loop.plan, 0, MACHINE_N, q, v, u, NULL);
    if (status != LEASTACTION_STATUS_OK) return status;
    for (int i = 0; i < MACHINE_N; i++) q[i] += 0.02f;
    return leastaction_start(&loop.model, &simulated, q, v, MACHINE_N, NULL);
}

int main(void) {
    float q[MACHINE_N], goal[MACHINE_N], v[MACHINE_N], u[MACHINE_N] = {0}, duty = 0, worst = 0;
    int32_t counts[MACHINE_N] = {0};
    uint64_t hash = HASH;
    leastaction_status status = begin();
    if (status != LEASTACTION_STATUS_OK) return refused("begin", status);
    uint32_t ticks = (uint32_t)(SECONDS / machine_period(&loop));
    for (uint32_t tick = 0; tick < ticks; tick++) {
        if ((status = leastaction_state_q(&simulated, MACHINE_N, q, NULL))) return refused("state", status);
        for (int i = 0; i < MACHINE_N; i++) counts[i] = machine_count(counts[i], (count(q[i] / machine_unit[i]) + machine_zero[i]) & 0xffff, 1 << 16);
        u[MACHINE_DRIVEN] = machine_full * duty;
        if ((status = machine_tick(&loop, 1, counts, &duty))) return refused("tick", status);
        if ((status = leastaction_step4(&loop.model, &simulated, machine_period(&loop), u, u, MACHINE_N, NULL, NULL, NULL)))
            return refused("step", status);
        hash = hashed(hashed(hash, q, MACHINE_N), &duty, 1);
    }
    if ((status = leastaction_plan_reference(&loop.plan, UINT32_MAX, MACHINE_N, goal, v, u, NULL))) return refused("goal", status);
    for (int i = 0; i < MACHINE_N; i++) {
        float error = q[i] < goal[i] ? goal[i] - q[i] : q[i] - goal[i];
        if (error > worst) worst = error;
    }
    put_hash(hash);
    put(worst < 0.05f ? "at the goal\n" : "NOT at the goal\n");
    return worst >= 0.05f;
}
