/* A model that follows its machine: a loop of a fixed rate, which moves a machine that carries a load that the model does not know.
 * ../tools/src/bin/trace/adapt.rs does the same in Rust. */
#include "example.h"

#define TICKS 960
/* What the machine carries, kg. */
#define LOAD 0.5f

static leastaction_adapter adapter;
static leastaction_model machine;
static leastaction_state state;
static uint64_t hash = HASH;
static const float start[N] = {MODEL_Q};
static float reference_q[N] = {MODEL_Q}, reference_v[N];

static void add(const float *x, size_t count) {
    hash = hashed(hash, x, count);
}

/* A motion to and fro, whose acceleration is constant but for its sign. */
static void go_on(uint32_t tick, float h, float *a) {
    for (uint32_t i = 0; i < N; i++) {
        uint32_t quarter = tick / (32 + 8 * i) % 4;
        a[i] = quarter == 0 || quarter == 3 ? 4.0f : -4.0f;
        reference_q[i] += h * reference_v[i];
        reference_v[i] += h * a[i];
    }
}

/* ANCHOR: adapt */
/* A tick of the loop: decide with the model whose numbers are in use, and let it follow. `before` is the force of the tick before. */
static int decide(uint32_t tick, const float *q, const float *v, const float *a, const float *before, float *u) {
    leastaction_error error;
    float wanted[N], force[N];
    for (int i = 0; i < N; i++) wanted[i] = a[i] + 16 * (reference_v[i] - v[i]) + 64 * (reference_q[i] - q[i]);
    if (leastaction_inverse_dynamics(&adapter.model, q, v, wanted, N, u, &error)) return refused("torque", &error);
    for (int i = 0; i < N; i++) force[i] = 0.5f * (before[i] + u[i]);
    /* For a while no readings come. */
    int missing = tick >= 100 && tick < 103;
    leastaction_status status =
        missing ? leastaction_adapter_skip(&adapter, &error) : leastaction_adapter_tick(&adapter, q, force, N, &error);
    return status ? refused("adapt", &error) : 0;
}
/* ANCHOR_END: adapt */

static int add_numbers(void) {
    leastaction_error error;
    leastaction_found found;
    if (leastaction_adapter_found(&adapter, &found, &error)) return refused("found", &error);
    for (uint32_t i = 0; i < found.numbers; i++) {
        leastaction_number number;
        if (leastaction_adapter_number(&adapter, i, &number, &error)) return refused("number", &error);
        add((float[]){number.model, number.estimate, number.standard_error, number.in_use, number.least, number.most}, 6);
    }
    return 0;
}

/* Begins anew with what was found, as after the power was off. */
static int restart(float h) {
    leastaction_error error;
    uint8_t patch[LEASTACTION_PATCH_BYTES];
    size_t bytes, model_bytes = (size_t)(model_file_end - model_file), settings_bytes = (size_t)(settings_file_end - settings_file);
    if (leastaction_adapter_save(&adapter, patch, sizeof patch, &bytes, &error)) return refused("save", &error);
    for (size_t i = 0; i < bytes; i++) add(&(float){patch[i]}, 1);
    memset(&adapter, 0, sizeof adapter);
    if (leastaction_adapter_begin(&adapter, sizeof adapter, LEASTACTION_ABI, model_file, model_bytes, settings_file, settings_bytes, h, &error)
        || leastaction_adapter_restore(&adapter, patch, bytes, &error)) {
        return refused("restore", &error);
    }
    return 0;
}

static int step(uint32_t tick, float h, float *before) {
    leastaction_error error;
    float q[N], v[N], a[N], u[N];
    if (leastaction_state_q(&state, N, q, &error) || leastaction_state_w(&state, N, v, &error)) return refused("measure", &error);
    go_on(tick, h, a);
    if (leastaction_adapter_freeze(&adapter, tick >= 400 && tick < 440, &error)) return refused("freeze", &error);
    if (decide(tick, q, v, a, before, u)) return 1;
    add(q, N);
    add(v, N);
    add(u, N);
    if (tick % 16 == 0 && add_numbers()) return 1;
    if (tick == 640 && restart(h)) return 1;
    if (leastaction_step4(&machine, &state, h, u, u, N, NULL, NULL, &error)) return refused("step", &error);
    memcpy(before, u, sizeof u);
    return 0;
}

/* ANCHOR: begin */
/* The model, and what it is told of the numbers that follow: files of `leastaction`, in flash. */
static int begin(float *h) {
    leastaction_error error;
    uint8_t order, control;
    size_t model_bytes = (size_t)(model_file_end - model_file), settings_bytes = (size_t)(settings_file_end - settings_file);
    if (leastaction_load(&machine, sizeof machine, LEASTACTION_ABI, machine_file, (size_t)(machine_file_end - machine_file), NULL, &error)
        || leastaction_trained_step(&machine, h, &order, &control, &error)) {
        return refused("machine", &error);
    }
    *h /= 8;
    if (leastaction_adapter_begin(&adapter, sizeof adapter, LEASTACTION_ABI, model_file, model_bytes, settings_file, settings_bytes, *h, &error)) {
        return refused("begin", &error);
    }
    return 0;
}
/* ANCHOR_END: begin */

/* ANCHOR: found */
/* What the machine carries, as far as it is sure. */
static int carries(void) {
    leastaction_error error;
    leastaction_found found;
    if (leastaction_adapter_found(&adapter, &found, &error)) return refused("found", &error);
    add((float[]){found.distance, found.standard_error}, 2);
    float off = found.distance - LOAD;
    return found.announced && !found.unlike && off < 0.0625f && off > -0.0625f ? 0 : refused("load", &error);
}
/* ANCHOR_END: found */

int adapt(void) {
    leastaction_error error;
    float h, rest[N] = {0}, before[N] = {0};
    if (begin(&h)) return 1;
    if (leastaction_start(&machine, &state, start, rest, N, &error)) return refused("start", &error);
    for (uint32_t tick = 0; tick < TICKS; tick++) {
        if (step(tick, h, before)) return 1;
    }
    if (carries()) return 1;
    put("adapt ");
    put_number(hash, 16);
    put("\n");
    return 0;
}
